"""The time of the first frame, and the steps between frames."""

from __future__ import annotations

import re
from typing import Annotated

from pydantic import Field, field_validator

from perilune.config import utc
from perilune.config.errors import fail
from perilune.config.types import Finite, Integer, Strict

_EPOCH = re.compile(
    r"(\d{4})-(\d\d)-(\d\d)(?:[T ](\d\d):(\d\d)(?::(\d\d(?:\.\d{1,9})?))?)?(?:Z|\+00:00)?"
)
_YEARS = (1960, 2100)  # UTC exists since 1960; the ephemeris of the Earth holds until 2100


class Time(Strict):
    """Time of the steps.

    Step k is step_s * k seconds after the epoch. These are SI seconds, as of TT and TAI, so a leap
    second in between shifts the UTC date by one second. Each step is one frame, or with `sensors`
    one frame of each sensor that is triggered."""

    epoch: str
    """Time of step 0: UTC in ISO 8601, such as 2026-03-20T12:00:00Z."""
    step_s: Finite = 0.0
    """Time from one step to the next."""
    frames_per_scene: Annotated[Integer, Field(ge=1)] = 1
    """Steps per scene. Values drawn once a scene (orbits of the kinds database and hook, drivers
    without an interval) are drawn anew at its start; what is drawn at every step goes on."""

    @field_validator("epoch")
    @classmethod
    def _iso_utc(cls, value: str) -> str:
        match = _EPOCH.fullmatch(value)
        if not match:
            fail("", "must be an ISO 8601 date in UTC, such as 2026-03-20T12:00:00Z")
        if not _YEARS[0] <= int(match[1]) <= _YEARS[1]:
            fail("", f"years {_YEARS[0]} to {_YEARS[1]} are covered")
        if wrong := utc.complaint(_fields(match)):
            fail("", wrong)
        return value

    def utc_fields(self) -> tuple[int, int, int, int, int, float]:
        """Year, month, day, hour, minute, second of the epoch."""
        match = _EPOCH.fullmatch(self.epoch)
        assert match is not None  # the validator has matched it
        return _fields(match)


def _fields(match: re.Match[str]) -> tuple[int, int, int, int, int, float]:
    year, month, day, hour, minute = (int(match[k] or 0) for k in range(1, 6))
    return year, month, day, hour, minute, float(match[6] or 0.0)
