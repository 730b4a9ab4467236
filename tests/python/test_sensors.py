"""Several sensors on one platform: keys, mountings, one world a step, and stereo from depth."""

from __future__ import annotations

import copy
import math
import pickle

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st

import perilune
from perilune import dataset
from perilune.base import rotations
from perilune.camera import trajectories
from perilune.config import ConfigError
from perilune.config.camera import Camera
from perilune.config.sensors import Sensor
from perilune.document.loader import read_tree

BASELINE_M = 0.8
STEREO = {"left": {}, "right": {"transformation": {"position_m": [BASELINE_M, 0, 0]}}}
CHANNELS = ["rgb", "depth", "normal", "part", "objects"]


@pytest.fixture(scope="module")
def base(request):
    return request.config.rootpath / "tests/python"


@pytest.fixture
def scene(base):
    """The tree of the small scene, free to be changed."""
    return read_tree(base / "scene.yaml")


def opened(scene, base, sensors, **camera):
    tree = copy.deepcopy(scene)
    tree["camera"] |= camera
    return perilune.open({**tree, "sensors": sensors}, base=base)


def pose_of(sim, index):
    """Camera to root at the opening."""
    return trajectories.camera_poses(sim.world(index))[0]


def test_sensors_take_the_keys_of_the_camera(scene, base):
    sensors = {
        "wide": {"fov_deg": 90, "width": 20},
        "matrix": {"K": [50, 0, 3, 0, 51, 4, 0, 0, 1], "exposure_time_s": 0.25},
        "same": {"exposure": {"percentile": 50}},
    }
    sim = opened(scene, base, sensors)
    wide, matrix, same = (sim.world(i).camera for i in range(3))
    assert (wide.width, wide.height, wide.fov_deg, wide.K) == (20, 32, 90, None)
    assert (matrix.fov_deg, matrix.focal_px, matrix.K[4]) == (None, None, 51)
    assert (matrix.exposure_time_s, same.exposure_time_s) == (0.25, 0.0)
    assert (same.fov_deg, same.exposure.percentile, wide.exposure.percentile) == (40, 50, 99)
    assert sim.config.camera.fov_deg == 40
    assert [sim.world(i).sensor for i in range(4)] == ["wide", "matrix", "same", "wide"]
    request = sim.request(0)
    assert (request["width"], request["K"][0, 0]) == (20, pytest.approx(10.0, rel=1e-15))
    assert (sim.request(1)["K"] == [[50, 0, 3], [0, 51, 4], [0, 0, 1]]).all()
    assert repr(sim).endswith("wide 20x32, matrix 48x32, same 48x32>")


def test_every_key_of_the_camera_can_be_a_sensors():
    assert set(Camera.model_fields) - {"trajectory"} <= set(Sensor.model_fields)


@pytest.mark.parametrize(
    ("sensors", "text"),
    [
        ({"a": {"fov": 3}}, r"sensors\.a\.fov: unknown key; did you mean 'fov_deg'"),
        ({"a": {"trajectory": {}}}, r"sensors\.a\.trajectory: unknown key"),
        ({"a": {"fov_deg": 3, "focal_px": 3}}, r"sensors\.a: .*give only one of"),
        ({"a": {"K": [0, 0, 3, 0, 51, 4, 0, 0, 1]}}, r"sensors\.a\.K: the focal lengths"),
        ({"a": {"trigger_interval": 0}}, r"sensors\.a\.trigger_interval"),
        ({"1a": {}}, r"sensors\.1a: a name is letters of any script"),
        ({"a": {"transformation": [0, 0, 0, 0, 0, 0, 0]}}, r"transformation.*must not be zero"),
        ({"a": {"transformation": [0, 0, 0, 1]}}, r"sensors\.a\.transformation"),
        ({"a": {"transformation": {"position": 3}}}, r"did you mean 'position_m'"),
    ],
)
def test_faults_are_named(scene, base, sensors, text):
    with pytest.raises(ConfigError, match=text):
        opened(scene, base, sensors)


def test_mountings(scene, base):
    half = math.sqrt(0.5)
    sensors = {
        "platform": {},
        "pose": {"transformation": [1, 2, 3, 2 * half, 0, 2 * half, 0]},
        "angles": {"transformation": {"position_m": [1, 2, 3], "rotation_deg": [0, 90, 0]}},
    }
    sim = opened(scene, base, sensors)
    for step in range(3):
        platform, pose, angles = (pose_of(sim, 3 * step + k) for k in range(3))
        axes = rotations.to_matrix(platform[3:])
        offset = pose[:3] - platform[:3]
        assert np.abs(axes.T @ offset - [1, 2, 3]).max() < 2e-9  # positions of 7e6 m in doubles
        # A quarter turn about y (down) looks along the platform's x (right).
        assert np.abs(rotations.to_matrix(pose[3:])[:, 2] - axes[:, 0]).max() < 1e-14
        assert np.abs(angles - pose).max() < 2e-9


