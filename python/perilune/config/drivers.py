"""Defaults and groups of the drivers."""

from __future__ import annotations

from typing import Annotated

from pydantic import BeforeValidator, Field, model_validator

from perilune.config.errors import fail
from perilune.config.types import Integer, StaticNonNegative, Strict, refuse_drawn
from perilune.drivers import Group, factor

Correlation = Annotated[float, Field(strict=True, ge=-1.0, le=1.0), BeforeValidator(refuse_drawn)]


class DriverGroup(Strict):
    """Settings and correlation of the drivers with `group: NAME`.

    Correlated draws use a Gaussian copula: normal drivers have the given correlations, other kinds
    are monotonic functions of correlated normal numbers."""

    jitter_strength: StaticNonNegative | None = None
    """Factor on every variance; 0 gives exactly the ideal values. Default: drivers.strength."""
    step_interval: Annotated[Integer, Field(ge=1)] | None = None
    """Steps between draws. Default: drivers.interval."""
    shared: Annotated[bool, Field(strict=True)] = False
    """Whether all drivers of the group use the same random draw."""
    members: Annotated[tuple[str, ...], Field(min_length=1)] | None = None
    """Key paths of the drivers, in the order of the rows of `correlation`."""
    correlation: tuple[tuple[Correlation, ...], ...] | None = None
    """Correlation matrix of `members`: symmetric, positive definite, ones on the diagonal."""

    @model_validator(mode="after")
    def _matrix(self) -> DriverGroup:
        if self.correlation is None:
            if self.members is not None:
                fail("members", "are the rows of `correlation`, which is missing")
            return self
        if self.shared:
            fail("shared", "give shared or correlation, not both")
        if self.members is None:
            fail("members", "required with correlation: the key paths of its rows")
        count = len(self.members)
        if len(set(self.members)) != count:
            fail("members", "a key path occurs twice")
        if len(self.correlation) != count or any(len(row) != count for row in self.correlation):
            fail("correlation", f"must be {count} x {count} for {count} members")
        try:
            factor(self.correlation)
        except ValueError as error:
            fail("correlation", str(error))
        return self

    def resolved(self, name: str) -> Group:
        """The group in the form that the drivers use."""
        return Group(
            name,
            self.jitter_strength,
            self.step_interval,
            self.shared,
            self.members or (),
            None if self.correlation is None else factor(self.correlation),
        )


class Drivers(Strict):
    """Defaults and groups of the drivers.

    A driver is a mapping in place of a value: {ideal, jitter_variance, clip_min, clip_max},
    {uniform: [low, high]}, {median, log_variance, clip_min, clip_max}, {choice: [...], weights:
    [...]} or {hook: module:function, ideal, ...}."""

    strength: StaticNonNegative = 1.0
    """Factor on every variance; 0 gives exactly the ideal values."""
    interval: Annotated[Integer, Field(ge=1)] | None = None
    """Steps between draws of a value. Default: time.frames_per_scene."""
    groups: dict[str, DriverGroup] = Field(default_factory=dict)
    """Groups of drivers with settings of their own, or correlated."""
