"""Rotations of bodies and attitudes of spacecraft, through the configuration."""

from __future__ import annotations

import math

import erfa
import numpy as np
import pytest
from tests.python.orbit.scenes import opened, refused, state

from perilune.base import rotations
from perilune.orbits import dates, solar_system
from perilune.orbits.ephemerides import csv_table

# --- rotations ----------------------------------------------------------------------------------


def axes(q):
    return rotations.to_matrix(q)


def test_earth_turns_by_erfa(scene, repo_dir):
    sim = opened(scene, repo_dir)
    for t_s in (0.0, 1e7):
        epoch = sim.system(0).setting.epoch
        tt, utc = dates.tt_of(epoch, np.array([t_s])), dates.utc_of(epoch, np.array([t_s]))
        expected = erfa.c2t06a(tt[0][0], tt[1][0], utc[0][0], utc[1][0], 0.0, 0.0).T
        found = axes(sim.system(0).states(np.array([t_s])).poses["earth"][0, 3:])
        assert np.allclose(found, expected, rtol=0, atol=1e-12)


def test_turns_by_steps(scene, repo_dir):
    """0.1 deg a step about the own z axis, from (23, 0, 0) deg: listing 1; then about ICRF's z."""
    for mode in ("local", "global"):
        turn = {"rotation_deg": [23.0, 0.0, 0.0], "rotation_deg_step_v": 0.1, "rotation_mode": mode}
        scene["bodies"]["earth"]["rotation"] = turn
        sim = opened(scene, repo_dir)
        for step in (0, 1, 900):
            found = sim.system(step).states(np.array([60.0 * step])).poses["earth"][0, 3:]
            c, s = math.cos(math.radians(23)), math.sin(math.radians(23))
            tilt = np.array([[1, 0, 0], [0, c, -s], [0, s, c]])
            c, s = math.cos(math.radians(0.1 * step)), math.sin(math.radians(0.1 * step))
            spin = np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]])
            expected = tilt @ spin if mode == "local" else spin @ tilt
            assert np.allclose(axes(found), expected, rtol=0, atol=1e-13)


def test_three_angles_by_step(scene, repo_dir):
    turn = {"rotation_deg_step_v": [0.0, 0.5, 0.0]}
    sim = opened(scene, repo_dir, attitude=turn)
    q = sim.system(4).states(np.array([240.0])).poses["sat"][0, 3:]
    assert np.allclose(q, rotations.axis_angle((0.0, 1.0, 0.0), math.radians(2.0)), atol=1e-14)


def test_pointing(scene, repo_dir):
    """What each kind states about its axes, from places and velocities alone."""
    scene["bodies"]["moon"] = {"kind": "moon"}
    for pointing in ("sun", "velocity", "target", "lvlh", "nadir"):
        attitude = {"pointing": pointing} | ({"target": "moon"} if pointing == "target" else {})
        sim = opened(scene, repo_dir, attitude=attitude)
        world = sim.world(3)
        r, v = world.poses["sat"][0, :3], world.velocities_m_s["sat"][0]
        matrix = axes(world.poses["sat"][0, 3:])
        normal = np.cross(r, v)
        towards = {
            "sun": (0, world.sun_position_m - r),
            "velocity": (0, v),
            "target": (2, world.poses["moon"][0, :3] - r),
            "lvlh": (2, -r),
            "nadir": (2, -r),
        }
        column, aim = towards[pointing]
        assert np.allclose(matrix[:, column], aim / np.linalg.norm(aim), rtol=0, atol=1e-9)
        if pointing in ("velocity", "lvlh", "nadir"):
            assert np.allclose(matrix[:, 1], -normal / np.linalg.norm(normal), rtol=0, atol=1e-12)
        elif pointing == "sun":
            assert abs(matrix[:, 1] @ normal) < 1e-9 * np.linalg.norm(normal)
            assert matrix[:, 2] @ normal > 0
        else:
            assert abs(matrix[:, 0] @ normal) < 1e-9 * np.linalg.norm(normal)
            assert matrix[:, 1] @ normal < 0