def test_all_sensors_of_a_step_see_one_world(scene, base):
    driven = {"ideal": 90, "jitter_variance": 100, "clip_min": 0, "clip_max": 180}
    scene["spacecraft"]["sat"]["orbit"]["raan_deg"] = driven
    sensors = {
        "left": {"exposure_time_s": 0.5},
        "right": {"transformation": [1, 0, 0, 1, 0, 0, 0], "exposure_time_s": 0.1},
        "slow": {"trigger_interval": 3},
    }
    sim = opened(scene, base, sensors)
    alone = opened(scene, base, {})
    for step in range(6):
        frames = [sim.timeline.index_of(step, name) for name in sim.timeline.sensors_of(step)]
        worlds = [sim.world(i) for i in frames]
        first = worlds[0]
        assert first.t_s == 60.0 * step
        for other in worlds:
            for name, pose in other.poses.items():
                assert (pose[0] == first.poses[name][0]).all()
            assert other.drivers == first.drivers == alone.world(step).drivers
            assert (
                trajectories.platform_poses(other)[0] == trajectories.platform_poses(first)[0]
            ).all()
        assert len({w.poses["sat"][1].tobytes() for w in worlds}) == len(worlds)
    assert len({sim.world(i).drivers["spacecraft.sat.orbit.raan_deg"] for i in range(14)}) == 6


@pytest.mark.parametrize(
    "trajectory",
    [
        {"kind": "orbit_object", "target": "sat", "distance_m": [16, 19]},
        {"kind": "random_box", "around": "sat", "target": "sat", "min_m": [-15] * 3,
         "max_m": [15] * 3},
    ],
)  # fmt: skip
def test_the_longest_exposure_places_the_platform(scene, base, trajectory):
    """A place that is refused because of one sensor's exposure is refused for all of them."""
    craft = scene["spacecraft"]["sat"]
    craft["orbit"]["mean_anomaly_deg"] = 0.0
    mate = copy.deepcopy(craft)
    mate["orbit"]["mean_anomaly_deg"] = 1e-4  # 12 m ahead, and it crosses at 7 m/s
    mate["orbit"]["inclination_deg"] += 0.05
    scene["spacecraft"]["mate"] = mate
    scene["time"]["step_s"] = 0.0
    scene["camera"]["trajectory"] = trajectory
    sim = opened(scene, base, {"short": {}, "long": {"exposure_time_s": 2.0}})
    radius = sim.models["mate"].radius_m
    for step in range(300):
        short, long = (sim.world(2 * step + k) for k in range(2))
        assert (short.shared.poses["mate"] == long.poses["mate"]).all()
        assert long.shared is long
        short_place, long_place = (trajectories.platform_poses(w) for w in (short, long))
        assert (short_place[0] == long_place[0]).all()
        assert np.linalg.norm(long_place[1, :3] - long.poses["mate"][1, :3]) > radius


@pytest.fixture(scope="module")
def stereo(base):
    scene = read_tree(base / "scene.yaml")
    return opened(scene, base, STEREO, width=120, height=80)


def test_samples_name_their_sensor(stereo):
    samples = [stereo.frame(i, CHANNELS) for i in range(3)]
    assert [s.camera.sensor for s in samples] == ["left", "right", "left"]
    assert [(s.meta["step"], s.meta["sensor"]) for s in samples][2] == (1, "left")
    assert samples[0].meta["time_utc"] == samples[1].meta["time_utc"] != samples[2].meta["time_utc"]
    batch = perilune.collate(samples)
    assert batch["sensor"] == ["left", "right", "left"]
    assert batch["rgb"].shape == (3, 80, 120, 3)


