"""The reader of OAISYS files: what becomes of their keys, what is told, which errors name what."""

from __future__ import annotations

import copy
import json
import pickle
import warnings
from pathlib import Path

import numpy as np
import pytest

import perilune
from perilune import config as cfg
from perilune import rotations
from perilune.config import ConfigError, oaisys
from perilune.config.loader import read_tree
from perilune.config.oaisys import OaisysWarning

FOLDER = Path(__file__).resolve().parents[2] / "configs" / "oaisys"
EARTH_M = 6.378e6
MESHES = "ASSET_SETUP.MESHES"
SENSOR = "SENSOR_SETUP.SENSORS[0].sensorParams"


@pytest.fixture
def tree():
    """The tree of listing 4's file, free to be changed."""
    return read_tree(FOLDER / "satellite_circular.json")


@pytest.fixture
def planet(tree):
    return tree["ASSET_SETUP"]["MESHES"][0]["meshParams"]


@pytest.fixture
def iss(tree):
    return tree["ASSET_SETUP"]["MESHES"][1]


@pytest.fixture
def general(tree):
    return tree["SENSOR_SETUP"]["GENERAL"]


def translated(tree, base=FOLDER):
    """Our tree, and the warnings as one text."""
    with warnings.catch_warnings(record=True) as told:
        warnings.simplefilter("always")
        found = oaisys.translate(tree, base, "f.json")
    assert all(issubclass(row.category, OaisysWarning) for row in told)
    return found.tree, "\n".join(str(row.message) for row in told)


def failure(tree) -> str:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        with pytest.raises(ConfigError) as error:
            cfg.load(tree, base=FOLDER)
    return str(error.value)


def test_it_is_known_by_its_sections(tree):
    assert oaisys.is_oaisys(tree)
    assert oaisys.is_oaisys({"SENSOR_SETUP": {}})
    assert not oaisys.is_oaisys({"version": 1, "camera": {}})


def test_the_fourth_listing(tree):
    found, _ = translated(tree)
    assert found["time"]["frames_per_scene"] == 10
    assert found["root"] == "planet"
    body = found["bodies"]["planet"]
    assert (body["kind"], body["radii_km"]) == ("earth", [6378.0] * 3)
    assert body["color_map"].endswith("earth_like.jpg")
    assert body["rotation"] == {
        "rotation_deg": [23.0, 0.0, 0.0],
        "rotation_deg_step_v": 0.1,
        "rotation_mode": "local",
    }
    craft = found["spacecraft"]["iss"]
    assert craft["metres_per_unit"] == pytest.approx(0.0000169332079 * EARTH_M, rel=1e-15)
    assert craft["attitude"] == {"rotation_deg": [30.0, 0.0, 0.0], "rotation_deg_step_v": 0.1}
    assert craft["orbit"] == {
        "kind": "circular",
        "around": "planet",
        "scale": [1.06396989] * 3,
        "rotation_deg": [30.0, 30.0, 0.0],
        "v_step": 0.01,
        "orbit_start": 0.3,
    }
    assert found["camera"]["K"] == [541.14, 0, 320, 0, 541.14, 240, 0, 0, 1]
    assert "sensors" not in found
    assert found["render"]["samples"] == 16
    assert found["render"]["max_bounces"] == 4
    assert found["render"]["channels"] == ["rgb", "depth", "semantic", "instance", "objects"]
    assert found["labels"] == {"ids": {"object": {"earth": 10, "iss": 20}}}


def test_orbit_params_inside_and_beside_are_the_same(tree, iss):
    beside, _ = translated(tree)
    iss["meshParams"]["orbit_params"] = iss.pop("orbit_params")
    assert translated(tree)[0] == beside


def test_the_database(tree, iss):
    iss["orbit_params"] = {
        "type": "orbit_database",
        "orbit_type": "LEO",
        "parent": "planet",
        "v_step": 0.01,
        "orbit_start": 0.3,
    }
    assert translated(tree)[0]["spacecraft"]["iss"]["orbit"] == {
        "kind": "database",
        "class": "LEO",
        "around": "planet",
        "propagator": "circular",
        "v_step": 0.01,
        "orbit_start": [0.3, 0.3],
    }
    iss["orbit_params"]["orbit_type"] = "LEOO"
    text = failure(tree)
    assert f"{MESHES}[1].orbit_params.orbit_type: no 'LEOO'; did you mean 'LEO'?" in text