def test_attitude_from_a_table(scene, repo_dir, tmp_path):
    """Between two lines half of a quarter turn is an eighth."""
    path = tmp_path / "a.csv"
    half = math.sqrt(0.5)
    path.write_text(f"t_s,qw,qx,qy,qz\n-60,1,0,0,0\n60,{-half},0,0,{-half}\n120,0,0,0,1\n")
    attitude = {"pointing": "table", "file": str(path)}
    sim = opened(scene, repo_dir, attitude=attitude)
    q = state(sim)[0][3:]
    expected = rotations.axis_angle((0.0, 0.0, 1.0), math.radians(45.0))
    assert abs(abs(q @ expected) - 1) < 1e-14
    with pytest.raises(ValueError, match=r"spacecraft\.sat: 180 s is outside the table"):
        sim.system(0).states(np.array([180.0]))


def test_attitude_tables_are_read_once(scene, repo_dir, tmp_path, monkeypatch):
    """As long as the file stays as it is: not in every frame."""
    path = tmp_path / "a.csv"
    path.write_text("t_s,qw,qx,qy,qz\n-60,1,0,0,0\n6e3,0,0,0,1\n")
    read, count = csv_table.read, []
    monkeypatch.setattr(csv_table, "read", lambda path: count.append(path) or read(path))
    sim = opened(scene, repo_dir, attitude={"pointing": "table", "file": str(path)})
    first = [state(sim, index=index)[0] for index in range(3)]
    assert len(count) == 1
    path.write_text("t_s,qw,qx,qy,qz\n-60,0,1,0,0\n6e3,0,0,1,0\n1e4,0,0,0,1\n")
    assert not np.allclose(state(sim)[0][3:], first[0][3:])
    assert len(count) == 2


def test_date_of_a_moment_is_kept(scene, repo_dir):
    """The setting's epoch is the configuration's."""
    sim = opened(scene, repo_dir)
    assert sim.system(0).setting.epoch == solar_system.date_from_utc((2026, 3, 20, 12, 0, 0.0))


def test_tumble_keeps_its_momentum(scene, repo_dir):
    """About principal axes and about turned ones: L in ICRF axes, and the rate's energy, stay; the
    rate by differences of the attitude."""
    tensor = np.diag([1.0, 2.0, 2.5])
    turn = axes(rotations.from_rpy_deg((20.0, -50.0, 70.0)))
    for inertia, matrix in (([1.0, 2.0, 2.5], tensor), (None, turn @ tensor @ turn.T)):
        rows = inertia or [[float(x) for x in row] for row in (matrix + matrix.T) / 2]
        attitude = {"pointing": "tumble", "inertia_kg_m2": rows, "rate_deg_s": [2.0, 5.0, 1.0],
                    "rotation_deg": [10.0, 20.0, 30.0]}  # fmt: skip
        system = opened(scene, repo_dir, attitude=attitude).system(0)
        start = axes(system.states(np.zeros(1)).poses["sat"][0, 3:])
        expected = rotations.from_rpy_deg((10.0, 20.0, 30.0))
        assert np.allclose(start, axes(expected), rtol=0, atol=1e-12)
        momenta = []
        for t_s in (0.0, 17.0, 1000.0):
            h = 1e-3
            around = system.states(t_s + np.array([-h, 0.0, h])).poses["sat"]
            a, b, c = (axes(pose[3:]) for pose in around)
            skew = b.T @ (c - a) / (2 * h)  # R^T dR/dt = [omega in own axes]
            omega = np.array([skew[2, 1], skew[0, 2], skew[1, 0]])
            momenta.append(b @ matrix @ omega)
            assert omega @ matrix @ omega == pytest.approx(
                np.radians([2, 5, 1]) @ matrix @ np.radians([2, 5, 1]), rel=1e-6
            )
        assert np.allclose(momenta, momenta[0], rtol=0, atol=1e-7)
    attitude["inertia_kg_m2"] = [[1.0, 0.5, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]
    assert "inertia tensor is symmetric" in refused(scene, repo_dir, attitude=attitude)
