"""Orbits, body orientation and the tree of poses, through the core's Python interface.

Expected numbers come from 50-digit tables, from SPICE's output and from ERFA (data README), or
from invariants; nothing here is a copy of what the code once printed.
"""

from __future__ import annotations

import csv
import itertools
import math
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import erfa
import numpy as np
import pytest
from hypothesis import assume, given, strategies as st

from perilune import _core

EPS = np.finfo(float).eps
GM = 3.986004418e14
J2000 = 2451545.0
STILL: dict[str, Any] = {"kind": "fixed", "position_m": (0.0, 0.0, 0.0)}
UNTURNED: dict[str, Any] = {"frame": "inertial"}


def elements(**changes: float) -> dict[str, float]:
    base = {
        "periapsis_m": 6.8e6,
        "eccentricity": 0.01,
        "inclination_rad": 0.9,
        "raan_rad": 1.0,
        "arg_periapsis_rad": 2.0,
        "since_periapsis_s": 30.0,
    }
    return base | changes


def matrix(q: np.ndarray) -> np.ndarray:
    w, x, y, z = q
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]
    )


def angle_deg(a: np.ndarray, b: np.ndarray) -> float:
    """Angle of the rotation between two matrices; exact for small angles too."""
    d = a.T @ b
    sine = np.linalg.norm([d[2, 1] - d[1, 2], d[0, 2] - d[2, 0], d[1, 0] - d[0, 1]]) / 2
    return math.degrees(math.atan2(sine, (np.trace(d) - 1) / 2))


def node(name: str, parent: int, **changes: Any) -> dict[str, Any]:
    return {"name": name, "parent": parent, "motion": STILL, "rotation": UNTURNED} | changes


def kepler(gm: float = GM, frame: str = "icrf", body: str | None = None, **el: float) -> Any:
    return {
        "kind": "kepler",
        "gm": gm,
        "elements": elements(**el),
        "frame": frame,
        "parent_body": body,
    }


def kepler_states(el: dict[str, Any], gm: float, t_s: np.ndarray) -> np.ndarray:
    spec = {"kind": "kepler", "gm": gm, "elements": el, "frame": "icrf"}
    return _core.Propagator(spec, J2000, 0.0).states(t_s)


def tree_poses(nodes: list[dict[str, Any]], day: float, fraction: float, t_s: Any) -> np.ndarray:
    """Poses of nodes whose motion may be the specification of a propagator."""
    ready = []
    for one in nodes:
        motion = one["motion"]
        if isinstance(motion, dict) and motion["kind"] == "kepler":
            motion = _core.Propagator(motion, day, fraction)
        ready.append(one | {"motion": motion})
    return _core.Tree(ready, day, fraction).states(t_s)[0]


# --- reference data ----------------------------------------------------------------------------


def two_body_rows(folder: Path) -> Iterator[dict[str, float]]:
    with (folder / "orbits/reference/two_body.csv").open() as file:
        for row in csv.DictReader(file):
            yield {key: float(value) for key, value in row.items() if key != "body"}


def test_two_body_table(data_dir: Path) -> None:
    """States up to 30 days on: position and velocity to 1e-12 + 4 eps n |dt|."""
    count = 0
    for row in two_body_rows(data_dir):
        gm, a, e = row["mu_km3_s2"] * 1e9, row["a_km"] * 1e3, row["e"]
        n = math.sqrt(gm / a**3)
        half = math.radians(row["nu0_deg"]) / 2
        anomaly = 2 * math.atan2(
            math.sqrt(1 - e) * math.sin(half), math.sqrt(1 + e) * math.cos(half)
        )
        el = {
            "periapsis_m": a * (1 - e),
            "eccentricity": e,
            "inclination_rad": math.radians(row["i_deg"]),
            "raan_rad": math.radians(row["raan_deg"]),
            "arg_periapsis_rad": math.radians(row["argp_deg"]),
            "since_periapsis_s": (anomaly - e * math.sin(anomaly)) / n,
        }
        state = kepler_states(el, gm, np.array([row["dt_s"]]))[0]
        tolerance = 1e-12 + 4 * EPS * n * abs(row["dt_s"])
        for got, keys in ((state[:3], "x y z"), (state[3:], "vx vy vz")):
            expected = np.array([row[key] * 1e3 for key in keys.split()])
            error = np.linalg.norm(got - expected) / np.linalg.norm(expected)
            assert error <= tolerance, (row, keys, error)
        count += 1
    assert count == 49


