"""Scenes of worlds without spacecraft: see gallery.py."""

from __future__ import annotations

import math
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import yaml

from perilune import _core
from perilune.base import rotations
from perilune.orbits.solar_system import date_from_utc, relative_m

Scene = dict[str, Any]
ROOT = Path(__file__).resolve().parents[2]
MAPS = "data:planets/solarsystemscope/"
EARTH_KM = 6378.1
CLOUDS: Scene = {
    "map": MAPS + "2k_earth_clouds.jpg",
    "noise": {"size_km": 200.0, "roughness": 0.76, "softness": 2.0, "octaves": 12.0},
}


def part(name: str, section: str, entry: str) -> Scene:
    """An entry of a section of a file in configs/; paths are those of the folder."""
    config = yaml.safe_load((ROOT / "configs" / f"{name}.yaml").read_text())
    return dict(config[section][entry])


def direction(lon_deg: float, lat_deg: float) -> np.ndarray[Any, Any]:
    """In a body's own axes."""
    lon, lat = math.radians(lon_deg), math.radians(lat_deg)
    flat = math.cos(lat)
    return np.array([flat * math.cos(lon), flat * math.sin(lon), math.sin(lat)])


def view(target: str, place_m: Any, aim_m: Any, up: Any, fov_deg: float, frame: str) -> Scene:
    """A camera at a place, and the point that it looks at, both from the target's centre."""
    return {
        "fov_deg": fov_deg,
        "trajectory": {
            "kind": "fixed",
            "target": target,
            "frame": frame,
            "position_m": np.asarray(place_m).tolist(),
            "aim_offset_m": np.asarray(aim_m).tolist(),
            "up": np.asarray(up).tolist(),
        },
    }


def above(place: tuple[float, float, float], aim: tuple[float, float, float], fov: float) -> Scene:
    """Over the Earth: longitude, latitude, deg, and height, km, of the camera and of its aim.

    What is farther from the Earth is up in the image; north, from more than a radius of it.
    """
    start, end = (direction(lon, lat) * (EARTH_KM + high) * 1e3 for lon, lat, high in (place, aim))
    up = np.array([0.0, 0.0, 1.0]) if place[2] > EARTH_KM else start
    return view("earth", start, end, up, fov, "target")


def still(epoch: str, root: str, bodies: Scene, camera: Scene, white: float) -> Scene:
    """white: the radiance that is shown as white, W m-2 sr-1."""
    fixed = {"mode": "fixed", "white_radiance_w_m2_sr": white}
    return {
        "version": 1,
        "time": {"epoch": epoch},
        "root": root,
        "bodies": bodies,
        "camera": camera | {"width": 360, "height": 240, "exposure": fixed},
    }


def planet(**more: Any) -> Scene:
    """The Earth as in configs/iss_leo.yaml, with its sea, clouds and what else is given."""
    body = part("iss_leo", "bodies", "earth")
    return body | {"ocean": {}, "clouds": CLOUDS} | more


def earth() -> Scene:
    """The Atlantic and Africa from 9000 km, the Sun mirrored by the sea."""
    camera = above((-30.0, 10.0, 9000.0), (-29.0, 10.0, 0.0), 76.0)
    return still("2026-03-20T15:10:00Z", "earth", {"earth": planet()}, camera, 250.0)


def night() -> Scene:
    """Europe's lights from 2500 km over Libya, looking northwest after the sunset."""
    lights = {"map": MAPS + "2k_earth_nightmap.jpg", "black": 0.02}
    camera = above((22.0, 30.0, 2500.0), (6.0, 47.0, 0.0), 45.0)
    bodies = {"earth": planet(night_lights=lights)}
    return still("2026-03-20T21:50:00Z", "earth", bodies, camera, 1.2e-3)


def clouds(strength: float) -> Scene:
    """The map of clouds over the Atlantic, bent by a driver of this strength."""
    warp = {"ideal": 0.0, "jitter_variance": 1.0, "clip_min": -10.0, "clip_max": 10.0}
    noise = CLOUDS["noise"] | {"size_km": 1500.0, "softness": 3.0, "warp": warp}
    camera = above((-30.0, 25.0, 6500.0), (-27.0, 25.0, 0.0), 40.0)
    bodies = {"earth": planet(clouds=CLOUDS | {"noise": noise})}
    scene = still("2026-06-20T13:30:00Z", "earth", bodies, camera, 230.0)
    return scene | {"drivers": {"strength": strength}, "seed": 8}


def earthshine() -> Scene:
    """The young Moon from the Earth's side, exposed for its night: a second and a half at f/4, by a
    camera whose lens scatters what is too much for the sensor."""
    date = date_from_utc((2026, 3, 21, 8, 0, 0.0))
    to_earth = relative_m("earth", "moon", date)
    place = to_earth / np.linalg.norm(to_earth) * 2.0e7
    camera = view("moon", place, [0.0, 0.0, 0.0], [0.0, 0.0, 1.0], 17.5, "icrf")
    camera["exposure_time_s"] = 1.5
    camera["sensor"] = {
        "f_number": 4.0,
        "full_well_e": 20000.0,
        "gain_e_dn": 1.25,
        "bits": 14,
        "read_noise_e": 3.0,
        "exposure": {"mode": "fixed"},
        "point_spread": {"sigma_px": 0.6, "wings": 0.02, "wing_beta": 1.25},
        "cosmic_rays": {"flux_cm2_s": 0.0},
    }
    bodies = {"moon": part("lro_moon", "bodies", "moon"), "earth": planet()}
    return still("2026-03-21T08:00:00Z", "moon", bodies, camera, 0.011)


def saturn() -> Scene:
    """Saturn and its rings with both shadows, from 24 deg over their lit side."""
    when = date_from_utc((2013, 10, 10, 0, 0, 0.0))
    turn = _core.body_orientation("saturn", when.day, np.array([when.fraction]))[0]
    to_sun = rotations.rotate(rotations.conjugate(turn), relative_m("sun", "saturn", when))
    azimuth_deg = math.degrees(math.atan2(to_sun[1], to_sun[0])) + 38.0
    place = direction(azimuth_deg, math.copysign(24.0, to_sun[2])) * 1.1e9
    camera = view("saturn", place, [0.0, 0.0, 0.0], [0.0, 0.0, 1.0], 17.0, "target")
    body = part("cassini_saturn", "bodies", "saturn")
    scene = still("2013-10-10T00:00:00Z", "saturn", {"saturn": body}, camera, 2.5)
    return scene | {"materials": {"bands": part("cassini_saturn", "materials", "bands")}}


WORLDS: dict[str, Callable[[], Scene | Path]] = {
    "earth": earth,
    "night": night,
    "saturn": saturn,
    "earthshine": earthshine,
    "comet": lambda: ROOT / "configs" / "comet.yaml",
    "fictional": lambda: ROOT / "configs" / "fictional.yaml",
}
"""Of gallery_worlds.png, three in a row."""
