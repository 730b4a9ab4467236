"""The files in configs/oaisys: they render, and every pose is the one computed by hand.

Expected poses are computed here with NumPy from the numbers of the JSON files, as the paper and
OAISYS define them: a scene unit is 6.378e6 m, a circle (cos u, sin u, 0) is scaled and turned by
Euler angles x, y, z, u = 2 pi (orbit_start + v_step * step), a mesh turns about its own z axis by
rotation_deg_step_v a step.
"""

from __future__ import annotations

import json
import math
import warnings
from pathlib import Path

import numpy as np
import pytest

import perilune
from perilune.base import rotations

FOLDER = Path(__file__).resolve().parents[3] / "configs" / "oaisys"
NAMES = sorted(path.stem for path in FOLDER.glob("*.json"))
EARTH_M = 6.378e6
FRAMES = (0, 1, 7, 12)


def opened(name, **overrides):
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        return perilune.open(FOLDER / f"{name}.json", overrides=overrides)


def listing(name):
    """The file, and the parameters of its meshes by name."""
    raw = json.loads((FOLDER / f"{name}.json").read_text())
    return raw, {row["name"]: row for row in raw["ASSET_SETUP"]["MESHES"]}


def about(axis, degrees):
    """Rotation matrix about x, y or z."""
    c, s = math.cos(math.radians(degrees)), math.sin(math.radians(degrees))
    i, j = [(1, 2), (2, 0), (0, 1)]["xyz".index(axis)]
    found = np.eye(3)
    found[i, i] = found[j, j] = c
    found[i, j], found[j, i] = -s, s
    return found


def euler(degrees):
    return about("z", degrees[2]) @ about("y", degrees[1]) @ about("x", degrees[0])


def circle(params, step):
    """Place on the path of orbit_params of type circular."""
    turns = params["orbit_start"] + params["v_step"] * step
    u = 2.0 * math.pi * turns
    return euler(params["rotation_deg"]) @ (
        EARTH_M * np.array(params["scale"]) * [math.cos(u), math.sin(u), 0.0]
    )


def own_turn(params, step):
    return euler(params["rotation_deg"]) @ about("z", params["rotation_deg_step_v"] * step)


def matrix(pose):
    return rotations.to_matrix(pose[3:])


def camera(sim, index):
    return sim.request(index)["camera_pose"][0]


def assert_looks_at(pose, place):
    forward = matrix(pose)[:, 2]
    direction = (place - pose[:3]) / np.linalg.norm(place - pose[:3])
    assert forward == pytest.approx(direction, abs=1e-9)


def test_there_are_the_listings():
    assert set(NAMES) == {
        "planet", "satellite_database", "satellite_circular", "random_sampling", "spiral",
        "linear", "flyby", "custom",
    }  # fmt: skip


def test_the_numbers_are_those_of_the_paper():
    """Listings 1, 3, 4, 6 and 7; but for the paths of their files."""
    _, meshes = listing("planet")
    planet = meshes["planet"]["meshParams"]
    assert planet["rotation_deg"] == [23, 0, 0]
    assert (planet["rotation_deg_step_v"], planet["rotation_mode"]) == (0.1, "local")
    assert (planet["scale"], planet["position"]) == ([1.0] * 3, [0, 0, 0])
    _, meshes = listing("satellite_database")
    iss = meshes["iss"]["meshParams"]
    assert iss["scale"] == [0.0000169332079] * 3
    assert iss["orbit_params"] == {
        "type": "orbit_database", "orbit_type": "LEO", "parent": "planet", "v_step": 0.01,
        "orbit_start": 0.3,
    }  # fmt: skip
    _, meshes = listing("satellite_circular")
    assert meshes["iss"]["orbit_params"] == {
        "type": "circular", "parent": "planet", "scale": [1.06396989] * 3,
        "rotation_deg": [30.0, 30.0, 0.0], "v_step": 0.01, "orbit_start": 0.3,
    }  # fmt: skip
    raw, _ = listing("random_sampling")
    assert raw["SENSOR_SETUP"]["GENERAL"] == {
        "sensorMovementType": "orbit_object", "orbit_mesh": "iss",
    }  # fmt: skip
    raw, _ = listing("spiral")
    assert raw["SENSOR_SETUP"]["GENERAL"] == {
        "sensorMovementType": "approach_trajectory", "orbit_mesh": "sat", "orbit_radius": 0.01,
        "orbit_radius_noise": 0, "approach_moving_type": "spiral", "approach_moving_params": {
            "r_start": 0.01, "r_end": 0.0001, "plane": "xy", "rotations": 0.25},
    }  # fmt: skip


