"""Dates in files: from text and time scale to JD(TDB)."""

from __future__ import annotations

import re
import warnings
from collections.abc import Sequence
from datetime import date, timedelta

import erfa
import numpy as np
from numpy.typing import NDArray

from perilune.config import utc
from perilune.config.errors import nearest
from perilune.orbits.solar_system import Date

F64 = NDArray[np.float64]

SCALES = ("UTC", "TAI", "TT", "TDB", "GPS")
_GPS_BEHIND_TAI_S = 19.0
_DAY_S = 86400.0
_LAST_SECOND = 60.0
_DATE = re.compile(
    r"(\d{4})-(?:(\d{3})|(\d\d)-(\d\d))(?:[T ](\d\d):(\d\d)(?::(\d\d(?:\.\d*)?))?)?Z?"
)


def _fields(text: str) -> tuple[int, int, int, int, int, float]:
    match = _DATE.fullmatch(text.strip())
    if match is None:
        raise ValueError(f"'{text}' is no date such as 2026-03-20T12:00:00.0 or 2026-079T12:00:00")
    year, hour, minute = (int(match[k] or 0) for k in (1, 5, 6))
    second = float(match[7] or 0.0)
    try:
        if match[2]:
            day = date(year, 1, 1) + timedelta(int(match[2]) - 1)
        else:
            day = date(year, int(match[3]), int(match[4]))
    except (ValueError, OverflowError) as error:
        raise ValueError(f"'{text}' is no date: {error}") from None
    leap = (hour, minute) == (23, 59)  # where there may be a second 60
    if day.year != year or hour > 23 or minute > 59 or second >= (61.0 if leap else 60.0):
        raise ValueError(f"'{text}' is no date")
    return (year, day.month, day.day, hour, minute, second)


def seconds_of(texts: Sequence[str], scale: str, epoch: Date) -> F64:
    """Seconds of TT from `epoch` to each date. ValueError for an invalid date, or a scale that is
    not in SCALES."""
    if scale not in SCALES:
        raise ValueError(f"no time system '{scale}'{nearest(scale, SCALES)}")
    fields = [_fields(text) for text in texts]
    for text, row in zip(texts, fields, strict=True):
        if scale == "UTC" and row[5] >= _LAST_SECOND and utc.complaint(row):
            raise ValueError(f"'{text}' is no date: there was no leap second")
    kind = "UTC" if scale == "UTC" else "TAI"  # dtf2d knows leap seconds in UTC alone
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", erfa.ErfaWarning)  # dubious year: leap seconds to come
        try:
            day, part = erfa.dtf2d(kind, *np.array(fields, dtype=object).T.tolist())
        except erfa.ErfaError as error:
            raise ValueError(f"not a date: {error}") from None
        if scale == "UTC":
            day, part = erfa.taitt(*erfa.utctai(day, part))
        elif scale == "TAI":
            day, part = erfa.taitt(day, part)
        elif scale == "GPS":
            day, part = erfa.taitt(day, part + _GPS_BEHIND_TAI_S / _DAY_S)
        elif scale == "TDB":
            day, part = erfa.tdbtt(day, part, erfa.dtdb(day, part, 0.0, 0.0, 0.0, 0.0))
    start = _tt_of_epoch(epoch)
    return np.asarray(((day - start[0]) + (part - start[1])) * _DAY_S)


def _tt_of_epoch(epoch: Date) -> tuple[float, float]:
    shift = erfa.dtdb(epoch.day, epoch.fraction, 0.0, 0.0, 0.0, 0.0)
    day, fraction = erfa.tdbtt(epoch.day, epoch.fraction, shift)
    return float(day), float(fraction)


def tt_of(epoch: Date, t_s: F64) -> tuple[F64, F64]:
    """JD(TT) in two parts for the times t_s, in seconds after an epoch."""
    day, fraction = _tt_of_epoch(epoch)
    later = fraction + np.asarray(t_s) / _DAY_S
    return np.full_like(later, day), later


def utc_of(epoch: Date, t_s: F64) -> tuple[F64, F64]:
    """Quasi JD(UTC), as in ERFA, of the same times."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", erfa.ErfaWarning)
        return erfa.taiutc(*erfa.tttai(*tt_of(epoch, t_s)))  # type: ignore[no-any-return]


def tt_of_utc(day: float, fraction: float) -> tuple[float, float]:
    """JD(TT) of a quasi JD(UTC), both in two parts."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", erfa.ErfaWarning)
        tt = erfa.taitt(*erfa.utctai(day, fraction))
    return float(tt[0]), float(tt[1])
