"""Orbits and attitudes where formulas break: every conic, angles at their ends, spans up to 1e9 s.

Nothing here may give NaN or fail to converge. Invariants: energy and angular momentum, round trips
of state and time, continuity through singular elements; scipy for free rotation.
"""

from __future__ import annotations

import csv
import itertools
import math
from pathlib import Path

import numpy as np
import pytest
from hypothesis import example, given, strategies as st
from scipy.integrate import solve_ivp

import perilune
from perilune import _core
from perilune.config import ConfigError

EPS = float(np.finfo(float).eps)
GM = 3.986004418e14
J2000 = 2451545.0

ECCENTRICITIES = [
    0.0, 1e-300, 1e-13, 0.01, 0.74, 0.99, 1 - 1e-6, 1 - 1e-12, 1 - EPS,
    1.0, 1 + EPS, 1 + 1e-12, 1 + 1e-6, 1.1, 3.0, 50.0,
]  # fmt: skip
INCLINATIONS = [0.0, 1e-13, 1e-9, 0.9, math.pi / 2, math.pi - 1e-13, math.pi]
ANOMALIES = [0.0, 1e-300, 1e-12, -1e-12, 1.0, math.pi - 1e-12, math.pi, math.pi + 1e-12]
TIMES = np.array([0.0, 1e-9, -1e-9, 1.0, 5400.0, -86400.0, 1e6, -1e7, 1e9, -1e9])


def propagator(spec: dict) -> _core.Propagator:
    return _core.Propagator({"kind": "kepler", "gm": GM, "frame": "icrf", **spec}, J2000, 0.0)


def elements(e: float, i: float = 0.9, **where: float) -> dict:
    shape = {"periapsis_m": 7e6, "eccentricity": e, "inclination_rad": i}
    return {"elements": {**shape, "raan_rad": 0.4, "arg_periapsis_rad": 1.3, **where}}


def check_invariants(states: np.ndarray, e: float, i: float) -> None:
    """Energy, angular momentum and distance of an orbit of periapsis 7e6 m."""
    assert np.isfinite(states).all()
    r, v = states[:, :3], states[:, 3:]
    distance = np.linalg.norm(r, axis=1)
    kinetic, potential = 0.5 * (v * v).sum(axis=1), GM / distance
    energy = 0.5 * GM * (e - 1) / 7e6
    assert np.abs(kinetic - potential - energy).max() <= 1e-13 * (kinetic + potential).max()
    h = math.sqrt(GM * 7e6 * (1 + e))
    normal = np.array([math.sin(i) * math.sin(0.4), -math.sin(i) * math.cos(0.4), math.cos(i)])
    noise = 1e-13 * h + 8 * EPS * distance * np.linalg.norm(v, axis=1)
    assert (np.linalg.norm(np.cross(r, v) - h * normal, axis=1) <= noise).all()
    assert (distance >= 7e6 * (1 - 1e-14)).all()
    if e < 1:
        assert (distance <= 7e6 * (1 + e) / (1 - e) * (1 + 1e-13)).all()


@pytest.mark.parametrize("e", ECCENTRICITIES)
def test_every_conic_at_every_time(e):
    for i, anomaly in itertools.product(INCLINATIONS, ANOMALIES):
        wheres = [{"since_periapsis_s": 1e3 * anomaly}]
        if e < 1 or abs(anomaly) < 1.5:
            wheres.append({"true_anomaly_rad": anomaly})
        if e != 1:
            wheres.append({"mean_anomaly_rad": anomaly})
        for where in wheres:
            check_invariants(propagator(elements(e, i, **where)).states(TIMES), e, i)


