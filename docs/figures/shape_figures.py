"""Bodies by their shapes: `python docs/figures/make_figures.py shapes`. Needs PERILUNE_DATA.

Phobos from 30 km by configs/phobos.yaml, Eros and Itokawa in sunlight from the side, the planet and
moon of configs/fictional.yaml. Craters, bumps and grain of Eros and Itokawa that are finer than the
facets of their shapes are drawn by graphs; they are no survey.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

from gallery_grounds import cratered

import perilune

ROOT = Path(__file__).resolve().parents[2]
SIZE = (360, 270)
EROS = {
    # Li et al. 2004 (Icarus 172, 415): w 0.33, one lobe of g -0.25, B0 1.4, h 0.01, roughness 28.
    "shape": "data:small_bodies/eros007790.tab",
    "material": "ground",
    "material_mode": "wrap",
    "radii_km": [17.0, 5.5, 5.5],
    "albedo": [0.37, 0.33, 0.28],
    "reflectance": "hapke",
    "photometry": {"b": 0.25, "c": 1.0, "b_s0": 1.4, "h_s": 0.01, "roughness_deg": 28.0},
}
ITOKAWA = {
    # Kitazato et al. 2008 (Icarus 194, 137): w 0.42, g -0.35, B0 0.87, h 0.01, roughness 26.
    "shape": "data:small_bodies/itokawa_16.obj",
    "material": "ground",
    "material_mode": "wrap",
    "radii_km": [0.27, 0.15, 0.12],
    "albedo": [0.45, 0.42, 0.37],
    "reflectance": "hapke",
    "photometry": {"b": 0.35, "c": 1.0, "b_s0": 0.87, "h_s": 0.01, "roughness_deg": 26.0},
}


def _alone(
    body: dict[str, Any], ground: dict[str, Any], position_m: list[float], sun: list[float]
) -> dict[str, Any]:
    return {
        "version": 1,
        "time": {"epoch": "2026-03-20T12:00:00Z"},
        "root": "rock",
        "bodies": {"rock": {"kind": "ellipsoid", "gm_km3_s2": 1e-6, **body}},
        "materials": {"ground": ground},
        "sun": {"direction": sun},
        "camera": {
            "width": SIZE[0],
            "height": SIZE[1],
            "fov_deg": 32.0,
            "trajectory": {"kind": "fixed", "target": "rock", "position_m": position_m},
            "exposure": {"mode": "auto", "percentile": 99.0, "key": 0.5},
        },
        "render": {"samples": 64, "max_bounces": 2},
    }


def rows() -> list[list[tuple[str, Any]]]:
    """Two rows of two titled images."""
    small = {"camera.width": SIZE[0], "camera.height": SIZE[1], "render.samples": 64}
    pits = cratered(2.2e3, "hapke", 0.7, 0.4, 0.25)
    stones = cratered(20.0, "hapke", -1.2, 0.4, 0.35)  # bowls that stand out
    sun = [-0.7, -0.35, 0.6]
    scenes: list[tuple[str, perilune.Simulation, int]] = [
        ("Phobos, Mars behind", perilune.open(ROOT / "configs" / "phobos.yaml", None, small), 0),
        ("Eros", perilune.open(_alone(EROS, pits, [12e3, -64e3, 18e3], [0.8, -0.35, 0.5])), 0),
        ("Itokawa", perilune.open(_alone(ITOKAWA, stones, [310.0, -990.0, 330.0], sun)), 0),
        ("made of nodes", perilune.open(ROOT / "configs" / "fictional.yaml", None, small), 4),
    ]
    shown = [(title, sim.frame(index, channels=["rgb"])["rgb"]) for title, sim, index in scenes]
    return [shown[:2], shown[2:]]
