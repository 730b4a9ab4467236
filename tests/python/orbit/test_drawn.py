"""Orbits drawn once a scene: the database and the user's hooks, through the configuration."""

from __future__ import annotations

import math

import erfa
import numpy as np
import pytest
from tests.python.orbit.scenes import equator_m, opened, refused, state

from perilune.base import rotations

# --- drawn orbits -------------------------------------------------------------------------------


def test_database_is_drawn_once_a_scene(scene, repo_dir):
    scene["time"]["frames_per_scene"] = 3
    orbit = {"kind": "database", "class": "LEO", "inclination_deg": 51.6}
    sim = opened(scene, repo_dir, orbit)

    def energy(index):
        found = sim.system(index).states(np.array([60.0 * index]))
        r, v = found.poses["sat"][0, :3], found.velocities_m_s["sat"][0]
        normal = np.cross(r, v)
        tilt = math.degrees(math.acos(normal[2] / np.linalg.norm(normal)))
        assert tilt == pytest.approx(51.6, abs=1e-9)
        return 0.5 * v @ v - 3.986004355070227e14 / np.linalg.norm(r)

    energies = [energy(index) for index in range(6)]
    assert np.allclose(energies[:3], energies[0], rtol=1e-12)
    assert np.allclose(energies[3:], energies[3], rtol=1e-12)
    assert abs(energies[0] / energies[3] - 1) > 1e-4
    again = opened(scene, repo_dir, orbit)
    assert np.array_equal(state(again, index=5)[0], state(sim, index=5)[0])
    other = opened(scene, repo_dir, orbit, seed=8)
    assert not np.allclose(state(other)[0][:3], state(sim)[0][:3])


def test_a_drawn_orbit_begins_with_its_scene(scene, repo_dir):
    """Elements hold at the scene's first step, whatever came before; so does the paper's start."""
    scene["time"] |= {"frames_per_scene": 4, "step_s": 700.0}
    kept = {"raan_deg": 0.0, "arg_periapsis_deg": 0.0, "inclination_deg": 0.0}
    orbit = {"kind": "database", "class": "LEO", "mean_anomaly_deg": 90.0, "eccentricity": 0.0}
    circle = {"propagator": "circular", "v_step": 0.1, "orbit_start": 0.25, "class": "LEO"}
    drawn = {"raan_deg": 0.0, "inclination_deg": 0.0, "kind": "database"}
    for section in (orbit | kept, circle | drawn):
        sim = opened(scene, repo_dir, section)
        for index in (0, 4, 40):
            pose, _ = state(sim, index=index, t_s=700.0 * index)
            assert abs(pose[0]) < 1e-3
            assert pose[1] > 6.6e6
        later, _ = state(sim, index=42, t_s=700.0 * 42)
        again, _ = state(sim, index=40, t_s=700.0 * 42)
        assert np.array_equal(later, again)
        assert later[0] < -1e6


def test_stationary_over_its_longitude(scene, repo_dir):
    """Over 24 h the point below a GEO stays within 0.01 deg of its longitude and the equator of
    date, by the Earth's precise rotation."""
    sim = opened(scene, repo_dir, {"kind": "database", "class": "GEO", "longitude_deg": -75.0})
    found = sim.system(0).states(np.linspace(0.0, 86400.0, 9))
    for sat, earth in zip(found.poses["sat"], found.poses["earth"], strict=True):
        x, y, z = rotations.rotate(rotations.conjugate(earth[3:]), sat[:3] - earth[:3])
        assert math.degrees(math.atan2(y, x)) == pytest.approx(-75.0, abs=0.02)
        # the elements' equator of date leaves out the nutation: 0.003 deg
        assert abs(math.degrees(math.atan2(z, math.hypot(x, y)))) < 0.005


def test_sun_synchronous_crosses_at_its_hour(scene, repo_dir):
    """Mean local time of the node. At 12 h UT the mean Sun stands over Greenwich, by the definition
    of universal time: its right ascension is the mean sidereal time."""
    orbit = {"kind": "database", "class": "SSO", "ltan_h": 10.5}
    pose, velocity = state(opened(scene, repo_dir, orbit))
    normal = erfa.pmat06(2461120.0, 0.0) @ np.cross(pose[:3], velocity)  # equinox of date
    node = math.atan2(normal[0], -normal[1])
    sun = erfa.gmst06(2461120.0, 0.0, 2461120.0, 69.2 / 86400)
    hour = (12.0 + math.degrees(math.remainder(node - sun, 2 * math.pi)) / 15.0) % 24.0
    assert hour == pytest.approx(10.5, abs=0.005)


# --- hooks --------------------------------------------------------------------------------------


def paper(body_radius_xyz=(6378.0, 6378.0, 6378.0)):
    altitude = np.random.uniform(800.0, 1200.0)  # noqa: NPY002 (the paper's listing 2)
    roll = np.random.uniform(np.deg2rad(-5), np.deg2rad(5))  # noqa: NPY002
    scale = (altitude + np.array(body_radius_xyz)) / np.array(body_radius_xyz)
    yaw = np.random.uniform(-np.pi, np.pi)  # noqa: NPY002
    return {"scale_xyz": scale, "rotation_rpy": np.array([roll, 0.0, yaw])}


