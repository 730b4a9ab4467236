"""From the ground of bodies in the configuration to the core's input."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from perilune import _core
from perilune.bodies.maps import HeightKey
from perilune.config import Config
from perilune.config.body import Body
from perilune.config.ground import NightLights, Relief

F64 = NDArray[np.float64]
LoadMap = Callable[..., _core.Map | None]
"""Loads a path of the configuration, with its key and options of _core.Map; `heights`: the key with
the height scale of a height map."""


def _heights(relief: Relief) -> tuple[str | None, HeightKey]:
    return relief.height_map, "height_m" if relief.height_unit_m is None else "height_unit_m"


def files(body: Body) -> tuple[Any, ...]:
    """All inputs of a scene for a body's ground."""
    relief, ocean, lights = body.relief, body.ocean, body.night_lights
    return (
        relief and (*_heights(relief), relief.normal_map, relief.normal_green),
        ocean and (ocean.map or body.color_map,),
        lights and (lights.map, lights.black),
    )


def of_body(body: Body, load: LoadMap) -> _core.Ground | None:
    """Maps of a body; None without any."""
    relief, ocean, lights = body.relief, body.ocean, body.night_lights
    ground: _core.Ground = {}
    if relief is not None:
        file, key = _heights(relief)
        ground["heights"] = load(file, "relief.height_map", heights=key, srgb=False)
        ground["normals"] = load(relief.normal_map, "relief.normal_map", srgb=False)
        ground["south"] = relief.normal_green == "south"
    if ocean is not None:
        ground["ocean"] = True
        if ocean.map is not None:
            ground["water"] = load(ocean.map, "ocean.map", srgb=False)
        else:
            ground["water"] = load(body.color_map, "color_map", water=True)
    if lights is not None:
        ground["lights"] = load(lights.map, "night_lights.map", black=lights.black)
    return ground or None


def _towns_m(lights: NightLights | None) -> float:
    if lights is None:
        return 0.0
    return np.nan if lights.detail_km is None else 1e3 * lights.detail_km


def numbers(config: Config) -> F64:
    """(bodies, 10): the request's body_ground."""
    rows = []
    for body in config.bodies.values():
        relief, ocean, lights = body.relief, body.ocean, body.night_lights
        rows.append(
            (
                (relief.height_m or relief.height_unit_m or 0.0) if relief else 0.0,
                relief.normal_strength if relief else 0.0,
                ocean.wind_m_s if ocean else 0.0,
                *(ocean.albedo if ocean and ocean.albedo else (np.nan,) * 3),
                *(lights.radiance_w_m2_sr if lights else (0.0,) * 3),
                _towns_m(lights),
            )
        )
    return np.array(rows, dtype=np.float64)