def test_a_custom_orbit_is_a_hook(tree, iss):
    params = {"type": "custom", "function": "m:f", "parent": "planet", "v_step": 0.01}
    iss["orbit_params"] = {**params, "params": {"a": 1}}
    orbit = translated(tree)[0]["spacecraft"]["iss"]["orbit"]
    assert orbit["kind"] == "hook"
    assert (orbit["function"], orbit["params"]) == ("m:f", {"a": 1})
    assert cfg.load(translated(tree)[0], base=FOLDER).config.spacecraft["iss"].orbit.v_step == 0.01


def test_metres_per_unit(tree, planet, general):
    """As stated; else the mean radius of what is orbited (science data of the core's table)."""
    tree["metres_per_unit"] = 1000.0
    found, _ = translated(tree)
    assert found["bodies"]["planet"]["radii_km"] == [1.0] * 3
    assert found["camera"]["trajectory"]["distance_m"] == [2.0, 2.0]
    del tree["metres_per_unit"]
    planet["meshFilePath"], planet["meshInstanceName"] = "mars.blend", "red"
    found, _ = translated(tree)
    mars_km = found["bodies"]["planet"]["radii_km"][0]
    assert mars_km == pytest.approx(3389.5, abs=0.1)
    assert found["camera"]["trajectory"]["distance_m"][0] == pytest.approx(2.0 * mars_km)
    tree["metres_per_unit"] = 0
    assert "metres_per_unit: must be positive" in failure(tree)


def test_a_scaled_planet(tree, planet):
    """Orbits are in scene units, whatever the planet's size; ours are in its radii."""
    planet["scale"] = [0.5, 0.25, 0.5]
    found, _ = translated(tree)
    assert found["bodies"]["planet"]["radii_km"] == [3189.0, 1594.5, 3189.0]
    scale = found["spacecraft"]["iss"]["orbit"]["scale"]
    assert scale == pytest.approx([2.12793978, 4.25587956, 2.12793978])


@pytest.mark.parametrize("name", ["planet", "earth"])
def test_names_and_instance_names(tree, iss, general, name):
    iss["orbit_params"]["parent"] = name
    iss["name"], iss["meshParams"]["meshInstanceName"] = "station 1", "iss"
    found, _ = translated(tree)
    assert found["spacecraft"]["station_1"]["orbit"]["around"] == "planet"
    assert found["camera"]["trajectory"]["target"] == "station_1"


def test_a_name_wins_over_an_instance_name(tree, planet, iss):
    moon = copy.deepcopy(iss)
    moon["name"], moon["meshParams"]["meshFilePath"] = "earth", "moon.blend"
    moon["meshParams"]["scale"] = [0.27] * 3
    moon["orbit_params"]["scale"] = [60.0] * 3
    tree["ASSET_SETUP"]["MESHES"].append(moon)
    iss["orbit_params"]["parent"] = "earth"
    found, _ = translated(tree)
    assert found["spacecraft"]["iss"]["orbit"]["around"] == "earth"
    assert found["bodies"]["earth"]["kind"] == "moon"
    assert found["bodies"]["earth"]["orbit"]["around"] == "planet"


def test_an_unknown_parent(tree, iss):
    iss["orbit_params"]["parent"] = "plant"
    text = failure(tree)
    assert f"{MESHES}[1].orbit_params.parent: no mesh named 'plant'; did you mean 'planet'" in text


def test_blend_files_become_gltf_beside_them(tree, iss):
    _, told = translated(tree)
    assert f"{MESHES}[1].meshParams.meshFilePath: read from ../../assets/models/station.glb" in told
    iss["meshParams"]["meshFilePath"] = "../../assets/models/station.glb"
    _, told = translated(tree)
    assert f"{MESHES}[1].meshParams.meshFilePath" not in told
    iss["meshParams"]["meshFilePath"] = "nowhere.blend"
    assert f"{MESHES}[1].meshParams.meshFilePath: no such file:" in failure(tree)