def test_the_papers_sampler(scene, repo_dir):
    """Listing 2 as it stands: altitude 800 to 1200 km, tilt up to 5 deg, same in any order."""
    sim = opened(scene, repo_dir, orbits={"sat": paper})
    first = [state(sim, index=index, t_s=60.0 * index)[0] for index in range(6)]
    np.random.random(100)  # noqa: NPY002
    other = opened(scene, repo_dir, orbits={"sat": paper})
    for index in (5, 2, 0, 1, 4, 3):
        pose = state(other, index=index, t_s=60.0 * index)[0]
        assert np.array_equal(pose, first[index])
        height = np.linalg.norm(pose[:3]) - 6378137.0
        assert 7.7e5 < height < 1.2001e6
        assert abs(math.degrees(math.asin(pose[2] / np.linalg.norm(pose[:3])))) <= 5.0


def test_hooks_are_asked_once_a_scene(scene, repo_dir):
    """Whatever frames of it are rendered, in whatever order, and the same orbit for each."""
    scene["time"]["frames_per_scene"] = 3
    asked = []

    def counted(body_radius_xyz, rng):
        asked.append(rng.random())
        return {"scale_xyz": (1.1, 1.1, 1.1), "rotation_rpy": (asked[-1], 0.0, 0.0)}

    sim = opened(scene, repo_dir, orbits={"sat": counted})
    poses = {index: state(sim, index=index, t_s=60.0)[0] for index in (4, 1, 2, 5, 0, 3)}
    assert len(asked) == 2  # the first scene's was drawn when it was opened
    assert asked[0] != asked[1]
    fresh = opened(scene, repo_dir, orbits={"sat": counted})
    for index, pose in poses.items():
        assert np.array_equal(state(fresh, index=index, t_s=60.0)[0], pose)


def test_hooks_see_the_world(scene, repo_dir):
    seen = {}

    def mate(world, rng, params):
        seen.update({name: thing.radii_m.tolist() for name, thing in world.items()})
        assert not world["sat"].position_m.flags.writeable
        place = (world["sat"].position_m - world["earth"].position_m) / 1e3
        place += [50.0, 0.0, rng.random()]
        across = np.cross([0.3, 0.4, 0.5], place)
        return {"position_km": place, "velocity_km_s": 7.6 * across / np.linalg.norm(across)}

    scene["spacecraft"]["mate"] = {**scene["spacecraft"]["sat"]}
    sim = opened(scene, repo_dir, orbits={"mate": mate})
    gap = state(sim, "mate")[0][:3] - state(sim)[0][:3]
    assert gap[0] == pytest.approx(50e3, abs=1e-6)
    assert set(seen) == {"earth", "sat"}
    assert seen["earth"][0] == pytest.approx(6.378e6, abs=1e3)
    assert seen["sat"] == [pytest.approx(sim.models["sat"].radius_m)] * 3


def test_hooks_return_elements(scene, repo_dir, tmp_path, monkeypatch):
    (tmp_path / "my_orbits.py").write_text(
        "def low(rng, height):\n"
        "    return {'altitude_km': height, 'inclination_deg': 30.0,\n"
        "            'mean_anomaly_deg': rng.uniform(0, 360)}\n"
    )
    monkeypatch.syspath_prepend(tmp_path)
    orbit = {"kind": "hook", "hook": "my_orbits:low", "params": {"height": 700.0}}
    sim = opened(scene, repo_dir, orbit)
    heights = [np.linalg.norm(state(sim, index=k)[0][:3]) for k in range(3)]
    assert np.allclose(np.array(heights) - equator_m(sim)[0], 7e5)
    orbit["hook"] = "my_orbits:lwo"
    assert "spacecraft.sat.orbit.hook = 'my_orbits:lwo'" in refused(scene, repo_dir, orbit=orbit)


@pytest.mark.parametrize(
    ("answer", "text"),
    [
        (3, "must return a mapping"),
        ({"scale_xyz": [1.1, 1.1, 1.1]}, "scale_xyz and rotation_rpy alone"),
        ({"scale_xyz": [1.1, 1.1], "rotation_rpy": [0, 0, 0]}, "scale_xyz must be three"),
        ({"scale_xyz": [1.1, -1, 1], "rotation_rpy": [0, 0, 0]}, "scale_xyz must be positive"),
        ({"position_km": [7e3, 0, 0]}, "must return position_km and velocity_km_s"),
        ({"altitude_km": 500.0, "inclination": 3.0}, "did you mean 'inclination_deg'"),
        ({"altitude_km": 500.0}, "exactly one of mean_anomaly_deg"),
    ],
)
def test_wrong_answers_are_named(scene, repo_dir, answer, text):
    found = refused(scene, repo_dir, orbits={"sat": lambda: answer})
    assert "spacecraft.sat: orbit.hook" in found
    assert text in found


def test_a_circle_that_a_hook_draws_needs_its_rate(scene, repo_dir, tmp_path, monkeypatch):
    """It stood still without a word."""
    circle = 'def circle():\n    return {"scale_xyz": [1.1] * 3, "rotation_rpy": [0, 0, 0]}\n'
    (tmp_path / "my_circles.py").write_text(circle)
    monkeypatch.syspath_prepend(tmp_path)
    orbit = {"kind": "hook", "function": "my_circles:circle"}
    assert "needs the orbit's key v_step" in refused(scene, repo_dir, orbit=orbit)
    opened(scene, repo_dir, orbit | {"v_step": 0.0})


def test_orbits_of_unknown_things(scene, repo_dir):
    assert "orbits: no entry named 'sta'; did you mean 'sat'" in refused(
        scene, repo_dir, orbits={"sta": paper}
    )
