"""The grounds of bodies with terrain or a shape, made once for each value of their drivers."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Protocol

from perilune import _core, orbits
from perilune.bodies import terrain as terrains
from perilune.bodies.elevation import ElevationRaster, read_elevation
from perilune.bodies.shapes import BodyShape
from perilune.config.body import Body
from perilune.config.errors import ConfigError
from perilune.config.types import Latitudes
from perilune.document.document import Document
from perilune.orbits.ground import Ground

_GROUNDS = 16
"""Number of grounds to cache, of which a body has one for each value of its drivers."""


class Teller(Protocol):
    """Receives warnings about a file or a key of the configuration."""

    def tell(self, key: str, path: str, lines: tuple[str, ...]) -> None: ...
    def tell_of_key(self, key: str, text: str) -> None: ...


def _make_room(kept: dict[Any, Any]) -> None:
    if len(kept) >= _GROUNDS:
        del kept[next(iter(kept))]


class Terrains:
    """Shared by the configurations that are derived from one another."""

    def __init__(self) -> None:
        self._elevations: dict[tuple[Any, ...], ElevationRaster] = {}
        self._terrains: dict[tuple[Any, ...], tuple[_core.Terrain, Ground]] = {}
        self._shapes: dict[tuple[Any, ...], Ground] = {}

    def of_shape(self, name: str, body: Body, shape: Callable[[], BodyShape]) -> Ground:
        """The ground of a body with a shape."""
        radii = orbits.radii_m(body)
        key = (name, body.shape, tuple(radii.tolist()), body.is_geodetic)
        if key not in self._shapes:
            _make_room(self._shapes)
            self._shapes[key] = Ground(radii, body.is_geodetic, shape().surfaces_m)
        return self._shapes[key]

    def _elevation(
        self, document: Document, name: str, k: int, body: Body, teller: Teller
    ) -> ElevationRaster:
        """An elevation model of a body; each is read once."""
        assert body.terrain is not None  # it has elevation models
        given, key = body.terrain.elevation[k], f"bodies.{name}.terrain.elevation[{k}]"
        path = document.path(given.file, f"{key}.file")
        x, y, z = orbits.radii_m(body).tolist()
        latitudes: Latitudes = "geodetic" if body.is_geodetic else "geocentric"
        read = (path, given, (x, y, z), latitudes)
        if read not in self._elevations:
            try:
                self._elevations[read] = read_elevation(given, path, (x, y, z), latitudes)
            except ValueError as error:
                raise ConfigError(f"{document.source}:\n  {key}.{error}") from error
        found = self._elevations[read]
        teller.tell(f"{key}.file", str(path), found.remarks)
        return found

    def of_terrain(
        self, document: Document, name: str, body: Body, teller: Teller
    ) -> tuple[_core.Terrain, Ground]:
        """The ground of a body with terrain; the same objects as long as no driver changes it.
        Raises ConfigError."""
        assert body.terrain is not None  # it has one
        given, radii = body.terrain, orbits.radii_m(body)
        parts = given.elevation, given.detail, given.craters, given.rocks
        key = (name, *parts, tuple(radii), body.is_geodetic)
        if key not in self._terrains:
            count = len(given.elevation)
            rasters = [self._elevation(document, name, k, body, teller) for k in range(count)]
            _make_room(self._terrains)
            try:
                core = terrains.core_terrain(given, radii, rasters)
            except ValueError as error:
                where = f"{document.source}:\n  bodies.{name}.terrain"
                raise ConfigError(f"{where}: {error}") from error
            for text in terrains.remarks_of(given, radii, rasters):
                teller.tell_of_key(f"bodies.{name}.terrain.detail.from_elevation", text)
            self._terrains[key] = core, terrains.ground_of(core, radii, body.is_geodetic)
        return self._terrains[key]
