"""Albedo and roughness of terrain from rasters: beside NumPy, maps and other keys; errors."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import perilune
from perilune import _core
from perilune.base import rotations
from perilune.config.errors import ConfigError
from perilune.frame import shutter

LON_DEG, LAT_DEG = 20.0, 10.0
SIDE, POST_M = 33, 250.0
PARAMETERS = {"b": 0.24, "c": 0.3, "b_s0": 1.7, "h_s": 0.07}
FLAT: dict[str, Any] = {"detail": {"strength": 0.0}}
WHOLE = {"projection": {"kind": "cylindrical", "west_deg": 0.0}}
LOCAL = {"projection": {"kind": "orthographic", "center_lon_lat_deg": [LON_DEG, LAT_DEG],
                        "post_m": POST_M}}  # fmt: skip


def moon(
    folder: Path, terrain: dict[str, Any] | None, height_m: float = 5e3, **body: Any
) -> perilune.Simulation:
    """A smooth Moon straight below a camera 48 pixels wide, with as much ground as height_m."""
    tree = {
        "version": 1,
        "time": {"epoch": "2026-03-03T06:00:00Z"},
        "root": "moon",
        "sun": {"at": {"lon_deg": LON_DEG, "lat_deg": LAT_DEG, "azimuth_deg": 90.0,
                       "elevation_deg": 50.0}},
        "bodies": {"moon": {"kind": "moon", "albedo": 1.0,
                            **({} if terrain is None else {"terrain": FLAT | terrain})} | body},
        "camera": {"width": 48, "height": 48, "fov_deg": 53.13, "exposure": {"mode": "auto"},
                   "trajectory": {"kind": "hover", "target": "moon", "lon_deg": LON_DEG,
                                  "lat_deg": LAT_DEG, "height_m": height_m}},
        "render": {"samples": 1, "max_bounces": 1, "force_off": ["soft_sun"]},
    }  # fmt: skip
    return perilune.open(tree, base=folder)


def radiance(sim: perilune.Simulation, **options: Any) -> np.ndarray:
    return np.asarray(sim.frame(0, ["radiance"], **options)["radiance"], dtype=float)


def local_m(sim: perilune.Simulation) -> np.ndarray:
    """(H, W, 2) east and north of the site, m, of the points that are seen."""
    sample = sim.frame(0, ["position"])
    pose = shutter.middle(sim.world(0)).poses["moon"][0]
    points = (sample["position"] - pose[:3]) @ rotations.to_matrix(pose[3:])
    points *= 1737.4e3 / np.linalg.norm(points, axis=-1, keepdims=True)
    lon, lat = np.radians(LON_DEG), np.radians(LAT_DEG)
    east = [-np.sin(lon), np.cos(lon), 0.0]
    north = [-np.sin(lat) * np.cos(lon), -np.sin(lat) * np.sin(lon), np.cos(lat)]
    return np.asarray(points @ np.array([east, north]).T)


def test_values_beside_numpy(tmp_path):
    """Albedo at a point is bilinear between posts: a ramp, and a bump above it, over gaps."""
    x, y = np.meshgrid(np.arange(SIDE), np.arange(SIDE))
    values = 0.2 + 0.005 * x + 0.004 * y + 0.1 * np.exp(-((x - 16) ** 2 + (y - 12) ** 2) / 40.0)
    holed = values.astype(np.float32)
    holed[2, 3] = np.nan  # outside of the frame
    np.save(tmp_path / "albedo.npy", holed)
    given = {"file": "albedo.npy", "border_posts": 1.0, **LOCAL}
    plain = moon(tmp_path, {})
    sim = moon(tmp_path, {"albedo": [given]})
    with pytest.warns(UserWarning, match=r"albedo\[0\]\.file: .*albedo\.npy: 1 of 1089 numbers"):
        found = radiance(sim) / radiance(plain)
    at = local_m(sim)
    u, v = at[..., 0] / POST_M + 16.0, 16.0 - at[..., 1] / POST_M
    i, j = np.floor(u).astype(int), np.floor(v).astype(int)
    s, t = u - i, v - j
    expected = ((1 - t) * ((1 - s) * values[j, i] + s * values[j, i + 1])
                + t * ((1 - s) * values[j + 1, i] + s * values[j + 1, i + 1]))  # fmt: skip
    # Samples lie anywhere in their pixel, a half of which is 0.2 posts.
    np.testing.assert_allclose(found, expected[..., None].repeat(3, -1), atol=4e-3)
    np.testing.assert_allclose(found.mean(), expected.mean(), rtol=5e-4)


def test_constant_rasters_are_numbers(tmp_path):
    """Of albedo and of roughness, over a colour map and over a photometric law."""
    np.save(tmp_path / "w.npy", np.full((18, 36), 0.4, np.float32))
    np.save(tmp_path / "theta.npy", np.full((18, 36), 10.0, np.float32))
    _core.png_write(str(tmp_path / "map.png"), np.full((4, 8, 3), 90, np.uint8))
    rasters = {
        "albedo": [{"file": "w.npy", **WHOLE}],
        "roughness": [{"file": "theta.npy", **WHOLE}],
    }
    law = {"reflectance": "hapke"}
    given = moon(tmp_path, rasters, color_map="map.png", **law)
    alone = moon(tmp_path, {}, albedo=0.4, photometry={"roughness_deg": 10.0}, **law)
    rougher = moon(tmp_path, {}, albedo=0.4, photometry={"roughness_deg": 30.0}, **law)
    np.testing.assert_allclose(radiance(given), radiance(alone), rtol=2e-6)
    assert np.abs(radiance(rougher) / radiance(alone) - 1.0).max() > 0.02
    smooth = [sim.with_overrides({"render.force_off": ["soft_sun", "terrain"]})
              for sim in (given, alone)]  # fmt: skip
    np.testing.assert_allclose(*(radiance(sim) for sim in smooth), rtol=2e-6)
    off = given.with_overrides({"render.force_off": ["soft_sun", "surface_maps"]})
    np.testing.assert_allclose(radiance(off), radiance(alone), rtol=1e-4)


def test_contrast_is_about_the_mean(tmp_path):
    """0: the mean; 2: twice the difference from it; also of a map on a body without terrain."""
    values = np.where(np.arange(36) % 2 == 0, 0.3, 0.5) * np.ones((18, 1))
    np.save(tmp_path / "w.npy", values.astype(np.float32))
    terrain = {"albedo": [{"file": "w.npy", **WHOLE}]}
    grey = np.where(np.arange(8) % 2 == 0, 120, 160).astype(np.uint8)
    _core.png_write(str(tmp_path / "map.png"), np.tile(grey[None, :, None], (4, 1, 3)))
    for ground, body in ((terrain, {}), (None, {"color_map": "map.png"})):
        none, once, twice = (
            radiance(moon(tmp_path, ground, 3e6, albedo_contrast=contrast, **body))
            for contrast in (0.0, 1.0, 2.0)
        )
        lit = once.sum(axis=-1) > 0.05 * once.sum(axis=-1).max()
        assert np.abs(once - none)[lit].max() > 0.05 * once.max()
        np.testing.assert_allclose((twice - once)[lit], (once - none)[lit], atol=2e-3 * once.max())


def test_brightness_does_not_depend_on_the_distance(tmp_path):
    """Over a raster of noise, from posts of 20 pixels to posts of a twentieth of a pixel, the same
    ground is as bright."""
    rng = np.random.default_rng(1)
    values = rng.uniform(0.1, 0.7, (257, 257)).astype(np.float32)
    np.save(tmp_path / "w.npy", values)
    place = {"kind": "orthographic", "center_lon_lat_deg": [LON_DEG, LAT_DEG], "post_m": 100.0}
    terrain = {"albedo": [{"file": "w.npy", "projection": place}]}
    means = []
    for height_m, half in ((1e4, 24), (4e4, 6), (2e5, 1)):
        ratio = radiance(moon(tmp_path, terrain, height_m), threads=1) / radiance(
            moon(tmp_path, {}, height_m), threads=1
        )
        inner = slice(24 - half, 24 + half)
        means.append(float(ratio[inner, inner].mean()))
    assert means == pytest.approx([means[0]] * 3, rel=0.01)


def test_the_same_bits_for_any_threads(tmp_path):
    values = np.random.default_rng(2).uniform(0.1, 0.7, (18, 36)).astype(np.float32)
    np.save(tmp_path / "w.npy", values)
    sim = moon(tmp_path, {"albedo": [{"file": "w.npy", **WHOLE}]}, 4e5)
    np.testing.assert_array_equal(radiance(sim, threads=1), radiance(sim, threads=2))


def test_bands_of_published_maps(data_dir):
    """Roughness and single-scattering albedo of LROC's maps, read as rasters, look as photometric
    maps: their grids and filters differ by what one degree holds."""
    path = str(data_dir / "reflectance" / "WAC_HAPKEPARAMMAP_643NM.tif")
    law = {"reflectance": "hapke"}
    rasters = {"albedo": [{"file": path, "band": 1}], "roughness": [{"file": path, "band": 8}]}
    given = radiance(moon(data_dir, rasters, 3e5, photometry=PARAMETERS, **law))
    maps = {"maps": [path], **PARAMETERS}
    known = radiance(moon(data_dir, {}, 3e5, photometry=maps, **law))
    np.testing.assert_allclose(given, known, rtol=0.02)
    with pytest.raises(ConfigError, match=r"albedo\[0\]\.band: .*643NM.tif: 10; the file has 9"):
        radiance(moon(data_dir, {"albedo": [{"file": path, "band": 10}]}, **law))


@pytest.mark.parametrize(
    ("keys", "body", "text"),
    [
        ({"albedo": [{"file": "no.npy", **WHOLE}]}, {}, r"albedo\[0\]\.file: no such file: .*no"),
        ({"albedo": [{"file": "w.npy", "band": 2, **WHOLE}]}, {},
         r"albedo\[0\]\.band: .*w\.npy: only for TIFF"),
        ({"albedo": [{"file": "w.npy"}]}, {}, r"albedo\[0\]\.projection: .*w\.npy: .*projection"),
        ({"albedo": [{"file": "w.npy", "scale": 100.0, **WHOLE}]}, {},
         r"albedo\[0\]\.scale: .*w\.npy: .*from 40 to 40; allowed: 0 to 10"),
        ({"roughness": [{"file": "w.npy", "offset": -1.0, **WHOLE}]}, {"reflectance": "hapke"},
         r"roughness\[0\]\.scale: .*w\.npy: .*from -0\.6.* allowed: 0 to 60"),
        ({"roughness": [{"file": "w.npy", **WHOLE}]}, {},
         r"terrain\.roughness: only for reflectance .*hapke.*not lambert"),
        ({"albedo": [{"file": "w.npy", "scale": 0.0, **WHOLE}]}, {}, r"scale: must not be 0"),
        ({"albedo": [{"file": "grey.png", **WHOLE}]}, {}, r"albedo\[0\]\.scale: .*grey\.png"),
        ({}, {"albedo_contrast": 0.5}, r"albedo_contrast: .*color_map.*terrain\.albedo"),
    ],
)  # fmt: skip
def test_errors(tmp_path, keys, body, text):
    np.save(tmp_path / "w.npy", np.full((18, 36), 0.4, np.float32))
    _core.png_write(str(tmp_path / "grey.png"), np.full((18, 36), 90, np.uint8))
    with pytest.raises((ConfigError, FileNotFoundError)) as caught:
        radiance(moon(tmp_path, keys, **body))
    assert re.search(r"bodies\.moon\." + ("" if body.get("albedo_contrast") else r"terrain\."),
                     str(caught.value))  # fmt: skip
    assert re.search(text, str(caught.value)), str(caught.value)
