"""Trajectories that lead somewhere, against poses worked out by hand and independent motion."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st
from scipy.integrate import solve_ivp
from scipy.spatial.transform import Rotation
from tests.python.camera_worlds import RADIUS_M, close, columns, offsets, orbit_axes, worlds

from perilune import _core, document as cfg
from perilune.camera import trajectories
from perilune.camera.trajectories.relative import clohessy_wiltshire, ellipse_state
from perilune.config import ConfigError
from perilune.config.trajectory.runs import RelativeEllipse
from perilune.document.loader import read_tree


@pytest.fixture
def scene(repo_dir):
    """The tree of the small scene, free to be changed."""
    return read_tree(repo_dir / "tests/python/scene.yaml")


# -- linear ----------------------------------------------------------------------------------------

LINEAR = {
    "kind": "linear",
    "target": "sat",
    "start": {"position_m": [0, -100, 0]},
    "end": {"position_m": [0, -20, 0]},
}


def test_linear_evenly(scene):
    places = worlds(scene, {**LINEAR, "positions": 5}, range(7))
    expected = [-100, -80, -60, -40, -20, -100, -80]  # repeats
    assert close(offsets(places), [[0, y, 0] for y in expected])
    for place in places:
        axes = columns(trajectories.camera_poses(place)[0])
        # Along +y with +z up: right is +x, down is -z.
        assert close(axes, np.array([[1, 0, 0], [0, 0, 1], [0, -1, 0]]), 1e-9)


def test_linear_holds_at_the_end(scene):
    places = worlds(scene, {**LINEAR, "positions": 3, "after": "hold"}, range(5))
    assert close(offsets(places)[:, 1], [-100, -60, -20, -20, -20])


def test_linear_slows_down(scene):
    """Constant deceleration from 3 to 1 m/s over 80 m takes 40 s: x = 3 t - t^2 / 40."""
    speeds = {"start_speed_m_s": 3.0, "end_speed_m_s": 1.0}
    times = np.arange(5) * 10.0
    expected = -100 + 3 * times - times**2 / 40
    by_time = worlds(scene, {**LINEAR, **speeds}, range(5), **{"time.step_s": 10.0})
    assert close(offsets(by_time[:4])[:, 1], expected[:4])
    assert close(offsets(by_time)[4, 1], -100)  # t = T begins again
    by_steps = worlds(scene, {**LINEAR, **speeds, "positions": 5}, range(5))
    assert close(offsets(by_steps)[:, 1], expected)
    held = worlds(scene, {**LINEAR, **speeds, "after": "hold"}, range(6), **{"time.step_s": 10.0})
    assert close(offsets(held)[:, 1], [*expected, -20])


def test_linear_moves_while_the_shutter_is_open(scene):
    changes = {"camera.exposure_time_s": 0.5, "time.step_s": 10.0}
    (place,) = worlds(scene, {**LINEAR, "duration_s": 40.0}, [1], **changes)
    assert close(offsets([place], when=0)[0], [0, -80, 0])
    assert close(offsets([place], when=1)[0], [0, -79, 0])
    by_steps = worlds(scene, {**LINEAR, "positions": 5}, [1, 4], **changes)
    assert close(offsets(by_steps, when=1), [[0, -79, 0], [0, -20, 0]])


def test_linear_in_the_axes_of_the_target(scene):
    for place in worlds(scene, {**LINEAR, "frame": "target", "positions": 3}, range(3)):
        own = place.body_axes("sat", offsets([place])[0])
        assert close(own, [0, -100 + 40 * place.step, 0])


def test_linear_from_pose_to_pose(scene):
    trajectory = {
        **LINEAR,
        "start": {"position_m": [50, 0, 0], "rotation_deg": [0, 0, 0]},
        "end": {"position_m": [90, 0, 0], "rotation_deg": [0, 0, 120]},
        "positions": 4,
    }
    for place in worlds(scene, trajectory, range(4)):
        pose = trajectories.camera_poses(place)[0]
        expected = Rotation.from_euler("z", 40 * place.step, degrees=True).as_matrix()
        assert close(columns(pose), expected, 1e-12)
    # A camera of Blender's looks along its -z: the same rotation turned half round x.
    (place,) = worlds(scene, {**trajectory, "camera_axes": "opengl"}, [0])
    assert close(columns(trajectories.camera_poses(place)[0]), np.diag([1, -1, -1]), 1e-12)


@pytest.mark.parametrize(
    ("changes", "text"),
    [
        ({}, r"camera\.trajectory\.positions: required \(over how many steps\), or duration_s"),
        ({"positions": 3, "duration_s": 4.0}, "give only one of positions, duration_s"),
        ({"positions": 3, "start_speed_m_s": 1.0}, "go together"),
        ({"start_speed_m_s": 0.0, "end_speed_m_s": 0.0}, "must be positive"),
        ({"positions": 0}, "positions"),
        ({"positions": 2, "target": "sta"}, "did you mean 'sat'"),
        ({"positions": 2, "frame": "lvhl"}, "frame"),
        ({"positions": 2, "frame": "lvlh", "target": "earth"}, "is the root body and orbits"),
        (
            {"positions": 2, "start": {"position_m": [1, 2, 3], "rotation_deg": [0, 0, 0]}},
            "rotation_deg of both",
        ),
    ],
)
def test_linear_faults(scene, changes, text):
    scene["camera"]["trajectory"] = {**LINEAR, **changes}
    with pytest.raises(ConfigError, match=text):
        cfg.load(scene)


def test_a_scene_is_the_default_of_positions(scene):
    places = worlds(scene, LINEAR, range(6), **{"time.frames_per_scene": 3})
    assert close(offsets(places)[:, 1], [-100, -60, -20, -100, -60, -20])


def test_time_must_pass_for_a_duration(scene):
    scene["camera"]["trajectory"] = {**LINEAR, "duration_s": 10.0}
    with pytest.raises(ConfigError, match=r"duration_s: counts time, which stands"):
        cfg.load(scene, {"time.step_s": 0.0})


# -- spiral and flyby ------------------------------------------------------------------------------


def test_the_spiral_of_the_paper(scene):
    """Listing 7 with r_start 0.01, r_end 0.0001 in units of 6378 km: a quarter turn in xy."""
    trajectory = {
        "kind": "spiral", "target": "sat", "r_start_m": 63780.0, "r_end_m": 637.8,
        "plane": "xy", "rotations": 0.25, "positions": 4,
    }  # fmt: skip
    found = offsets(worlds(scene, trajectory, range(4)))
    for k in range(4):
        radius = 63780.0 + k / 3 * (637.8 - 63780.0)
        angle = k / 3 * math.pi / 2
        expected = [radius * math.cos(angle), radius * math.sin(angle), 0.0]
        assert close(found[k], expected, 1e-8)


@pytest.mark.parametrize(
    ("plane", "first", "second"),
    [
        ({"plane": "xy"}, [1, 0, 0], [0, 1, 0]),
        ({"plane": "yz"}, [0, 1, 0], [0, 0, 1]),
        ({"plane": "zx"}, [0, 0, 1], [1, 0, 0]),
        ({"normal": [0, 0, 2]}, [1, 0, 0], [0, 1, 0]),
        ({"normal": [0, -1, 0]}, [1, 0, 0], [0, 0, 1]),
        ({"normal": [1, 0, 0]}, [0, 1, 0], [0, 0, 1]),
        ({"normal": [-1, 0, 0]}, [0, 1, 0], [0, 0, -1]),
    ],
)
def test_planes_of_the_spiral(scene, plane, first, second):
    trajectory = {
        "kind": "spiral", "target": "sat", "r_start_m": 50.0, "start_angle_deg": 30.0,
        "positions": 4, "rotations": 0.75, **plane,
    }  # fmt: skip
    found = offsets(worlds(scene, trajectory, range(4)))
    for k in range(4):
        angle = math.radians(30 + 90 * k)
        expected = math.cos(angle) * np.array(first) + math.sin(angle) * np.array(second)
        assert close(found[k], 50 * expected, 1e-8)


def test_a_spiral_from_a_place_winds_around_a_cone(scene):
    trajectory = {
        "kind": "spiral", "target": "sat", "start_m": [30, 0, 40], "r_end_m": 25.0,
        "rotations": -1.5, "positions": 2,
    }  # fmt: skip
    found = offsets(worlds(scene, trajectory, range(2)))
    assert close(found, [[30, 0, 40], [-15, 0, 20]], 1e-8)


def test_noise_of_the_distance(scene):
    for trajectory in (
        {"kind": "spiral", "target": "sat", "r_start_m": 50.0, "positions": 10},
        {"kind": "orbit_object", "target": "sat", "distance_m": 50.0},
    ):
        places = worlds(scene, {**trajectory, "distance_noise_m": 5.0}, range(200))
        distances = np.linalg.norm(offsets(places), axis=1)
        assert (np.abs(distances - 50) <= 5 + 1e-8).all()
        # Uniform: standard deviation 5 / sqrt 3, its relative error below 5 sqrt(0.8 / 4 / 200).
        assert abs(distances.std() / (5 / math.sqrt(3)) - 1) < 5 * math.sqrt(0.2 / 200)
        with pytest.raises(ConfigError, match="distance_noise_m"):
            worlds(scene, {**trajectory, "distance_noise_m": 50.0}, [0])


def test_flyby(scene):
    trajectory = {
        "kind": "flyby", "target": "sat", "closest_m": 30.0, "direction": [0, 1, 0],
        "side": [1, 5, 0], "before_m": 40.0, "after_m": 80.0, "positions": 4,
    }  # fmt: skip
    found = offsets(worlds(scene, trajectory, range(4)))
    assert close(found, [[30, -40, 0], [30, 0, 0], [30, 40, 0], [30, 80, 0]], 1e-8)
    pose = trajectories.camera_poses(worlds(scene, trajectory, [0])[0])[0]
    assert close(columns(pose)[:, 2], [-0.6, 0.8, 0.0], 1e-9)
    scene["camera"]["trajectory"] = {**trajectory, "side": [0, -2, 0]}
    with pytest.raises(ConfigError, match=r"side: must not be along"):
        cfg.load(scene)


# -- centred target --------------------------------------------------------------------------------


def test_landing_on_a_body(scene):
    """Heights fall by one factor a step: 1000 km to 1 km in three steps is a factor of 10."""
    trajectory = {
        "kind": "centred_target", "target": "earth", "direction": [1, 0, 0], "frame": "target",
        "distance_m": 7378137.0, "landing": True, "final_distance_m": 1e3, "positions": 4,
    }  # fmt: skip
    places = worlds(scene, trajectory, range(4))
    for k, place in enumerate(places):
        pose = trajectories.camera_poses(place)[0]
        own = place.body_axes("earth", pose[:3])
        assert close(own, [6378137 + 1e6 / 10**k, 0, 0], 1e-8)
        assert close(columns(pose)[:, 2], -pose[:3] / np.linalg.norm(pose[:3]), 1e-12)
    (low,) = worlds(scene, {**trajectory, "distance_m": 6e6}, [0])
    with pytest.raises(ValueError, match=r"landing starts 6e\+06 m from the centre of earth"):
        trajectories.camera_poses(low)


def test_centred_on_a_spacecraft(scene):
    trajectory = {"kind": "centred_target", "target": "sat"}
    found = offsets(worlds(scene, trajectory, range(6), **{"time.frames_per_scene": 3}))
    assert close(np.linalg.norm(found, axis=1), 3 * RADIUS_M, 1e-8)
    assert close(found[:3], found[0])
    assert close(found[3:], found[3])
    assert np.linalg.norm(found[0] - found[3]) > 0.01
    landing = {**trajectory, "direction": [0, 0, -1], "distance_scale": 5.0, "positions": 3,
               "landing": True, "final_distance_m": 1.0}  # fmt: skip
    found = offsets(worlds(scene, landing, range(3)))
    assert close(found, [[0, 0, -20], [0, 0, -8], [0, 0, -5]], 1e-8)
    scene["camera"]["trajectory"] = {**landing, "landing": False}
    with pytest.raises(ConfigError, match="final_distance_m"):
        cfg.load(scene)


# -- relative --------------------------------------------------------------------------------------


@settings(max_examples=25, deadline=None)
@given(
    st.tuples(*[st.floats(-100, 100)] * 3),
    st.tuples(*[st.floats(-0.1, 0.1)] * 3),
    st.floats(1e-4, 2e-3),
    st.floats(0, 2e4),
)
def test_clohessy_wiltshire_solves_its_equations(position, velocity, rate, t_s):
    """Against scipy's DOP853 on x'' = 3 n^2 x + 2 n y', y'' = -2 n x', z'' = -n^2 z."""

    def slope(_, s):
        x, _, z, vx, vy, vz = s
        return [vx, vy, vz, 3 * rate**2 * x + 2 * rate * vy, -2 * rate * vx, -(rate**2) * z]

    state = np.array([*position, *velocity])
    found = clohessy_wiltshire(state[:3], state[3:], rate, t_s)
    if t_s == 0.0:
        assert (found == state[:3]).all()
        return
    truth = solve_ivp(slope, (0, t_s), state, method="DOP853", rtol=1e-11, atol=1e-9).y[:3, -1]
    assert np.abs(found - truth).max() < 1e-6 * max(1.0, np.abs(truth).max())