def test_kepler_equation_table(data_dir: Path) -> None:
    """Places on the unit ellipse for any mean anomaly; the error is that of the phase M."""
    with (data_dir / "orbits/reference/kepler_equation.csv").open() as file:
        rows = [{key: float(value) for key, value in row.items()} for row in csv.DictReader(file)]
    assert len(rows) == 216
    for row in rows:
        e, anomaly = row["e"], row["E_rad"]
        el = dict.fromkeys(elements(), 0.0) | {"periapsis_m": 1 - e, "eccentricity": e}
        x, y, z = kepler_states(el, 1.0, np.array([row["M_rad"]]))[0, :3]
        # 1 - e as a double is not 1 - e of the table's decimals: (eps/2)/(1 - e) of a phase near
        # periapsis, where dE/dM is 1/(1 - e cos E); elsewhere both factors are of order one.
        stretch = 1 / (1 - e * math.cos(anomaly))
        tolerance = 4 * EPS * (1 + abs(row["M_rad"])) * stretch
        assert abs(x - (math.cos(anomaly) - e)) <= tolerance, row
        assert abs(y - math.sqrt((1 - e) * (1 + e)) * math.sin(anomaly)) <= tolerance, row
        assert z == 0.0


# Bodies whose model is the one behind SPICE's file. Mercury's pole and rate, and Neptune's rate,
# were revised in 2015: the tolerances are the sizes of those revisions.
NAIF_DEG = dict.fromkeys(
    ("venus", "earth", "moon", "mars", "jupiter", "saturn", "uranus"), (5e-6, 1e-9)
) | {"mercury": (2e-3, 0.1), "neptune": (5e-6, 180.0)}


def test_naif_matrices(data_dir: Path) -> None:
    """Body-fixed to ICRF matrices of SPICE, nine bodies, four dates: pole and prime meridian."""
    seen = dict.fromkeys(NAIF_DEG, 0)
    for line in (data_dir / "orbits/naif/IAU-pole-NAIF.txt").read_text().splitlines():
        fields = line.split()
        if len(fields) != 15 or fields[2].lower() not in seen:
            continue
        name = fields[2].lower()
        expected = np.array([float(x) for x in fields[6:]]).reshape(3, 3)
        days = np.array([float(fields[1]) / 86400])
        got = matrix(_core.body_orientation(name, J2000, days)[0])
        d = expected.T @ got
        pole = math.degrees(math.hypot(d[0, 2], d[1, 2]))
        meridian = math.degrees(math.atan2(d[1, 0] - d[0, 1], d[0, 0] + d[1, 1]))
        assert pole <= NAIF_DEG[name][0], line
        assert abs(meridian) <= NAIF_DEG[name][1], line
        seen[name] += 1
    assert set(seen.values()) == {4}


# --- orientation -------------------------------------------------------------------------------


@pytest.mark.parametrize("year", range(2000, 2036, 5))
def test_earth_orientation_against_erfa(year: int) -> None:
    """The IAU's simple model of Earth against precession, nutation and Earth rotation: 0.15 deg."""
    for day in range(0, 365, 30):
        jd = 2451544.5 + 365.25 * (year - 2000) + day
        tt = (jd, 69.184 / 86400)
        celestial_to_terrestrial = erfa.c2t06a(*tt, jd, 0.0, 0.0, 0.0)
        got = matrix(_core.body_orientation("earth", *(tt[0], np.array([tt[1]])))[0])
        assert angle_deg(celestial_to_terrestrial.T, got) < 0.15


def test_orientation_at_epoch() -> None:
    """The series of Moon, Europa and Phobos at J2000, summed with 40 digits (degrees)."""
    for name, ra, dec in (
        ("moon", 266.857733444955, 65.641102747845),
        ("europa", 268.03980652405, 64.961246022088),
        ("phobos", 318.00280838105, 53.942651587447),
    ):
        a, d = math.radians(ra), math.radians(dec)
        pole = matrix(_core.body_orientation(name, J2000, np.zeros(1))[0])[:, 2]
        expected = [math.cos(d) * math.cos(a), math.cos(d) * math.sin(a), math.sin(d)]
        assert np.allclose(pole, expected, rtol=0, atol=1e-13)


