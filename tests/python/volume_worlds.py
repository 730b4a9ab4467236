"""Configurations with volumes: a rock of a metre at the origin, and mist a kilometre above it."""

from __future__ import annotations

from typing import Any

import numpy as np

import perilune
from perilune.base import rotations

AWAY_M = 1000.0
"""Of the middle of the scene above the rock, along z."""


def config(volumes: dict[str, Any], **changes: Any) -> dict[str, Any]:
    """The camera looks along y at the middle of the scene, from 20 m; the sun is along +x."""
    tree: dict[str, Any] = {
        "version": 1,
        "time": {"epoch": "2026-03-20T12:00:00Z"},
        "root": "rock",
        "sun": {"direction": [1.0, 0.0, 0.0], "irradiance_w_m2": 1000.0},
        "bodies": {
            "rock": {
                "kind": "ellipsoid",
                "radii_km": 1e-3,
                "gm_km3_s2": 1e-15,
                "albedo": 0.5,
                "rotation": {"spin_rate_deg_s": 0.0},
            }
        },
        "volumes": volumes,
        "camera": {
            "width": 24,
            "height": 18,
            "fov_deg": 12.0,
            "trajectory": {
                "kind": "fixed",
                "target": "rock",
                "position_m": [0.0, -20.0, AWAY_M],
                "aim_offset_m": [0.0, 0.0, AWAY_M],
            },
            "exposure": {"mode": "fixed", "white_radiance_w_m2_sr": 100.0},
        },
        "render": {"samples": 1, "channels": ["radiance", "rgb"], "tolerance_dn": 0.01},
    }
    return tree | changes


def mist(**changes: Any) -> dict[str, Any]:
    """A ball of radius 1 m in the middle of the scene."""
    ball = {
        "parent": "rock",
        "shape": "ellipsoid",
        "radii_m": 1.0,
        "position_m": [0.0, 0.0, AWAY_M],
        "extinction_per_m": [0.3, 1.0, 4.0],
        "albedo": [1.0, 0.8, 0.5],
        "g": 0.5,
    }
    return ball | changes


def rays(sim: perilune.Simulation) -> tuple[Any, Any]:
    """Origin and unit directions (H, W, 3) of pixels, about the middle of the scene."""
    pose = sim.camera_poses(0)[0]
    camera = sim.world(0).camera
    K = np.asarray(sim.request(0)["K"])
    x, y = np.meshgrid(np.arange(camera.width), np.arange(camera.height))
    local = np.stack([(x - K[0, 2]) / K[0, 0], (y - K[1, 2]) / K[1, 1], np.ones_like(x)], -1)
    local = local / np.linalg.norm(local, axis=-1, keepdims=True)
    return pose[:3] - [0.0, 0.0, AWAY_M], local @ rotations.to_matrix(pose[3:]).T