@pytest.mark.parametrize("name", NAMES)
def test_planets_turn_as_listed(name):
    sim, (_, meshes) = opened(name), listing(name)
    for index in FRAMES:
        pose = sim.world(index).poses["planet"][0]
        expected = own_turn(meshes["planet"]["meshParams"], index)
        assert pose[:3].tolist() == [0.0, 0.0, 0.0]
        assert matrix(pose) == pytest.approx(expected, abs=1e-12)
    assert sim.world(0).body_radii_m["planet"].tolist() == [EARTH_M] * 3


@pytest.mark.parametrize(
    ("name", "mesh"),
    [
        ("satellite_circular", "iss"),
        ("random_sampling", "iss"),
        ("spiral", "sat"),
        ("linear", "sat"),
        ("flyby", "sat"),
    ],
)
def test_satellites_are_where_the_listing_puts_them(name, mesh):
    sim, (_, meshes) = opened(name), listing(name)
    entry = meshes[mesh]
    params = entry["meshParams"]
    orbit = params.get("orbit_params") or entry["orbit_params"]
    for index in FRAMES:
        pose = sim.world(index).poses[mesh][0]
        expected = circle(orbit, index)
        assert np.linalg.norm(pose[:3] - expected) < 1e-9 * np.linalg.norm(expected)
        assert matrix(pose) == pytest.approx(own_turn(params, index), abs=1e-12)
    # 408 km over 6378 km, as the paper says.
    assert np.linalg.norm(sim.world(0).position_m(mesh)) == pytest.approx(6786e3, rel=1e-6)


def test_the_database_draws_a_circle_a_batch():
    """Within LEO's altitudes, 300 to 1600 km; 3.6 degrees a step from orbit_start on."""
    sim = opened("satellite_database")
    places = np.array([sim.world(index).position_m("iss") for index in range(10)])
    radii = np.linalg.norm(places, axis=1)
    for batch in (slice(0, 5), slice(5, 10)):
        assert np.ptp(radii[batch]) < 1e-6
        assert 6678e3 < radii[batch][0] < 7978e3
        units = places[batch] / radii[batch][:, None]
        steps = np.degrees(np.arccos(np.sum(units[1:] * units[:-1], axis=1)))
        assert steps == pytest.approx([3.6] * 4, abs=1e-6)
    assert abs(radii[0] - radii[5]) > 1.0


def test_a_stationary_orbit_is_over_the_equator_as_it_is_turned():
    """42164 km (Vallado, table 1-2: 42164.169), in the plane normal to the planet's own z axis."""
    raw, meshes = listing("satellite_database")
    meshes["iss"]["meshParams"]["orbit_params"] |= {"orbit_type": "GEO"}
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        sim = perilune.open(raw, base=FOLDER)
    pole = euler(meshes["planet"]["meshParams"]["rotation_deg"])[:, 2]
    places = [sim.world(index).position_m("iss") for index in range(3)]
    for place in places:
        assert np.linalg.norm(place) == pytest.approx(42164.17e3, rel=1e-5)
        assert abs(place @ pole) < 1e-6
    turn = math.degrees(math.acos(places[0] @ places[1] / (places[0] @ places[0])))
    assert turn == pytest.approx(3.6, abs=1e-6)


def test_the_custom_orbit_is_the_functions():
    """Listing 2: near the equator, 800 to 1200 km high; the same in every order."""
    sim = opened("custom")
    places = [sim.world(index).position_m("sat") for index in range(10)]
    for place in places:
        assert 7178e3 < np.linalg.norm(place) < 7578e3
        assert abs(math.degrees(math.asin(place[2] / np.linalg.norm(place)))) < 5.0
    again = opened("custom").world(7).position_m("sat")
    assert again.tolist() == places[7].tolist()
    assert np.linalg.norm(places[4]) != np.linalg.norm(places[5])
    for index in (0, 6):
        pose, place = camera(sim, index), places[index]
        assert pose[:3] == pytest.approx(place * (1.0 + 300.0 / np.linalg.norm(place)))
        assert_looks_at(pose, place)


def test_satellites_of_satellites():
    """The paper's figure 5: a spacecraft around a moon around a planet, in any order of entries."""
    raw, meshes = listing("satellite_circular")
    iss = meshes["iss"]
    moon = json.loads(json.dumps(iss))
    moon["name"] = "moon"
    moon["meshParams"] |= {"meshFilePath": "moon.blend", "meshInstanceName": "luna"}
    moon["meshParams"]["scale"] = [0.25] * 3
    moon["orbit_params"] |= {"scale": [3.0, 2.0, 3.0], "v_step": -0.02}
    iss["orbit_params"] |= {"parent": "luna", "scale": [0.5] * 3}
    raw["ASSET_SETUP"]["MESHES"] = [iss, moon, meshes["planet"]]
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        sim = perilune.open(raw, base=FOLDER)
    for index in FRAMES:
        world = sim.world(index)
        middle = circle(moon["orbit_params"], index)
        assert world.position_m("moon") == pytest.approx(middle, rel=1e-9, abs=1e-3)
        expected = middle + circle(iss["orbit_params"], index)
        assert world.position_m("iss") == pytest.approx(expected, rel=1e-9, abs=1e-3)
    assert sim.world(0).body_radii_m["moon"] == pytest.approx([0.25 * EARTH_M] * 3)