def test_bodies_table() -> None:
    bodies = _core.BODIES
    expected = "sun mercury venus earth moon mars phobos europa jupiter saturn uranus neptune"
    assert set(bodies) == set(expected.split())
    for name, body in bodies.items():
        a, b, c = body["radii_m"]
        assert a >= b >= c > 0
        assert body["gm_m3_s2"] > 0
        assert (body["parent"] is None) == (name == "sun")
        assert body["parent"] is None or bodies[body["parent"]]["gm_m3_s2"] > body["gm_m3_s2"]
        assert body["orientation"] is True
        # a slip of a unit or digit in GM or a radius shows in the density, kg/m3
        density = body["gm_m3_s2"] / 6.6743e-11 / (4 / 3 * math.pi * a * b * c)
        assert 600 < density < 5600
        assert 0 <= body["geometric_albedo"] < 1
        assert 0 <= body["bond_albedo"] < 1


# --- two-body motion ---------------------------------------------------------------------------

conics = st.fixed_dictionaries(
    {
        "periapsis_m": st.floats(1e6, 1e9),
        "eccentricity": st.one_of(st.floats(0, 3), st.sampled_from([0.0, 1.0, 1 - 1e-15, 1e-13])),
        "inclination_rad": st.floats(0, math.pi),
        "raan_rad": st.floats(-7, 7),
        "arg_periapsis_rad": st.floats(-7, 7),
        "since_periapsis_s": st.floats(-1e5, 1e5),
    }
)


@given(el=conics, t=st.floats(-1e6, 1e6))
def test_energy_and_momentum(el: dict[str, float], t: float) -> None:
    state = kepler_states(el, GM, np.array([0.0, t]))
    q, e = el["periapsis_m"], el["eccentricity"]
    for r, v in ((s[:3], s[3:]) for s in state):
        potential = 2 * GM / np.linalg.norm(r)
        kinetic = v @ v
        assert abs(kinetic - potential - GM * (e - 1) / q) <= 1e-13 * (kinetic + potential)
        h = np.cross(r, v)
        expected = math.sqrt(GM * q * (1 + e))
        # the rounding of cross products grows with how nearly parallel r and v are
        size = np.linalg.norm(r) * np.linalg.norm(v)
        i, node_angle = el["inclination_rad"], el["raan_rad"]
        normal = [
            math.sin(i) * math.sin(node_angle),
            -math.sin(i) * math.cos(node_angle),
            math.cos(i),
        ]
        assert np.allclose(
            h, expected * np.array(normal), rtol=0, atol=1e-13 * expected + 8 * EPS * size
        )
        assert np.linalg.norm(r) >= q * (1 - 1e-14)


def elements_of(state: np.ndarray) -> dict[str, float]:
    """Classical elements by their definitions, in no way ours (Vallado, algorithm 9; Kepler's
    equation). For conics that are neither circular, equatorial nor parabolic."""
    r, v = state[:3], state[3:]
    distance, h = float(np.linalg.norm(r)), np.cross(r, v)
    towards = np.cross(v, h) / GM - r / distance
    e, size = float(np.linalg.norm(towards)), float(np.linalg.norm(h))
    node = np.array([-h[1], h[0], 0.0])
    nu = math.atan2(h @ np.cross(towards, r) / size, towards @ r)
    q = size * size / GM / (1 + e)
    if e < 1:
        anomaly = 2 * math.atan2(
            math.sqrt(1 - e) * math.sin(nu / 2), math.sqrt(1 + e) * math.cos(nu / 2)
        )
        mean = anomaly - e * math.sin(anomaly)
    else:
        anomaly = 2 * math.atanh(math.sqrt((e - 1) / (e + 1)) * math.tan(nu / 2))
        mean = e * math.sinh(anomaly) - anomaly
    return {
        "periapsis_m": q,
        "eccentricity": e,
        "inclination_rad": math.atan2(math.hypot(h[0], h[1]), h[2]),
        "raan_rad": math.atan2(node[1], node[0]),
        "arg_periapsis_rad": math.atan2(h @ np.cross(node, towards) / size, node @ towards),
        "since_periapsis_s": mean / math.sqrt(GM * abs((1 - e) / q) ** 3),
    }


