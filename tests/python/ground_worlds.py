"""A globe with relief, water or lights, straight through the core, and maps for it."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import air_worlds
import numpy as np
from numpy.typing import NDArray
from PIL import Image

from perilune import _core

F64 = NDArray[np.float64]


def saved(folder: Path, name: str, texels: NDArray[Any]) -> str:
    """An 8-bit PNG of values 0..1, (rows, columns) or (rows, columns, 3)."""
    path = str(folder / f"{name}.png")
    Image.fromarray(np.rint(255.0 * np.clip(texels, 0.0, 1.0)).astype(np.uint8)).save(path)
    return path


def lattice(rows: int) -> F64:
    """(rows, 2 rows, 3) directions of the texels of an equirectangular map."""
    lat = np.pi * (0.5 - (np.arange(rows) + 0.5) / rows)
    lon = np.pi * ((np.arange(2 * rows) + 0.5) / rows - 1.0)
    flat = np.cos(lat)[:, None]
    up = np.broadcast_to(np.sin(lat)[:, None], (rows, 2 * rows))
    return np.stack([flat * np.cos(lon), flat * np.sin(lon), up], axis=-1)


def globe(
    ground: _core.Ground | None,
    center_lon_rad: float = 0.0,
    map_path: str | None = None,
    reflectance: str = "lambert",
) -> _core.Scene:
    world = _core.Scene(1)
    world.add_body(
        name="globe",
        map=_core.Map(map_path) if map_path else None,
        map_center_lon_rad=center_lon_rad,
        reflectance=reflectance,
        instance_id=1,
        part_id=1,
        class_ids=np.array([1], dtype=np.uint16),
        regolith_map=None,
        air=None,
        ground=ground,
    )
    return world


def numbers(
    height_m: float = 0.0,
    steepness: float = 1.0,
    wind_m_s: float = 7.0,
    water: float = 0.0,
    lights: float = 0.0,
    towns_m: float = 0.0,
) -> F64:
    """A request's body_ground."""
    row = [height_m, steepness, wind_m_s, *([water] * 3), *([lights] * 3), towns_m]
    return np.array([row])


def seen(
    world: _core.Scene, given: F64, *view: Any, threads: int = 1, **more: Any
) -> tuple[dict[str, Any], dict[str, Any]]:
    """The request, by air_worlds.request, and its frame."""
    asked = air_worlds.request(*view, **more)
    asked["body_ground"] = given
    return asked, air_worlds.render(world, asked, threads)


def points(asked: dict[str, Any], frame: dict[str, Any]) -> tuple[F64, NDArray[np.bool_]]:
    """Unit directions from the centre of the globe at the root to what pixels show, and whether
    they show it."""
    hit = frame["instance"] == 1
    distance = np.where(hit, frame["range"], 1.0)[..., None]
    at = asked["camera_pose"][0, :3] + distance * air_worlds.directions(asked)
    return at / np.linalg.norm(at, axis=-1, keepdims=True), hit