def two_body(state, times):
    """Positions (n, 3) about the Earth, by scipy."""
    gm = _core.BODIES["earth"]["gm_m3_s2"]

    def slope(_, s):
        return np.concatenate([s[3:], -gm * s[:3] / np.linalg.norm(s[:3]) ** 3])

    solution = solve_ivp(slope, (0, times[-1]), state, "DOP853", times, rtol=1e-13, atol=1e-6)
    return solution.y[:3].T


def test_relative_motion_is_that_of_a_second_satellite(scene):
    """A neighbour some 20 m off, moved by gravity alone, is where the equations put it.

    Second order of 20 m over 6878 km, for a third of a revolution: below a millimetre.
    """
    (start,) = worlds(scene, {"kind": "fixed", "target": "sat", "position_m": [9, 0, 0]}, [0])
    axes = orbit_axes(start)
    r, v = start.poses["sat"][0, :3], start.velocities_m_s["sat"][0]
    rate = np.linalg.norm(v) / np.linalg.norm(r)
    offset, speed = np.array([10.0, -15.0, 5.0]), np.array([0.002, -0.015, 0.004])
    moved = speed + np.cross([0, 0, rate], offset)  # the axes turn
    begin = np.concatenate([r + axes @ offset, v + axes @ moved])
    times = np.arange(7) * 300.0
    mate = two_body(begin, times)
    state = {"position_m": offset.tolist(), "velocity_m_s": speed.tolist()}
    trajectory = {"kind": "relative", "target": "sat", "state": state, "clearance_m": None}
    places = worlds(scene, trajectory, range(0, 31, 5))
    for place, found, truth in zip(places, offsets(places), mate, strict=True):
        assert np.linalg.norm(found - (truth - place.position_m("sat"))) < 1e-3
    # Forward, minus the normal, down: the same state.
    lvlh = {
        "position_m": [offset[1], -offset[2], -offset[0]],
        "velocity_m_s": [speed[1], -speed[2], -speed[0]],
    }
    again = worlds(scene, {**trajectory, "state": lvlh, "frame": "lvlh"}, range(0, 31, 5))
    assert close(offsets(again), offsets(places), 1e-8)
    poses = [trajectories.camera_poses(w[3])[0] for w in (places, again)]
    assert abs(abs(poses[0][3:] @ poses[1][3:]) - 1) < 1e-12