def test_a_planet_with_a_model_is_a_mesh(tree, planet):
    planet["meshFilePath"] = "../../assets/models/tango_like.glb"
    found, _ = translated(tree)
    assert list(found["spacecraft"]) == ["planet", "iss"]
    assert found["root"] == "origin"
    orbit = found["spacecraft"]["planet"]["orbit"]
    assert orbit["around"] == "origin"
    assert orbit["position_km"] == pytest.approx([0.0] * 3, abs=1e-11)  # a few nm from a speck
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        sim = perilune.open(tree, base=FOLDER)
    # A circle in scene units about a mesh, whose bounding radius is what the schema scales by.
    place = sim.world(0).position_m("iss") - sim.world(0).position_m("planet")
    assert np.linalg.norm(place) == pytest.approx(1.06396989 * EARTH_M, rel=1e-9)


def test_an_asteroid_alone(tree, planet):
    """The kind of scene of OAISYS's own example: a mesh, and a camera on a line to it."""
    mesh = tree["ASSET_SETUP"]["MESHES"][0]
    mesh["type"] = "MeshAsteroid"
    mesh["meshParams"] = {
        "meshFilePath": "../../assets/models/tango_like.blend",
        "meshInstanceName": "asteroid",
        "location": "trajectory_simulation",
        "activationProbability": 0.3,
    }
    mesh["name"] = "asteroid"
    del tree["ASSET_SETUP"]["MESHES"][1]
    tree["SENSOR_SETUP"]["GENERAL"] = {
        "sensorMovementType": "centeredTarget",
        "targetObject": "asteroid",
        "sensorDistanceScale": [1.5, 3.0],
    }
    found, told = translated(tree)
    assert f"{MESHES}[0].meshParams.activationProbability: not applied" in told
    assert found["spacecraft"]["asteroid"]["metres_per_unit"] == 1.0
    sim = perilune.open(found, base=FOLDER, overrides={"render.samples": 1})
    sample = sim.frame(1, channels=["rgb", "instance", "objects"])
    assert sample.objects["visib_fract"][0] == 1.0
    assert sample["rgb"].max() > 20
    assert set(np.unique(sample["instance"])) == {0, sample.objects["instance_id"][0]}


def test_an_alien_planet_is_an_ellipsoid(tree, planet):
    planet["meshFilePath"], planet["meshInstanceName"] = "alien.blend", "alien"
    found, told = translated(tree)
    assert found["bodies"]["planet"]["kind"] == "ellipsoid"
    assert found["bodies"]["planet"]["radii_km"] == [6378.0] * 3
    assert f"{MESHES}[0].meshParams.meshFilePath: no alien.blend in glTF" in told
    cfg.load(found, base=FOLDER)


def test_a_body_away_from_the_origin(tree, planet):
    planet["position"] = [2.0, 0.0, -1.0]
    found, _ = translated(tree)
    assert found["root"] == "origin"
    assert found["bodies"]["planet"]["orbit"]["position_km"] == [12756.0, 0.0, -6378.0]
    cfg.load(found, base=FOLDER)


def test_orbit_radius_left_out_is_three_radii(tree, general):
    """The station's bounds, from its file, about its origin."""
    from perilune import _core

    del general["orbit_radius"]
    found, told = translated(tree)
    bounds = _core.Model(str(FOLDER / "../../assets/models/station.glb")).bounds
    radius = np.linalg.norm(np.abs(bounds).max(axis=0)) * 0.0000169332079 * EARTH_M
    low, high = found["camera"]["trajectory"]["distance_m"]
    assert low == high == pytest.approx(3.0 * radius, rel=1e-12)
    assert "SENSOR_SETUP.GENERAL.orbit_radius: left out: 3 times the radius of iss" in told
    general["orbit_mesh"] = "planet"
    found, _ = translated(tree)
    assert found["camera"]["trajectory"]["distance_m"][0] == pytest.approx(3.0 * EARTH_M)


