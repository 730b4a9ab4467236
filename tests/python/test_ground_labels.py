"""Slope and roughness of the ground: exact planes, other filters, any camera."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st
from scipy import ndimage
from tests.python.test_terrain_frames import (
    LAT_DEG,
    LON_DEG,
    MOON_M,
    VIEWS,
    in_body_axes,
    moon,
    over,
)

import perilune
from perilune.bodies.rocks import rock_field

F64 = np.ndarray[Any, np.dtype[np.float64]]


def patch(path: Path, heights_m: F64, post_m: float) -> dict[str, Any]:
    """Terrain of a patch of heights about the site alone; rows are from north to south."""
    np.save(path, heights_m)
    place = {"kind": "orthographic", "center_lon_lat_deg": [LON_DEG, LAT_DEG], "post_m": post_m}
    return {"elevation": [{"file": str(path), "projection": place}], "detail": None}


def axes() -> tuple[F64, F64, F64]:
    """East, north and up at the site, body axes."""
    lon, lat = np.radians([LON_DEG, LAT_DEG])
    up = np.array([np.cos(lat) * np.cos(lon), np.cos(lat) * np.sin(lon), np.sin(lat)])
    east = np.array([-np.sin(lon), np.cos(lon), 0.0])
    return east, np.cross(up, east), up


@pytest.mark.parametrize("off_nadir_deg", [0.0, 55.0])
def test_a_plane_has_its_slope_from_any_side(off_nadir_deg: float, tmp_path: Path) -> None:
    """Sobel gradients over the true distances of points are exact on a plane."""
    x = np.linspace(-2000.0, 2000.0, 101)
    terrain = patch(tmp_path / "plane.npy", 0.25 * x[None, :] - 0.1 * x[:, None], 40.0)
    sim = moon(terrain, {"trajectory": over(300.0, off_nadir_deg)})
    sample = sim.frame(0, ["slope_sobel", "roughness_laplacian", "range"])
    inner = (slice(1, -1), slice(1, -1))
    expected = np.arctan(np.hypot(0.25, 0.1))
    np.testing.assert_allclose(sample["slope_sobel"][inner], expected, atol=2e-4)
    # In perspective, elevations of a plane are not linear in pixels, most of all seen aslant.
    bent = sample["roughness_laplacian"][inner] / sample["range"][inner]
    assert bent.max() < (5e-5 if off_nadir_deg == 0.0 else 2e-3)


@pytest.mark.parametrize("view", VIEWS)
def test_filters_are_those_of_scipy(view: str) -> None:
    """Beside scipy's on the elevations and places of the pixels; nan beside the sky, at the edge,
    and nowhere else."""
    sim = moon({"detail": {"seed": 3}, "rocks": {"seed": 3}}, {"trajectory": VIEWS[view]})
    sample = sim.frame(0, ["position", "range", "slope_sobel", "roughness_laplacian"])
    points, seen = in_body_axes(sim, sample), sample["range"] > 0.0
    points[~seen] = 0.0
    height = np.linalg.norm(points, axis=-1) - MOON_M
    rough = np.abs(ndimage.laplace(height))
    cross = ndimage.generate_binary_structure(2, 1)
    inside = ndimage.binary_erosion(seen, cross)
    np.testing.assert_array_equal(np.isfinite(sample["roughness_laplacian"]), inside)
    np.testing.assert_allclose(sample["roughness_laplacian"][inside], rough[inside], rtol=1e-5,
                               atol=1e-7)  # fmt: skip
    whole = ndimage.binary_erosion(seen, np.ones((3, 3)))
    np.testing.assert_array_equal(np.isfinite(sample["slope_sobel"]), whole)
    up = points / np.maximum(np.linalg.norm(points, axis=-1, keepdims=True), 1.0)
    east = np.cross([0.0, 0.0, 1.0], up)
    east /= np.maximum(np.linalg.norm(east, axis=-1, keepdims=True), 1e-9)
    north = np.cross(up, east)
    changes = [
        [ndimage.sobel(v, axis) / 8.0 for v in (points[..., 0], points[..., 1], points[..., 2])]
        for axis in (1, 0)
    ]
    ground = np.array([[(np.stack(row, -1) * a).sum(-1) for a in (east, north)] for row in changes])
    rise = np.array([ndimage.sobel(height, axis) / 8.0 for axis in (1, 0)])
    rows = ground.transpose(2, 3, 0, 1)[whole], rise.transpose(1, 2, 0)[whole][..., None]
    steep = np.linalg.norm(np.linalg.solve(*rows)[..., 0], axis=-1)
    np.testing.assert_allclose(sample["slope_sobel"][whole], np.arctan(steep), atol=1e-5)


ROUGH = {"detail": {"seed": 3}, "craters": {"seed": 5, "min_diameter_m": 2.0}}


def test_cones_have_their_slope_and_roughness(tmp_path: Path) -> None:
    """On the flank a plane; about the apex, heights s r over a disc of radius R have a variance of
    s^2 R^2 / 18 and no slope."""
    x = np.linspace(-200.0, 200.0, 401)
    steep, flank_m = 0.5, 60.0
    terrain = patch(tmp_path / "cone.npy", -steep * np.hypot(x[None, :], x[:, None]), 1.0)
    ground = moon(terrain, {"trajectory": over(300.0)}).terrain(0)
    east, _, up = axes()
    places = np.stack([up, up + flank_m / MOON_M * east])
    for baseline_m in (20.0, 50.0):
        (at_apex, rough), (on_flank, _) = ground.planes(places, baseline_m, 256)
        assert at_apex < 0.02
        assert rough == pytest.approx(steep * 0.5 * baseline_m / np.sqrt(18.0), rel=0.03)
        # A flank is curved across: its heights' mean gradient over the disc, to second order.
        bent = (0.5 * baseline_m / flank_m) ** 2 / 12.0
        assert np.tan(on_flank) == pytest.approx(steep * (1.0 - bent), rel=0.005)


def test_waves_have_their_slope_and_roughness(tmp_path: Path) -> None:
    """Far below a wave: its slope; heights c x^2 / 2 over a disc have an RMS of |c| R^2 / 8."""
    x = np.arange(-250.0, 250.5, 0.5)
    amplitude, k = 2.0, 2.0 * np.pi / 100.0
    waves = np.broadcast_to(amplitude * np.sin(k * x), (len(x), len(x)))
    terrain = patch(tmp_path / "waves.npy", waves.copy(), 0.5)
    terrain["elevation"][0]["interpolation"] = "cubic"
    ground = moon(terrain, {"trajectory": over(300.0)}).terrain(0)
    east, north, up = axes()
    shifts = np.random.default_rng(7).uniform(-100.0, 100.0, (40, 2))
    places = up + (shifts / MOON_M) @ np.stack([east, north])
    found = ground.planes(places, 8.0, 128)
    slopes = np.abs(amplitude * k * np.cos(k * shifts[:, 0]))
    np.testing.assert_allclose(np.tan(found[:, 0]), slopes, atol=0.002)
    bent = np.abs(amplitude * k * k * np.sin(k * shifts[:, 0])) * 4.0**2 / 8.0
    np.testing.assert_allclose(found[:, 1], bent, atol=5e-4)


@pytest.mark.parametrize("baseline_m", [1.0, 30.0])
def test_planes_are_those_of_least_squares(baseline_m: float) -> None:
    """Beside numpy's through the heights of a square lattice in the same disc."""
    ground = moon(ROUGH, {"trajectory": over(300.0)}).terrain(0)
    east, north, up = axes()
    rng = np.random.default_rng(11)
    places = up + (rng.uniform(-300.0, 300.0, (12, 2)) / MOON_M) @ np.stack([east, north])
    found = ground.planes(places, baseline_m, 256)
    lattice = np.stack(np.meshgrid(*2 * [np.linspace(-0.5, 0.5, 37)]), axis=-1).reshape(-1, 2)
    xy = baseline_m * lattice[np.hypot(*lattice.T) < 0.5]
    for place, (slope, rough) in zip(places, found, strict=True):
        up_here = place / np.linalg.norm(place)
        a = np.cross(up_here, [0.3, 0.2, 0.9])
        a /= np.linalg.norm(a)
        ways = up_here + (xy / MOON_M) @ np.stack([a, np.cross(up_here, a)])
        heights = ground.heights(ways, baseline_m / 8.0)
        design = np.concatenate([xy, np.ones((len(xy), 1))], axis=1)
        plane, rest, *_ = np.linalg.lstsq(design, heights, rcond=None)
        assert np.hypot(*plane[:2]) == pytest.approx(np.tan(slope), abs=0.004)
        assert np.sqrt(rest[0] / len(xy)) == pytest.approx(rough, rel=0.05)


