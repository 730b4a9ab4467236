"""Frames of terrain: points beside the heights, shadows beside exact outlines, the same bits
however a frame is made."""

from __future__ import annotations

import math
import re
from typing import Any

import numpy as np
import pytest

import perilune
from perilune import _core
from perilune.base import rotations
from perilune.frame import shutter

MOON_M = 1737.4e3
LON_DEG, LAT_DEG = 20.0, 10.0
SEED = 3


def moon(terrain: dict[str, Any], camera: dict[str, Any], **more: Any) -> perilune.Simulation:
    """A Moon of grey Lambert ground under a camera 64 pixels wide."""
    size = {"width": 64, "height": 48, "fov_deg": 50.0, "exposure": {"mode": "auto"}}
    tree = {
        "version": 1,
        "time": {"epoch": "2026-03-03T06:00:00Z"},
        "root": "moon",
        "sun": {"at": {"lon_deg": LON_DEG, "lat_deg": LAT_DEG, "azimuth_deg": 90.0,
                       "elevation_deg": 30.0}},
        "bodies": {"moon": {"kind": "moon", "albedo": 0.3, "terrain": terrain}},
        "camera": size | camera,
        "render": {"samples": 4, "max_bounces": 1},
    } | more  # fmt: skip
    return perilune.open(tree)


def over(height_m: float, off_nadir_deg: float = 0.0) -> dict[str, Any]:
    """A trajectory over the site."""
    return {"kind": "hover", "target": "moon", "lon_deg": LON_DEG, "lat_deg": LAT_DEG,
            "height_m": height_m, "altitude_above": "terrain", "off_nadir_deg": off_nadir_deg,
            "clearance_m": None}  # fmt: skip


def in_body_axes(sim: perilune.Simulation, sample: perilune.Sample) -> np.ndarray:
    """(H, W, 3) points that are seen, body axes, m; nan where there is sky."""
    pose = shutter.middle(sim.world(0)).poses["moon"][0]
    axes = rotations.to_matrix(pose[3:])
    return (sample["position"] - pose[:3]) @ axes


VIEWS = {
    "orbit": over(200e3),
    "limb": over(100e3, 75.0),
    "lander": over(500.0, 40.0),
    "rover": over(1.5, 80.0),
}


@pytest.mark.parametrize("view", VIEWS)
def test_points_lie_on_the_heights(view):
    """Cells are up to 1.4 pixels wide (2.8 near the horizon): what a mesh of them leaves out of a
    ground with slopes of some degrees is a small part of a cell."""
    sim = moon({"detail": {"seed": SEED}}, {"trajectory": VIEWS[view]})
    sample = sim.frame(0, ["position", "range", "elevation"])
    points, seen = in_body_axes(sim, sample), sample["range"] > 0.0
    assert seen.mean() > (0.3 if view in ("limb", "rover") else 0.99)
    away = np.linalg.norm(points[seen], axis=1)
    terrain = _core.Terrain(np.full(3, MOON_M), [], {"seed": SEED})
    heights = terrain.heights(points[seen] / away[:, None])
    np.testing.assert_allclose(sample["elevation"][seen], away - MOON_M, atol=0.02)
    pixel_m = sample["range"][seen] * math.radians(50.0) / 64
    off = np.abs(away - MOON_M - heights) / np.maximum(pixel_m, 0.01)
    assert np.median(off) < 0.1
    assert np.percentile(off, 99.0) < 0.6
    assert off.max() < 2.0


@pytest.mark.parametrize("method", ["noise", "diamond_square"])
def test_the_same_bits_for_any_threads_and_whatever_is_kept(method, tmp_path):
    trajectory = over(300.0, 60.0) | {"lon_deg": {"uniform": [19.9, 20.1]}}
    np.save(tmp_path / "z.npy", np.random.default_rng(1).normal(0.0, 300.0, (180, 360)))
    model = {"file": str(tmp_path / "z.npy"), "projection": {"kind": "cylindrical", "west_deg": 0}}
    ground = {"detail": {"method": method, "seed": SEED}}
    ground |= {"elevation": [model]} if method == "diamond_square" else {}
    sim = moon(ground, {"trajectory": trajectory}, time={
        "epoch": "2026-03-03T06:00:00Z", "step_s": 1.0})  # fmt: skip
    channels = ["radiance", "depth", "normal", "slope"]
    kept = [sim.frame(k, channels, threads=1) for k in (2, 0, 1)][2]
    fresh = sim.with_overrides({}).frame(1, channels, threads=2)
    for name in channels:
        np.testing.assert_array_equal(kept[name], fresh[name])


def test_ground_without_heights_is_the_ellipsoid():
    camera = {"trajectory": over(200e3) | {"altitude_above": "datum"}}
    quiet = {"samples": 4, "max_bounces": 1, "force_off": ["soft_sun"]}
    flat = moon({"detail": {"strength": 0.0}}, camera, render=quiet)
    left_out = quiet | {"force_off": ["soft_sun", "terrain"]}
    smooth = moon({"detail": {"seed": SEED}}, camera, render=left_out)
    a, b = (sim.frame(0, ["radiance", "depth", "instance"]) for sim in (flat, smooth))
    np.testing.assert_array_equal(a["instance"], b["instance"])
    np.testing.assert_allclose(a["radiance"], b["radiance"], rtol=0.01)
    np.testing.assert_allclose(a["depth"], b["depth"], rtol=1e-4)
    assert not next(row["on"] for row in b.plan if row["name"] == "terrain")


