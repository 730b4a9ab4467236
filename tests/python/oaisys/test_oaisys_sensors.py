"""The reader of OAISYS files: how sensors move, the Sun, several sensors."""

from __future__ import annotations

import copy
import warnings

import numpy as np
import pytest
from tests.python.oaisys.oaisys_files import EARTH_M, FOLDER, SENSOR, failure, translated

import perilune
from perilune import document as cfg
from perilune.base import rotations


def test_orbit_radius_left_out_is_three_radii(tree, general):
    """The station's farthest vertex, from its file, from its origin."""
    from perilune import _core

    del general["orbit_radius"]
    found, told = translated(tree)
    mesh = _core.Model(str(FOLDER / "../../assets/models/station.glb")).mesh()
    reach = np.linalg.norm(mesh["positions"].astype(float), axis=1).max()
    radius = reach * 0.0000169332079 * EARTH_M
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
    assert hook == {"kind": "hook", "hook": "m:f", "params": {"speed": 2}}


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


@pytest.mark.parametrize("head", ["", "frame,x,y,z,qw,qx,qy,qz\n"])
def test_deterministic_from_another_frame(tree, tmp_path, head):
    """Rows that begin at frame 1: one a step from the first on, each once, then again."""
    rows = tmp_path / "poses.csv"
    rows.write_text(head + "".join(f"{k},{2 + k},0,0,1,0,0,0\n" for k in (1, 2, 3)))
    movement = {"sensorMovementType": "deterministic", "sensorMovementPose": str(rows)}
    table, told = moved(tree, **movement)
    assert table["first_frame"] == 1
    assert "sensorMovementPose: its first row is for frame 1, which is our frame 0" in told
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        sim = perilune.open(tree, base=FOLDER)
    x = [sim.request(index)["camera_pose"][0, 0] / EARTH_M for index in range(4)]
    assert x == pytest.approx([3.0, 4.0, 5.0, 3.0], abs=1e-12)


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
    assert f"{where}.AirDensity: its middle, 0.5, is applied" in told
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