@given(
    el=st.fixed_dictionaries(
        {
            "periapsis_m": st.floats(2e6, 1e8),
            "eccentricity": st.one_of(st.floats(0.05, 0.9), st.floats(1.1, 3.0)),
            "inclination_rad": st.floats(0.05, math.pi - 0.05),
            "raan_rad": st.floats(-3.1, 3.1),
            "arg_periapsis_rad": st.floats(-3.1, 3.1),
            "since_periapsis_s": st.floats(-1e4, 1e4),
        }
    )
)
def test_round_trip_of_elements(el: dict[str, float]) -> None:
    """Elements -> state -> elements, 1e-10; the state as a state -> the same one, and later too."""
    state = kepler_states(el, GM, np.zeros(1))[0]
    found = elements_of(state)
    rate = math.sqrt(GM / el["periapsis_m"] ** 3)
    period = math.inf
    if el["eccentricity"] < 1:
        period = math.tau / rate / (1 - el["eccentricity"]) ** 1.5
    for key, value in el.items():
        scale = {"periapsis_m": el["periapsis_m"], "since_periapsis_s": 1 / rate}.get(key, 1.0)
        away = found[key] - value
        if key == "since_periapsis_s" and math.isfinite(period):
            away = math.remainder(away, period)
        assert abs(away) <= 1e-10 * scale, key


@given(el=conics, t=st.floats(-1e6, 1e6))
def test_round_trip_of_states(el: dict[str, float], t: float) -> None:
    """Elements -> state, taken as a state; its state at t, taken as a state: back to the first.

    An error of eps in speed or place is one of the period, times the time; it grows far out.
    """
    spec = {"kind": "kepler", "gm": GM, "frame": "icrf"}

    def through(state: np.ndarray, *times: float) -> np.ndarray:
        path = _core.Propagator({**spec, "state": state}, 2451545.0, 0.0)
        return path.states(np.array(times))

    start = kepler_states(el, GM, np.zeros(1))[0]
    here, there = through(start, 0.0, t)
    back = through(there, -t)[0]
    q = el["periapsis_m"]
    size = [float(np.linalg.norm(s[:3])) for s in (start, there)]
    assert np.linalg.norm(here - start) <= 1e-13 * np.linalg.norm(start)
    phase = math.sqrt(GM / q**3) * (abs(t) + abs(el["since_periapsis_s"]))
    bound = (1e-10 + 16 * EPS * phase) * max(size) / q
    assert np.linalg.norm(back[:3] - start[:3]) <= bound * max(size)


@given(el=conics, turns=st.integers(-1000, 1000))
def test_period(el: dict[str, float], turns: int) -> None:
    e = el["eccentricity"]
    assume(e < 0.9)
    period = 2 * math.pi * math.sqrt((el["periapsis_m"] / (1 - e)) ** 3 / GM)
    start, later = kepler_states(el, GM, np.array([0.0, turns * period]))
    # phase error of rounding `period` and the time, times the largest speed in phase
    phase = 8 * EPS * (1 + abs(turns) * 2 * math.pi + abs(el["since_periapsis_s"]) / period)
    stretch = (1 + e) / (1 - e) ** 2
    assert np.linalg.norm(later[:3] - start[:3]) <= phase * stretch * np.linalg.norm(start[:3])


@given(el=conics, t=st.floats(-1e5, 1e5))
def test_velocity_is_the_derivative(el: dict[str, float], t: float) -> None:
    step = 1e-3 * math.sqrt(el["periapsis_m"] ** 3 / GM)
    a, b, c = kepler_states(el, GM, np.array([t - step, t, t + step]))
    speed = np.linalg.norm(b[3:])
    # third derivative of position times step^2/6, and the rounding of positions over the step
    bound = 1e-6 * speed * (1 + el["eccentricity"]) + 8 * EPS * np.linalg.norm(b[:3]) / step
    bound += 8 * EPS * (abs(t) + 1e5) / step * speed
    assert np.linalg.norm((c[:3] - a[:3]) / (2 * step) - b[3:]) <= bound


@pytest.mark.parametrize(
    ("changes", "gm", "text"),
    [
        ({"periapsis_m": 0.0}, GM, "periapsis_m is 0"),
        ({"eccentricity": -0.1}, GM, "eccentricity is -0.1"),
        ({"raan_rad": math.nan}, GM, "raan_rad is nan"),
        ({}, -1.0, "gm is -1"),
        ({"eccentricity": "round"}, GM, "eccentricity"),
    ],
)
def test_bad_elements(changes: dict[str, Any], gm: float, text: str) -> None:
    with pytest.raises((ValueError, TypeError), match=text):
        kepler_states(elements(**changes), gm, np.zeros(1))


