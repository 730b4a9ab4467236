"""Values of all drivers of a tree at a step, with settings resolved and groups correlated.

Strength and interval of a driver are its own, those of its group, of the section that contains it,
or the defaults, in this order. Draws are keyed by (seed, key path, step // interval); in a
correlated group by the group's name, with one number for each member. They do not depend on the
order of keys, on workers or on other drivers."""

from __future__ import annotations

import copy
import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from difflib import get_close_matches
from functools import cached_property
from itertools import accumulate, pairwise
from pathlib import Path
from typing import Any, NamedTuple, TypeAlias

import numpy as np
from numpy.typing import NDArray

from perilune import _core
from perilune.base.random import stable_hash
from perilune.drivers.clipped import Clipped
from perilune.drivers.common import F64, DriverError, KeyPath, Need, Source
from perilune.drivers.hook import Hooked
from perilune.drivers.tree import Found
from perilune.drivers.truncated import Truncated

_SYMMETRIC = 1e-12
"""Largest difference of mirrored elements of a correlation matrix that rounding explains."""

PILED = 0.1
"""Fraction of a driver's draws on one of its limits above which a warning is given: clips are
mostly meant to cut off a tail, not to make one value more frequent than any other."""


def factor(correlation: Sequence[Sequence[float]]) -> F64:
    """Cholesky factor: lower triangular L with L L^T = the correlation matrix; ValueError if there
    is none."""
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
    """A named group: settings and correlation of its drivers."""

    name: str = ""
    strength: float | None = None
    interval: int | None = None
    shared: bool = False
    members: tuple[str, ...] = ()
    """Key paths, in the order of the matrix's rows."""
    factor: F64 | None = None
    """(m, m) Cholesky factor; see `factor`."""

    @property
    def correlates(self) -> bool:
        """Whether the draws of its drivers depend on each other."""
        return self.shared or self.factor is not None

    @property
    def width(self) -> int:
        """Number of independent normals per member; value k of a member is correlated with value k
        of others."""
        return 1 if self.factor is None else len(self.members)

    def normals(self, free: Sequence[float], member: str) -> list[float]:
        """Normals of a member from independent ones, `width` per member; all members receive the
        same input."""
        if self.factor is None:
            return list(free)
        row = self.factor[self.members.index(member)].tolist()
        found = []
        for first in range(0, len(free), self.width):
            total = 0.0  # in a fixed order: BLAS may round otherwise on another machine
            for weight, value in zip(row, free[first : first + self.width], strict=True):
                total += weight * value
            found.append(total)
        return found


def copied(value: Any) -> Any:
    """A copy of a drawn value, which the caller may change."""
    return value if isinstance(value, (float, int, str)) else copy.deepcopy(value)


class Named(Mapping[str, Any]):
    """Values of drivers by their key paths as text, copied when they are first read."""

    def __init__(self, drivers: Sequence[Found], values: Mapping[KeyPath, Any]) -> None:
        self._drivers = drivers
        self._values = values

    @cached_property
    def _copies(self) -> dict[str, Any]:
        return {driver.name: copied(self._values[driver.path]) for driver in self._drivers}

    def __getitem__(self, name: str) -> Any:
        return self._copies[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self._copies)

    def __len__(self) -> int:
        return len(self._drivers)


@dataclass(frozen=True)
class Defaults:
    """Settings of drivers that nothing else sets."""

    strength: float = 1.0
    interval: int = 1


_Draw: TypeAlias = tuple[int, float, int]
"""Key of a draw: seed, strength, number."""


@dataclass
class _Row:
    """A driver with everything about its draws that is the same at all steps, and its last draw."""

    driver: Found
    strength: float | tuple[float, ...]
    interval: int
    group: Group | None
    """Its group, if that correlates."""
    key: int
    """Key of the random number generator."""
    needs: dict[float, Need | None] = field(default_factory=dict)
    """Strength -> random numbers that a draw needs."""
    scalars: dict[float, Callable[[float], Any] | None] = field(default_factory=dict)
    """Strength -> function that makes a single number of its standard one, where there is one."""
    last: tuple[_Draw, Any] | None = None
    """The last draw. It is replaced as a whole, because threads draw for different steps."""

    @cached_property
    def varies(self) -> bool:
        """Whether its draws may differ from the ideal."""
        strengths = self.strength if isinstance(self.strength, tuple) else (self.strength,)
        needs = map(self.driver.distribution.needs, strengths)
        return isinstance(self.driver.distribution, Hooked) or any(needs)

    def strength_of(self, epoch: int) -> float:
        """Strength of the draw of a number."""
        strength = self.strength
        if isinstance(strength, tuple):
            return strength[min(epoch, len(strength) - 1)]
        return strength

    def need(self, strength: float) -> tuple[bool, int]:
        """Whether a draw takes normals, and how many numbers."""
        if strength not in self.needs:
            self.needs[strength] = self.driver.distribution.needs(strength)
        need = self.needs[strength]
        if need is None:
            return False, 0
        width = 1 if self.group is None else self.group.width
        return need.normal or self.group is not None, need.numbers * width

    def _scalar(self, strength: float) -> Callable[[float], Any] | None:
        if strength not in self.scalars:
            given, found = self.driver.distribution, None
            if self.group is None and isinstance(given, Clipped | Truncated):
                found = given.scalar_draw(strength) if given.needs(strength) is not None else None
            self.scalars[strength] = found
        return self.scalars[strength]

    def drawn(self, draw: _Draw, drawn: Sequence[float]) -> Any:
        """A new value. drawn: the standard numbers that it needs."""
        seed, strength, epoch = draw
        scalar = self._scalar(strength)
        if scalar is not None:
            return scalar(drawn[0])
        source = Source(self.driver.name, seed, epoch * self.interval, epoch, drawn)
        if self.group is not None:
            normals = self.group.normals(source.drawn, self.driver.name)
            source = source._replace(drawn=normals, correlates=True)
        return self.driver.distribution.draw(source, strength)


