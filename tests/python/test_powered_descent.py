"""Powered descents: against a closed form, another integrator, and what energy says."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest
from hypothesis import assume, given, settings, strategies as st
from scipy.integrate import solve_ivp
from tests.python.camera_worlds import columns, worlds

import perilune
from perilune.camera import trajectories
from perilune.config import ConfigError
from perilune.config.standing import Descent
from perilune.document.loader import read_tree
from perilune.orbits.descent import DescentError, Field, track, uniform_acceleration_m_s2
from perilune.orbits.ground import Ground, smooth

MOON_M, MOON_GM = 1737.4e3, 4.9028e12
STILL = (0.0, 0.0, 0.0)
FAR_M = 1e9
"""Radius of a body whose gravity is uniform."""
SPIN = (0.0, 0.0, 7.088e-5)
"""That of Mars."""


def descent(**keys):
    given = {"lon_deg": 30.0, "lat_deg": 20.0, "heading_deg": 70.0, "start_height_m": 2000.0}
    return Descent(**given | {"horizontal_speed_m_s": 60.0, "descent_speed_m_s": 20.0} | keys)


def moon(spec, omega=STILL, height_m=0.0, ground=None):
    field = Field(MOON_GM, omega)
    return track(spec, ground or smooth((MOON_M,) * 3, False), field, height_m)


@settings(max_examples=15, deadline=None)
@given(
    st.floats(0.0, 300.0), st.floats(0.0, 300.0), st.floats(300.0, 20_000.0), st.floats(0.3, 9.8)
)
def test_in_uniform_gravity_it_is_the_closed_form(across, down, height_m, g):
    spec = descent(
        start_height_m=height_m,
        horizontal_speed_m_s=across + 30.0,
        descent_speed_m_s=down,
        touchdown_speed_m_s=0.01,
        place="start",
    )
    expected = uniform_acceleration_m_s2(g, height_m, down, across + 30.0)
    assume(expected > 1.05 * g)  # otherwise it is refused
    found = track(spec, smooth((FAR_M,) * 3, False), Field(g * FAR_M**2, STILL), 0.0)
    # The last centimetre a second takes some 1e-4 m, of which the closed form knows.
    assert found.turn.acceleration_m_s2 == pytest.approx(expected, rel=2e-4)
    k, speed = expected / g, math.hypot(down, across + 30.0)
    assert found.turned_s == pytest.approx((k * speed + down) / (g * (k * k - 1.0)), rel=1e-3)


def test_another_integrator_comes_down_at_the_same_place():
    """SciPy's, in the ICRF instead of the body's axes, where nothing rotates but the body."""
    spec = descent(specific_impulse_s=300.0, horizontal_speed_m_s=400.0, start_height_m=9000.0)
    found = moon(spec, SPIN)
    a0, omega = found.turn.acceleration_m_s2, np.array(SPIN)

    def slope(t, y):
        over_ground = y[3:] - np.cross(omega, y[:3])
        thrust = -a0 / (1.0 - a0 * t / (300.0 * 9.80665)) / np.linalg.norm(over_ground)
        pull = -MOON_GM / np.linalg.norm(y[:3]) ** 3
        return np.concatenate([y[3:], pull * y[:3] + thrust * over_ground])

    start = found.turn.states[0]
    first = np.concatenate([start[:3], start[3:] + np.cross(omega, start[:3])])
    end = solve_ivp(slope, (0.0, found.turned_s), first, method="DOP853", rtol=1e-11, atol=1e-9)
    angle = SPIN[2] * found.turned_s
    c, s = math.cos(angle), math.sin(angle)
    back = np.array([[c, s, 0.0], [-s, c, 0.0], [0.0, 0.0, 1.0]])
    place, speed = back @ end.y[:3, -1], back @ end.y[3:, -1]
    np.testing.assert_allclose(place, found.turn.states[-1, :3], rtol=0, atol=1e-2)
    speed -= np.cross(omega, place)
    np.testing.assert_allclose(speed, found.turn.states[-1, 3:], rtol=0, atol=1e-3)


def test_energy_height_speed_and_place():
    spec = descent(final_height_m=50.0)
    found = moon(spec)
    times = np.linspace(0.0, found.turned_s, 4001)
    states = [found.state(t) for t in times]
    places, speeds = np.array([s[0] for s in states]), np.array([s[1] for s in states])
    size = np.linalg.norm(speeds, axis=1)
    energy = 0.5 * size**2 - MOON_GM / np.linalg.norm(places, axis=1)
    work = np.trapezoid(-found.turn.acceleration_m_s2 * size, times)
    assert energy[-1] - energy[0] == pytest.approx(work, rel=1e-5)
    heights = np.linalg.norm(places, axis=1) - MOON_M
    assert (np.diff(heights) < 0.0).all()
    assert (np.diff(size) < 0.0).all()
    assert heights[0] == pytest.approx(2000.0, abs=1e-6)
    assert heights[-1] == pytest.approx(50.0, abs=1e-4)
    assert size[-1] == pytest.approx(1.0, abs=1e-6)
    assert found.end_s == pytest.approx(found.turned_s + 50.0, abs=1e-4)
    place, velocity = found.state(found.end_s - 20.0)
    assert np.linalg.norm(place) - MOON_M == pytest.approx(20.0, abs=1e-4)
    np.testing.assert_allclose(velocity, -found.up, atol=1e-12)
    lon, lat = math.radians(30.0), math.radians(20.0)
    site = [math.cos(lat) * math.cos(lon), math.cos(lat) * math.sin(lon), math.sin(lat)]
    np.testing.assert_allclose(found.feet_m, MOON_M * np.array(site), rtol=0, atol=2e-3)
    assert found.state(found.end_s + 9.0)[1].tolist() == [0.0, 0.0, 0.0]


def test_thrust_is_against_the_velocity():
    found = moon(descent())
    for t in np.linspace(0.0, 0.99 * found.turned_s, 7):
        axes, velocity = found.axes(t), found.state(t)[1]
        np.testing.assert_allclose(axes.T @ axes, np.eye(3), atol=1e-14)
        np.testing.assert_allclose(axes[:, 2], -velocity / np.linalg.norm(velocity), atol=1e-12)
        assert axes[:, 0] @ velocity == pytest.approx(0.0, abs=1e-9)


def test_it_comes_down_on_the_ground_that_there_is():
    def hills(d):
        return MOON_M + 300.0 * np.sin(40.0 * d[:, 0]) * np.cos(50.0 * d[:, 1]) - 1000.0

    ground = Ground(np.full(3, MOON_M), False, hills)
    for above, height_m in (("terrain", 2000.0), ("datum", 2000.0)):
        found = moon(descent(altitude_above=above), ground=ground, height_m=3.0)
        feet = found.feet_m / np.linalg.norm(found.feet_m)
        assert np.linalg.norm(found.feet_m) - hills(feet[None])[0] == pytest.approx(3.0, abs=1e-4)
        start = found.turn.states[0, :3]
        assert ground.height_m(start, above) == pytest.approx(height_m, abs=1e-3)


@pytest.mark.parametrize(
    ("keys", "text"),
    [
        ({"max_acceleration_m_s2": 2.0}, r"max_acceleration_m_s2: 2: the descent needs 2\.04"),
        ({"specific_impulse_s": 2.0}, "start_height_m: 2000: no thrust stops the fall"),
        ({"start_height_m": 1e5}, "start_height_m: 100000: too high for a turn from this speed"),
    ],
)
def test_what_no_throttle_does_is_refused(keys, text):
    with pytest.raises(DescentError, match=text):
        moon(descent(**keys))


def test_faulty_sections_are_refused():
    with pytest.raises(ValueError, match="must be below the speed at the start, 63"):
        descent(touchdown_speed_m_s=70.0)
    with pytest.raises(ValueError, match="must be below start_height_m, 2000"):
        descent(final_height_m=2000.0)


@pytest.fixture
def scene(repo_dir):
    tree = read_tree(repo_dir / "tests/python/scene.yaml")
    tree["bodies"], tree["root"] = {"moon": {"kind": "moon"}}, "moon"
    tree["spacecraft"]["sat"]["orbit"] = {"around": "moon", "altitude_km": 500,
                                          "mean_anomaly_deg": 0}  # fmt: skip
    return tree


CAMERA = {"kind": "powered_descent", "target": "moon", "lon_deg": 30.0, "lat_deg": 20.0,
          "start_height_m": 2000.0, "horizontal_speed_m_s": 60.0, "height_m": 2.0}  # fmt: skip


def test_a_camera_comes_down(scene):
    heights, downs = [], []
    for place in worlds(scene, {**CAMERA, "positions": 6}, range(8)):
        pose = trajectories.camera_poses(place)[0]
        own = place.body_axes("moon", pose[:3])
        heights.append(np.linalg.norm(own) - MOON_M)
        downs.append(-own / np.linalg.norm(own) @ place.body_axes("moon", columns(pose)[:, 2]))
    assert heights[0] == pytest.approx(2000.0, abs=1e-3)
    np.testing.assert_allclose(heights[5:], 2.0, atol=1e-3)
    assert (np.diff(heights[:6]) < 0.0).all()
    np.testing.assert_allclose(downs, 1.0, atol=1e-9)


@pytest.mark.parametrize("look", ["thrust", "site"])
def test_a_camera_looks_where_it_shall(scene, look):
    (place,) = worlds(scene, {**CAMERA, "look": look, "tilt_deg": 10.0}, [0])
    pose = trajectories.camera_poses(place)[0]
    site = MOON_M * place.ground("moon").site(Descent(lon_deg=30.0, lat_deg=20.0,
        start_height_m=1.0, horizontal_speed_m_s=9.0))[1]  # fmt: skip
    forward, own = (place.body_axes("moon", v) for v in (columns(pose)[:, 2], pose[:3]))
    way = site - own
    if look == "thrust":  # along the horizontal velocity, to the north
        way = way - (way @ own) * own / (own @ own)
    angle = math.degrees(math.acos(forward @ way / np.linalg.norm(way)))
    assert angle == pytest.approx(10.0, abs=2e-2)


def test_a_camera_that_cannot_is_refused_by_its_key(scene):
    (place,) = worlds(scene, {**CAMERA, "max_acceleration_m_s2": 1.7}, [0])
    text = r"camera\.trajectory\.max_acceleration_m_s2: 1\.7: the descent needs"
    with pytest.raises(ValueError, match=text):
        trajectories.camera_poses(place)


LANDER = {"kind": "powered_descent", "around": "moon", "lon_deg": 30.0, "lat_deg": 20.0,
          "start_height_m": 2000.0, "horizontal_speed_m_s": 60.0}  # fmt: skip


def opened(scene, repo_dir: Path, **keys):
    scene["spacecraft"]["sat"] |= {"orbit": LANDER | keys}
    del scene["spacecraft"]["sat"]["attitude"]
    return perilune.open(scene, base=repo_dir / "tests/python")


def test_a_lander_stands_on_its_feet_at_the_end(scene, repo_dir):
    sim = opened(scene, repo_dir)
    model = sim.models["sat"]
    feet = model.metres_per_unit * (model.model.bounds[0] - model.offset)[2]
    found = sim.system(0).states(np.array([0.0, 60.0, 1e4]))
    turns = sim.system(0).states(np.array([0.0, 60.0, 1e4])).poses["moon"]
    heights = np.linalg.norm(found.poses["sat"][:, :3], axis=1) - MOON_M
    assert heights[0] == pytest.approx(2000.0, abs=1e-3)
    assert heights[2] == pytest.approx(-feet, abs=1e-3)
    speed = np.linalg.norm(found.velocities_m_s["sat"][0] - np.cross(
        [0, 0, 0], turns[0, :3]))  # fmt: skip
    assert 50.0 < speed < 70.0  # over the ground, which rotates by 4.6 m/s
    up = columns(found.poses["sat"][2])[:, 2]
    assert up @ found.poses["sat"][2, :3] / MOON_M == pytest.approx(1.0, abs=1e-5)


def test_a_lander_that_cannot_is_refused_by_its_key(scene, repo_dir):
    with pytest.raises(ConfigError, match=r"spacecraft\.sat: max_acceleration_m_s2: 1\.7"):
        opened(scene, repo_dir, max_acceleration_m_s2=1.7)
