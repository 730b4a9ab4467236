"""Numerical orbits from the configuration to the root frame."""

from __future__ import annotations

import math

import numpy as np
import pytest

import perilune
from perilune.config import ConfigError
from perilune.document.loader import read_tree

LOW = {"altitude_km": 500.0, "inclination_deg": 51.6, "raan_deg": 40.0, "true_anomaly_deg": 10.0}
DAY_S = 86400.0


@pytest.fixture
def scene(repo_dir):
    """A tree without a model to load: the small scene of the tests, free to be changed."""
    return read_tree(repo_dir / "tests/python/scene.yaml")


def opened(scene, repo_dir, **orbit):
    scene["spacecraft"]["sat"]["orbit"] = {"around": "earth", **orbit}
    return perilune.open(scene, base=repo_dir / "tests/python")


def states(sim, *t_s):
    found = sim.system(0).states(np.array(t_s))
    return found.poses["sat"][:, :3], found.velocities_m_s["sat"]


def test_without_forces_it_is_kepler(scene, repo_dir):
    t_s = (0.0, 3000.0, -DAY_S, DAY_S)
    exact = states(opened(scene, repo_dir, kind="kepler", **LOW), *t_s)
    got = states(opened(scene, repo_dir, kind="numerical", rtol=1e-13, **LOW), *t_s)
    assert np.linalg.norm(got[0] - exact[0], axis=1).max() < 1e-3
    assert np.linalg.norm(got[1] - exact[1], axis=1).max() < 1e-6


def test_the_oblate_earth_turns_the_plane(scene, repo_dir):
    """Node rate over 5 days against -1.5 J2 (R/p)^2 n cos i, to 1 % (osculating for mean)."""
    forces = {"harmonics": {"degree": 2}}
    sim = opened(scene, repo_dir, kind="numerical", forces=forces, **LOW)
    r, v = states(sim, 0.0, 5 * DAY_S)
    h = np.cross(r, v)
    node = np.arctan2(h[:, 0], -h[:, 1])
    a = 6378.137e3 + 500e3
    n = math.sqrt(398600.4355e9 / a**3)
    rate = -1.5 * 1.0826267e-3 * (6378.137e3 / a) ** 2 * n * math.cos(math.radians(51.6))
    assert (node[1] - node[0]) / (5 * DAY_S) == pytest.approx(rate, rel=0.01)


def test_all_forces_and_a_file(scene, repo_dir, data_dir):
    forces = {
        "harmonics": {"file": "data:orbits/gravity/EGM96-truncated-21x21", "degree": 8},
        "third_bodies": ["sun", "moon"],
        "drag": {"area_to_mass_m2_kg": 0.01},
        "radiation_pressure": {"area_to_mass_m2_kg": 0.01},
    }
    sim = opened(scene, repo_dir, kind="numerical", forces=forces, **LOW)
    there = states(sim, DAY_S)[0]
    again = states(opened(scene, repo_dir, kind="numerical", forces=forces, **LOW), -1e4, DAY_S)[0]
    np.testing.assert_array_equal(there[0], again[1])
    plain = states(opened(scene, repo_dir, kind="kepler", **LOW), DAY_S)[0]
    assert 1e5 < np.linalg.norm(there - plain) < 2e6


def test_below_the_surface_names_the_orbit(scene, repo_dir):
    """An orbit that meets the ground after some hours of thick air."""
    forces = {"drag": {"area_to_mass_m2_kg": 10.0}}
    low = {**LOW, "altitude_km": 150.0}
    sim = opened(scene, repo_dir, kind="numerical", forces=forces, **low)
    states(sim, 60.0)
    with pytest.raises((ConfigError, ValueError), match=r"sat.*surface"):
        states(sim, DAY_S)


@pytest.mark.parametrize(
    ("forces", "what"),
    [
        ({"harmonics": {"degree": 9}}, "degree"),
        ({"harmonics": {"degree": 9, "file": "nowhere.gfc"}}, "nowhere.gfc"),
        ({"third_bodies": ["mooon"]}, "moon"),
        ({"third_bodies": ["earth"]}, "is what is orbited"),
        ({"drag": {"area_to_mass_m2_kg": -1.0}}, "area_to_mass_m2_kg"),
    ],
)
def test_refusals(scene, repo_dir, forces, what):
    with pytest.raises((ConfigError, ValueError, OSError)) as error:
        states(opened(scene, repo_dir, kind="numerical", forces=forces, **LOW), 0.0)
    assert what in str(error.value)


def test_a_body_that_spins_about_another_axis_has_no_field(scene, repo_dir):
    scene["bodies"]["earth"]["rotation"] = {"spin_axis": [1, 0, 0], "spin_rate_deg_s": 0.1}
    forces = {"harmonics": {"degree": 2}}
    with pytest.raises((ConfigError, ValueError), match="another axis than z"):
        states(opened(scene, repo_dir, kind="numerical", forces=forces, **LOW), 0.0)
