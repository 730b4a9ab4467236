"""Camera poses: the stated limits hold, the target is where it is said to be, hooks are checked."""

from __future__ import annotations

import math

import numpy as np
import pytest

from perilune import document as cfg, world
from perilune.base import rotations
from perilune.camera import trajectories
from perilune.document.loader import read_tree
from perilune.document.references import check_references
from perilune.orbits import solar_system

RADIUS_M = 4.0
FRAMES = range(60)


@pytest.fixture
def scene(repo_dir):
    """The tree of the small scene, free to be changed."""
    return read_tree(repo_dir / "tests/python/scene.yaml")


def worlds(scene, trajectory=None, frames=FRAMES, **overrides):
    """The worlds of some frames; the trajectory's keys are added to those of the scene."""
    scene["camera"]["trajectory"] |= trajectory or {}
    document = cfg.load(scene, overrides)
    check_references(document.config, "scene")
    epoch = solar_system.date_from_utc(document.config.time.utc_fields())
    radii = dict.fromkeys(document.config.spacecraft, RADIUS_M)
    return [world.build(document.config, {}, i, epoch, radii) for i in frames]


def from_target(place, pose, target="sat"):
    return pose[:3] - place.position_m(target)


def angle_deg(a, b):
    return math.degrees(math.atan2(np.linalg.norm(np.cross(a, b)), a @ b))


def aim(pose):
    return rotations.rotate(pose[3:], np.array([0.0, 0.0, 1.0]))


def test_distances_directions_and_aim(scene):
    distances, directions = [], []
    for place in worlds(scene, frames=range(400)):
        opening, closing = trajectories.camera_poses(place)
        offset = from_target(place, opening)
        distances.append(np.linalg.norm(offset))
        directions.append(offset / distances[-1])
        assert angle_deg(aim(opening), -offset) < 1e-5
        assert (opening == closing).all()
    assert min(distances) >= 12.0
    assert max(distances) <= 20.0
    # Uniform on [12, 20] and on the sphere, bounds at 5 standard errors (false alarm < 1e-6 each);
    # the Earth's side is as good as the others at these distances.
    assert abs(np.mean(distances) - 16.0) < 5.0 * 8.0 / math.sqrt(12.0 * 400)
    assert (np.abs(np.mean(directions, axis=0)) < 5.0 / math.sqrt(3.0 * 400)).all()
    second = np.mean(np.square(directions), axis=0)
    assert (np.abs(second - 1.0 / 3.0) < 5.0 * math.sqrt(4.0 / 45.0 / 400)).all()


def test_sun_angle(scene):
    angles = []
    for place in worlds(scene, {"sun_angle_deg": [20, 70]}, frames=range(300)):
        pose = trajectories.camera_poses(place)[0]
        to_sun = place.sun_position_m - place.position_m("sat")
        angles.append(angle_deg(from_target(place, pose), to_sun))
    assert min(angles) >= 20.0 - 1e-6
    assert max(angles) <= 70.0 + 1e-6
    # Uniform in the cosine: mean of the cosines within 5 standard errors.
    low, high = math.cos(math.radians(70)), math.cos(math.radians(20))
    spread = (high - low) / math.sqrt(12.0 * 300)
    assert abs(np.cos(np.radians(angles)).mean() - 0.5 * (low + high)) < 5.0 * spread


def test_sun_angle_of_no_width(scene):
    for place in worlds(scene, {"sun_angle_deg": 33.0}):
        pose = trajectories.camera_poses(place)[0]
        to_sun = place.sun_position_m - place.position_m("sat")
        assert abs(angle_deg(from_target(place, pose), to_sun) - 33.0) < 1e-6


def test_cone_in_the_target_frame(scene):
    limits = {"cone_axis": [1, 0, 0], "cone_angle_deg": [0, 25]}
    for place in worlds(scene, limits):
        pose = trajectories.camera_poses(place)[0]
        offset = place.body_axes("sat", from_target(place, pose))
        assert angle_deg(offset, np.array([1.0, 0.0, 0.0])) <= 25.0 + 1e-6


def test_background_lies_behind_the_target(scene):
    angles = []
    for place in worlds(scene, {"background": "earth"}, frames=range(200)):
        pose = trajectories.camera_poses(place)[0]
        offset = from_target(place, pose)
        behind = place.hit_m("earth", place.position_m("sat"), -offset / np.linalg.norm(offset))
        assert behind is not None
        assert behind > 490e3
        angles.append(angle_deg(offset, place.position_m("sat")))
    horizon = math.degrees(math.asin(6378.137 / 6878.137))
    assert 0.8 * horizon < max(angles) <= horizon + 0.1  # the whole disc is used, limb included


