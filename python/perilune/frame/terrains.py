"""The grounds of bodies with terrain or a shape, made once for each value of their drivers."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from perilune import _core, orbits
from perilune.base.kept import make_room
from perilune.bodies import terrain as terrains
from perilune.bodies.craters import read_catalogue
from perilune.bodies.elevation import ElevationRaster, read_elevation
from perilune.bodies.ground_textures import clods_of, mottling_of, read_texture
from perilune.bodies.raster_doubts import hidden
from perilune.bodies.rocks import RockModel, read_rock_model
from perilune.bodies.shapes import BodyShape
from perilune.bodies.surface_rasters import ALBEDO, MASK, ROUGHNESS, Quantity, read_surface
from perilune.config.body import Body
from perilune.config.elevation import Elevation, SurfaceRaster
from perilune.config.errors import ConfigError
from perilune.config.ground_textures import (
    Clods,
    FactorImage,
    GroundTexture,
    HeightImage,
    Mottling,
)
from perilune.config.terrain import Terrain
from perilune.config.types import Latitudes
from perilune.document.document import Document
from perilune.orbits.ground import Ground

_GROUNDS = 16
"""Number of grounds to cache, of which a body has one for each value of its drivers."""
_SAMPLES = 2 * _GROUNDS
"""Number of samples of ground that are made to cache."""


class Teller(Protocol):
    """Receives warnings about a file or a key of the configuration."""

    def tell(self, key: str, path: str, lines: tuple[str, ...]) -> None: ...
    def tell_of_key(self, key: str, text: str) -> None: ...


class Terrains:
    """Shared by the configurations that are derived from one another."""

    def __init__(self) -> None:
        self._elevations: dict[tuple[Any, ...], ElevationRaster] = {}
        self._catalogues: dict[Path, NDArray[np.void]] = {}
        self._textures: dict[tuple[Any, ...], _core.Raster] = {}
        self._samples: dict[tuple[float, int, Clods | Mottling], _core.Raster] = {}
        self._rock_models: dict[Path, RockModel] = {}
        self._terrains: dict[tuple[Any, ...], tuple[_core.Terrain, Ground]] = {}
        self._shapes: dict[tuple[Any, ...], Ground] = {}

    def of_shape(self, name: str, body: Body, shape: Callable[[], BodyShape]) -> Ground:
        """The ground of a body with a shape."""
        radii = orbits.radii_m(body)
        key = (name, body.shape, tuple(radii.tolist()), body.is_geodetic)
        if key not in self._shapes:
            make_room(self._shapes, _GROUNDS)
            self._shapes[key] = Ground(radii, body.is_geodetic, shape().surfaces_m)
        return self._shapes[key]

    def _raster(
        self,
        document: Document,
        key: str,
        given: Elevation | SurfaceRaster,
        quantity: Quantity | None,
        body: Body,
        teller: Teller,
    ) -> ElevationRaster:
        """A raster of a body, at `key`; each is read once. quantity: None for elevation models."""
        path = document.path(given.file, f"{key}.file")
        x, y, z = orbits.radii_m(body).tolist()
        latitudes: Latitudes = "geodetic" if body.is_geodetic else "geocentric"
        read = (path, given, quantity, (x, y, z), latitudes)
        if read not in self._elevations:
            try:
                if isinstance(given, Elevation):
                    found = read_elevation(given, path, (x, y, z), latitudes)
                else:
                    assert quantity is not None  # it is no elevation model
                    found = read_surface(given, path, quantity, (x, y, z), latitudes)
                self._elevations[read] = found
            except ValueError as error:
                raise ConfigError(f"{document.source}:\n  {key}.{error}") from error
        found = self._elevations[read]
        teller.tell(f"{key}.file", str(path), found.remarks)
        return found

    def _texture(
        self, document: Document, key: str, given: HeightImage | FactorImage | None
    ) -> _core.Raster | None:
        if given is None:
            return None
        low, high = (
            (given.low_m, given.high_m)
            if isinstance(given, HeightImage)
            else (given.low, given.high)
        )
        path = document.path(given.file, f"{key}.file")
        if (path, low, high) not in self._textures:
            try:
                self._textures[path, low, high] = read_texture(path, low, high)
            except ValueError as error:
                raise ConfigError(f"{document.source}:\n  {key}.{error}") from error
        return self._textures[path, low, high]

    def _textures_of(
        self, document: Document, where: str, given: Terrain
    ) -> list[terrains.Textures]:
        found = []
        for k, row in enumerate(given.textures):
            key = f"{where}.textures[{k}]"
            heights = self._texture(document, f"{key}.displacement", row.displacement)
            rough = self._texture(document, f"{key}.roughness", row.roughness)
            albedo = self._texture(document, f"{key}.albedo", row.albedo)
            if row.clods is not None:
                heights = self._made(document, f"{key}.clods", row, row.clods)
            if row.mottling is not None:
                albedo = self._made(document, f"{key}.mottling", row, row.mottling)
            found.append((heights, rough, albedo))
        return found

    def _made(
        self, document: Document, key: str, row: GroundTexture, given: Clods | Mottling
    ) -> _core.Raster:
        """An image that the core makes, once."""
        of = (row.size_m, row.seed, given)
        if of not in self._samples:
            make_room(self._samples, _SAMPLES)
            try:
                self._samples[of] = (
                    clods_of(row, given) if isinstance(given, Clods) else mottling_of(row, given)
                )
            except ValueError as error:
                raise ConfigError(f"{document.source}:\n  {key}.{error}") from error
        return self._samples[of]

    def _rock_models_of(
        self, document: Document, where: str, given: Terrain, teller: Teller
    ) -> list[RockModel]:
        """Models of rocks, each read once."""
        found = []
        for k, file in enumerate(given.rocks.models if given.rocks is not None else ()):
            key = f"{where}.rocks.models[{k}]"
            path = document.path(file, key)
            if path not in self._rock_models:
                try:
                    self._rock_models[path] = read_rock_model(path)
                except ValueError as error:
                    raise ConfigError(f"{document.source}:\n  {key}: {error}") from error
            found.append(self._rock_models[path])
            teller.tell(key, str(path), found[-1].remarks)
        return found

    def catalogue(self, document: Document, name: str, body: Body) -> NDArray[np.void] | None:
        """The catalogue of a body's craters, read once; None if it has none."""
        if body.terrain is None or body.terrain.crater_catalogue is None:
            return None
        key = f"bodies.{name}.terrain.crater_catalogue"
        path = document.path(body.terrain.crater_catalogue, key)
        if path not in self._catalogues:
            try:
                self._catalogues[path] = read_catalogue(path)
            except ValueError as error:
                raise ConfigError(f"{document.source}:\n  {key}: {error}") from error
        return self._catalogues[path]

    def of_terrain(
        self, document: Document, name: str, body: Body, teller: Teller
    ) -> tuple[_core.Terrain, Ground]:
        """The ground of a body with terrain; the same objects as long as no driver changes it.
        Raises ConfigError."""
        assert body.terrain is not None  # it has one
        given, radii = body.terrain, orbits.radii_m(body)
        surface = given.albedo, given.roughness, given.mask, given.patch, given.roughness_baseline_m
        relief = (
            given.elevation,
            given.detail,
            given.craters,
            given.rocks,
            given.tracks,
            given.textures,
        )
        parts = (*relief, *surface)
        key = (name, *parts, tuple(radii), body.is_geodetic)
        if key not in self._terrains:
            where = f"bodies.{name}.terrain"

            def read(
                key: str, rows: Sequence[Elevation | SurfaceRaster], quantity: Quantity | None
            ) -> list[ElevationRaster]:
                return [
                    self._raster(document, f"{where}.{key}[{k}]", row, quantity, body, teller)
                    for k, row in enumerate(rows)
                ]

            rasters = read("elevation", given.elevation, None)
            albedo = read("albedo", given.albedo, ALBEDO)
            roughness = read("roughness", given.roughness, ROUGHNESS)
            mask = read("mask", given.mask, MASK)
            catalogue = self.catalogue(document, name, body)
            textures = self._textures_of(document, where, given)
            rock_models = self._rock_models_of(document, where, given, teller)
            make_room(self._terrains, _GROUNDS)
            try:
                core = terrains.core_terrain(
                    given,
                    radii,
                    rasters,
                    albedo,
                    roughness,
                    catalogue,
                    mask,
                    body.is_geodetic,
                    textures,
                    rock_models,
                )
            except ValueError as error:
                raise ConfigError(f"{document.source}:\n  {where}: {error}") from error
            for word, rows in (
                ("elevation", rasters),
                ("albedo", albedo),
                ("roughness", roughness),
                ("mask", mask),
            ):
                for k, text in hidden(rows):
                    teller.tell_of_key(f"bodies.{name}.terrain.{word}[{k}]", text)
            for text in terrains.remarks_of(given, radii, rasters):
                teller.tell_of_key(f"bodies.{name}.terrain.detail.from_elevation", text)
            self._terrains[key] = core, terrains.ground_of(core, radii, body.is_geodetic)
        return self._terrains[key]