@pytest.mark.parametrize("e", [e for e in ECCENTRICITIES if e < 1])
def test_a_million_revolutions(e):
    """As a mean anomaly and as a time: the place of the remainder, to eps of the phase."""
    turns, mean = 1e6, 1.25
    a = 7e6 / (1 - e)
    period = 2 * math.pi * math.sqrt(a**3 / GM)
    here = propagator(elements(e, mean_anomaly_rad=mean)).states(np.zeros(1))[0]
    many = propagator(elements(e, mean_anomaly_rad=turns * math.tau + mean)).states(np.zeros(1))[0]
    later = propagator(elements(e, mean_anomaly_rad=mean)).states(np.array([turns * period]))[0]
    for state in (many, later):
        moved = np.linalg.norm(state[:3] - here[:3])
        assert moved <= 8 * EPS * turns * math.tau * a * (1 + e) / (1 - e * math.cos(mean))


@pytest.mark.parametrize("e", ECCENTRICITIES)
@pytest.mark.parametrize("dt", [0.0, 60.0, -5400.0, 1e5])
def test_round_trip_of_states(e, dt):
    """State -> orbit -> state at dt -> orbit -> state at -dt: the first one, at any inclination."""
    for i, since in itertools.product(INCLINATIONS, [0.0, 300.0, -2000.0]):
        start = propagator(elements(e, i, since_periapsis_s=since)).states(np.zeros(1))[0]
        there = propagator({"state": start}).states(np.array([0.0, dt]))
        back = propagator({"state": there[1]}).states(np.array([-dt]))[0]
        # An error of eps in speed or place is one of the period, times the time; it grows far out.
        n = math.sqrt(GM / 7e6**3)
        far = max(np.linalg.norm(there[1, :3]) / 7e6, 1.0)
        bound = (1e-13 + 16 * EPS * n * abs(dt)) * far * 7e6
        assert np.linalg.norm(there[0, :3] - start[:3]) <= 1e-14 * 7e6
        assert np.linalg.norm(back[:3] - start[:3]) <= bound


def test_two_body_table_from_states(data_dir: Path):
    """The reference states as states instead of elements: conversions to 1e-10."""
    with (data_dir / "orbits/reference/two_body.csv").open() as file:
        rows = list(csv.DictReader(file))
    assert len(rows) == 49
    for row in rows:
        number = {key: float(value) for key, value in row.items() if key != "body"}
        state = 1e3 * np.array([number[key] for key in ["x0", "y0", "z0", "vx0", "vy0", "vz0"]])
        spec = {"kind": "kepler", "gm": number["mu_km3_s2"] * 1e9, "frame": "icrf", "state": state}
        got = _core.Propagator(spec, J2000, 0.0).states(np.array([number["dt_s"]]))[0]
        for part, keys in ((got[:3], "x y z"), (got[3:], "vx vy vz")):
            expected = np.array([number[key] * 1e3 for key in keys.split()])
            assert np.linalg.norm(part - expected) <= 1e-10 * np.linalg.norm(expected), row


@given(
    e=st.sampled_from([0.0, 1e-13, 1e-9, 1 - 1e-12, 1.0, 1 + 1e-12]),
    i=st.sampled_from([0.0, 1e-13, math.pi - 1e-13, math.pi]),
    t=st.floats(-1e5, 1e5),
)
def test_continuous_through_singular_elements(e, i, t):
    """A change of 1e-12 in a state at rest, equatorial or parabolic is one of that size later."""
    start = propagator(elements(e, i, since_periapsis_s=0.0)).states(np.zeros(1))[0]
    moved = start + 1e-12 * np.array([7e6, -7e6, 7e6, 7e3, 7e3, -7e3])
    times = np.array([t])
    a = propagator({"state": start}).states(times)[0]
    b = propagator({"state": moved}).states(times)[0]
    growth = 10 * (1 + math.sqrt(GM / 7e6**3) * abs(t))
    assert np.linalg.norm(a[:3] - b[:3]) <= 1e-12 * 7e6 * growth


