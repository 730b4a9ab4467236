"""Terrain from real elevation models: posts and summits beside the files, poles, patches."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

import perilune
from perilune import _core
from perilune.bodies.elevation import ElevationRaster, read_elevation
from perilune.bodies.terrain import core_terrain
from perilune.config.elevation import Elevation
from perilune.config.terrain import Terrain

CONFIGS = Path(__file__).resolve().parents[2] / "configs"
RADIUS_M = 1737400.0
RADII_M = np.full(3, RADIUS_M)
LOLA: dict[str, Any] = {
    "file": "ldem_4.img",
    "projection": {"kind": "cylindrical", "west_deg": 0.0},
    "scale_m": 0.5,
    "missing": 0.0,
}
APOLLO: dict[str, Any] = {
    "file": "apollo15",
    "projection": {"kind": "orthographic", "center_lon_lat_deg": [3.6, 26.1], "post_m": 2.0},
    "scale_m": 49.0 / 255.0,
    "offset_m": -1950.0,
}
F64 = NDArray[np.float64]


def lola(data_dir: Path, **more: Any) -> ElevationRaster:
    given = Elevation.model_validate({**LOLA, **more})
    path = data_dir / "lunar_dem" / "ldem_4.img"
    return read_elevation(given, path, (RADIUS_M, RADIUS_M, RADIUS_M))


def apollo(data_dir: Path, **more: Any) -> ElevationRaster:
    (path,) = (data_dir / "lunar_dem" / "apollo15").glob("*.png")
    given = Elevation.model_validate({**APOLLO, **more})
    return read_elevation(given, path, (RADIUS_M, RADIUS_M, RADIUS_M))


def terrain(*rasters: ElevationRaster, **more: Any) -> _core.Terrain:
    return core_terrain(Terrain.model_validate({"elevation": [LOLA], **more}), RADII_M, rasters)


def directions_of(raster: ElevationRaster, posts: NDArray[Any]) -> F64:
    return raster.raster.directions(posts.astype(np.float64))


def test_posts_and_the_highest_point_with_all_detail(data_dir: Path) -> None:
    found = lola(data_dir)
    ground = terrain(found, detail={"seed": 3})
    stored = np.fromfile(data_dir / "lunar_dem" / "ldem_4.img", "<i2").reshape(720, 1440)
    random = np.random.default_rng(1)
    posts = np.stack([random.integers(0, 1440, 400), random.integers(40, 680, 400)], axis=1)
    heights = ground.heights(directions_of(found, posts))
    known = stored[posts[:, 1], posts[:, 0]] != 0
    np.testing.assert_allclose(
        heights[known], 0.5 * stored[posts[:, 1], posts[:, 0]][known], atol=1e-9
    )
    row, column = np.unravel_index(stored.argmax(), stored.shape)
    summit = ground.heights(directions_of(found, np.array([[column, row]])))[0]
    assert abs(summit - 10504.0) < 1e-9
    between = ground.heights(directions_of(found, posts + 0.5))
    assert np.std(between - found.heights(directions_of(found, posts + 0.5))) > 5.0  # detail


def test_one_height_at_the_poles(data_dir: Path) -> None:
    ground = terrain(lola(data_dir), detail=None)
    for sign in (1.0, -1.0):
        lon = np.linspace(0.0, 2.0 * math.pi, 60)
        around = np.stack([1e-9 * np.cos(lon), 1e-9 * np.sin(lon), np.full(60, sign)], axis=1)
        assert np.ptp(ground.heights(around)) < 1e-2


def test_a_patch_lies_over_the_whole_body(data_dir: Path) -> None:
    base, patch = lola(data_dir), apollo(data_dir, border_posts=16.0)
    ground, alone = terrain(base, patch, detail=None), terrain(base, detail=None)
    columns, rows = np.meshgrid(np.arange(16, 241), np.arange(16, 241))
    posts = np.stack([columns.ravel(), rows.ravel()], axis=1)
    inside = directions_of(patch, posts)
    np.testing.assert_array_equal(ground.heights(inside), patch.heights(inside))
    assert not np.array_equal(ground.heights(inside), alone.heights(inside))
    outside = directions_of(patch, np.array([[-0.6, 100.0], [100.0, 256.6], [1e4, 0.0]]))
    np.testing.assert_array_equal(ground.heights(outside), alone.heights(outside))
    # Over the border heights go over without a step: a hundredth of a post, a hundredth of a step.
    across = directions_of(patch, np.stack([np.linspace(-1.0, 20.0, 2101), np.full(2101, 99.5)], 1))
    steps = np.abs(np.diff(ground.heights(across)))
    difference = np.abs(patch.heights(inside) - alone.heights(inside)).max()
    assert steps.max() < 0.01 * (2.0 * difference / 16.0 + 2.0)


def test_a_patch_in_another_projection_fits(data_dir: Path) -> None:
    """The same heights as a polar map: between its posts little changes."""
    base = lola(data_dir, interpolation="cubic")
    side, step = 81, 1000.0
    x = step * (np.arange(side) - 40.0)
    place = {"lat0_rad": math.radians(-75.0), "lon0_rad": 2.0, "radius_m": RADIUS_M}
    frame = _core.Raster(
        np.zeros((side, side), np.uint8), "stereographic", x[0], -x[0], step, -step, **place
    )
    columns, rows = np.meshgrid(np.arange(side), np.arange(side))
    posts = np.stack([columns.ravel(), rows.ravel()], axis=1).astype(np.float64)
    samples = base.heights(frame.directions(posts)).reshape(side, side).astype(np.float32)
    raster = _core.Raster(samples, "stereographic", x[0], -x[0], step, -step, **place)
    layers = [(base.raster, "cubic", 0.0, 0.0), (raster, "cubic", 10.0, 0.0)]
    both = _core.Terrain(RADII_M, layers, None)
    one = _core.Terrain(RADII_M, layers[:1], None)
    anywhere = np.random.default_rng(2).uniform(-5.0, side + 4.0, (5000, 2))
    directions = frame.directions(anywhere)
    change = both.heights(directions) - one.heights(directions)
    assert np.abs(change).max() < 0.02 * np.ptp(samples)


def test_an_apron_takes_the_walls_from_the_border(data_dir: Path) -> None:
    """LOLA is up to 40 m off the patch at its edges."""
    x = np.linspace(-620.0, 620.0, 63)
    east, north = (place.ravel() for place in np.meshgrid(x, x))
    beside = np.maximum(np.abs(east), np.abs(north))
    base = lola(data_dir, interpolation="cubic")
    keys = {"interpolation": "cubic", "destep": True, "border_posts": 32.0, "offset_m": -1895.0}
    patch = apollo(data_dir, **keys)
    posts = np.stack([128.0 + east / 2.0, 128.0 - north / 2.0], axis=1)
    directions = patch.raster.directions(posts)

    def slopes_deg(apron_m: float) -> F64:
        plain = {"detail": {"baseline_m": 17.0, "deviation_m": 1.0}}
        ground = terrain(base, apollo(data_dir, **keys, apron_m=apron_m), **plain)
        slopes: F64 = np.hypot.reduce(ground.slopes(directions, baseline_m=17.0), axis=1)
        return np.degrees(np.arctan(slopes))

    walls, meets = slopes_deg(0.0), slopes_deg(400.0)
    border = (beside > 193.0) & (beside < 257.0)
    assert np.median(walls[border]) > 14.0
    assert np.median(meets[border]) < 8.0
    assert np.percentile(walls[border], 99) > 40.0
    assert np.percentile(meets[border], 99) < 22.0
    np.testing.assert_array_equal(meets[beside < 170.0], walls[beside < 170.0])


def test_the_sun_of_apollo_15_rises_over_mountains(data_dir: Path) -> None:
    """East of the site LOLA's mountains stand 6.6 degrees high, 23 km away: by a march over heights
    in NumPy. With the Sun at 5 degrees the ground is in their shadow, at 9 it is not."""
    sim = perilune.open(
        CONFIGS / "apollo15.yaml", overrides={"camera.width": 16, "camera.height": 12}
    )
    lon, lat, azimuth = np.radians([3.6, 26.1, 95.0])
    up = np.array([math.cos(lat) * math.cos(lon), math.cos(lat) * math.sin(lon), math.sin(lat)])
    east = np.array([-math.sin(lon), math.cos(lon), 0.0])
    way = math.cos(azimuth) * np.cross(up, east) + math.sin(azimuth) * east
    angle = np.linspace(1e3, 1e5, 500) / RADIUS_M
    places = np.cos(angle)[:, None] * up + np.sin(angle)[:, None] * way
    away = RADIUS_M + sim.terrain(0).heights(np.vstack([up, places]))
    over = away[1:] * np.cos(angle) - away[0]
    seen_deg = np.degrees(np.arctan2(over, away[1:] * np.sin(angle)))
    assert 6.0 < seen_deg.max() < 7.0
    assert 2.2e4 < RADIUS_M * angle[seen_deg.argmax()] < 2.5e4  # a ridge of two kilometres
    for sun_deg, least, most in ((5.0, 1.0, 1.0), (9.0, 0.0, 0.4)):
        turned = sim.with_overrides({"sun.at.elevation_deg": sun_deg})
        sample = turned.frame(0, ["shadow", "range"])
        near = (sample["range"] > 0.0) & (sample["range"] < 500.0)
        share = sample["shadow"][near].mean()
        assert least <= share <= most