def test_bad_times_and_keys() -> None:
    with pytest.raises(ValueError, match="time 1 is inf, but must be finite"):
        kepler_states(elements(), GM, np.array([0.0, math.inf]))
    with pytest.raises(ValueError, match="t_s has 2 dimensions"):
        kepler_states(elements(), GM, np.zeros((2, 2)))
    incomplete = elements()
    del incomplete["raan_rad"]
    with pytest.raises(ValueError, match="kepler: the key 'raan_rad' is missing"):
        kepler_states(incomplete, GM, np.zeros(1))
    with pytest.raises(ValueError, match="no body named 'erth'; allowed: sun, mercury"):
        _core.body_orientation("erth", J2000, np.zeros(1))
    assert kepler_states(elements(), GM, np.zeros(0)).shape == (0, 6)


# --- the tree ----------------------------------------------------------------------------------


def test_tree_of_three_levels() -> None:
    lunar = kepler(gm=4.9e12, periapsis_m=1.8e6)
    moon = kepler(periapsis_m=3.6e8, eccentricity=0.05)
    nodes = [
        node("lro", 2, motion=lunar, rotation={"frame": "lvlh"}),
        node("earth", -1, rotation={"frame": "body", "body": "earth"}),
        node("moon", 1, motion=moon, rotation={"frame": "body", "body": "moon"}),
    ]
    t = np.array([0.0, 1e3, -4e4])
    poses = tree_poses(nodes, 2461000.5, 0.25, t)
    assert poses.shape == (3, 3, 7)
    moon_states = kepler_states(moon["elements"], moon["gm"], t)
    lro_states = kepler_states(lunar["elements"], lunar["gm"], t)
    assert np.all(poses[:, 1, :3] == 0)
    assert np.array_equal(poses[:, 2, :3], moon_states[:, :3])
    assert np.array_equal(poses[:, 0, :3], moon_states[:, :3] + lro_states[:, :3])
    for name, column in (("earth", 1), ("moon", 2)):
        assert np.array_equal(
            poses[:, column, 3:], _core.body_orientation(name, 2461000.5, 0.25 + t / 86400)
        )
    for pose, state in zip(poses[:, 0], lro_states, strict=True):
        axes = matrix(pose[3:])
        normal = np.cross(state[:3], state[3:])
        assert np.allclose(axes[:, 2], -state[:3] / np.linalg.norm(state[:3]), rtol=0, atol=1e-14)
        assert np.allclose(axes[:, 1], -normal / np.linalg.norm(normal), rtol=0, atol=1e-14)


def test_equator_frame() -> None:
    """An orbit of inclination 0 on Saturn's equator is normal to Saturn's pole."""
    motion = kepler(3.79e16, "equator", "saturn", inclination_rad=0.0, periapsis_m=1.2e8)
    nodes = [node("saturn", -1), node("cassini", 0, motion=motion)]
    poses = tree_poses(nodes, 2461000.5, 0.0, np.linspace(0, 1e5, 50))
    pole = matrix(_core.body_orientation("saturn", 2461000.5, np.zeros(1))[0])[:, 2]
    r = poses[:, 1, :3]
    assert np.max(np.abs(r @ pole) / np.linalg.norm(r, axis=1)) < 1e-14


@given(rate=st.floats(-1, 1), t=st.floats(-1e6, 1e6))
def test_spin(rate: float, t: float) -> None:
    """The axis stays, in both frames; the angle is rate * t; unit norm."""
    q = np.array([0.3, -0.5, 0.7, 0.2])
    spin = {"frame": "inertial", "q": q, "axis": (0.0, 0.0, 2.0), "rate_rad_s": rate}
    poses = tree_poses([node("x", -1, rotation=spin)], J2000, 0.0, np.array([0.0, t]))
    start, later = (matrix(p[0, 3:]) for p in poses)
    assert np.allclose(np.linalg.norm(poses[:, 0, 3:], axis=1), 1, rtol=0, atol=4 * EPS)
    assert np.allclose(start[:, 2], later[:, 2], rtol=0, atol=1e-15)
    turned = start.T @ later
    angle = math.atan2(turned[1, 0], turned[0, 0])
    assert abs(math.remainder(angle - math.remainder(rate * t, math.tau), math.tau)) < 1e-9


