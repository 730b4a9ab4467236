"""Maps on bodies whose pixels are shaded by one value each, at grazing views and where the map is
sharp at the scale of pixels: against as many samples as a lens that is in focus everywhere takes.
"""

from __future__ import annotations

import copy
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml
from numpy.typing import NDArray
from PIL import Image

import perilune

F64 = NDArray[np.float64]
U8 = NDArray[np.uint8]
SIDE = 40
RADIUS_KM, HEIGHT_KM = 1000.0, 1500.0
WHITE = 433.0  # W m-2 sr-1: about that of a white plate under the sun, 1361 / pi
WORLD: dict[str, Any] = {
    "version": 1,
    "seed": 3,
    "time": {"epoch": "2026-03-20T12:00:00Z", "step_s": 0.0},
    "root": "ball",
    "sun": {"direction": [1.0, 0.2, 0.8]},
    "bodies": {
        "ball": {
            "kind": "ellipsoid",
            "radii_km": [RADIUS_KM] * 3,
            "gm_km3_s2": 1.0,
            "color_map": "map.png",
            "class": "ball",
        }
    },
    "camera": {
        "width": SIDE,
        "height": SIDE,
        "fov_deg": 6.1,
        "exposure": {"mode": "fixed", "white_radiance_w_m2_sr": WHITE},
        "trajectory": {
            "kind": "hover",
            "target": "ball",
            "lon_deg": 0.0,
            "lat_deg": 80.0,
            "height_m": 1000.0 * HEIGHT_KM,
            "off_nadir_deg": 20.5,
            "azimuth_deg": 180.0,
        },
    },
    "render": {"samples": 4, "tolerance_dn": 1e-3, "max_bounces": 0, "channels": ["radiance"]},
}


def shoot(folder: Path, **changes: Any) -> F64:
    tree = copy.deepcopy(WORLD)
    tree["camera"] |= changes.get("camera", {})
    tree["render"] |= changes.get("render", {})
    (folder / "world.yaml").write_text(yaml.safe_dump(tree))
    image = perilune.open(folder / "world.yaml").frame(0)["radiance"]
    return image[..., 1].astype(np.float64) / WHITE


def cosines() -> F64:
    """Of the angle between the view and the normal, by a sphere's own formula; 0 beside it."""
    focal = 0.5 * SIDE / np.tan(np.radians(0.5 * WORLD["camera"]["fov_deg"]))
    x, y = np.meshgrid(*[np.arange(SIDE) - 0.5 * (SIDE - 1)] * 2)
    rays = np.stack([x, y, np.full_like(x, focal)], axis=-1)
    rays /= np.linalg.norm(rays, axis=-1, keepdims=True)
    tilt = np.radians(WORLD["camera"]["trajectory"]["off_nadir_deg"])
    # The horizon is up in the image: nadir lies below its middle.
    nadir = np.array([0.0, np.sin(tilt), np.cos(tilt)])
    sine = np.sqrt(1.0 - (rays @ nadir) ** 2) * (1.0 + HEIGHT_KM / RADIUS_KM)
    return np.sqrt(np.maximum(0.0, 1.0 - sine**2))


def compare(folder: Path, texels: U8) -> tuple[F64, F64]:
    """Analytic and sampled values at cosines of 0.15 to 0.6."""
    Image.fromarray(texels).save(folder / "map.png")
    analytic = shoot(folder)
    view = cosines()
    grazing = (view > 0.17) & (view < 0.6)
    assert grazing.sum() > 500
    again = shoot(folder, render={"samples": 6})
    # The footprint is up to 0.03 of the radius long. What is sampled differs with the number.
    assert (analytic == again)[grazing].mean() > 0.8
    lens = {"focus_distance_m": "infinity", "aperture_mm": 1e-7}
    many = {"samples": 1024, "force_on": ["depth_of_field"]}
    sampled = shoot(folder, camera={"lens": lens}, render=many)
    inside = grazing & (analytic == again)
    return analytic[inside], sampled[inside]


def checker(width: int, cell: int) -> U8:
    y, x = np.indices((width // 2, width))
    return ((x // cell + y // cell) % 2 * 255).astype(np.uint8)


def check(analytic: F64, sampled: F64, most_rms: float) -> None:
    """Near each other, no brighter in the mean, and with as much contrast."""
    off = analytic - sampled
    rms = float(np.sqrt(np.mean(off**2)))
    contrast = analytic.std() / sampled.std()
    print(f"RMS {rms:.4f}, largest {abs(off).max():.3f}, contrast {contrast:.3f}")
    assert sampled.std() > 0.03
    assert rms < most_rms
    assert abs(off).max() < 7.0 * most_rms
    assert abs(off.mean()) < 2e-3
    assert contrast == pytest.approx(1.0, abs=0.15)


@pytest.mark.parametrize(
    ("width", "cell"), [(1024, 2), (1024, 8), (2048, 4), (4096, 4), (4096, 12)]
)
def test_checkers_at_grazing_views(tmp_path: Path, width: int, cell: int) -> None:
    """A pixel is 2.6 texels wide of the finest, and up to 17 long. Smooth reads, whose kernels are
    1.7 times as wide as a pixel's box, leave up to 0.037."""
    check(*compare(tmp_path, checker(width, cell)), most_rms=0.02)


def test_noise_at_grazing_views(tmp_path: Path) -> None:
    """Texels of chance; smooth reads leave 0.067."""
    texels = np.random.default_rng(8).integers(0, 2, (1024, 2048)).astype(np.uint8) * 255
    check(*compare(tmp_path, texels), most_rms=0.035)


@pytest.mark.parametrize("name", ["usgs/phobos_1024x512.png", "solarsystemscope/2k_mars.jpg"])
def test_maps_at_grazing_views(tmp_path: Path, data_dir: Path, name: str) -> None:
    with Image.open(data_dir / "planets" / name) as picture:
        texels = np.asarray(picture.convert("L"))
    check(*compare(tmp_path, texels), most_rms=1.9e-3)