@settings(max_examples=6, deadline=None)
@given(
    height_m=st.floats(2.0, 5e3),
    off_nadir_deg=st.floats(0.0, 80.0),
    cells=st.sampled_from([0.25, 1.0, 2.0]),
)
def test_baselines_know_no_camera(height_m: float, off_nadir_deg: float, cells: float) -> None:
    """From any camera and with any mesh, the numbers are those of the place."""
    terrain = ROUGH | {"cells_per_pixel": cells}
    camera = {"trajectory": over(height_m, off_nadir_deg), "width": 24, "height": 16}
    sim = moon(terrain, camera, labels={"ground": {"baseline_m": [2.0, 20.0], "points": 16}})
    sample = sim.frame(0, ["position", "range", "slope_baseline", "rms_height"])
    seen = sample["range"] > 0.0
    places = in_body_axes(sim, sample)[seen]
    assert sample["slope_baseline"].shape == (16, 24, 2)
    for k, baseline_m in enumerate((2.0, 20.0)):
        expected = sim.terrain(0).planes(places, baseline_m, 16)
        np.testing.assert_allclose(sample["slope_baseline"][seen, k], expected[:, 0], atol=1e-5)
        np.testing.assert_allclose(sample["rms_height"][seen, k], expected[:, 1], rtol=1e-3)
    assert np.isnan(sample["slope_baseline"][~seen]).all()
    assert np.isnan(sample["rms_height"][~seen]).all()


