"""The Moon's ground: `python docs/figures/make_figures.py terrain`. Needs the sample data.

From configs/: highlands near the south pole under a Sun 1.5 degrees up; a mare from a lander; and
views from a rover's mast, under a low and a high Sun.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

import perilune

CONFIGS = Path(__file__).resolve().parents[2] / "configs"
SIZE = {"camera.width": 480, "camera.height": 360, "render.samples": 16}
SUN_ELEVATION = "sun.at.elevation_deg"
SCENES = (
    ("the south pole, 8 to 15 km up, Sun 1.5 deg", "lunar_pole", {}),
    ("a mare, from a lander", "lunar_lander", {}),
    ("a rover's mast, Sun 8 deg", "lunar_rover", {SUN_ELEVATION: 8.0}),
    ("the same, Sun 40 deg", "lunar_rover", {SUN_ELEVATION: 40.0}),
)
UNDER_SUNS = (
    ("orbiter", "lunar_orbiter", 5, (5.0, 20.0, 60.0)),
    ("lander", "lunar_lander", 40, (5.0, 20.0, 60.0)),
    ("rover", "lunar_rover", 3, (5.0, 20.0, 60.0)),
    ("pole", "lunar_pole", 0, (1.5, 5.0, 15.0)),
    ("Apollo 15", "apollo15", 0, (10.0, 20.0, 60.0)),
    ("Mars", "mars_descent", 5, (5.0, 20.0, 60.0)),
)
"""Title, configuration, frame, elevations of the Sun in degrees."""

TRACK = {
    "lon_deg": 10.0,
    "lat_deg": 20.0,
    "waypoints_m": [[-12, -9], [-8, -6], [-3, -6], [2, -8], [7, -5], [6, 1], [-2, -2], [-6, -12]],
    "grousers": {"spacing_m": 0.08, "depth_m": 0.006, "angle_deg": 25.0},
}


def tracks() -> tuple[str, NDArray[np.uint8]]:
    """A rover's own tracks, from its mast."""
    changes = {
        "bodies.moon.terrain.tracks": [TRACK],
        "camera.trajectory.yaw_deg": -25.0,
        "camera.trajectory.pitch_deg": -25.0,
        SUN_ELEVATION: 15.0,
    }
    sim = perilune.open(CONFIGS / "lunar_rover.yaml", overrides=SIZE | changes)
    return "tracks of a rover, Sun 15 deg", sim.frame(0, ["rgb"])["rgb"]


def soil() -> list[list[tuple[str, NDArray[np.uint8]]]]:
    """Rows of titles and images: the rover's ground and Mars, without and with their textures."""
    rows = []
    for title, name, body, frame, elevation in (
        ("a mast, Sun 20 deg", "lunar_rover", "moon", 3, 20.0),
        ("Mars from 1 km, Sun 30 deg", "mars_descent", "mars", 5, 30.0),
    ):
        row = []
        for kind, without in (("without", {f"bodies.{body}.terrain.textures": []}), ("", {})):
            changes = SIZE | without | {SUN_ELEVATION: elevation}
            sim = perilune.open(CONFIGS / f"{name}.yaml", overrides=changes)
            row.append((kind or title, sim.frame(frame, ["rgb"])["rgb"]))
        rows.append(row)
    return rows


def suns() -> list[list[tuple[str, NDArray[np.uint8]]]]:
    """Rows of titles and images: scenes under a low, a middling and a high Sun."""
    small = {"camera.width": 280, "camera.height": 210}
    rows = []
    for title, name, frame, elevations in UNDER_SUNS:
        row = []
        for elevation in elevations:
            changes = small | {SUN_ELEVATION: elevation}
            sim = perilune.open(CONFIGS / f"{name}.yaml", overrides=changes)
            row.append((f"{title}, Sun {elevation:g} deg", sim.frame(frame, ["rgb"])["rgb"]))
        rows.append(row)
    return rows


def apron() -> list[tuple[str, NDArray[np.uint8]]]:
    """Titles and images: the patch of Apollo 15 from above, without and with its apron."""
    path = CONFIGS / "apollo15.yaml"
    above = {"kind": "hover", "target": "moon", "lon_deg": 3.6, "lat_deg": 26.1, "height_m": 1500.0}
    changes = {"camera.width": 420, "camera.height": 315, "camera.trajectory": above}
    sim = perilune.open(path, overrides=changes | {SUN_ELEVATION: 20.0})
    rows = sim.config.bodies["moon"].terrain
    assert rows is not None  # it is a scene of terrain
    base, patch = (row.model_dump(exclude_unset=True) for row in rows.elevation)
    out = []
    for apron_m in (0.0, patch["apron_m"]):
        model = patch | {"apron_m": apron_m}
        changed = sim.with_overrides({"bodies.moon.terrain.elevation": [base, model]})
        out.append((f"apron_m: {apron_m:g}", changed.frame(0, ["rgb"])["rgb"]))
    return out


def views() -> list[tuple[str, NDArray[np.uint8]]]:
    """Titles and images."""
    out = []
    for title, name, changes in SCENES:
        sim = perilune.open(CONFIGS / f"{name}.yaml", overrides=SIZE | changes)
        out.append((title, sim.frame(0, ["rgb"])["rgb"]))
    return out