@dataclass(frozen=True)
class Plan:
    """Drivers that are ready to be drawn."""

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
        """Path -> ideal value."""
        return {driver.path: driver.ideal for driver in self.drivers}

    @property
    def ideal_keys(self) -> dict[str, str]:
        """Key path -> key of the driver that holds the ideal, such as `.ideal`."""
        return {driver.name: driver.distribution.ideal_key for driver in self.drivers}

    def loaded(self, file: Callable[[str, str], Path] | None) -> Plan:
        """The plan with the functions of hooks loaded; HookError for a missing one."""
        rows = tuple(
            replace(row, distribution=row.distribution.load(file))
            if isinstance(row.distribution, Hooked)
            else row
            for row in self.drivers
        )
        return replace(self, drivers=rows)

    @cached_property
    def _rows(self) -> list[_Row]:
        return [self._row(driver) for driver in self.drivers]

    def _row(self, driver: Found) -> _Row:
        group = self.groups[driver.group] if driver.group is not None else Group()
        strengths = (driver.strength, group.strength, driver.section.strength)
        # Drivers of different sections go together in a correlated group.
        around = None if group.correlates else driver.section.interval
        intervals = (driver.interval, group.interval, around)
        strength = next((row for row in strengths if row is not None), self.defaults.strength)
        interval = next((row for row in intervals if row is not None), self.defaults.interval)
        own = f"driver-group:{group.name}" if group.correlates else f"driver:{driver.name}"
        correlated = group if group.correlates else None
        return _Row(driver, strength, interval, correlated, stable_hash(own))

    def piled(self) -> Iterator[tuple[Found, str, float]]:
        """(driver, limit, fraction of draws clipped to it), where the fraction is above PILED."""
        for row in self._rows:
            driver = row.driver
            if isinstance(driver.distribution, Clipped):
                limits = driver.distribution.standard_limits(row.strength_of(0))
                for name, at, sign in (("clip_min", 0, -1.0), ("clip_max", 1, 1.0)):
                    shares = [
                        0.5 * math.erfc(sign * limit[at] / math.sqrt(2.0))
                        for limit in limits
                        if limit[0] < limit[1]  # else it asks for one value
                    ]
                    if max(shares, default=0.0) > PILED:
                        yield driver, name, max(shares)

    @cached_property
    def fixed(self) -> Mapping[KeyPath, Any]:
        """Path -> value of the drivers that have the same at all steps."""
        return {row.driver.path: row.driver.ideal for row in self._rows if not row.varies}

    @cached_property
    def _in_order(self) -> Mapping[KeyPath, Any]:
        """`fixed`, with None for what is drawn, in the order of the drivers."""
        return {row.driver.path: self.fixed.get(row.driver.path) for row in self._rows}

    @cached_property
    def _varying(self) -> list[_Row]:
        return [row for row in self._rows if row.varies]

    @cached_property
    def _standards(self) -> _Standards:
        return _Standards()

    def values(self, seed: int, step: int) -> dict[KeyPath, Any]:
        """Path -> value at a step."""
        found = dict(self._in_order)
        new: list[tuple[_Row, _Draw]] = []
        for row in self._varying:
            epoch = step // row.interval
            draw = (seed, row.strength_of(epoch), epoch)
            last = row.last
            if last is not None and last[0] == draw:
                found[row.driver.path] = last[1]
            else:
                new.append((row, draw))
        if not new:
            return found
        for (row, draw), drawn in zip(new, self._standards.draw(seed, new), strict=True):
            value = row.drawn(draw, drawn)
            row.last = draw, value
            found[row.driver.path] = value
        return found


class _Columns(NamedTuple):
    """What the core is told of the random numbers of some drivers, apart from their counters."""

    drivers: list[tuple[str, float]]
    """Name and strength of each."""
    keys: NDArray[np.uint64]
    normal: NDArray[np.bool_]
    counts: NDArray[np.int64]
    spans: list[tuple[int, int]]
    """Where the numbers of each begin and end."""


class _Standards:
    """Draws the standard random numbers of drivers in one call of the core."""

    def __init__(self) -> None:
        self._last: _Columns | None = None
        """Those of the last draw: mostly the same drivers draw together."""

    def draw(self, seed: int, rows: Sequence[tuple[_Row, _Draw]]) -> list[list[float]]:
        """The numbers of each driver."""
        drivers = [(row.driver.name, draw[1]) for row, draw in rows]
        columns = self._last
        if columns is None or columns.drivers != drivers:
            columns = self._last = _columns(drivers, rows)
        epochs = np.array([draw[2] for _, draw in rows], dtype=np.uint64)
        numbers = _core.draws(seed, columns.keys, epochs, columns.normal, columns.counts).tolist()
        return [numbers[begin:end] for begin, end in columns.spans]


def _columns(drivers: list[tuple[str, float]], rows: Sequence[tuple[_Row, _Draw]]) -> _Columns:
    needs = [row.need(strength) for row, (_, strength, _) in rows]
    counts = [count for _, count in needs]
    return _Columns(
        drivers,
        np.array([row.key for row, _ in rows], dtype=np.uint64),
        np.array([normal for normal, _ in needs], dtype=np.bool_),
        np.array(counts, dtype=np.int64),
        list(pairwise(accumulate(counts, initial=0))),
    )
