"""Worlds, and seven spacecraft over six of them, after figures of the Space OAISYS paper:

    python docs/figures/gallery.py                 # the gallery_*.png of docs/images, or some
    python docs/figures/gallery.py 12 14 15 worlds
    python docs/figures/gallery.py cells --bodies mars,moon --craft iss --width 640 --out /tmp/look

Figures 14 and 15 are the spacecraft, 12 is clouds that a driver bends; `cells` writes single
pictures of 14 and 15. Models, maps and surfaces are those of the files in configs/; here is where
things are, and the camera. Needs Pillow and the sample data.
"""

from __future__ import annotations

import argparse
import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import gallery_stills
import numpy as np
from gallery_grounds import cratered, icy, lands
from gallery_stills import part
from numpy.typing import NDArray
from PIL import Image

import perilune
from perilune import _core
from perilune.base import rotations
from perilune.orbits.solar_system import AU_M, date_from_utc, relative_m

F64 = NDArray[np.float64]
ROOT = Path(__file__).resolve().parents[2]
IMAGES = ROOT / "docs" / "images"
MODELS = "data:spacecraft/plain/"
ASPECT = 3, 4


@dataclass(frozen=True)
class Ground:
    """A body, and where over it spacecraft are seen."""

    config: Mapping[str, Any]
    altitude_km: float
    epoch: tuple[int, int, int, int, int]
    sun_zenith_deg: float
    """At the spacecraft."""
    bearing_deg: float
    """Of the first spacecraft from the point under the Sun, from the direction of the ICRF's x."""
    step_deg: float = 37.0
    """From the bearing of one spacecraft to that of the next."""
    limb_deg: float = 9.0
    """How far over the middle of the picture the limb is."""
    others: Mapping[str, Any] = field(default_factory=dict)
    materials: Mapping[str, Any] = field(default_factory=dict)
    white: float = 0.5
    """The reflectance that is shown as white where it faces the Sun: the exposure."""


@dataclass(frozen=True)
class Craft:
    """A spacecraft, and from where it is seen."""

    config: Mapping[str, Any]
    distance_m: float
    azimuth_deg: float
    """Of the camera as seen from the spacecraft, from the Sun's azimuth."""
    lift_m: float = 0.0
    """How far above the spacecraft's middle the camera looks."""
    materials: Mapping[str, Any] = field(default_factory=dict)
    finer: int = 1
    """By so many times the number of samples is larger: crumpled mirrors are noisy."""


def model(name: str, entry: str, **changes: Any) -> dict[str, Any]:
    """A spacecraft of a file in configs/, to be put on an orbit."""
    spacecraft = part(name, "spacecraft", entry)
    return {key: value for key, value in spacecraft.items() if key != "parts"} | changes


def ready(*names: str) -> dict[str, Any]:
    """Materials of assets/materials."""
    return {name: {"file": f"../assets/materials/{name}.yaml"} for name in names}


def level(*rotation_deg: float) -> dict[str, Any]:
    """An attitude from the local horizon: roll, pitch, yaw."""
    return {"pointing": "lvlh", "rotation_deg": list(rotation_deg)}


MARS = part("mro_mars", "bodies", "mars")
LOW_CLOUDS = {
    "map": "data:planets/solarsystemscope/2k_earth_clouds.jpg",
    # The map's texels are 20 km: finer things, bent as by winds, are the noise's.
    "noise": {"size_km": 200.0, "roughness": 0.76, "softness": 0.7, "octaves": 15.0, "warp": 0.5},
}
OWN_GROUND = {"material": "ground", "material_mode": "wrap"}
GROUNDS = {
    "earth": Ground(
        part("iss_leo", "bodies", "earth") | OWN_GROUND | {"clouds": LOW_CLOUDS},
        418.0,
        (2026, 3, 20, 12, 40),
        45.0,
        100.0,
        materials={"ground": lands()},
    ),
    "mars": Ground(
        MARS | OWN_GROUND,
        300.0,
        (2026, 2, 10, 0, 0),
        48.0,
        10.0,
        materials={"ground": cratered(45e3, "lambert", 0.6, 0.25, 0.9)},
    ),
    "mercury": Ground(
        {
            "kind": "mercury",
            "color_map": "data:planets/solarsystemscope/2k_mercury.jpg",
            "reflectance": "hapke",
            "albedo": [1.25, 1.15, 1.03],  # a geometric albedo of 0.14
            **OWN_GROUND,
        },
        700.0,
        (2026, 4, 1, 0, 0),
        55.0,
        60.0,
        white=0.42,
        materials={"ground": cratered(60e3, "hapke")},
    ),
    "moon": Ground(
        part("lro_moon", "bodies", "moon") | OWN_GROUND,
        100.0,
        (2026, 3, 3, 6, 0),
        55.0,
        0.0,
        white=0.4,
        materials={"ground": cratered(16e3, "hapke")},
    ),
    "europa": Ground(
        {
            "kind": "europa",
            "color_map": "data:planets/usgs/europa_1024x512.png",
            "material": "ground",
        },
        500.0,
        (2026, 5, 1, 3, 0),
        50.0,
        200.0,
        step_deg=9.0,
        white=0.6,
        materials={"ground": icy(150e3)},
    ),
    "phobos": Ground(
        part("phobos", "bodies", "phobos"),
        35.0,
        (2026, 6, 1, 11, 30),
        35.0,
        140.0,
        limb_deg=7.0,
        others={"mars": MARS},
        white=0.3,
    ),
}