LIMITS = {"footprint_m": 6.0, "max_slope_deg": 9.0, "max_roughness_m": 0.09,
          "max_rock_height_m": 0.25}  # fmt: skip


def hazards_of(sim: perilune.Simulation, places: F64, points: int = 32) -> F64:
    """Bits at places (n, 3) in body axes, rock by rock."""
    limits, moon_terrain = sim.config.labels.ground.hazard, sim.config.bodies["moon"].terrain
    ways = places / np.linalg.norm(places, axis=1, keepdims=True)
    planes = sim.terrain(0).planes(ways, limits.footprint_m, points)
    bits = np.where(planes[:, 0] > np.radians(limits.max_slope_deg), 1, 0)
    bits += np.where(planes[:, 1] > limits.max_roughness_m, 2, 0)
    assert moon_terrain is not None
    assert moon_terrain.rocks is not None
    field = rock_field(moon_terrain.rocks, MOON_M)
    middle = ways.mean(axis=0)
    middle /= np.linalg.norm(middle)
    far_m = MOON_M * np.linalg.norm(ways - middle, axis=1).max() + 30.0
    rocks = field.list(sim.terrain(0), middle, far_m, 0.115)
    near = np.zeros(len(ways), dtype=bool)
    for rock in rocks[rocks["height_m"] > limits.max_rock_height_m]:
        away_m = MOON_M * np.linalg.norm(ways - rock["direction"], axis=1)
        near |= away_m < 0.5 * (limits.footprint_m + rock["diameter_m"])
    return bits + np.where(near, 4, 0)


@pytest.mark.parametrize(("height_m", "off_nadir_deg"), [(60.0, 20.0), (2.0, 70.0), (150.0, 0.0)])
def test_hazards_are_those_of_planes_and_rocks(height_m: float, off_nadir_deg: float) -> None:
    """Beside the same rule, rock by rock; off the ground nothing is known."""
    terrain = ROUGH | {"rocks": {"seed": 3, "min_diameter_m": 0.1}}
    camera = {"trajectory": over(height_m, off_nadir_deg), "width": 40, "height": 30}
    sim = moon(terrain, camera, labels={"ground": {"hazard": LIMITS}})
    sample = sim.frame(0, ["hazard", "position", "range"])
    seen = (sample["range"] > 0.0) & (sample["range"] < 300.0 + height_m)
    found = sample["hazard"][seen]
    np.testing.assert_array_equal(found, hazards_of(sim, in_body_axes(sim, sample)[seen]))
    assert (sample["hazard"][~(sample["range"] > 0.0)] == 128).all()
    for bit in (1, 2, 4):
        assert 0.002 < ((found & bit) > 0).mean() < 1.0 or height_m < 10.0