def test_background_and_sun_together(scene):
    limits = {"background": "earth", "sun_angle_deg": [0, 80]}
    for place in worlds(scene, limits):
        pose = trajectories.camera_poses(place)[0]
        offset = from_target(place, pose)
        assert angle_deg(offset, place.sun_position_m) <= 80.01
        direction = -offset / np.linalg.norm(offset)
        assert place.hit_m("earth", place.position_m("sat"), direction) is not None


def test_impossible_limits_say_why(scene):
    limits = {"background": "earth", "sun_angle_deg": [0, 5]}
    (place,) = worlds(scene, limits, frames=[3])
    with pytest.raises(ValueError, match=r"frame 3: no camera pose") as error:
        trajectories.camera_poses(place)
    middle = angle_deg(place.position_m("sat"), place.sun_position_m - place.position_m("sat"))
    half = math.degrees(math.asin(6378.137e3 / np.linalg.norm(place.position_m("sat"))))
    expected = f"With earth behind the target, sun angles of {middle - half:.1f} to"
    assert expected in str(error.value)


def test_clearance_of_the_bounding_sphere(scene):
    (place,) = worlds(scene, {"distance_m": [1, 4.9], "clearance_m": 1.0}, frames=[0])
    with pytest.raises(ValueError, match=r"within clearance_m of sat.*radius 4 m"):
        trajectories.camera_poses(place)
    for place in worlds(scene, {"distance_m": [1, 6], "clearance_m": 1.0}):
        pose = trajectories.camera_poses(place)[0]
        assert np.linalg.norm(from_target(place, pose)) > RADIUS_M + 1.0


def test_never_in_or_behind_a_body(scene):
    for place in worlds(scene, {"distance_m": [400e3, 14000e3]}):
        pose = trajectories.camera_poses(place)[0]
        target = place.position_m("sat")
        assert np.linalg.norm(pose[:3]) > 6356e3
        steps = np.linspace(0.0, 1.0, 2000)[:, None]
        between = pose[:3] + steps * (target - pose[:3])
        assert np.linalg.norm(between, axis=1).min() > 6356e3


def test_other_spacecraft_are_kept_clear_of(scene):
    mate = {**scene["spacecraft"]["sat"]}
    mate["orbit"] = {**mate["orbit"], "mean_anomaly_deg": 20 + 1.2e-4}  # about 14 m ahead
    scene["spacecraft"]["mate"] = mate
    for place in worlds(scene, frames=range(150)):
        pose = trajectories.camera_poses(place)[0]
        assert np.linalg.norm(from_target(place, pose, "mate")) > RADIUS_M


def test_aim_jitter(scene):
    offsets = []
    for place in worlds(scene, {"aim_jitter_deg": 2.0, "roll_deg": 0.0}, frames=range(400)):
        pose = trajectories.camera_poses(place)[0]
        target = rotations.rotate(rotations.conjugate(pose[3:]), place.position_m("sat") - pose[:3])
        offsets.append(np.degrees(np.arctan2(target[:2], target[2])))
    sigma = np.sqrt(np.mean(np.square(offsets), axis=0))
    assert (np.abs(sigma / 2.0 - 1.0) < 5.0 / math.sqrt(2.0 * 400)).all()


def test_roll_and_up(scene):
    for place in worlds(scene, {"roll_deg": 0.0}):
        matrix = rotations.to_matrix(trajectories.camera_poses(place)[0][3:])
        assert abs(matrix[2, 0]) < 1e-9  # the image's x axis is horizontal
        assert matrix[2, 1] < 0.0  # +z is up, y points down
    for place in worlds(scene, {"roll_deg": 30.0}):
        matrix = rotations.to_matrix(trajectories.camera_poses(place)[0][3:])
        tilt = math.degrees(math.atan2(-matrix[2, 0], -matrix[2, 1]))
        assert abs(abs(tilt) - 30.0) < 1e-6


def test_exposure_moves_the_camera_with_the_target(scene):
    for place in worlds(scene, **{"camera.exposure_time_s": 0.5}):
        opening, closing = trajectories.camera_poses(place)
        target = place.poses["sat"]
        moved = np.linalg.norm(target[1, :3] - target[0, :3])
        assert abs(moved - 0.5 * 7613.0) < 10.0
        assert np.abs((closing - opening)[:3] - (target[1] - target[0])[:3]).max() < 1e-6
        assert (opening[3:] == closing[3:]).all()