def test_stereo_depth_gives_the_disparity(stereo):
    """Left depth, projected into the right image, is right depth there.

    1/z is affine in pixel coordinates on a plane, so that interpolating it between four pixels of
    one face is exact up to single precision: no tolerance for the raster is needed.
    """
    compared = 0
    for step in range(4):
        left, right = (stereo.frame(2 * step + k, CHANNELS) for k in range(2))
        K = left.camera.K
        assert (K == right.camera.K).all()
        assert np.abs(left.camera.R_w2c - right.camera.R_w2c).max() < 1e-15
        rows, columns = np.nonzero(left["part"] > 1)  # of the satellite: planes
        z = left["depth"][rows, columns].astype(np.float64)
        u = columns - K[0, 0] * BASELINE_M / z
        x = np.floor(u).astype(int)
        inside = (x >= 0) & (x + 1 < 120)
        rows, columns, z, u, x = (a[inside] for a in (rows, columns, z, u, x))
        same = np.ones(len(x), dtype=bool)
        for k in range(2):
            same &= right["part"][rows, x + k] == left["part"][rows, columns]
            turned = right["normal"][rows, x + k] - left["normal"][rows, columns]
            same &= np.abs(turned).max(axis=1) < 1e-6
            same &= np.abs(right["depth"][rows, x + k] / z - 1.0) < 0.05  # not a parallel face
        rows, z, u, x = (a[same] for a in (rows, z, u, x))
        weight = u - x
        near, far = (1.0 / right["depth"][rows, x + k].astype(np.float64) for k in range(2))
        error = np.abs(z * ((1.0 - weight) * near + weight * far) - 1.0)
        assert np.median(error) < 1e-6
        # Beside edges two parallel faces a step apart can take part; they are few.
        assert np.mean(error < 1e-5) > 0.98
        compared += len(error)
    assert compared > 600


def test_same_bits_in_any_order(stereo):
    def bits(sim, index, threads=1):
        sample = sim.frame(index, CHANNELS, threads=threads)
        return {name: sample[name].tobytes() for name in sample}

    forward = [bits(stereo, i) for i in range(4)]
    again = pickle.loads(pickle.dumps(stereo))
    backward = [bits(again, i, threads=2) for i in reversed(range(4))][::-1]
    assert forward == backward
    assert forward[0] != forward[1]


def test_sensors_of_other_sizes(scene, base):
    sim = opened(scene, base, {"a": {"width": 16, "height": 12}, "b": {"width": 10, "height": 14}})
    frames = perilune.Dataset(sim, 2, channels=["depth", "objects"])
    assert [frames[i]["depth"].shape for i in range(2)] == [(12, 16), (14, 10)]
    with pytest.raises(ValueError, match=r"16 x 12 \(sensor a\) and of 10 x 14 \(sensor b\)"):
        dataset.collate([frames[0], frames[1]])


def test_a_callable_moves_the_platform(scene, base):
    tree = {**scene, "sensors": STEREO}
    place = [2e7, 0, 0, 1, 0, 0, 0]
    sim = perilune.open(tree, base=base, trajectory=lambda world: place)
    poses = [trajectories.camera_poses(sim.world(i), lambda w: place)[0] for i in range(2)]
    assert (poses[0] == place).all()
    assert (poses[1] == [2e7 + BASELINE_M, 0, 0, 1, 0, 0, 0]).all()


def test_sensors_may_not_be_in_a_body(scene, base):
    sim = opened(scene, base, {"probe": {"transformation": [-2e7, 0, 0, 1, 0, 0, 0]}})
    with pytest.raises(ValueError, match="frame 0: the camera is inside earth"):
        trajectories.camera_poses(sim.world(0), lambda world: [2e7, 0, 0, 1, 0, 0, 0])


def test_sensors_may_not_be_in_what_the_platform_keeps_clear_of(scene, base):
    """20 m from the satellite's centre, and 18 m of it on a boom: its bounding sphere is larger."""
    scene["camera"]["trajectory"] = {"kind": "orbit_object", "target": "sat", "distance_m": 20.0}
    sim = opened(scene, base, {"main": {}, "boom": {"transformation": {"position_m": [0, 0, 18]}}})
    trajectories.camera_poses(sim.world(0))
    with pytest.raises(ValueError, match=r"sensors\.boom: frame 1: .*sat \(bounding sphere"):
        trajectories.camera_poses(sim.world(1))


@settings(max_examples=30, deadline=None)
@given(st.tuples(*[st.floats(-5, 5)] * 3), st.tuples(*[st.floats(-180, 180)] * 3))
def test_mountings_are_rigid(position, angles):
    sensor = Sensor.model_validate(
        {"transformation": {"position_m": position, "rotation_deg": angles}}
    )
    q = rotations.from_rpy_deg([20, 50, -70])
    platform = np.array([[1.0, -2.0, 3.0, *q], [4.0, 5.0, 6.0, *q]])
    opening, closing = trajectories.mounted(platform, sensor.transformation)
    for pose, own in ((opening, platform[0]), (closing, platform[1])):
        assert abs(np.linalg.norm(pose[:3] - own[:3]) - np.linalg.norm(position)) < 1e-12
        assert abs(np.linalg.norm(pose[3:]) - 1.0) < 1e-12
    back = rotations.multiply(rotations.conjugate(q), opening[3:])
    assert abs(abs(back @ rotations.from_rpy_deg(angles)) - 1.0) < 1e-12
