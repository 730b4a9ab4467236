"""The section `terrain` of a body: what it accepts, and what stands over its ground."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

import perilune
from perilune.base import rotations
from perilune.config import ConfigError
from perilune.config.errors import ConfigWarning
from perilune.config.terrain import Detail, Terrain
from perilune.document.loader import read_tree
from perilune.frame import passes, terrains

MOON_M = 1737.4e3
PLACE = {"kind": "cylindrical", "west_deg": -180.0}
HOVER = {"kind": "hover", "target": "moon", "lon_deg": 12.0, "lat_deg": 34.0, "height_m": 5.0}


@pytest.fixture
def heights(tmp_path: Path) -> Path:
    """A cone of 8 km about longitude 12, latitude 34, on posts of 1 degree."""
    lon, lat = np.meshgrid(np.arange(-179.5, 180.0), np.arange(89.5, -90.0, -1.0))
    away = np.hypot((lon - 12.0) * np.cos(np.radians(lat)), lat - 34.0)
    np.save(tmp_path / "cone.npy", np.maximum(8000.0 - 400.0 * away, -500.0).astype(np.float32))
    return tmp_path / "cone.npy"


@pytest.fixture
def scene(repo_dir, heights):
    tree = read_tree(repo_dir / "tests/python/scene.yaml")
    row = {"file": str(heights), "projection": PLACE}
    terrain = {"elevation": [row], "detail": {"seed": 5}}
    tree["bodies"], tree["root"] = {"moon": {"kind": "moon", "terrain": terrain}}, "moon"
    tree["spacecraft"]["sat"]["orbit"] = {"around": "moon", "kind": "surface", "lon_deg": 20.0,
                                          "lat_deg": 30.0}  # fmt: skip
    del tree["spacecraft"]["sat"]["attitude"]
    tree["camera"]["trajectory"] = dict(HOVER)
    return tree


def opened(scene, repo_dir, **options):
    return perilune.open(scene, base=repo_dir / "tests/python", **options)


def refused(scene, repo_dir, text):
    with pytest.raises((ConfigError, ValueError), match=text):
        opened(scene, repo_dir).camera_poses(0)


# -- what is accepted ------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("keys", "text"),
    [
        ({"detail": None}, "null: without elevation or craters there is then no ground"),
        ({"cells_per_pixel": 0.0}, "cells_per_pixel"),
        ({"finest_cell_m": 0.0}, "finest_cell_m"),
        ({"roughness_baseline_m": -1.0}, "roughness_baseline_m"),
        ({"detail": {"hurst": 0.5, "ranges": [{"from_m": 0.0, "hurst": 0.9}]}},
         "give only one of hurst, ranges"),
        ({"detail": {"ranges": [{"from_m": 1.0, "hurst": 0.9}]}}, "must be 0"),
        ({"detail": {"ranges": [{"from_m": 0.0, "hurst": 0.9}] * 2}}, "must be above that before"),
        ({"detail": {"hurst": 1.1}}, "hurst"),
        ({"detail": {"deviation_m": 1.0}}, "baseline_m and deviation_m go together"),
        ({"detail": {"longest_m": 1.0, "finest_m": 2.0}}, "must not be above longest_m, 1"),
        ({"detail": {"seed": 2**64}}, "seed"),
    ],
)  # fmt: skip
def test_what_makes_no_sense_is_refused(keys, text):
    with pytest.raises(ValueError, match=text):
        Terrain.model_validate(keys)


@pytest.mark.parametrize("seed", [0, 2**64 - 1])
@pytest.mark.parametrize("hurst", [0.0, 1.0])
def test_extreme_details_are_accepted(scene, repo_dir, seed, hurst):
    scene["bodies"]["moon"]["terrain"]["detail"] = {"seed": seed, "hurst": hurst}
    assert opened(scene, repo_dir).camera_poses(0).shape == (2, 7)


@pytest.mark.parametrize(
    ("key", "value"), [("shape", "ball.obj"), ("relief", {"normal_map": "map.png"})]
)
def test_a_ground_is_one_thing(scene, repo_dir, key, value):
    scene["bodies"]["moon"][key] = value
    refused(scene, repo_dir, f"bodies.moon.terrain: not with {key}")


def test_faults_of_files_name_their_key(scene, repo_dir):
    row = scene["bodies"]["moon"]["terrain"]["elevation"][0]
    del row["projection"]
    refused(
        scene, repo_dir, r"^configuration:\n  bodies\.moon\.terrain\.elevation\[0\]\.projection"
    )
    row["file"] = "none.npy"
    with pytest.raises(FileNotFoundError, match=r"moon\.terrain\.elevation\[0\]\.file: no such"):
        opened(scene, repo_dir)


# -- what stands on it -----------------------------------------------------------------------------


def height_m(sim, point, index=0):
    """Over the datum, of a point of the root frame."""
    world = sim.world(index)
    return float(np.linalg.norm(world.body_axes("moon", point - world.position_m("moon")))) - MOON_M


def test_cameras_count_from_the_ground_or_from_the_datum(scene, repo_dir):
    scene["bodies"]["moon"]["terrain"]["detail"] = None
    on_ground = opened(scene, repo_dir).camera_poses(0)[0, :3]
    sim = opened(scene, repo_dir, overrides={"camera.trajectory.altitude_above": "datum",
                                             "camera.trajectory.height_m": 9000.0})  # fmt: skip
    over_datum = sim.camera_poses(0)[0, :3]
    assert height_m(sim, over_datum) == pytest.approx(9000.0, abs=1e-6)
    assert 7600.0 < height_m(sim, on_ground) < 8000.0  # the cone's tip lies between posts
    assert sim.world(0).ground("moon").height_m(
        sim.world(0).body_axes("moon", on_ground)
    ) == pytest.approx(5.0, abs=1e-6)


def test_a_camera_under_the_ground_is_told_how_far(scene, repo_dir):
    scene["camera"]["trajectory"] |= {"altitude_above": "datum", "height_m": 3000.0}
    refused(scene, repo_dir, r"frame 0: the camera is \d{4} m below the ground of moon")


def test_an_orbit_under_the_ground_is_refused(scene, repo_dir):
    scene["spacecraft"]["sat"]["orbit"] = {"around": "moon", "position_km": [1740.0, 0.0, 0.0]}
    sim = opened(scene, repo_dir)
    assert sim.world(0).inside(sim.world(0).position_m("sat")) is None
    scene["spacecraft"]["sat"]["orbit"]["position_km"] = [1730.0, 0.0, 0.0]
    refused(scene, repo_dir, r"spacecraft\.sat\.orbit: at .* below the ground of moon")


def test_low_orbits_over_low_ground_are_not_refused(scene, repo_dir):
    """Away from the cone the ground is 500 m below the datum."""
    low = {"around": "moon", "kind": "kepler", "position_km": [0.0, -1737.2, 0.0]}
    scene["spacecraft"]["sat"]["orbit"] = low
    scene["bodies"]["moon"] |= {"rotation": {}}
    opened(scene, repo_dir).system(0).states(np.zeros(1))


def test_a_craft_stands_on_the_slope_of_the_cone(scene, repo_dir):
    """400 m a degree of 30 323 m: 0.76 degrees."""
    scene["bodies"]["moon"]["terrain"]["detail"] = None
    scene["spacecraft"]["sat"]["orbit"] |= {"lon_deg": 12.5, "lat_deg": 27.1}
    sim = opened(scene, repo_dir)
    states = sim.system(0).states(np.zeros(1)).poses
    own = rotations.rotate(rotations.conjugate(states["moon"][0, 3:]), states["sat"][0, :3])
    up = own / np.linalg.norm(own)
    turn = rotations.multiply(rotations.conjugate(states["moon"][0, 3:]), states["sat"][0, 3:])
    tilt = math.acos(float(rotations.to_matrix(turn)[:, 2] @ up))
    assert math.tan(tilt) == pytest.approx(400.0 / (math.radians(1.0) * MOON_M), rel=0.02)


def test_the_way_to_the_sun_is_marched(scene, repo_dir):
    """Beside the cone, seen from 20 degrees off its axis at heights over and below the tip."""
    scene["bodies"]["moon"]["terrain"]["detail"] = None
    ground = opened(scene, repo_dir).world(0).ground("moon")
    tip = np.array([math.cos(math.radians(34.0)) * math.cos(math.radians(12.0)),
                    math.cos(math.radians(34.0)) * math.sin(math.radians(12.0)),
                    math.sin(math.radians(34.0))])  # fmt: skip
    side = np.cross(tip, [0.0, 0.0, 1.0])
    side /= np.linalg.norm(side)
    for over_m, hit in ((9000.0, False), (6000.0, True)):
        start = tip * (MOON_M + over_m) + 3e5 * side
        found = ground.hit_m(start, -side)
        assert (found is not None) == hit
        if found is not None:
            assert ground.height_m(start - found * side) == pytest.approx(0.0, abs=1e-3)
            assert found < 3e5
    assert ground.hit_m(tip * MOON_M, tip) == 0.0
    down = ground.hit_m(tip * (MOON_M + 1e5), -tip)
    assert down == pytest.approx(1e5 - ground.height_m(tip * MOON_M) * -1.0, abs=1e-3)
    assert ground.hit_m(tip * (MOON_M + 1e5), tip) is None


# -- what is kept ----------------------------------------------------------------------------------


def test_rasters_are_read_once(scene, repo_dir, monkeypatch):
    read = []
    own = terrains.read_elevation
    monkeypatch.setattr(
        terrains, "read_elevation", lambda *args: (read.append(args[1]), own(*args))[1]
    )
    sim = opened(scene, repo_dir)
    for index in range(3):
        sim.camera_poses(index)
    for k, strength in enumerate((0.5, 2.0)):
        other = sim.with_overrides({"bodies.moon.terrain.detail.strength": strength})
        assert (other.camera_poses(0) != sim.camera_poses(0)).any()
        assert len(read) == 1, k


def test_craters_are_in_the_ground(scene, repo_dir):
    terrain = scene["bodies"]["moon"]["terrain"]
    terrain["craters"] = {"law": "power", "coefficient": 0.05, "exponent": -2.0, "seed": 3}
    sim = opened(scene, repo_dir)
    found = [sim] + [
        sim.with_overrides({f"bodies.moon.terrain.craters{key}": value})
        for key, value in ((".seed", 4), (".density", 0.0), ("", None))
    ]
    heights = [height_m(other, other.camera_poses(0)[0, :3]) for other in found]
    assert len(set(heights[:3])) == 3
    assert heights[2] == pytest.approx(heights[3], abs=1e-9)  # a density of 0 is none


def test_rocks_are_on_the_ground(scene, repo_dir):
    """They change what is seen, not heights; a density of 0 is none, and a driver draws it."""
    scene["render"] = {"samples": 1, "channels": ["depth"]}
    scene["camera"] |= {"width": 48, "height": 48, "fov_deg": 90.0}
    scene["bodies"]["moon"]["terrain"]["rocks"] = {"law": "haworth", "density": 3.0, "seed": 3}
    sim = opened(scene, repo_dir)
    without = sim.with_overrides({"bodies.moon.terrain.rocks": None})
    none = sim.with_overrides({"bodies.moon.terrain.rocks.density": 0.0})
    drawn = sim.with_overrides({"bodies.moon.terrain.rocks.density": {"uniform": [1.0, 5.0]}})
    depths = [each.frame(0, threads=1)["depth"] for each in (sim, without, none, drawn)]
    poses = [each.camera_poses(0) for each in (sim, without)]
    np.testing.assert_array_equal(poses[0], poses[1])
    np.testing.assert_array_equal(depths[1], depths[2])
    nearer = depths[1] - depths[0]
    assert (nearer > 0.02).any()
    assert nearer.min() > -1e-3
    assert (depths[3] != depths[0]).any()


def test_a_driver_draws_the_roughness(scene, repo_dir):
    scene["bodies"]["moon"]["terrain"]["detail"]["strength"] = {"uniform": [0.1, 3.0]}
    sim = opened(scene, repo_dir)
    heights = [height_m(sim, sim.camera_poses(k)[0, :3], k) for k in range(4)]
    assert len({round(value, 6) for value in heights}) == 4
    again = opened(scene, repo_dir)
    assert [height_m(again, again.camera_poses(k)[0, :3], k) for k in (3, 0)] == [
        heights[3],
        heights[0],
    ]


def test_defaults_are_those_of_the_core():
    assert Terrain().detail == Detail()
    assert Terrain().cells_per_pixel == 1.0


def test_a_frame_is_of_the_ground(scene, repo_dir):
    """Depth down to the ground beneath is the camera's height over it."""
    scene["render"] = {"samples": 1, "channels": ["depth"]}
    scene["camera"] |= {"width": 9, "height": 9, "fov_deg": 1.0}
    scene["camera"]["trajectory"]["height_m"] = 3000.0
    sim = opened(scene, repo_dir)
    depth = sim.frame(0, threads=1)["depth"]
    assert depth[4, 4] == pytest.approx(3000.0, abs=2.0)
    scene["bodies"]["moon"]["terrain"]["finest_cell_m"] = 2e4
    assert (opened(scene, repo_dir).frame(0, threads=1)["depth"] != depth).any()


def test_a_view_beyond_the_limit_of_tiles_names_the_body(scene, repo_dir, monkeypatch):
    """tests/c/test_height_field.c has what the core reports."""
    scene["render"] = {"samples": 1, "channels": ["depth"]}
    scene["camera"] |= {"width": 9, "height": 9}
    sim = opened(scene, repo_dir)
    render = passes.render

    def limited(*given):
        result = render(*given)
        assert result["ground"]["widened_body"] is None
        return result | {"ground": result["ground"] | {"widened": 1.5, "widened_body": "moon"}}

    monkeypatch.setattr(passes, "render", limited)
    with pytest.warns(ConfigWarning, match=r"bodies\.moon\.terrain: .* 1\.5 times"):
        sim.frame(0, threads=1)
