"""Worlds with air, straight through the core: the root is the first body's centre."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from perilune import _core

F64 = NDArray[np.float64]
AU_M, SOLAR, SUN_M = 149597870700.0, 1361.0, 695700e3


def scene(
    airs: Sequence[_core.Air | None],
    path: str | None = None,
    rings: Sequence[_core.Rings | None] = (),
) -> _core.Scene:
    """A body for each air; rings are of the first bodies."""
    world = _core.Scene(1)
    for index, air in enumerate(airs):
        world.add_body(
            name=f"body{index}",
            map=_core.Map(path) if path else None,
            map_center_lon_rad=0.0,
            reflectance="lambert",
            instance_id=index + 1,
            part_id=index + 1,
            class_ids=np.array([index + 1], dtype=np.uint16),
            regolith_map=None,
            air=air,
            rings=rings[index] if index < len(rings) else None,
        )
    return world


def look(forward: Sequence[float], up: Sequence[float] = (0.0, 0.0, 1.0)) -> F64:
    """Quaternion of a camera (x right, y down, z forward)."""
    z = np.array(forward) / np.linalg.norm(forward)
    x = np.cross(z, up)
    x = x / np.linalg.norm(x)
    m = np.stack([x, np.cross(z, x), z], axis=1)
    K = np.array(
        [
            [m[0, 0] - m[1, 1] - m[2, 2], 0, 0, 0],
            [m[1, 0] + m[0, 1], m[1, 1] - m[0, 0] - m[2, 2], 0, 0],
            [m[2, 0] + m[0, 2], m[2, 1] + m[1, 2], m[2, 2] - m[0, 0] - m[1, 1], 0],
            [m[2, 1] - m[1, 2], m[0, 2] - m[2, 0], m[1, 0] - m[0, 1], np.trace(m)],
        ]
    )
    x_, y_, z_, w_ = np.linalg.eigh(K)[1][:, -1]
    return np.array([w_, x_, y_, z_])


def request(
    radii_m: Sequence[Sequence[float]],
    camera_m: Sequence[float],
    forward: Sequence[float],
    sun: Sequence[float],
    *,
    centers_m: Sequence[Sequence[float]] = ((0.0, 0.0, 0.0),),
    up: Sequence[float] = (0.0, 0.0, 1.0),
    size: tuple[int, int] = (48, 36),
    fov_deg: float = 50.0,
    albedo: float = 0.3,
    white: float = 330.0,
    tolerance_dn: float = 1.0,
    samples: int = 16,
    force_on: Sequence[str] = (),
    force_off: Sequence[str] = (),
) -> dict[str, Any]:
    """Bodies of radii_m at centers_m; sun: direction to it, at 1 AU."""
    width, height = size
    focal = 0.5 * width / math.tan(0.5 * math.radians(fov_deg))
    pose = np.concatenate([camera_m, look(forward, up)])
    count = len(radii_m)
    places = [[[*center, 1.0, 0.0, 0.0, 0.0]] * 2 for center in centers_m]
    return {
        "seed": 1,
        "index": 0,
        "width": width,
        "height": height,
        "K": np.array([[focal, 0, 0.5 * (width - 1)], [0, focal, 0.5 * (height - 1)], [0, 0, 1]]),
        "camera_pose": np.stack([pose, pose]),
        "object_poses": np.empty((0, 2, 7)),
        "object_scale": np.empty(0),
        "body_poses": np.array(places, dtype=np.float64).reshape(count, 2, 7),
        "body_radii": np.array(radii_m, dtype=np.float64),
        "body_albedo": np.full((count, 3), albedo),
        "body_emission": np.zeros((count, 3)),
        "sun_position": AU_M * np.array(sun) / np.linalg.norm(sun),
        "sun_radius": SUN_M,
        "sun_irradiance": SOLAR,
        "quality": {
            "samples": samples,
            "max_bounces": 0,
            "texture_filter": 4,
            "tolerance_dn": tolerance_dn,
            "force_on": list(force_on),
            "force_off": list(force_off),
        },
        "exposure": {"mode": "fixed", "white_radiance": white, "percentile": 99.0, "key": 0.8},
    }


def render(world: _core.Scene, asked: dict[str, Any], threads: int = 1) -> dict[str, Any]:
    """`rgb`, `radiance`, `range` and `instance`."""
    shape = asked["height"], asked["width"]
    out: dict[str, Any] = {
        "rgb": np.empty((*shape, 3), np.uint8),
        "radiance": np.empty((*shape, 3), np.float32),
        "range": np.empty(shape, np.float32),
        "instance": np.empty(shape, np.int32),
    }
    _core.Renderer(world).render(asked, out, threads)
    return out


def directions(asked: dict[str, Any]) -> F64:
    """(H, W, 3) unit, root axes, through the pixels' centres."""
    w, x, y, z = asked["camera_pose"][0, 3:]
    R = np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]
    )
    rows, columns = np.indices((asked["height"], asked["width"]))
    pixels = np.stack([columns, rows, np.ones_like(rows)], axis=-1)
    rays = pixels @ np.linalg.inv(asked["K"]).T @ R.T
    return np.asarray(rays / np.linalg.norm(rays, axis=-1, keepdims=True), dtype=np.float64)
