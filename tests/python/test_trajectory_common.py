"""What all kinds of trajectory keep: the aim, its noise, distances, clearances, the same bits."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import assume, given, settings, strategies as st
from tests.python.camera_worlds import RADIUS_M, columns, offsets, worlds

from perilune.base import rotations
from perilune.camera import trajectories
from perilune.document.loader import read_tree


@pytest.fixture
def scene(repo_dir):
    """The tree of the small scene, free to be changed."""
    return read_tree(repo_dir / "tests/python/scene.yaml")


# -- what all kinds keep ---------------------------------------------------------------------------

AIMED = {
    "fixed": {"position_m": [12, 3, 4]},
    "linear": {"start": {"position_m": [0, -100, 0]}, "end": {"position_m": [0, -20, 0]},
               "positions": 7},
    "spiral": {"r_start_m": 40.0, "r_end_m": 10.0, "positions": 7, "rotations": 2.5},
    "flyby": {"closest_m": 9.0, "before_m": 60.0, "positions": 7},
    "centred_target": {"distance_m": 30.0, "landing": True, "final_distance_m": 2.0,
                       "positions": 7},
    "relative": {"ellipse": {"radial_m": 12.0}, "frame": "rsw"},
    "orbit_object": {"distance_m": [10, 20]},
    "random_box": {"around": "sat", "min_m": [-30] * 3, "max_m": [30] * 3},
}  # fmt: skip
FRAMES = ("icrf", "target", "lvlh", "rsw")


def kind(name, **changes):
    return {"kind": name, "target": "sat", **AIMED[name], **changes}


@pytest.mark.parametrize("name", AIMED)
def test_jitter_roll_and_noise_are_common(scene, name):
    """Without any the target is in the centre and `up` is up; each has its spread."""
    steady = worlds(scene, kind(name, roll_deg=0.0), range(7))
    for place in steady:
        pose = trajectories.camera_poses(place)[0]
        seen = rotations.rotate(rotations.conjugate(pose[3:]), place.position_m("sat") - pose[:3])
        assert math.hypot(seen[0], seen[1]) < 1e-8
        assert seen[2] > 0.0
    count = 200
    shaken = worlds(scene, kind(name, roll_deg=0.0, aim_jitter_deg=1.5), range(count))
    aims = []
    for place in shaken:
        pose = trajectories.camera_poses(place)[0]
        seen = rotations.rotate(rotations.conjugate(pose[3:]), place.position_m("sat") - pose[:3])
        aims.append(np.degrees(np.arctan2(seen[:2], seen[2])))
    sigma = np.sqrt(np.mean(np.square(aims), axis=0))
    assert (np.abs(sigma / 1.5 - 1.0) < 5.0 / math.sqrt(2.0 * count)).all()


def test_pointing_noise_is_about_three_axes(scene):
    count = 400
    still = worlds(scene, kind("fixed"), range(count))
    noisy = worlds(scene, kind("fixed", pointing_noise_deg=0.5, roll_deg=20.0), range(count))
    errors = []
    for a, b in zip(still, noisy, strict=True):
        first = rotations.multiply(
            trajectories.camera_poses(a)[0][3:], rotations.axis_angle((0, 0, 1), math.radians(20))
        )
        turn = rotations.multiply(rotations.conjugate(first), trajectories.camera_poses(b)[0][3:])
        errors.append(np.degrees(2 * turn[1:] * np.sign(turn[0])))
    sigma = np.std(errors, axis=0)
    assert (np.abs(sigma / 0.5 - 1.0) < 5.0 / math.sqrt(2.0 * count)).all()
    # Independent of the aim's jitter: no correlation beyond five standard errors.
    jitter = []
    jittered = worlds(scene, kind("fixed", aim_jitter_deg=0.5), range(count))
    for a, b in zip(still, jittered, strict=True):
        first, second = (trajectories.camera_poses(w)[0][3:] for w in (a, b))
        turn = rotations.multiply(rotations.conjugate(first), second)
        jitter.append(turn[1:3] * np.sign(turn[0]))
    both = np.corrcoef(np.hstack([errors, jitter]).T)[:3, 3:]
    assert np.abs(both).max() < 5.0 / math.sqrt(count)


@pytest.mark.parametrize("name", AIMED)
def test_same_in_any_order(scene, name):
    spec = kind(name, aim_jitter_deg=1.0, pointing_noise_deg=0.1, roll_deg=[-5, 5])
    forward = [trajectories.camera_poses(w).tobytes() for w in worlds(scene, spec, range(9))]
    backward = worlds(scene, spec, range(8, -1, -1))
    assert [trajectories.camera_poses(w).tobytes() for w in backward][::-1] == forward
    assert len(set(forward)) == 9


@settings(max_examples=60, deadline=None)
@given(
    name=st.sampled_from(["fixed", "linear", "spiral", "flyby", "centred_target"]),
    frame=st.sampled_from(FRAMES),
    up=st.tuples(*[st.floats(-1, 1)] * 3).filter(lambda v: math.hypot(*v) > 1e-3),
    step=st.integers(0, 20),
    roll=st.floats(-180, 180),
)
def test_the_target_is_always_in_the_centre(repo_dir, name, frame, up, step, roll):
    scene = read_tree(repo_dir / "tests/python/scene.yaml")
    spec = kind(name, frame=frame, up=list(up), roll_deg=roll)
    (place,) = worlds(scene, spec, [step], **{"camera.exposure_time_s": 0.3})
    poses = trajectories.camera_poses(place)
    for when in range(2):
        pose, target = poses[when], place.poses["sat"][when]
        axes = columns(pose)
        assert np.abs(axes.T @ axes - np.eye(3)).max() < 1e-12
        to = target[:3] - pose[:3]
        distance = np.linalg.norm(to)
        assert np.linalg.norm(np.cross(axes[:, 2], to / distance)) < 1e-9
        assert distance > RADIUS_M


@settings(max_examples=40, deadline=None)
@given(
    low=st.floats(1, 30),
    width=st.floats(0, 30),
    share=st.floats(0, 0.99),
    clearance=st.floats(0, 5),
    step=st.integers(0, 1000),
)
def test_distances_and_clearances_are_kept(repo_dir, low, width, share, clearance, step):
    scene = read_tree(repo_dir / "tests/python/scene.yaml")
    noise = share * low
    spec = {"kind": "orbit_object", "target": "sat", "distance_m": [low, low + width],
            "distance_noise_m": noise, "clearance_m": clearance}  # fmt: skip
    # At the very edge rounding decides.
    assume(abs(low + width + noise - RADIUS_M - clearance) > 1e-9)
    (place,) = worlds(scene, spec, [step])
    if low + width + noise < RADIUS_M + clearance:
        with pytest.raises(ValueError, match="within clearance_m of sat"):
            trajectories.camera_poses(place)
        return
    # Where this step's noise leaves little of the range, 2000 tries may not be enough.
    assume(low + 0.95 * width - noise > RADIUS_M + clearance)
    (offset,) = offsets([place])
    distance = np.linalg.norm(offset)
    assert low - noise - 1e-8 <= distance <= low + width + noise + 1e-8
    assert distance > RADIUS_M + clearance - 1e-8


def test_every_kind_has_a_test(scene):
    assert {*AIMED, "hover", "traverse", "powered_descent", "deterministic", "hook"} == set(
        trajectories.TRAJECTORIES
    )
