"""Positions of the Sun, planets and moons, by series (solar_system.py) or SPICE kernels."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from perilune import _core
from perilune.base.files import stamp
from perilune.config.errors import nearest
from perilune.config.schema import Config
from perilune.orbits import solar_system
from perilune.orbits.ephemerides.spice import Spice, objects
from perilune.orbits.solar_system import Date

F64 = NDArray[np.float64]

_NAIF: dict[str, tuple[int, ...]] = {
    "sun": (10,),
    "mercury": (199, 1),
    "venus": (299, 2),
    "earth": (399,),
    "moon": (301,),
    "mars": (499, 4),
    "jupiter": (599, 5),
    "saturn": (699, 6),
    "uranus": (799, 7),
    "neptune": (899, 8),
    "phobos": (401,),
    "europa": (502,),
}
"""Body -> its NAIF number and that of its system's barycentre. The barycentre replaces a planet
that a kernel lacks: an error of 0.2 m for Mars, up to 300 km for giant planets. Never for the
Earth."""


@dataclass(frozen=True)
class Almanac:
    """Geometric states in ICRF axes, without light time and aberration."""

    kernels: tuple[Path, ...] = ()
    """SPICE kernels; without them the series of perilune.orbits.solar_system are used."""

    def has(self, name: str) -> bool:
        """Whether the position of a body at a date is known."""
        return solar_system.has_ephemeris(name)

    def source(self, name: str) -> str:
        """Source and accuracy of a body's position, in words."""
        if self.kernels and self._number(name) is not None:
            return ", ".join(str(path) for path in self.kernels)
        return solar_system.accuracy(name)

    def _number(self, name: str) -> int | None:
        held = _held(self.kernels, tuple(stamp(path) for path in self.kernels))
        return next((number for number in _NAIF.get(name, ()) if number in held), None)

    def relative_state(self, name: str, origin: str, date: Date) -> F64:
        """Position and velocity (6,), m and m/s, of a body relative to another's centre; `sun` is a
        body too. ValueError for a body that no kernel has."""
        if not self.kernels or name == origin:
            return solar_system.relative_state(name, origin, date)
        for moon, sign in ((name, 1.0), (origin, -1.0)):
            planet = self._series_about(moon)
            if planet is None:
                continue
            offset = sign * solar_system.relative_state(moon, planet, date)
            ends = (planet, origin) if sign > 0.0 else (name, planet)
            return np.asarray(offset + self.relative_state(*ends, date))
        target, observer = (self._known(end) for end in (name, origin))
        rows = Spice(self.kernels, str(target), str(observer)).states(date, np.zeros(1))
        return np.asarray(rows[0])

    def relative_m(self, name: str, origin: str, date: Date) -> F64:
        """Position (3,) alone, m."""
        return self.relative_state(name, origin, date)[:3]

    def _series_about(self, name: str) -> str | None:
        """The planet of a moon that no kernel has; the series gives the moon's position relative to
        it."""
        if name == "moon" or name not in _core.BODIES or self._number(name) is not None:
            return None
        parent = _core.BODIES[name]["parent"]
        return parent if parent not in (None, "sun") else None

    def _known(self, name: str) -> int:
        if name not in _NAIF:
            raise ValueError(f"no ephemeris of '{name}'{nearest(name, _NAIF)}")
        number = self._number(name)
        if number is None:
            numbers = " or ".join(str(one) for one in _NAIF[name])
            files = ", ".join(str(path) for path in self.kernels)
            raise ValueError(f"ephemeris.kernels: no {name} (SPICE's {numbers}) in {files}")
        return number


@lru_cache(maxsize=16)
def _held(kernels: tuple[Path, ...], _: tuple[object, ...]) -> frozenset[int]:
    return frozenset(number for path in kernels for number in objects(path))


def sources(config: Config) -> dict[str, str]:
    """Key of each body without an orbit, and of the Sun -> source of its position."""
    places = almanac(config)
    found = {}
    for name, body in config.bodies.items():
        table = body.ephemeris if body.kind == "ellipsoid" else body.kind
        if body.orbit is None and name != config.root and table is not None:
            found[f"bodies.{name}"] = places.source(table)
    if config.sun.by_date:
        root = config.bodies[config.root]
        table = (root.ephemeris if root.kind == "ellipsoid" else root.kind) or "earth"
        found["sun"] = places.source("sun" if places.kernels else table)
    return found


def almanac(config: Config) -> Almanac:
    """The almanac of a configuration."""
    return Almanac(tuple(Path(text) for text in config.ephemeris.kernels))