@pytest.mark.parametrize("name", ["random_sampling", "satellite_database", "satellite_circular"])
def test_random_positions_are_on_the_sphere(name):
    from perilune import _core

    sim = opened(name)
    mesh = _core.Model(str(FOLDER / "../../assets/models/station.glb")).mesh()
    reach = np.linalg.norm(mesh["positions"].astype(float), axis=1).max()
    radius = reach * 0.0000169332079 * EARTH_M
    expected = 0.002 * EARTH_M if name == "satellite_circular" else 3.0 * radius
    offsets = []
    for index in range(6):
        place = sim.world(index).position_m("iss")
        pose = camera(sim, index)
        assert np.linalg.norm(pose[:3] - place) == pytest.approx(expected, rel=1e-6)
        assert_looks_at(pose, place)
        offsets.append(pose[:3] - place)
    assert np.linalg.norm(np.ptp(offsets, axis=0)) > expected  # from all around


def test_the_planet_is_seen_from_around():
    sim = opened("planet")
    for index in range(6):
        pose = camera(sim, index)
        assert 2.5 * EARTH_M <= np.linalg.norm(pose[:3]) <= 3.5 * EARTH_M
        assert_looks_at(pose, np.zeros(3))


@pytest.mark.parametrize(("name", "first", "second"), [("spiral", 0, 1), ("flyby", 1, 0)])
def test_spirals(name, first, second):
    """Radius and angle grow evenly over the ten samples, in the listed plane."""
    sim, (raw, meshes) = opened(name), listing(name)
    params = raw["SENSOR_SETUP"]["GENERAL"]["approach_moving_params"]
    entry = meshes["sat"]
    orbit = entry["meshParams"]["orbit_params"]
    for index in range(10):
        share = index / 9.0
        radius = EARTH_M * (params["r_start"] + share * (params["r_end"] - params["r_start"]))
        angle = 2.0 * math.pi * params["rotations"] * share
        offset = np.zeros(3)
        offset[first], offset[second] = radius * math.cos(angle), radius * math.sin(angle)
        place = circle(orbit, index)
        pose = camera(sim, index)
        assert pose[:3] - place == pytest.approx(offset, abs=1e-8 * radius + 1e-6)
        assert_looks_at(pose, place)


def test_linear_slows_down():
    """Constant deceleration: the way after a share t of the time is (v0 t + (v1 - v0) t^2 / 2)."""
    sim, (raw, meshes) = opened("linear"), listing("linear")
    params = raw["SENSOR_SETUP"]["GENERAL"]["approach_moving_params"]
    start, end = (EARTH_M * np.array(params[key]) for key in ("start_pose", "end_pose"))
    v0, v1 = params["start_velocity"], params["end_velocity"]
    orbit = meshes["sat"]["meshParams"]["orbit_params"]
    for index in range(10):
        t = index / 9.0
        share = (v0 * t + 0.5 * (v1 - v0) * t * t) / (0.5 * (v0 + v1))
        place = circle(orbit, index)
        pose = camera(sim, index)
        assert pose[:3] - place == pytest.approx(start + share * (end - start), abs=1e-4)
        assert_looks_at(pose, place)


@pytest.mark.parametrize("name", NAMES)
def test_they_render_and_labels_have_the_poses(name):
    """640x480, K as listed: the poses of the labels are those of the world, in the camera's axes.

    The planet or the satellite fills some of the image, in every file.
    """
    sim = opened(name, **{"render.samples": 1})
    sample = sim.frame(2, channels=["rgb", "depth", "semantic", "instance", "objects"])
    K = sample.camera.K
    assert K.tolist() == [[541.14, 0, 320], [0, 541.14, 240], [0, 0, 1]]
    assert sample["rgb"].shape == (480, 640, 3)
    assert (sample["instance"] > 0).any()
    assert sample["rgb"].max() > 50
    world, pose = sim.world(2), camera(sim, 2)
    R_w2c = matrix(pose).T
    for row, craft in zip(sample.objects, sim.config.spacecraft, strict=True):
        place = world.position_m(craft)
        distance = np.linalg.norm(place - pose[:3])
        assert row["t_m2c"] == pytest.approx(R_w2c @ (place - pose[:3]), abs=1e-6 * distance)
        expected = R_w2c @ matrix(world.poses[craft][0])
        assert row["R_m2c"] == pytest.approx(expected, abs=1e-9)
        assert row["px_count_visib"] > 0
    classes = {int(value) for value in np.unique(sample["semantic"][..., 1])}
    assert classes <= {0, 10, 20}
    assert classes & {10, 20}