def test_a_camera_below_the_ground_is_told_by_how_much():
    lon, lat = math.radians(LON_DEG), math.radians(LAT_DEG)
    up = np.array([math.cos(lat) * math.cos(lon), math.cos(lat) * math.sin(lon), math.sin(lat)])

    def height_m(seed: int) -> float:
        return float(_core.Terrain(np.full(3, MOON_M), [], {"seed": seed}).heights(up[None])[0])

    seed = next(k for k in range(20) if height_m(k) > 10.0)
    low = over(1.0) | {"altitude_above": "datum"}
    with pytest.raises(ValueError, match="ground") as caught:
        moon({"detail": {"seed": seed}}, {"trajectory": low}).frame(0, ["depth"])
    told = [float(x) for x in re.findall(r"[0-9]+\.?[0-9]*(?:e[+-]?[0-9]+)?", str(caught.value))]
    assert any(abs(x - (height_m(seed) - 1.0)) < 1e-3 * height_m(seed) for x in told)


@pytest.fixture(scope="module")
def cone(tmp_path_factory):
    """A cone 60 m high and 200 m wide on a plane, posts of 2 m."""
    x, y = np.meshgrid(np.arange(-400, 401) * 2.0, np.arange(400, -401, -1) * 2.0)
    path = tmp_path_factory.mktemp("cone") / "cone.npy"
    np.save(path, np.maximum(60.0 - 0.6 * np.hypot(x, y), 0.0).astype(np.float32))
    return path


def test_far_casters_are_fine_where_their_shadows_are_seen(cone):
    """Beside the cone, which is outside of the frame: its shadow is as exact as if it were seen,
    and that of a cone of wide cells is not."""
    away = math.degrees(1500.0 / (MOON_M * math.cos(math.radians(LAT_DEG))))
    place = {"kind": "orthographic", "center_lon_lat_deg": [LON_DEG, LAT_DEG], "post_m": 2.0}
    terrain = {"elevation": [{"file": str(cone), "projection": place}], "detail": None}
    sun = {"at": {"lon_deg": LON_DEG, "lat_deg": LAT_DEG, "azimuth_deg": 90.0,
                  "elevation_deg": 2.0}}  # fmt: skip
    camera = {"trajectory": over(300.0) | {"lon_deg": LON_DEG - away}, "fov_deg": 15.0}
    dark = {}
    for off in ((), ("far_casters",)):
        hard = {"samples": 1, "max_bounces": 0,
                "force_off": ["soft_sun", "antialiasing", *off]}  # fmt: skip
        sample = moon(terrain, camera, sun=sun, render=hard).frame(0, ["radiance"])
        dark[off] = sample["radiance"][..., 1] == 0.0
    exact = moon(terrain | {"cells_per_pixel": 8.0}, camera, sun=sun,
                 render={"samples": 1, "max_bounces": 0,
                         "force_off": ["soft_sun", "antialiasing"]})  # fmt: skip
    true = exact.frame(0, ["radiance"])["radiance"][..., 1] == 0.0
    assert 0.05 < true.mean() < 0.95
    assert (dark[()] != true).mean() < 0.01
    assert (dark[("far_casters",)] != true).mean() > 3.0 * max((dark[()] != true).mean(), 0.003)


def test_rays_at_terrain_are_timed() -> None:
    """Beside raw Embree: one ray through each pixel, and one to the Sun from what is lit."""
    sim = moon({"detail": {"seed": SEED}}, {"trajectory": over(500.0)})
    rays = sim.measure_rays(0, 1)
    assert rays["primary"][0] == 64 * 48
    assert 0.5 * 64 * 48 < rays["shadow"][0] <= 64 * 48
    assert all(ours_s > 0.0 and raw_s > 0.0 for _, ours_s, raw_s in rays.values())


def test_rays_of_a_frame_are_cast_again() -> None:
    """Each pixel has a ray to its centre at least, nothing is kept for the next frame, and the
    frame has the same bits."""
    sim = moon({"detail": {"seed": SEED}}, {"trajectory": over(500.0)}, render={"samples": 2})
    before = sim.frame(0, ["rgb"])["rgb"].copy()
    rays = sim.measure_frame(0, 1)
    assert rays["closest"][0] >= 64 * 48
    assert rays["shadow"][0] >= 0.5 * 64 * 48
    assert all(ours_s > 0.0 and raw_s > 0.0 for _, ours_s, raw_s in rays.values())
    again = sim.measure_frame(0, 1)
    assert {kind: row[0] for kind, row in again.items()} == {
        kind: row[0] for kind, row in rays.items()
    }
    np.testing.assert_array_equal(sim.frame(0, ["rgb"])["rgb"], before)