def test_orbit_radius_noise(tree, general):
    general["orbit_radius"], general["orbit_radius_noise"] = [0.01], 0.002
    found, _ = translated(tree)
    trajectory = found["camera"]["trajectory"]
    assert trajectory["distance_m"] == pytest.approx([0.01 * EARTH_M] * 2)
    assert trajectory["distance_noise_m"] == pytest.approx(0.002 * EARTH_M)
    general["orbit_radius_noise"] = 0.01
    assert "SENSOR_SETUP.GENERAL" in failure(tree)


def moved(tree, **general):
    """Our trajectory of a section GENERAL, checked by the schema; and the warnings."""
    tree["SENSOR_SETUP"]["GENERAL"] = general
    found, told = translated(tree)
    cfg.load(found, base=FOLDER)
    return found["camera"]["trajectory"], told


def test_the_seventh_listing(tree):
    """As printed: the movement type stands over a line break."""
    params = {"r_start": 0.01, "r_end": 0.0001, "plane": "xy", "rotations": 0.25}
    spiral, _ = moved(
        tree,
        sensorMovementType="\n    approach_trajectory",
        orbit_mesh="iss",
        orbit_radius=0.01,
        orbit_radius_noise=0,
        approach_moving_type="spiral",
        approach_moving_params=params,
    )
    assert spiral == {
        "kind": "spiral",
        "target": "iss",
        "r_start_m": pytest.approx(63780.0),
        "r_end_m": pytest.approx(637.8),
        "plane": "xy",
        "rotations": 0.25,
        "positions": 10,
    }


@pytest.mark.parametrize("plane", ["xy", "yz", "zx", "xz", "yx", "zy"])
def test_every_plane_turns_from_its_first_axis_to_its_second(tree, plane):
    """A quarter turn of a circle, by the words of the schema: normal, angle from x (or y)."""
    spiral, _ = moved(
        tree,
        sensorMovementType="approach_trajectory",
        orbit_mesh="iss",
        approach_moving_type="spiral",
        approach_moving_params={"r_start": 0.01, "plane": plane, "rotations": 0.25},
    )
    axes = np.eye(3)
    first, second = axes["xyz".index(plane[0])], axes["xyz".index(plane[1])]
    if "plane" in spiral:
        assert spiral["plane"] == plane
        return
    normal = np.array(spiral["normal"])
    assert normal == pytest.approx(np.cross(first, second))
    zero = axes[1] if abs(normal[0]) == 1.0 else axes[0]
    angle = np.radians(spiral.get("start_angle_deg", 0.0))
    start = np.cos(angle) * zero + np.sin(angle) * np.cross(normal, zero)
    assert start == pytest.approx(first, abs=1e-15)


def test_spirals_by_orbit_radius_and_by_place(tree):
    common = {
        "sensorMovementType": "approach_trajectory",
        "orbit_mesh": "iss",
        "approach_moving_type": "spiral",
        "orbit_radius": 0.02,
        "orbit_radius_noise": 0.001,
    }
    spiral, _ = moved(tree, **common, approach_moving_params={"plane": "zy"})
    assert spiral["r_start_m"] == pytest.approx(0.02 * EARTH_M)
    assert spiral["distance_noise_m"] == pytest.approx(0.001 * EARTH_M)
    assert "r_end_m" not in spiral
    place = {"start_position": [0.0, 0.01, 0.0], "plane": "zy"}
    spiral, _ = moved(tree, **common, approach_moving_params=place)
    assert spiral["start_m"] == pytest.approx([0.0, 63780.0, 0.0])
    assert "start_angle_deg" not in spiral