@pytest.mark.parametrize("speed", [0.0, 100.0, -100.0, 2e4, -2e4])
def test_rectilinear(speed):
    """Up and down on a line, to an error at the centre and never NaN."""
    line = np.array([3.0, 5.0, -7.0]) / math.sqrt(83.0)  # r x v is 0 but for its rounding
    fall = propagator({"state": np.concatenate([line * 7e6, line * speed])})
    answers = 0
    for t in np.linspace(-3000.0, 3000.0, 301):
        try:
            state = fall.states(np.array([t]))[0]
        except ValueError:  # beyond the centre
            continue
        answers += 1
        assert np.isfinite(state).all()
        assert np.linalg.norm(np.cross(state[:3], line)) < 1e-9 * np.linalg.norm(state[:3])
        energy = 0.5 * (state[3:] @ state[3:]) - GM / np.linalg.norm(state[:3])
        assert abs(energy - (0.5 * speed**2 - GM / 7e6)) < 1e-12 * GM / np.linalg.norm(state[:3])
    assert 60 < answers < 301
    for t in (-1e9, 1e9):
        if speed * t < 1e13:  # bound, or on its way in
            with pytest.raises(ValueError, match="radial motion has passed the centre"):
                fall.states(np.array([t]))


@given(
    moments=st.tuples(*[st.floats(0.05, 1.0)] * 3),
    rates=st.tuples(*[st.floats(-1.0, 1.0)] * 3),
    t=st.floats(-1e9, 1e9),
)
@example(moments=(0.5, 0.5, 0.2), rates=(0.0, 1.0, 0.0), t=1e9)
@example(moments=(0.5, 0.3, 0.2), rates=(1e-6, 1.0, 1e-6), t=1e9)
def test_tumbling_keeps_energy_and_momentum(moments, rates, t):
    """To 1e-10 at any time, by the axes alone: L is fixed outside, so in the axes it is R^T L."""
    p, q, r = moments  # masses on three axes: moments that some body has
    inertia = np.array([q + r, r + p, p + q])
    omega = np.array(rates)
    spec = {"frame": "tumble", "inertia": inertia, "omega_rad_s": omega}
    still = {"kind": "fixed", "position_m": (0.0, 0.0, 0.0)}
    tree = _core.Tree(
        [{"name": "rock", "parent": -1, "motion": still, "rotation": spec}], J2000, 0.0
    )
    w, x, y, z = tree.states(np.array([t]))[0][0, 0, 3:]
    assert abs(w * w + x * x + y * y + z * z - 1) < 1e-14
    axes = np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]
    )
    momentum = axes.T @ (inertia * omega)
    energy, start = momentum @ (momentum / inertia), omega @ (inertia * omega)
    assert abs(energy - start) <= 1e-10 * start


@pytest.mark.parametrize("seed", range(6))
def test_tumbling_as_scipy_integrates_it(seed):
    """Axes after 100 rad, by Euler's equations and the quaternion's, DOP853 at 1e-13: 1e-9 rad."""
    random = np.random.default_rng(seed)
    p, q, r = random.uniform(0.1, 1.0, 3)
    inertia, omega = np.array([q + r, r + p, p + q]), random.uniform(-1, 1, 3)

    def rate(_, y):
        w, x, y_, z = y[3:]
        a, b, c = y[:3]
        torque = np.cross(inertia * y[:3], y[:3]) / inertia
        spin = [-x * a - y_ * b - z * c, w * a + y_ * c - z * b,
                w * b + z * a - x * c, w * c + x * b - y_ * a]  # fmt: skip
        return np.concatenate([torque, 0.5 * np.array(spin)])

    start = np.concatenate([omega, [1.0, 0.0, 0.0, 0.0]])
    times = np.linspace(0.0, 100.0, 11)
    truth = solve_ivp(rate, (0, 100), start, "DOP853", times, rtol=1e-13, atol=1e-14).y[3:].T
    spec = {"frame": "tumble", "inertia": inertia, "omega_rad_s": omega}
    still = {"kind": "fixed", "position_m": (0.0, 0.0, 0.0)}
    node = {"name": "rock", "parent": -1, "motion": still, "rotation": spec}
    got = _core.Tree([node], J2000, 0.0).states(times)[0][:, 0, 3:]
    assert np.abs(np.abs((got * truth).sum(axis=1)) - 1).max() < 1e-12
    signs = np.sign((got * truth).sum(axis=1))[:, None]
    assert np.abs(got - signs * truth).max() < 1e-9


