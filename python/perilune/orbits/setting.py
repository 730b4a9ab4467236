"""Inputs of orbits: the configuration of a frame and properties of central bodies."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from functools import lru_cache
from pathlib import Path
from types import MappingProxyType
from typing import Any

import numpy as np
from numpy.typing import NDArray

from perilune import _core
from perilune.base.hooks import Hook
from perilune.base.same import Latest, Same
from perilune.config.body import Body
from perilune.config.schema import Config
from perilune.orbits.ground import Ground, smooth
from perilune.orbits.motion import Kept
from perilune.orbits.solar_system import Date

F64 = NDArray[np.float64]

KM = 1e3


@dataclass(frozen=True)
class Setting:
    """The configuration of a frame, and what else its orbits need."""

    config: Config
    epoch: Date
    scene: int
    file: Callable[[str, str], Path]
    """Resolves a path of the configuration; its key is for errors."""
    craft_radius_m: Callable[[str], float]
    """Bounding radius of a spacecraft; may load the model."""
    hooks: Mapping[str, Hook] = field(default_factory=lambda: MappingProxyType({}))
    """Object's name -> function given in code that replaces the configured orbit."""
    first_of_scene: Callable[[], Setting] | None = None
    """Setting of the scene's first step; None if this is it."""
    grounds: Callable[[str], Ground | None] = lambda name: None
    """Ground of a body with a shape; None for a smooth ellipsoid. May load files."""
    craft_bounds_m: Callable[[str], F64] | None = None
    """(2, 3): lower and upper corner of a spacecraft's box, in its axes about its origin. Default:
    the box about its bounding sphere."""
    drawn: Kept[Any] = field(default_factory=lambda: Kept(64), compare=False)
    """(Scene, name) -> path, for orbits drawn once a scene."""
    nodes: Same[list[dict[str, Any]]] = field(default_factory=Same, compare=False)
    """The tree's nodes, while no driver changes what they are made from."""
    each_node: Latest[dict[str, Any]] = field(default_factory=Latest, compare=False)
    """The same for single nodes, by name."""

    @property
    def start(self) -> Setting:
        """Setting of the scene's first step, from which the scene's orbits are drawn."""
        return self if self.first_of_scene is None else self.first_of_scene()

    def ground(self, name: str) -> Ground:
        """The ground of a body; the same object as long as nothing changes it."""
        body = self.config.bodies[name]
        x, y, z = radii_m(body).tolist()
        return self.grounds(name) or smooth((x, y, z), body.is_geodetic)

    @property
    def start_s(self) -> float:
        """Time of the scene's first step, in seconds after the epoch."""
        time = self.config.time
        return time.step_s * (self.scene * time.frames_per_scene)


@dataclass(frozen=True)
class Parent:
    """The central body of an orbit."""

    name: str
    table: str | None
    """Name in the core's table of bodies."""
    is_body: bool
    gm_or_none: float | None
    _radii_m: Callable[[], F64]

    @property
    def radii_m(self) -> F64:
        """Semi-axes of a body; bounding radius of a spacecraft."""
        return self._radii_m()

    @property
    def mean_radius_m(self) -> float:
        """Mean equatorial radius, the reference of altitudes."""
        x, y, _ = self.radii_m.tolist()
        return float(0.5 * (x + y))

    @property
    def gm_m3_s2(self) -> float:
        """Gravitational parameter; ValueError for a spacecraft without one."""
        if self.gm_or_none is None:
            raise ValueError(f"an orbit about {self.name} needs spacecraft.{self.name}.gm_km3_s2")
        return self.gm_or_none


def table_name(body: Body) -> str | None:
    """Name of the body in the core's table; None for a free ellipsoid."""
    return body.ephemeris if body.kind == "ellipsoid" else body.kind


def ephemeris_name(config: Config, name: str) -> str | None:
    """Body whose ephemeris places one without an orbit; a free ellipsoid as root uses the
    Earth's."""
    return table_name(config.bodies[name]) or ("earth" if name == config.root else None)


def radii_m(body: Body) -> F64:
    """Semi-axes, body-fixed; read-only."""
    return _radii_m(body.kind, body.radii_km)


@lru_cache(maxsize=256)
def _radii_m(kind: str, radii_km: tuple[float, ...] | None) -> F64:
    if radii_km is not None:
        found = np.array(radii_km) * KM
    else:
        found = np.array(_core.BODIES[kind]["radii_m"], dtype=np.float64)
    found.flags.writeable = False
    return found


def gm_m3_s2(body: Body) -> float:
    """Gravitational parameter."""
    if body.gm_km3_s2 is not None:
        return body.gm_km3_s2 * 1e9
    return float(_core.BODIES[body.kind]["gm_m3_s2"])


def parent_of(setting: Setting, name: str) -> Parent:
    """The central body of orbits around `name`."""
    entry = setting.config.bodies.get(name) or setting.config.spacecraft[name]
    if isinstance(entry, Body):
        return Parent(name, table_name(entry), True, gm_m3_s2(entry), lambda: radii_m(entry))
    gm = None if entry.gm_km3_s2 is None else entry.gm_km3_s2 * 1e9
    return Parent(name, None, False, gm, lambda: np.full(3, setting.craft_radius_m(name)))