def test_linear(tree):
    params = {"start_pose": [0.01, 0, 0], "end_pose": [0.002, 0, 0]}
    common = {
        "sensorMovementType": "approach_trajectory",
        "orbit_mesh": "iss",
        "approach_moving_type": "linear",
    }
    speeds = {"start_velocity": 0.002, "end_velocity": 0.0005}
    line, _ = moved(tree, **common, approach_moving_params=params | speeds)
    assert line["start"] == {"position_m": pytest.approx([63780.0, 0.0, 0.0])}
    assert line["start_speed_m_s"] / line["end_speed_m_s"] == pytest.approx(4.0)
    assert line["positions"] == 10
    q = np.array([0.3, -0.4, 0.5, 0.7])
    turned = {"start_pose": [0.01, 0, 0, *q], "end_pose": [0.002, 0, 0, 0.5, -0.5, 0.5, 0.5]}
    line, _ = moved(tree, **common, approach_moving_params=turned)
    assert line["camera_axes"] == "opengl"
    for key, expected in (("start", q), ("end", np.array([0.5, -0.5, 0.5, 0.5]))):
        ours = rotations.from_rpy_deg(line[key]["rotation_deg"])
        expected = expected / np.linalg.norm(expected)
        assert abs(ours @ expected) == pytest.approx(1.0, abs=1e-12)


def test_a_custom_trajectory_is_a_hook(tree):
    hook, _ = moved(
        tree,
        sensorMovementType="approach_trajectory",
        orbit_mesh="iss",
        approach_moving_type="custom",
        approach_moving_params={"function": "m:f", "speed": 2},
    )
    assert hook == {"kind": "hook", "function": "m:f", "params": {"speed": 2}}


def test_random_euclidean(tree):
    """Euler angles are radians there."""
    common = {
        "randomEuclideanPosMin": [2, -1, 0],
        "randomEuclideanPosMax": [3, 1, 0],
        "stepInterval": 2,
    }
    angles = {
        "randomEuclideanEulerMin": [0, 0, 0],
        "randomEuclideanEulerMax": [0, 0, np.pi],
    }
    box, _ = moved(tree, sensorMovementType="randomEuclidean", **common, **angles)
    assert box["min_m"] == [2 * EARTH_M, -EARTH_M, 0.0]
    assert box["rotation_max_deg"] == pytest.approx([0.0, 0.0, 180.0])
    assert box["interval"] == 2
    targets = {"randomTargetPosMin": [-1, 0, 0], "randomTargetPosMax": [0, 0, 0]}
    box, told = moved(
        tree,
        sensorMovementType="randomEuclideanTarget",
        **common,
        **targets,
        randomTargetRollDeg=[-10.0, 10.0],
        hoverBaseModeEnabled=True,
        hoverBaseDistance=1.5,
        hoverTargetModeEnabled=False,
        hoverTargetDistance=0.0,
    )
    assert box["target_min_m"] == [-EARTH_M, 0.0, 0.0]
    assert box["target_from"] == "camera"
    assert box["roll_deg"] == [-10.0, 10.0]
    assert "GENERAL.hoverBaseDistance: not applied" in told
    assert "hoverTarget" not in told
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        sim = perilune.open(tree, base=FOLDER, overrides={"camera.trajectory.roll_deg": 0.0})
    for index in range(3):  # whatever the position, it looks along -x
        forward = rotations.to_matrix(sim.request(index)["camera_pose"][0, 3:])[:, 2]
        assert forward == pytest.approx([-1.0, 0.0, 0.0], abs=1e-9)


def test_deterministic(tree, tmp_path):
    rows = tmp_path / "poses.csv"
    rows.write_text("0,3,0,0,1,0,0,0\n1,3,0,1,1,0,0,0\n")
    table, _ = moved(
        tree,
        sensorMovementType="deterministic",
        sensorMovementPose=str(rows),
        deterministicSensorOffsetPos=[0.0, 0.0, 1.0],
    )
    assert table == {
        "kind": "deterministic",
        "file": str(rows),
        "metres_per_unit": EARTH_M,
        "offset_m": [0.0, 0.0, EARTH_M],
    }


def test_centered_target(tree):
    common = {"sensorMovementType": "centeredTarget", "targetObject": "planet"}
    scales = {"sensorDistanceScale": [1.5, 3.0], "finalApproachDistance": 1.05}
    centred, _ = moved(tree, **common, **scales)
    assert centred["distance_scale"] == {"uniform": [1.5, 3.0]}
    assert "landing" not in centred
    centred, _ = moved(tree, **common, **scales, landingMode=True)
    assert centred["final_distance_m"] == pytest.approx(0.05 * EARTH_M)
    assert centred["positions"] == 10


