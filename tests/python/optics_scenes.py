"""Small worlds for tests of lens and shutter: bodies and a satellite at stated places, no physics.

The camera is 5 m before the root and looks along +x with -z down; image right is -y.
"""

from __future__ import annotations

from typing import Any

import numpy as np

import perilune
from perilune.base import rotations

FORWARD = rotations.look_at(np.array([1.0, 0.0, 0.0]), np.array([0.0, 0.0, 1.0]))
STANDS_M = 5.0
RIGHT, DOWN = np.array([0.0, -1.0, 0.0]), np.array([0.0, 0.0, -1.0])


def at(depth_m: float, right_m: float = 0.0, down_m: float = 0.0) -> list[float]:
    """Place in the root frame, km."""
    place = (STANDS_M + depth_m) * np.array([1.0, 0.0, 0.0]) + right_m * RIGHT + down_m * DOWN
    return [float(x) * 1e-3 for x in place]


def ball(place_km: list[float], radius_m: float, **keys: Any) -> dict[str, Any]:
    """A body; glows with 1 W m-2 sr-1 unless told otherwise."""
    return {
        "kind": "ellipsoid",
        "radii_km": [radius_m * 1e-3] * 3,
        "gm_km3_s2": 1e-20,
        "albedo": 0.0,
        "emission_w_m2_sr": 1.0,
        "orbit": {"around": "anchor", "position_km": place_km},
    } | keys


def tree(
    size: tuple[int, int] = (64, 48), focal_px: float = 100.0, **bodies: Any
) -> dict[str, Any]:
    """A configuration of these bodies, in which nothing else is seen."""
    anchor = {"kind": "ellipsoid", "radii_km": [1e-6] * 3, "gm_km3_s2": 1e-20, "albedo": 0.0}
    return {
        "version": 1,
        "time": {"epoch": "2026-03-20T12:00:00Z", "step_s": 1.0},
        "root": "anchor",
        "bodies": {"anchor": anchor, **bodies},
        "spacecraft": {},
        "sun": {"direction": [-1.0, 0.3, 0.5]},
        "camera": {
            "width": size[0],
            "height": size[1],
            "focal_px": focal_px,
            "exposure": {"mode": "fixed", "white_radiance_w_m2_sr": 2.0},
            "trajectory": {"kind": "fixed", "target": "anchor", "position_m": [0.01, 0.0, 0.0]},
        },
        "render": {"samples": 64, "max_bounces": 0, "tolerance_dn": 0.0},
    }


def still(offset_m: tuple[float, float] = (0.0, 0.0)) -> Any:
    """A trajectory: the camera stands, by so much right and down of its place."""
    place = np.array([STANDS_M, 0.0, 0.0]) + offset_m[0] * RIGHT + offset_m[1] * DOWN
    return lambda world: np.concatenate([place, FORWARD])


def opened(config: dict[str, Any], root: Any, **options: Any) -> perilune.Simulation:
    """The simulation; relative paths are of the repository."""
    return perilune.open(config, base=root, **{"trajectory": still(), **options})


def row(sample: perilune.Sample, name: str) -> dict[str, Any]:
    """Of the sample's plan."""
    return next(dict(r) for r in sample.plan if r["name"] == name)
