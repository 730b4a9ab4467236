"""A turning satellite through lens and shutter: `python docs/figures/make_figures.py shutter`.

As it is; blurred over half a second; by a rolling shutter, row by row from the top; by a lens of 30
cm that focuses on its body.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import perilune

ROOT = Path(__file__).resolve().parents[2]
HEIGHT = 300


def _scene(camera: dict[str, Any]) -> dict[str, Any]:
    """The satellite of 3 m turns by 40 degrees a second, 5 m before the camera and a moonlet."""
    moonlet = {"kind": "ellipsoid", "radii_km": [0.02, 0.015, 0.015], "gm_km3_s2": 1e-12}
    sat = {
        "model": "assets/models/smallsat.glb",
        "size_m": 3.0,
        "orbit": {"around": "moonlet", "position_km": [0.0, 0.025, 0.0]},
        "attitude": {"rotation_deg": [20.0, 30.0, 40.0], "spin_rate_deg_s": 40.0},
    }
    place = {"kind": "fixed", "target": "sat", "position_m": [1.0, 5.0, 0.5], "frame": "icrf"}
    exposure = {"mode": "fixed", "white_radiance_w_m2_sr": 500.0}
    view = {"width": 400, "height": HEIGHT, "fov_deg": 36.0, "exposure": exposure}
    return {
        "version": 1,
        "time": {"epoch": "2026-03-20T12:00:00Z", "step_s": 1.0},
        "root": "moonlet",
        "bodies": {"moonlet": {**moonlet, "albedo": 0.08}},
        "spacecraft": {"sat": sat},
        "sun": {"direction": [0.4, 0.8, 0.45]},
        "camera": {**view, "trajectory": place, **camera},
        "render": {"samples": 64, "max_bounces": 2},
    }


def rows() -> list[list[tuple[str, Any]]]:
    """Two rows of two titled images."""
    cases: list[tuple[str, dict[str, Any]]] = [
        ("sharp", {}),
        ("motion blur, 0.5 s", {"exposure_time_s": 0.5}),
        ("rolling shutter, 0.8 s", {"line_time_us": 0.8e6 / HEIGHT}),
        ("depth of field", {"lens": {"focus_distance_m": 5.0, "aperture_mm": 300.0}}),
    ]
    shown = []
    for title, camera in cases:
        sim = perilune.open(_scene(camera), base=ROOT)
        shown.append((title, sim.frame(0, channels=["rgb"])["rgb"]))
    return [shown[:2], shown[2:]]