def test_the_sun_of_the_sky(tree):
    """Blender's sky: rotation 0 is towards +y, 90 deg towards +x."""
    exposure = translated(tree)[0]["camera"]["exposure"]
    assert exposure["white_radiance_w_m2_sr"] == pytest.approx(1361.0 / np.pi)
    effects = tree["ENVIRONMENT_EFFECTS_SETUP"]["ENVIRONMENT_EFFECTS"]
    params = effects[0]["environmentEffectsParams"]
    params |= {"SunRotation": [90.0], "SunElevation": [0.0], "SunSize": [0.545]}
    config = cfg.load(translated(tree)[0], base=FOLDER).config
    assert config.sun.direction == pytest.approx((1.0, 0.0, 0.0))
    angular = 2.0 * np.degrees(np.arcsin(config.sun.radius_km / 149597870.7))
    assert angular == pytest.approx(0.545)
    params |= {"SunRotation": [0.0, 60.0], "SunElevation": [30.0], "AirDensity": [0.0, 1.0]}
    params |= {"stepIntervalOption": "LOCAL", "stepInterval": 3, "SunStrength": [1.0]}
    found, told = translated(tree)
    azimuth = found["sun"]["direction"]["azimuth_deg"]
    assert azimuth == {"uniform": [30.0, 90.0], "interval": 3}
    where = "ENVIRONMENT_EFFECTS_SETUP.ENVIRONMENT_EFFECTS[0].environmentEffectsParams"
    assert f"{where}.AirDensity: not applied" in told
    assert f"{where}.SunStrength: not applied" in told
    document = cfg.load(found, base=FOLDER)
    first, third, fourth = (document.at(k)[0].sun.direction for k in (0, 2, 3))
    assert first == third != fourth


def test_no_sky_no_direction(tree):
    tree["ENVIRONMENT_EFFECTS_SETUP"]["ENVIRONMENT_EFFECTS"] = [{"type": "EnvHDRI"}]
    found, told = translated(tree)
    assert "sun" not in found
    assert "ENVIRONMENT_EFFECTS_SETUP.ENVIRONMENT_EFFECTS[0]: EnvHDRI: not applied" in told


def test_stereo(tree):
    """A baseline of 0.1 scene units along Blender's x; its y is up, its z backwards."""
    sensors = tree["SENSOR_SETUP"]["SENSORS"]
    second = copy.deepcopy(sensors[0])
    second["sensorParams"] |= {
        "outputBaseName": "right",
        "transformation": [0.1, 0.2, 0.3, 0.5, 0.5, 0.5, 0.5],
        "triggerInterval": 2,
    }
    sensors.append(second)
    found, _ = translated(tree)
    assert list(found["sensors"]) == ["sensor_1", "right"]
    right = found["sensors"]["right"]
    assert right["trigger_interval"] == 2
    place = np.array(right["transformation"][:3])
    assert place == pytest.approx(EARTH_M * np.array([0.1, -0.2, -0.3]))
    flip = np.diag([1.0, -1.0, -1.0])
    blender = rotations.to_matrix(np.array([0.5, 0.5, 0.5, 0.5]))
    ours = rotations.to_matrix(np.array(right["transformation"][3:]))
    assert ours == pytest.approx(flip @ blender @ flip)
    assert cfg.load(found, base=FOLDER).config.timeline.sensors_of(1) == ("sensor_1",)


def test_a_zero_quaternion_is_no_rotation(tree):
    tree["SENSOR_SETUP"]["SENSORS"][0]["sensorParams"]["transformation"] = [0] * 7
    found, told = translated(tree)
    assert "sensors" not in found
    assert f"{SENSOR}.transformation: a zero quaternion" in told


def test_passes(tree):
    passes = tree["RENDER_SETUP"]["RENDER_PASSES"]
    passes[0]["passParams"] |= {"renderDepthActive": False, "renderSamples": 7}
    del passes[1:]
    render = translated(tree)[0]["render"]
    assert (render["channels"], render["samples"]) == (["rgb", "objects"], 7)
    passes[0]["type"] = "FlowPass"
    assert "RENDER_PASSES[0]: FlowPass: has no counterpart" in translated(tree)[1]
    del tree["RENDER_SETUP"]
    channels = translated(tree)[0]["render"]["channels"]
    assert channels == ["rgb", "depth", "semantic", "instance", "objects"]