FOIL = [
    {"material": "foil_gold*", "use": "gold_mli"},
    {"material": "foil_*", "use": "silver_mli"},
]
CRAFT = {
    "iss": Craft(model("iss_leo", "iss"), 260.0, 62.0, lift_m=-6.0),
    "station": Craft(
        model("rendezvous", "station", attitude=level(0.0, 0.0, 40.0)),
        66.0,
        -48.0,
        lift_m=-1.0,
        materials=ready("gold_mli", "silver_mli", "solar_cells", "white_paint"),
    ),
    "lro": Craft(
        model("lro_moon", "lro", materials=FOIL),
        13.5,
        55.0,
        lift_m=0.5,
        materials=ready("gold_mli", "silver_mli"),
        finer=4,
    ),
    "mro": Craft(
        model("mro_mars", "mro", attitude=level(180.0, 0.0, 0.0)), 24.5, -60.0, lift_m=-0.6
    ),
    "shuttle": Craft(
        {
            "model": MODELS + "space_shuttle_d.glb",
            "metres_per_unit": 0.0254,  # the model is in inches
            "attitude": level(90.0, 0.0, 30.0),
        },
        70.0,
        50.0,
        lift_m=-1.0,
    ),
    "tango": Craft(
        {
            "model": "../assets/models/tango_like.glb",
            "metres_per_unit": 1.0,
            "attitude": level(160.0, -25.0, 30.0),
            "materials": [
                {"material": "mli_silver", "use": "silver_mli"},
                {"material": "solar_cell", "use": "solar_cells"},
            ],
        },
        3.0,
        -52.0,
        materials=ready("silver_mli", "solar_cells"),
        finer=4,
    ),
    "voyager": Craft(
        model("voyager_phobos", "voyager", attitude=level(180.0, 10.0, 30.0)),
        29.0,
        58.0,
        lift_m=0.0,
    ),
}


def turned(v: F64, axis: F64, angle_deg: float) -> F64:
    return rotations.rotate(rotations.axis_angle(axis, math.radians(angle_deg)), v)


def radius_km(body: str) -> float:
    return float(max(_core.BODIES[body]["radii_m"])) * 1e-3


def to_sun_m(body: str) -> F64:
    return relative_m("sun", body, date_from_utc((*GROUNDS[body].epoch, 0.0)))


def state(body: str, column: int) -> dict[str, Any]:
    """On a circle towards the point under the Sun; each column comes from another side."""
    ground = GROUNDS[body]
    to_sun = to_sun_m(body)
    to_sun /= np.linalg.norm(to_sun)
    side = np.cross(to_sun, [0.0, 0.0, 1.0])
    bearing = ground.bearing_deg + ground.step_deg * column
    axis = turned(side / np.linalg.norm(side), to_sun, bearing)
    up = turned(to_sun, axis, ground.sun_zenith_deg)
    distance_km = radius_km(body) + ground.altitude_km
    speed_km_s = math.sqrt(_core.BODIES[body]["gm_m3_s2"] * 1e-9 / distance_km)
    return {
        "position_km": (up * distance_km).tolist(),
        "velocity_km_s": (np.cross(up, axis) * speed_km_s).tolist(),
    }


def camera(body: str, craft: str) -> dict[str, Any]:
    """Beside the spacecraft and above it, so that the limb is behind it."""
    ground, seen = GROUNDS[body], CRAFT[craft]
    row = list(GROUNDS).index(body)
    radius = radius_km(body)
    down = math.acos(radius / (radius + ground.altitude_km)) + math.radians(ground.limb_deg)
    azimuth = math.radians((seen.azimuth_deg + 4.0 * row - 10.0) * (-1) ** row)
    ahead = np.array([math.cos(azimuth), math.sin(azimuth), 0.0])
    place = seen.distance_m * (math.cos(down) * ahead - [0.0, 0.0, math.sin(down)])
    return {
        "fov_deg": 42.0,
        "trajectory": {
            "kind": "fixed",
            "target": craft,
            "frame": "lvlh",
            "position_m": place.tolist(),
            "aim_offset_m": [0.0, 0.0, -seen.lift_m],
            "up": [0.0, 0.0, -1.0],
        },
    }


