"""The frames that are compared, without what the renderers mean differently.

Air, clouds and open water of the bodies are off, and Hapke's law is Lambert's, as the others have
no counterpart; the Sun's disc is even; the satellite has the materials of its file, as the others
know no graphs.
"""

from __future__ import annotations

import os
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from PIL import Image as Picture

import perilune
from perilune.bodies import shape_files

from . import models

ROOT = Path(__file__).resolve().parents[2]
PLAIN = {"render.tolerance_dn": 0.0, "render.force_off": ["limb_darkening"]}


@dataclass(frozen=True)
class Frame:
    """A frame of a configuration; `make` writes files that overrides name into a folder."""

    config: str | dict[str, Any]
    index: int = 0
    overrides: dict[str, Any] = field(default_factory=dict)
    make: Callable[[Path], dict[str, Any]] | None = None

    def open(self, width: int, folder: Path, **render: Any) -> perilune.Simulation:
        """At 4 to 3; `render`: keys of that section."""
        changes = {"camera.width": width, "camera.height": width * 3 // 4, **PLAIN}
        changes |= self.overrides | (self.make(folder) if self.make is not None else {})
        changes |= {f"render.{key}": value for key, value in render.items()}
        config = self.config
        source = config if isinstance(config, dict) else str(ROOT / "configs" / config)
        return perilune.open(source, overrides=changes)


def fine_phobos(folder: Path) -> dict[str, Any]:
    """Phobos' measured shape, each triangle as 16, with finer ground: 512 640 triangles."""
    path = folder / "fine_phobos.obj"
    if not path.exists():
        data = Path(os.environ["PERILUNE_DATA"])
        vertices, triangles = shape_files.read(data / "small_bodies" / "phobos.obj")
        for _ in range(2):
            vertices, triangles = models.halved(vertices, triangles)
        models.write_obj(path, models.rubble(vertices, 0.012), triangles)
    return {"bodies.phobos.shape": str(path)}


def alone() -> dict[str, Any]:
    """An object over a small dark ball behind the camera, which hardly lights it."""
    return {
        "version": 1,
        "seed": 1,
        "time": {"epoch": "2026-03-20T12:00:00Z"},
        "root": "planet",
        "sun": {"direction": [0.55, -0.6, 0.58]},
        "bodies": {
            "planet": {"kind": "ellipsoid", "radii_km": 100.0, "gm_km3_s2": 1.0, "albedo": 0.02}
        },
        "spacecraft": {
            "object": {
                "model": "object.glb",
                "metres_per_unit": 1.0,
                "centre": "origin",
                "orbit": {"around": "planet", "position_km": [0.0, -400.0, 0.0]},
                "attitude": {"pointing": "inertial"},
            }
        },
        "camera": {
            "fov_deg": 40.0,
            "trajectory": {"kind": "fixed", "target": "object", "position_m": [0.0, -3.6, 2.0]},
            "exposure": {"mode": "fixed", "white_radiance_w_m2_sr": 400.0},
        },
        "render": {"samples": 16, "max_bounces": 4},
    }


def foil(folder: Path) -> dict[str, Any]:
    """A crumpled sheet of gold before a wall of another metal: light goes to and fro."""
    wall = models.rectangle((0.0, 1.25, 0.5), (1.2, 0.0, 0.0), (0.0, 0.0, 0.7))
    pieces = [
        (models.crumpled(1.2, 0.35), None, models.metal((0.94, 0.72, 0.33), 0.45)),
        (wall, None, models.metal((0.9, 0.9, 0.9), 0.35)),
    ]
    return {"spacecraft.object.model": str(models.write_glb(folder / "foil.glb", pieces))}


def ball(albedo: float, position_km: list[float]) -> dict[str, Any]:
    """A ball of 500 km from a place, the Sun aside; nothing else."""
    config = alone()
    del config["spacecraft"]
    config["bodies"]["planet"] |= {"radii_km": 500.0, "albedo": albedo}
    config["camera"]["trajectory"] = {
        "kind": "fixed",
        "target": "planet",
        "position_m": [1e3 * v for v in position_km],
    }
    return config


def air(multiple: bool) -> dict[str, Any]:
    """Gas about a ball, as deep as the Earth's in each band and ten times as high for its ball;
    light that is scattered once, in denser gas over black ground, or all."""
    config = ball(0.3 if multiple else 0.0, [300.0, -900.0, -900.0])
    config["bodies"]["planet"]["atmosphere"] = {
        "rayleigh_per_km": [0.002, 0.004, 0.008] if multiple else [0.01, 0.014, 0.02],
        "rayleigh_height_km": 25.0,
        "top_km": 250.0,
        "multiple_scattering": multiple,
    }
    if multiple:
        config["bodies"]["planet"]["atmosphere"]["ground_albedo"] = 0.3
    config["camera"] |= {"fov_deg": 60.0}
    config["camera"]["exposure"]["white_radiance_w_m2_sr"] = 100.0
    return config


def sea(folder: Path) -> dict[str, Any]:
    """A map that is water everywhere."""
    path = folder / "white.png"
    path.parent.mkdir(parents=True, exist_ok=True)
    Picture.new("L", (8, 4), 255).save(path)
    return {"bodies.planet.ocean": {"map": str(path), "wind_m_s": 7.0, "albedo": 0.0}}


def glint() -> dict[str, Any]:
    """A ball of water, the Sun 100 degrees from the eye: its glint is near the limb."""
    config = ball(0.0, [900.0, 900.0, -100.0])
    config["camera"] |= {"fov_deg": 50.0}
    config["camera"]["exposure"]["white_radiance_w_m2_sr"] = 150.0
    return config


FRAMES = {
    "iss": Frame("iss_leo.yaml", 1, {"bodies.earth.atmosphere": None}),
    "voyager": Frame("voyager_phobos.yaml", 1),
    "satellite": Frame(
        "demo.yaml",
        2,
        {
            "spacecraft.smallsat.materials": None,
            "spacecraft.smallsat.model_graphs": False,
            "bodies.planet.atmosphere": None,
            "bodies.planet.clouds": None,
            "bodies.planet.ocean": None,
            "camera.trajectory.distance_m": [6.0, 7.0],
        },
    ),
    "body": Frame(
        "phobos.yaml",
        0,
        {
            "bodies.phobos.reflectance": "lambert",
            "bodies.phobos.photometry": None,
            "bodies.phobos.albedo": [0.9, 0.85, 0.8],
            "bodies.mars.atmosphere": None,
            "render.max_bounces": 4,
        },
        fine_phobos,
    ),
    "ground": Frame(
        "paper2_slope.yaml",
        0,
        {
            "bodies.moon.reflectance": "lambert",
            "bodies.moon.albedo": 0.3,
            "bodies.moon.terrain.rocks": None,
            "bodies.moon.terrain.craters.rays": None,
            "sun.at.elevation_deg": 12.0,
            "sun.at.azimuth_deg": 70.0,
            "render.force_off": [
                "limb_darkening",
                "sub_cell_normals",
            ],  # the mesh has no such slopes
        },
    ),
    "foil": Frame(alone(), make=foil),
    "air": Frame(air(multiple=True)),
    "air_once": Frame(air(multiple=False)),
    "glint": Frame(glint(), make=sea),
}