def test_labels(tree, planet, iss):
    iss["meshParams"]["passParams"]["semantic_label"]["labelIDVec"] = [[1, 10]]
    found, _ = translated(tree)
    assert found["labels"]["ids"]["object"] == {"earth": 10}
    assert found["spacecraft"]["iss"]["class"] == "earth"
    iss["meshParams"]["passParams"]["semantic_label"]["labelIDVec"] = [[0]]
    found, told = translated(tree)
    assert found["labels"]["ids"]["object"] == {"earth": 10}
    assert f"{MESHES}[1].meshParams.passParams.semantic_label.labelIDVec: not applied" in told
    iss["meshParams"]["passParams"]["semantic_label"]["labelIDVec"] = [["x"]]
    assert "semantic_label.labelIDVec[0]: must be whole numbers" in failure(tree)


def test_material_drivers_are_checked_and_told_of(tree, iss):
    driver = {"clip_min": 0.1, "clip_max": 10.0, "ideal": 1.0, "jitter_variance": 10.0}
    drivers = {"drivers": {"scale": driver}, "jitter_strength": 1.0, "step_interval": 1}
    iss["meshParams"]["material_drivers"] = drivers
    _, told = translated(tree)
    path = f"{MESHES}[1].meshParams.material_drivers.drivers.scale"
    assert f"{path}: not applied" in told
    driver["ideal"] = 11.0
    assert f"{path}.ideal: 11 is outside [clip_min, clip_max]" in failure(tree)
    del driver["ideal"]
    assert f"{path}.ideal: required, but missing" in failure(tree)


def test_what_has_no_counterpart_is_told_by_its_key(tree, planet, iss):
    tree["SIMULATION_SETUP"]["numBatches"] = 3
    tree["SIMULATION_SETUP"]["outputPath"] = "/tmp/x"
    tree["NEW_SECTION"] = {"a": 1}
    planet["colour"] = "blue"
    iss["meshParams"]["position"] = [1, 0, 0]
    stage = {"name": "s", "type": "StageBlenderLandscape", "stageParams": {"a": 1}}
    tree["ASSET_SETUP"]["STAGES"] = [stage]
    material = {"name": "m", "type": "MaterialTerrain", "materialParams": {"general": {}}}
    tree["ASSET_SETUP"]["MATERIALS"] = [material]
    rocks = {"name": "r", "type": "MeshMultipleRandom", "meshParams": {"numberInstances": 3}}
    tree["ASSET_SETUP"]["MESHES"].append(rocks)
    effects = [{"type": "BloomEffect", "quality": "HIGH"}]
    tree["RENDER_POST_PROCESSING_EFFECTS_SETUP"]["POST_EFFECTS"] = effects
    tree["SENSOR_SETUP"]["SENSORS"][0]["sensorParams"]["depthOfField"] = {"fStop": 1.4}
    _, told = translated(tree)
    for path in (
        "SIMULATION_SETUP.numBatches: batches are scenes of 10 steps; render them with --frames 0",
        "SIMULATION_SETUP.outputPath: not applied",
        "NEW_SECTION: has no counterpart",
        f"{MESHES}[0].meshParams.colour: has no counterpart",
        f"{MESHES}[1].meshParams.position: not applied: the orbit",
        "ASSET_SETUP.STAGES[0]: StageBlenderLandscape: terrain is not there yet",
        "ASSET_SETUP.MATERIALS[0]: MaterialTerrain",
        f"{MESHES}[2]: MeshMultipleRandom: scattered meshes",
        "RENDER_POST_PROCESSING_EFFECTS_SETUP.POST_EFFECTS[0]: BloomEffect: not applied",
        "RENDER_SETUP.GENERAL.renderEngine: has no counterpart",
        f"{SENSOR}.depthOfField: not applied",
    ):
        assert f"f.json: {path}" in told, path