@given(data=st.data(), count=st.integers(2, 30))
def test_cycles_are_named(data: st.DataObject, count: int) -> None:
    """Random parents: a cycle is reported exactly when there is one, and the text walks it."""
    parents = [data.draw(st.integers(-1, count - 1)) for _ in range(count)]
    nodes = [node(f"n{i}", parent) for i, parent in enumerate(parents)]

    def reaches_root(i: int) -> bool:
        for _ in range(count + 1):
            if i < 0:
                return True
            i = parents[i]
        return False

    if all(reaches_root(i) for i in range(count)):
        assert tree_poses(nodes, J2000, 0.0, np.zeros(1)).shape == (1, count, 7)
        return
    with pytest.raises(ValueError, match=r"^cycle of parents: ") as caught:
        tree_poses(nodes, J2000, 0.0, np.zeros(1))
    walk = [int(name[1:]) for name in str(caught.value).split(": ")[1].split(" -> ")]
    assert walk[0] == walk[-1]
    assert len(set(walk)) == len(walk) - 1
    assert all(parents[a] == b for a, b in itertools.pairwise(walk))


@pytest.mark.parametrize(
    ("changes", "text"),
    [
        ({"parent": 9}, "node 'iss': parent 9 does not exist; allowed: -1 to 1"),
        ({"parent": -1, "motion": kepler()}, "node 'iss': an orbit needs a parent"),
        ({"motion": {"kind": "orbit"}}, "kind is 'orbit'; allowed: fixed, given"),
        ({"motion": 3.0}, "node 'iss': motion: must be a perilune._core.Propagator"),
        ({"motion": {"kind": "given", "slot": -1}}, "slot is -1, but must not be negative"),
        ({"motion": {"kind": "given", "slot": 0}}, "takes slot 0 of the given states"),
        ({"motion": kepler(frame="equator")}, "'equator' needs parent_body"),
        ({"motion": kepler(frame="equator", body="terra")}, "no body named 'terra'"),
        ({"motion": kepler(periapsis_m=-1.0)}, "kepler: periapsis_m is -1"),
        ({"motion": {"kind": "fixed", "position_m": (1, 2)}}, "position_m has 2 numbers"),
        ({"rotation": {"frame": "roll"}}, "frame is 'roll'; allowed: inertial, body, parent, lvlh"),
        ({"rotation": {"frame": "body"}}, "node 'iss': rotation: the key 'body' is missing"),
        ({"rotation": {"frame": "lvlh"}}, "node 'iss': lvlh: the object is at its parent's centre"),
        ({"rotation": {"frame": "inertial", "q": (0, 0, 0, 0)}}, "q must be finite and not zero"),
        ({"rotation": {"frame": "sun", "towards": 7}}, "'iss': the node 7 to point at does not"),
        ({"rotation": {"frame": "sun", "towards": 1}}, "'iss': it cannot point at itself"),
        ({"rotation": {"frame": "sun", "towards": 0}}, "'iss': it stands where it is to point at"),
        ({"rotation": {"frame": "given", "slot": 0}}, "'iss': takes slot 0 of the given quat"),
    ],
)
def test_bad_nodes(changes: dict[str, Any], text: str) -> None:
    nodes = [node("earth", -1), node("iss", 0) | changes]
    with pytest.raises((ValueError, TypeError), match=text):
        tree_poses(nodes, J2000, 0.0, np.zeros(1))


def test_epochs_must_agree() -> None:
    motion = _core.Propagator(kepler(), J2000, 0.5)
    with pytest.raises(ValueError, match="node 'iss': motion: the propagator's epoch is not"):
        _core.Tree([node("earth", -1), node("iss", 0, motion=motion)], J2000, 0.25)


# --- random words ------------------------------------------------------------------------------

words = st.integers(0, 2**64 - 1)


@given(
    key=st.tuples(words, words),
    counter=st.tuples(*[st.one_of(words, st.just(2**64 - 1))] * 4),
    count=st.integers(0, 20),
)
def test_philox_is_numpy(key: Any, counter: Any, count: int) -> None:
    def array(values: Any) -> np.ndarray:
        return np.array(values, dtype=np.uint64)

    expected = np.random.Philox(key=array(key), counter=array(counter)).random_raw(count)
    got = _core.philox(key, counter, count)
    assert got.dtype == np.uint64
    assert np.array_equal(got, expected)


def test_philox_arguments() -> None:
    with pytest.raises(ValueError, match="count is -1"):
        _core.philox((1, 2), (0, 0, 0, 0), -1)
    with pytest.raises(OverflowError):
        _core.philox((1, 2**64), (0, 0, 0, 0), 1)