def test_lvlh_attitude(scene):
    scene["spacecraft"]["sat"]["attitude"] = {"pointing": "lvlh", "rotation_deg": [0, 0, 90]}
    for place in worlds(scene, frames=range(5), **{"camera.exposure_time_s": 0.1}):
        pose = place.poses["sat"]
        velocity = pose[1, :3] - pose[0, :3]
        matrix = rotations.to_matrix(pose[0, 3:])
        assert angle_deg(matrix[:, 2], -pose[0, :3]) < 0.01
        assert angle_deg(-matrix[:, 1], velocity) < 0.02  # turned by 90 deg about nadir


def test_spin(scene):
    still, later = worlds(scene, frames=[0, 1])
    turn = rotations.multiply(
        rotations.conjugate(still.poses["sat"][0, 3:]), later.poses["sat"][0, 3:]
    )
    expected = rotations.axis_angle((0, 0, 1), math.radians(0.5 * 60.0))
    assert abs(abs(turn @ expected) - 1.0) < 1e-12


def test_fixed(scene):
    scene["camera"]["trajectory"] = {"kind": "fixed", "target": "sat", "position_m": [0, -30, 0]}
    for place in worlds(scene):
        pose = trajectories.camera_poses(place)[0]
        assert np.abs(from_target(place, pose) - [0, -30, 0]).max() < 1e-6
        assert np.abs(aim(pose) - [0, 1, 0]).max() < 1e-12
        down = rotations.rotate(pose[3:], np.array([0.0, 1.0, 0.0]))
        assert np.abs(down - [0, 0, -1]).max() < 1e-12


def test_fixed_in_the_frame_of_the_target(scene):
    scene["camera"]["trajectory"] = {
        "kind": "fixed", "target": "sat", "position_m": [20, 0, 0], "frame": "target",
        "aim_offset_m": [0, 5, 0],
    }  # fmt: skip
    for place in worlds(scene, **{"camera.exposure_time_s": 2.0}):
        poses = trajectories.camera_poses(place)
        for when in range(2):
            target = place.poses["sat"][when]
            offset = place.body_axes("sat", poses[when, :3] - target[:3], when)
            assert np.abs(offset - [20, 0, 0]).max() < 1e-6
            sight = place.body_axes("sat", aim(poses[when]), when)
            assert angle_deg(sight, np.array([-20.0, 5.0, 0.0])) < 1e-5
        assert (poses[0, 3:] != poses[1, 3:]).any()


def test_fixed_inside_a_body_is_refused(scene):
    scene["camera"]["trajectory"] = {"kind": "fixed", "target": "sat", "position_m": [0, 0, 1]}
    (place,) = worlds(scene, {"target": "earth"}, frames=[2])
    with pytest.raises(ValueError, match="frame 2: the camera is inside earth"):
        trajectories.camera_poses(place)


def high_above(place, height_m):
    """The hook of the tests below: over the target, looking down."""
    target = place.position_m("sat")
    up = target / np.linalg.norm(target)
    q = rotations.look_at(-up, np.array([0.0, 0.0, 1.0]))
    return np.concatenate([target + height_m * up, q])


def test_hook_by_name(scene, tmp_path, monkeypatch):
    (tmp_path / "my_hooks.py").write_text(
        "def above(place, height_m):\n"
        "    x, y, z = place.position_m('sat')\n"
        "    return [x, y, z + height_m, 0, 2, 0, 0]\n"
    )
    monkeypatch.syspath_prepend(tmp_path)
    hook = {"kind": "hook", "function": "my_hooks:above", "params": {"height_m": 40.0}}
    scene["camera"]["trajectory"] = hook
    for place in worlds(scene, frames=range(3)):
        poses = trajectories.camera_poses(place)
        assert poses.shape == (2, 7)
        assert np.abs(from_target(place, poses[0]) - [0, 0, 40]).max() < 1e-6
        assert (poses[0, 3:] == [0, 1, 0, 0]).all()
    for name in ("my_hooks:beyond", "no_such_module:above"):
        with pytest.raises(ValueError, match=name):
            trajectories.camera_poses(worlds(scene, {"function": name}, frames=[0])[0])


