"""What all drivers of a tree draw at a step: their settings resolved, their groups correlated.

Strength and interval of a driver are its own, or its group's, or those of the section it stands in,
or the defaults. Draws are keyed by (seed, key path, step // interval), in a correlated group by the
group's name instead of the path and taken at the driver's place among the members: independent of
the order of keys, of workers and of other drivers.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from difflib import get_close_matches
from pathlib import Path
from typing import Any

import numpy as np

from perilune.base.random import generator
from perilune.drivers.common import F64, DriverError, KeyPath, Source
from perilune.drivers.hook import Hooked
from perilune.drivers.log_normal import LogNormal
from perilune.drivers.normal import Normal
from perilune.drivers.tree import Found

_SYMMETRIC = 1e-12
"""Difference of two elements of a correlation matrix that rounding explains."""

PILED = 0.1
"""Share of a driver's draws on one of its limits that is worth a warning: most that clip mean to
keep a tail out, not to draw one value more often than any other."""


def factor(correlation: Sequence[Sequence[float]]) -> F64:
    """Lower triangular L with L L^T = the correlation matrix; ValueError if it is none."""
    matrix = np.array(correlation, dtype=np.float64)
    if matrix.ndim != 2 or matrix.shape[0] != matrix.shape[1]:
        raise ValueError("must be a square matrix")
    if np.abs(matrix - matrix.T).max() > _SYMMETRIC:
        raise ValueError("must be symmetric")
    if (np.diag(matrix) != 1.0).any():
        raise ValueError("must have ones on its diagonal: it holds correlations, not covariances")
    try:
        lower = np.asarray(np.linalg.cholesky(matrix), dtype=np.float64)
    except np.linalg.LinAlgError:
        raise ValueError(
            "must be positive definite: no numbers can be so correlated (for the same draw in all "
            "members say shared: true)"
        ) from None
    return lower


@dataclass(frozen=True)
class Group:
    """A named group: settings of its drivers, and how their draws go together."""

    name: str = ""
    strength: float | None = None
    interval: int | None = None
    shared: bool = False
    members: tuple[str, ...] = ()
    """Key paths, in the order of the matrix's rows."""
    factor: F64 | None = None
    """(m, m): see `factor`."""

    @property
    def correlates(self) -> bool:
        """Whether its drivers' draws depend on each other."""
        return self.shared or self.factor is not None

    def normals(self, seed: int, epoch: int, member: str) -> Callable[[int], F64] | None:
        """Draws of a member: value k of each goes with value k of the others."""
        if not self.correlates:
            return None

        def draw(count: int) -> F64:
            rng = generator(seed, f"driver-group:{self.name}", epoch)
            if self.factor is None:
                return rng.standard_normal(count)
            free = rng.standard_normal((count, len(self.members)))
            row = self.factor[self.members.index(member)]
            # Summed in a fixed order: BLAS may round otherwise on another machine.
            total = np.zeros(count)
            for k, weight in enumerate(row.tolist()):
                total += weight * free[:, k]
            return total

        return draw


@dataclass(frozen=True)
class Defaults:
    """For drivers that nothing else sets."""

    strength: float = 1.0
    interval: int = 1


@dataclass(frozen=True)
class Plan:
    """Drivers, ready to be drawn."""

    drivers: tuple[Found, ...] = ()
    groups: Mapping[str, Group] = field(default_factory=dict)
    defaults: Defaults = Defaults()

    def check(self) -> None:
        """DriverError for a driver that does not fit the group it names."""
        for driver in self.drivers:
            self._check(driver)

    def _check(self, driver: Found) -> None:
        if driver.group is None:
            return
        group = self.groups.get(driver.group)
        key = f"{driver.name}.group"
        if group is None:
            known = list(self.groups)
            close = get_close_matches(driver.group, known, n=1, cutoff=0.5)
            hint = f"; did you mean '{close[0]}'?" if close else ";"
            allowed = f"{hint} allowed: {', '.join(known) or '(none)'}"
            raise DriverError(key, f"no group '{driver.group}' in drivers.groups{allowed}")
        if not group.correlates:
            return
        if not driver.kind.correlates:
            text = f"a {driver.kind.name} draws by itself; '{group.name}' correlates its draws"
            raise DriverError(key, text)
        if driver.interval is not None:
            text = f"the draws of the group '{group.name}' go together; set its step_interval"
            raise DriverError(f"{driver.name}.interval", text)
        if group.factor is not None and driver.name not in group.members:
            text = f"is not among drivers.groups.{group.name}.members, the rows of its correlation"
            raise DriverError(key, text)

    @property
    def ideals(self) -> dict[KeyPath, Any]:
        """Path -> value without strength."""
        return {driver.path: driver.ideal for driver in self.drivers}

    @property
    def ideal_keys(self) -> dict[str, str]:
        """Key path -> the driver's key that the ideal stands in, `.ideal`."""
        return {driver.name: driver.distribution.ideal_key for driver in self.drivers}

    def loaded(self, file: Callable[[str, str], Path] | None) -> Plan:
        """With the functions of hooks; HookError for one that is not there."""
        rows = tuple(
            replace(row, distribution=row.distribution.load(file))
            if isinstance(row.distribution, Hooked)
            else row
            for row in self.drivers
        )
        return replace(self, drivers=rows)

    def settings(self, driver: Found, step: int) -> tuple[float, int, int]:
        """Of the draw of a driver at a step: strength, number, and the first step it is for."""
        group = self.groups[driver.group] if driver.group is not None else Group()
        strengths = (driver.strength, group.strength, driver.section.strength)
        # Drivers of different sections go together in a correlated group.
        around = None if group.correlates else driver.section.interval
        intervals = (driver.interval, group.interval, around)
        strength = next((row for row in strengths if row is not None), self.defaults.strength)
        interval = next((row for row in intervals if row is not None), self.defaults.interval)
        epoch = step // interval
        if isinstance(strength, tuple):
            strength = strength[min(epoch, len(strength) - 1)]
        return strength, epoch, epoch * interval

    def piled(self) -> Iterator[tuple[Found, str, float]]:
        """(driver, limit, share of its draws that are clipped to it), of those above PILED."""
        for driver in self.drivers:
            if isinstance(driver.distribution, (Normal, LogNormal)):
                strength, _, _ = self.settings(driver, 0)
                rows = driver.distribution.standard_limits(strength)
                for name, at, sign in (("clip_min", 0, -1.0), ("clip_max", 1, 1.0)):
                    shares = [
                        0.5 * math.erfc(sign * row[at] / math.sqrt(2.0))
                        for row in rows
                        if row[0] < row[1]  # else it asks for one value
                    ]
                    if max(shares, default=0.0) > PILED:
                        yield driver, name, max(shares)

    def draw(self, driver: Found, seed: int, step: int) -> Any:
        """The value of one driver at a step."""
        strength, epoch, first = self.settings(driver, step)
        group = self.groups[driver.group] if driver.group is not None else Group()
        normals = group.normals(seed, epoch, driver.name)
        source = Source(driver.name, seed, first, epoch, normals)
        return driver.distribution.draw(source, strength)

    def values(self, seed: int, step: int) -> dict[KeyPath, Any]:
        """Path -> value at a step."""
        return {driver.path: self.draw(driver, seed, step) for driver in self.drivers}