def test_relative_ellipse(scene):
    ellipse = {"radial_m": 20.0, "phase_deg": 0.0, "ahead_m": 100.0, "normal_m": 6.0,
               "normal_phase_deg": 90.0}  # fmt: skip
    trajectory = {"kind": "relative", "target": "sat", "ellipse": ellipse, "positions": 5}
    expected = [[-20, 100, 6], [0, 140, 0], [20, 100, -6], [0, 60, 0], [-20, 100, 6]]
    for place, truth in zip(worlds(scene, trajectory, range(5)), expected, strict=True):
        assert close(offsets([place])[0], orbit_axes(place) @ truth, 1e-7)
    assert close(offsets(worlds(scene, trajectory, range(5))[:1])[0],
                 offsets(worlds(scene, {**trajectory, "duration_s": 60.0}, [0]))[0])  # fmt: skip


@given(st.floats(1, 50), st.floats(0, 360), st.floats(0, 30), st.floats(0, 360), st.floats(0, 40))
def test_ellipses_are_closed(radial, phase, normal, across, turns):
    ellipse = RelativeEllipse(
        radial_m=radial, phase_deg=phase, normal_m=normal, normal_phase_deg=across, ahead_m=7.0
    )
    position, velocity = ellipse_state(ellipse, 1e-3)
    found = clohessy_wiltshire(position, velocity, 1e-3, turns * 2e3 * math.pi)
    angle = math.radians(phase) + 2 * math.pi * turns
    expected = [-radial * math.cos(angle), 7 + 2 * radial * math.sin(angle),
                normal * math.sin(math.radians(across) + 2 * math.pi * turns)]  # fmt: skip
    assert np.abs(found - expected).max() < 1e-9 * (1 + turns) * radial