@pytest.mark.parametrize(
    ("path", "value", "expected"),
    [
        ("SENSOR_SETUP.SENSORS", [], "SENSOR_SETUP.SENSORS: needs a sensor"),
        ("SENSOR_SETUP.GENERAL", 3, "SENSOR_SETUP.GENERAL: must be a mapping"),
        ("SENSOR_SETUP.GENERAL.orbit_mesh", None, "GENERAL.orbit_mesh: required"),
        ("SENSOR_SETUP.GENERAL.orbit_radius", -1, "GENERAL.orbit_radius: must be positive"),
        ("SENSOR_SETUP.GENERAL.sensorMovementType", "orbit_objects", "did you mean 'orbit_object'"),
        ("ASSET_SETUP.MESHES", [], "ASSET_SETUP.MESHES: holds no mesh"),
        ("ASSET_SETUP.MESHES", {}, "ASSET_SETUP.MESHES: must be a list"),
        ("SIMULATION_SETUP.numSamplesPerBatch", 0, "numSamplesPerBatch: must be a whole number"),
    ],
)
def test_errors_name_the_key(tree, path, value, expected):
    *sections, last = path.split(".")
    node = tree
    for section in sections:
        node = node[section]
    node[last] = value
    assert expected in failure(tree)


def test_errors_of_the_schema_name_the_files_key(tree, iss):
    params = tree["SENSOR_SETUP"]["SENSORS"][0]["sensorParams"]
    params["KMatrix"][0] = -1.0
    params["imageResolution"] = [640, 100000]
    tree["RENDER_SETUP"]["RENDER_PASSES"][0]["passParams"]["renderSamples"] = 70000
    iss["meshParams"]["scale"] = [1e-40] * 3
    text = failure(tree)
    assert f"{SENSOR}.imageResolution (here: camera.height) = 100000: must be less" in text
    assert "passParams.renderSamples (here: render.samples) = 70000: must be less" in text
    assert f"{MESHES}[1].meshParams.scale (here: spacecraft.iss.metres_per_unit)" in text
    assert f"{SENSOR}.KMatrix (here: camera.K)" not in text  # checked once the numbers are valid


def test_errors_of_orbits_and_files_name_the_files_key(tree, iss, tmp_path):
    iss["orbit_params"]["scale"] = [0.5] * 3
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        with pytest.raises(ConfigError) as error:
            perilune.open(tree, base=FOLDER)
        assert f"{MESHES}[1].orbit_params (here: spacecraft.iss.orbit): at " in str(error.value)
        assert "below the surface of planet" in str(error.value)
        tree["SENSOR_SETUP"]["GENERAL"] = {
            "sensorMovementType": "deterministic",
            "sensorMovementPose": "nowhere.csv",
        }
        with pytest.raises(FileNotFoundError) as missing:
            cfg.load(tree, base=FOLDER)
    assert "SENSOR_SETUP.GENERAL.sensorMovementPose (here: camera.traj" in str(missing.value)


def test_overrides_are_of_our_keys_and_documents_pickle(tree):
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        document = cfg.load(tree, {"camera.width": 64}, base=FOLDER)
    assert document.config.camera.width == 64
    with warnings.catch_warnings():
        warnings.simplefilter("error")  # told once, not by every worker
        again = pickle.loads(pickle.dumps(document))
    assert again.config == document.config
    assert again.origins == document.origins


def test_a_file_of_the_command_line(tree, tmp_path, capsys):
    from perilune.cli import main

    tree["ASSET_SETUP"]["MESHES"][0]["meshParams"]["meshFilePath"] = "earth.blend"
    tree["ASSET_SETUP"]["MESHES"][1]["meshParams"]["meshFilePath"] = str(
        FOLDER / "../../assets/models/tango_like.blend"
    )
    path = tmp_path / "scene.json"
    path.write_text(json.dumps(tree))
    assert main(["parts", str(path)]) == 0
    told = capsys.readouterr().err
    assert f"perilune: warning: {path}: RENDER_SETUP.GENERAL.renderEngine" in told
    assert "__init__.py" not in told