def test_a_rock_is_a_hazard_within_half_a_footprint_of_it() -> None:
    """On a plain: a disc, as wide as rock and footprint together; lower rocks are none."""
    rocks = {"law": "power", "coefficient": 8e-3, "exponent": -3.0, "min_diameter_m": 1.0,
             "max_diameter_m": 2.5, "seed": 1}  # fmt: skip
    camera = {"trajectory": over(60.0), "width": 96, "height": 96}
    counts = []
    for limit_m in (0.2, 0.9):
        limits = LIMITS | {"max_rock_height_m": limit_m, "footprint_m": 4.0}
        sim = moon(
            {"detail": {"strength": 1e-4}, "rocks": rocks},
            camera,
            labels={"ground": {"hazard": limits}},
        )
        sample = sim.frame(0, ["hazard", "position"])
        np.testing.assert_array_equal(np.unique(sample["hazard"]), [0, 4])
        places = in_body_axes(sim, sample).reshape(-1, 3)
        field = rock_field(sim.config.bodies["moon"].terrain.rocks, MOON_M)  # type: ignore
        found = field.list(sim.terrain(0), axes()[2], 20.0, 0.5)
        high = found[found["height_m"] > limit_m]
        apart = MOON_M * np.linalg.norm(high["direction"][:, None] - high["direction"], axis=2)
        isolated = high[(apart + 99.0 * np.eye(len(high)) > 9.0).all(axis=1)]
        assert len(isolated) >= 1
        pixel_m2 = (60.0 * 2.0 * np.tan(np.radians(25.0)) / 96) ** 2
        for rock in isolated:
            away_m = np.linalg.norm(places - rock["center"], axis=1)
            area_m2 = (sample["hazard"].ravel()[away_m < 4.5] == 4).sum() * pixel_m2
            assert area_m2 == pytest.approx(np.pi / 4 * (4.0 + rock["diameter_m"]) ** 2, rel=0.15)
        counts.append((sample["hazard"] == 4).sum())
    assert counts[0] > 1.5 * counts[1]


def test_threads_do_not_matter() -> None:
    ground = {"baseline_m": 40, "hazard": LIMITS}
    terrain = ROUGH | {"rocks": {"seed": 3}}
    sim = moon(terrain, {"trajectory": over(50.0, 30.0)}, labels={"ground": ground})
    names = ["slope_sobel", "roughness_laplacian", "slope_baseline", "rms_height", "hazard"]
    one, three = (sim.frame(0, names, threads=n) for n in (1, 3))
    for name in names:
        np.testing.assert_array_equal(one[name], three[name])


def test_spacecraft_are_not_ground(repo_dir: Path) -> None:
    """Beside their outlines there are no gradients, either; smooth bodies are flat."""
    craft = {
        "model": str(repo_dir / "assets/models/smallsat.glb"),
        "size_m": 200.0,
        "orbit": {"kind": "surface", "around": "moon", "lon_deg": LON_DEG, "lat_deg": LAT_DEG,
                  "heading_deg": 0.0},
    }  # fmt: skip
    sim = moon({}, {"trajectory": over(600.0)}, spacecraft={"sat": craft})
    sample: perilune.Sample = sim.frame(0, ["instance", "slope_sobel", "slope_baseline"])
    ground = sample["instance"] == 1
    assert 0.2 < ground.mean() < 0.995
    whole = ndimage.binary_erosion(ground, np.ones((3, 3)))
    np.testing.assert_array_equal(np.isfinite(sample["slope_sobel"]), whole)
    np.testing.assert_array_equal(np.isfinite(sample["slope_baseline"][..., 0]), ground)


def test_smooth_bodies_are_flat_and_have_no_baselines() -> None:
    keys = ("kind", "target", "lon_deg", "lat_deg", "height_m")
    camera = {"trajectory": {key: over(100e3)[key] for key in keys}}
    bodies = {"moon": {"kind": "moon", "albedo": 0.3}}
    names = ["slope_sobel", "roughness_laplacian", "slope_baseline", "hazard"]
    sample = moon({}, camera, bodies=bodies).frame(0, names)
    assert np.nanmax(sample["slope_sobel"]) == np.nanmax(sample["roughness_laplacian"]) == 0.0
    assert np.isnan(sample["slope_baseline"]).all()
    assert (sample["hazard"] == 128).all()