@pytest.mark.parametrize(
    ("answer", "text"),
    [
        ([0.0] * 6, r"not \(6,\)"),
        ([0.0] * 7, "zero quaternion"),
        ([math.nan, 0, 0, 1, 0, 0, 0], "not finite"),
        ([0, 0, 0, 1, 0, 0, 0], "inside earth"),
    ],
)
def test_answers_of_hooks_are_checked(scene, answer, text):
    (place,) = worlds(scene, frames=[0])
    with pytest.raises(ValueError, match=text):
        trajectories.camera_poses(place, lambda _: answer)


def test_callable(scene):
    (place,) = worlds(scene, frames=[0])
    poses = trajectories.camera_poses(place, lambda w: high_above(w, 25.0))
    assert abs(np.linalg.norm(from_target(place, poses[0])) - 25.0) < 1e-6


def test_hooks_draw_by_the_step(scene, tmp_path, monkeypatch):
    """Their generator, and NumPy's own, give the same in any order and to all sensors of a step."""
    (tmp_path / "drawing_hooks.py").write_text(
        "import numpy as np\n"
        "def near(world, rng, reach_m):\n"
        "    offset = rng.uniform(10, reach_m, 3) + np.random.uniform(0, 1, 3)\n"
        "    return [*(world.position_m('sat') + offset), 1, 0, 0, 0]\n"
    )
    monkeypatch.syspath_prepend(tmp_path)
    scene["camera"]["trajectory"] = {
        "kind": "hook", "function": "drawing_hooks:near", "params": {"reach_m": 30.0},
    }  # fmt: skip
    np.random.seed(3)  # noqa: NPY002
    forward = [trajectories.camera_poses(p)[0] for p in worlds(scene, frames=range(6))]
    after = np.random.uniform()  # noqa: NPY002
    np.random.seed(4)  # noqa: NPY002
    backward = [trajectories.camera_poses(p)[0] for p in reversed(worlds(scene, frames=range(6)))]
    assert (np.array(forward) == np.array(backward)[::-1]).all()
    assert len({pose.tobytes() for pose in forward}) == 6
    np.random.seed(3)  # noqa: NPY002
    assert after == np.random.uniform()  # noqa: NPY002 (hooks leave the generators as they were)
    scene["sensors"] = {"left": {}, "right": {}}
    pairs = [trajectories.camera_poses(p)[0] for p in worlds(scene, frames=range(12))]
    assert (np.array(pairs[::2]) == np.array(pairs[1::2])).all()
    assert (np.array(pairs[::2]) == np.array(forward)).all()


def test_callables_may_ask_for_a_generator(scene):
    def near(world, rng):
        return [*(world.position_m("sat") + rng.uniform(10, 20, 3)), 1, 0, 0, 0]

    one, other = (
        [trajectories.camera_poses(p, near)[0] for p in worlds(scene, frames=range(3))]
        for _ in range(2)
    )
    assert (np.array(one) == np.array(other)).all()
    assert len({pose.tobytes() for pose in one}) == 3


def test_frames_are_drawn_independently_of_each_other(scene):
    forward = [trajectories.camera_poses(p) for p in worlds(scene)]
    backward = [trajectories.camera_poses(p) for p in reversed(worlds(scene))][::-1]
    assert (np.array(forward) == np.array(backward)).all()
    assert len({pose.tobytes() for pose in np.array(forward)}) == len(forward)


def test_ellipsoid_hits_agree_with_the_implicit_surface(scene):
    scene["bodies"]["earth"]["radii_km"] = [7000, 6500, 6000]
    (place,) = worlds(scene, frames=[0], **{"spacecraft.sat.orbit.altitude_km": 3000})
    rng = np.random.default_rng(5)
    origin, hits = place.position_m("sat"), 0
    for _ in range(500):
        direction = rng.standard_normal(3)
        direction /= np.linalg.norm(direction)
        distance = place.hit_m("earth", origin, direction)
        steps = np.linspace(0.0, 3e7, 4000)[:, None] * direction + origin
        q = rotations.conjugate(place.poses["earth"][0, 3:])
        R = rotations.to_matrix(q)
        inside = (np.square(steps @ R.T / place.body_radii_m["earth"]).sum(axis=1)) < 1.0
        if distance is None:
            assert not inside.any()
        else:
            hits += 1
            p = R @ (origin + distance * direction) / place.body_radii_m["earth"]
            assert abs(p @ p - 1.0) < 1e-9
            assert not inside[: int(distance / (3e7 / 3999))].any()
    assert hits > 50