def scene(body: str, craft: str, width: int = 200, samples: int = 16) -> dict[str, Any]:
    """The configuration of one picture."""
    ground, seen = GROUNDS[body], CRAFT[craft]
    orbit = {"around": body, "state": state(body, list(CRAFT).index(craft)), "frame": "icrf"}
    year, month, day, hour, minute = ground.epoch
    sunlight = 1361.0 * (AU_M / float(np.linalg.norm(to_sun_m(body)))) ** 2
    size = {"width": width, "height": width * ASPECT[0] // ASPECT[1]}
    white = {"white_radiance_w_m2_sr": ground.white * sunlight / math.pi}
    return {
        "version": 1,
        "time": {"epoch": f"{year}-{month:02}-{day:02}T{hour:02}:{minute:02}:00Z"},
        "root": body,
        "bodies": {body: dict(ground.config)} | dict(ground.others),
        "materials": dict(seen.materials) | dict(ground.materials),
        "spacecraft": {craft: dict(seen.config) | {"orbit": orbit, "class": craft}},
        "camera": camera(body, craft) | size | {"exposure": {"mode": "fixed", **white}},
        "render": {"samples": samples * seen.finer, "max_bounces": 4},
    }


def picture(body: str, craft: str, width: int, samples: int) -> NDArray[np.uint8]:
    sim = perilune.open(scene(body, craft, width, samples), base=ROOT / "configs")
    rgb: NDArray[np.uint8] = sim.frame(0, channels=["rgb"])["rgb"]
    return rgb


def grid(pictures: list[list[NDArray[np.uint8]]]) -> Image.Image:
    """Rows of pictures of one size, a black line between."""
    gap, (height, width) = 3, pictures[0][0].shape[:2]
    whole = Image.new(
        "RGB", (len(pictures[0]) * (width + gap) - gap, len(pictures) * (height + gap) - gap)
    )
    for row, line in enumerate(pictures):
        for column, rgb in enumerate(line):
            whole.paste(Image.fromarray(rgb), (column * (width + gap), row * (height + gap)))
    return whole


def craft_sheet(rows: list[str], width: int, samples: int) -> Image.Image:
    """Bodies as rows, spacecraft as columns."""
    return grid([[picture(body, craft, width, samples) for craft in CRAFT] for body in rows])


def rendered(scene: dict[str, Any] | Path, width: int, samples: int) -> NDArray[np.uint8]:
    """A still, three by two; by its camera's sensor where it has one."""
    changes = {"camera.width": width, "camera.height": width * 2 // 3, "render.samples": samples}
    sim = perilune.open(scene, base=ROOT / "configs", overrides=changes)
    sensor = isinstance(scene, dict) and "sensor" in scene["camera"]
    channel = "sensor_rgb" if sensor else "rgb"
    rgb: NDArray[np.uint8] = sim.frame(0, channels=[channel])[channel]
    return rgb


def worlds(width: int, samples: int) -> Image.Image:
    """The Earth by day and by night, Saturn, the Moon in the Earth's light, a comet, a fiction."""
    shown = [rendered(scene(), width, samples) for scene in gallery_stills.WORLDS.values()]
    return grid([shown[:3], shown[3:]])


def clouds(width: int, samples: int) -> Image.Image:
    """One map of clouds, bent more and more by a driver."""
    scenes = [gallery_stills.clouds(strength) for strength in (0.0, 0.05, 0.5, 4.0)]
    return grid([[rendered(scene, width, samples) for scene in scenes]])


SHEETS = {
    "12": lambda width, samples: clouds(width * 3 // 2, samples),
    "14": lambda width, samples: craft_sheet(list(GROUNDS)[:3], width, samples),
    "15": lambda width, samples: craft_sheet(list(GROUNDS)[3:], width, samples),
    "worlds": lambda width, samples: worlds(width * 2, samples),
}


def cells(options: argparse.Namespace) -> None:
    """Single pictures."""
    options.out.mkdir(parents=True, exist_ok=True)
    for body in options.bodies.split(","):
        for craft in options.craft.split(","):
            rgb = picture(body, craft, options.width, options.samples)
            Image.fromarray(rgb).save(options.out / f"{body}_{craft}.png")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("what", nargs="*", help=f"{', '.join(SHEETS)} (default: all), cells")
    parser.add_argument("--bodies", default=",".join(GROUNDS), help="of cells: such as earth,mars")
    parser.add_argument("--craft", default=",".join(CRAFT), help="of cells: such as iss,lro")
    parser.add_argument("--width", type=int, default=300, help="of a cell, pixels")
    parser.add_argument("--samples", type=int, default=16)
    parser.add_argument("--out", type=Path, default=IMAGES)
    options = parser.parse_args()
    for name in options.what or SHEETS:
        if name == "cells":
            cells(options)
        elif name not in SHEETS:
            parser.error(f"no sheet named '{name}'")
        else:
            image = SHEETS[name](options.width, options.samples)
            image.save(options.out / f"gallery_{name}.png", optimize=True)


if __name__ == "__main__":
    main()