def test_deep_trees():
    """A chain of 300 orbits, each around the last, declared in reverse: the sum of all."""
    count = 300
    spec = elements(0.1, since_periapsis_s=0.0)
    motion = propagator(spec)
    still = {"kind": "fixed", "position_m": (0.0, 0.0, 0.0)}
    nodes = [
        {"name": f"n{k}", "parent": k + 1 if k + 1 < count else -1,
         "motion": motion if k + 1 < count else still,
         "rotation": {"frame": "parent"} if k + 1 < count else {"frame": "inertial"}}
        for k in range(count)
    ]  # fmt: skip
    times = np.array([0.0, 1e4])
    poses, velocities = _core.Tree(nodes, J2000, 0.0).states(times)
    one = motion.states(times)
    assert np.allclose(poses[:, 0, :3], (count - 1) * one[:, :3], rtol=1e-13, atol=0)
    assert np.allclose(velocities[:, 0], (count - 1) * one[:, 3:], rtol=1e-13, atol=0)


SCENE = {
    "version": 1,
    "time": {"epoch": "2026-03-20T12:00:00Z"},
    "root": "earth",
    "bodies": {"earth": {"kind": "earth"}},
    "spacecraft": {},
    "camera": {
        "width": 8, "height": 8, "fov_deg": 40.0,
        "trajectory": {"kind": "fixed", "target": "earth", "position_m": [2e7, 0.0, 0.0]},
    },
}  # fmt: skip


def scene(**orbit) -> dict:
    bodies = {
        "earth": {"kind": "earth"},
        "rock": {"kind": "ellipsoid", "radii_km": [1, 1, 1], "albedo": [0.1, 0.1, 0.1],
                 "gm_km3_s2": 1e-6, "orbit": {"around": "earth", **orbit}},
    }  # fmt: skip
    return {**SCENE, "bodies": bodies}


@pytest.mark.parametrize(
    "orbit",
    [
        {"periapsis_km": 6300.0, "true_anomaly_deg": 0.0},
        {"semi_major_axis_km": 7000.0, "eccentricity": 0.2, "mean_anomaly_deg": 180.0},
        {"semi_major_axis_km": -7000.0, "eccentricity": 1.5, "true_anomaly_deg": 10.0},
        {"state": {"position_km": [7000, 0, 0], "velocity_km_s": [0, 5.0, 0]}},
        {"state": {"position_km": [7000, 0, 0], "velocity_km_s": [-1, 0, 0]}},
    ],
)
def test_below_the_surface(orbit):
    """The error names the orbit and what is wrong with it."""
    with pytest.raises(ConfigError, match=r"bodies\.rock: .*periapsis.*inside"):
        perilune.open(scene(**orbit))


@pytest.mark.parametrize("e", [0.0, 0.7, 1 - 1e-12, 1.0, 1 + 1e-12, 50.0])
@pytest.mark.parametrize("step_s", [0.0, 1e9])
def test_spans_through_the_configuration(e, step_s):
    orbit = {"periapsis_km": 7e3, "eccentricity": e, "inclination_deg": 180.0,
             "true_anomaly_deg": 0.01}  # fmt: skip
    config = scene(**orbit)
    config["time"] = {**config["time"], "step_s": step_s}
    world = perilune.open(config).world(1)
    place, speed = world.position_m("rock"), world.velocities_m_s["rock"][0]
    assert np.isfinite(place).all()
    gm = _core.BODIES["earth"]["gm_m3_s2"]
    kinetic, potential = 0.5 * (speed @ speed), gm / np.linalg.norm(place)
    assert abs(kinetic - potential - 0.5 * gm * (e - 1) / 7e6) < 1e-13 * (kinetic + potential)
