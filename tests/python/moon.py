"""A Moon seen from far away, by the core alone."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from perilune import _core

F64 = NDArray[np.float64]
RADIUS_M, DISTANCE_M, AU_M = 1737.4e3, 384400e3, 149597870700.0
SOLAR = 1361.0
# Along the root's -x axis, x right (-y of the root), y down (-z).
LOOK_DOWN_X = np.array([0.5, -0.5, -0.5, 0.5])


def scene(reflectance: str, regolith_map: _core.Grid | None = None) -> _core.Scene:
    """One body at the root's origin."""
    moon = _core.Scene(1)
    moon.add_body(
        name="moon",
        map=None,
        map_center_lon_rad=0.0,
        reflectance=reflectance,
        instance_id=1,
        part_id=1,
        class_ids=np.array([1], dtype=np.uint16),
        regolith_map=regolith_map,
        air=None,
    )
    return moon


def request(size: int, phase_deg: float, **changes: Any) -> dict[str, Any]:
    """From above longitude and latitude 0; the Sun at longitude `phase_deg`."""
    g = math.radians(phase_deg)
    pose = np.concatenate([[DISTANCE_M, 0.0, 0.0], LOOK_DOWN_X])
    focal = 0.48 * size * DISTANCE_M / RADIUS_M
    center = 0.5 * (size - 1)
    return {
        "seed": 1,
        "index": 0,
        "width": size,
        "height": size,
        "K": np.array([[focal, 0.0, center], [0.0, focal, center], [0.0, 0.0, 1.0]]),
        "camera_pose": np.stack([pose, pose]),
        "object_poses": np.empty((0, 2, 7)),
        "object_scale": np.empty(0),
        "body_poses": np.array([[[0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0]] * 2]),
        "body_radii": np.full((1, 3), RADIUS_M),
        "body_albedo": np.ones((1, 3)),
        "body_emission": np.zeros((1, 3)),
        "sun_position": AU_M * np.array([math.cos(g), math.sin(g), 0.0]),
        "sun_radius": 695700e3,
        "sun_irradiance": SOLAR,
        "quality": {
            "samples": 4,
            "max_bounces": 0,
            "texture_filter": 1,
            "tolerance_dn": 0.0,
            "force_on": [],
            "force_off": [],
        },
        "exposure": {"mode": "fixed", "white_radiance": 200.0, "percentile": 99.0, "key": 0.8},
        **changes,
    }


def radiance(moon: _core.Scene, asked: dict[str, Any]) -> NDArray[np.float32]:
    """(size, size, 3), W m-2 sr-1."""
    out = np.empty((asked["height"], asked["width"], 3), np.float32)
    _core.Renderer(moon).render(asked, {"radiance": out})
    return out


def disc_reflectance(image: NDArray[np.float32], asked: dict[str, Any]) -> F64:
    """(3,): irradiance over that of a white Lambert disc of the Moon's size facing the Sun."""
    focal = asked["K"][0, 0]
    rows, columns = np.indices(image.shape[:2]) - 0.5 * (image.shape[0] - 1)
    cosine = 1.0 / np.sqrt(1.0 + (rows**2 + columns**2) / focal**2)
    light: F64 = (image * cosine[:, :, None] ** 3).sum(axis=(0, 1)) / focal**2
    return light * math.pi / (SOLAR * math.pi * (RADIUS_M / DISTANCE_M) ** 2)
