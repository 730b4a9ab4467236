"""The numerical propagator against SciPy's DOP853 on forces written again in NumPy, the forces
against SciPy's special functions, and the integrator's numbers against SciPy's."""

from __future__ import annotations

import math
import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st
from scipy import integrate, special
from scipy.integrate._ivp import dop853_coefficients as book

from perilune import _core

EPOCH = (2459000.0, 0.5)
GM = 398600.4418e9
RADIUS = 6378137.0
J = (1.0826266835531513e-3, -2.5326564853322355e-6, -1.619621591367e-6, -2.27e-7, 5.4e-7)
UPRIGHT = (1.0, 0.0, 0.0, 0.0)
SPIN = 7.292115e-5
AU = 149597870700.0
SUN = {
    "kind": "kepler", "gm": 1.32712440018e20, "frame": "icrf",
    "state": [1.2e11, 7.5e10, 3.3e10, -1.6e4, 2.3e4, 1.0e4],
}  # fmt: skip
MOON = {
    "kind": "kepler", "gm": 4.03503e14, "frame": "icrf",
    "state": [3.2e8, 1.8e8, 8.0e7, -500.0, 780.0, 350.0],
}  # fmt: skip
GM_SUN, GM_MOON = 1.32712440018e20, 4.9028e12


def propagator(state: Any, forces: Any = (), rtol: float = 1e-13, **keys: Any) -> _core.Propagator:
    spec = {"kind": "numerical", "gm": GM, "state": state, "rtol": rtol, "forces": forces, **keys}
    return _core.Propagator(spec, *EPOCH)


def test_the_books_numbers(repo_dir: Path) -> None:
    """SciPy's tables are the book's too; ours hold the same doubles."""
    text = (repo_dir / "csrc" / "orbit" / "dop853_table.h").read_text().split("pl_dop853_node")[1]
    number = r"-?\d+\.\d+(?:e-?\d+)?"
    ours = [float(value) for value in re.findall(number, text)]
    rows = [book.C, *(row[row != 0.0] for row in book.A)]
    rows += [row[row != 0.0] for row in (book.E5, book.E3, *book.D)]
    np.testing.assert_array_equal(ours, np.concatenate(rows))


def zonal(r: np.ndarray) -> np.ndarray:
    """Gradient of -gm/r sum J_n (R/r)^n P_n(z/r), with NumPy's Legendre series."""
    d = np.linalg.norm(r)
    up, pole = r / d, np.array([0.0, 0.0, 1.0])
    s = r[2] / d
    a = np.zeros(3)
    for n, j in enumerate(J, 2):
        p = np.polynomial.legendre.Legendre.basis(n)
        k = GM * j * RADIUS**n / d ** (n + 2)
        a += k * ((n + 1) * p(s) * up - p.deriv()(s) * (pole - s * up))
    return a


def direct(gm: float, r: np.ndarray, s: np.ndarray) -> np.ndarray:
    """The third body's pull in extended precision, as the plain difference of two pulls."""
    r, s = r.astype(np.longdouble), s.astype(np.longdouble)
    d = s - r
    return (gm * (d / (d @ d) ** 1.5 - s / (s @ s) ** 1.5)).astype(float)


def lit_fraction(r: np.ndarray, sun: np.ndarray) -> float:
    """Visible part of the Sun's disc by quadrature over its chords, not by the lens formula."""
    to = sun - r
    a = math.asin(695700e3 / np.linalg.norm(to))
    b = math.asin(RADIUS / np.linalg.norm(r))
    c = math.atan2(np.linalg.norm(np.cross(to, -r)), to @ -r)
    if c >= a + b:
        return 1.0
    if c <= b - a:
        return 0.0
    y, weight = special.roots_legendre(200)  # chords at right angles to the line of centres
    y = y * math.pi / 2
    height, step = a * np.sin(y), a * np.cos(y) * weight * math.pi / 2
    half = a * np.cos(y)
    edge = c - np.sqrt(np.maximum(b * b - height * height, 0.0))
    # Of the chord from -half to half what lies on the far side of the planet's edge is lit.
    return float((np.clip(edge + half, 0.0, 2 * half) * step).sum() / (math.pi * a * a))


def drag(r: np.ndarray, v: np.ndarray) -> np.ndarray:
    """One exponential layer over a sphere."""
    wind = v - np.cross([0.0, 0.0, SPIN], r)
    rho = 4e-12 * math.exp(-(np.linalg.norm(r) - RADIUS - 400e3) / 60e3)
    return -0.5 * rho * 2.2 * 0.02 * np.linalg.norm(wind) * wind


Field = Callable[[float, np.ndarray, np.ndarray], np.ndarray]
_MOTIONS = {"sun": SUN, "moon": MOON}
_AIR = [[300e3, 4e-12 * math.exp(100 / 60), 60e3]]
CASES: dict[str, tuple[list[dict[str, Any]], Field]] = {
    "two-body": ([], lambda t, r, v: np.zeros(3)),
    "zonal": (
        [{"kind": "zonal", "q": UPRIGHT, "radius_m": RADIUS, "j": J}],
        lambda t, r, v: zonal(r),
    ),
    "third bodies": (
        [
            {"kind": "third_body", "gm": GM_SUN, "motion": "sun"},
            {"kind": "third_body", "gm": GM_MOON, "motion": "moon"},
        ],
        lambda t, r, v: (
            direct(GM_SUN, r, place("sun", t)) + direct(GM_MOON, r, place("moon", t))
        ),
    ),
    "drag": (
        [
            {
                "kind": "drag", "q": UPRIGHT, "rate_rad_s": SPIN, "area_to_mass_m2_kg": 0.02,
                "cd": 2.2, "radii_m": [RADIUS, RADIUS], "air": _AIR,
            }
        ],
        lambda t, r, v: drag(r, v),
    ),
}  # fmt: skip
_PLACES = {name: _core.Propagator(spec, *EPOCH) for name, spec in _MOTIONS.items()}


def place(name: str, t: float) -> np.ndarray:
    return _PLACES[name].states(np.array([t]))[0, :3]


STARTS = {
    "low": np.array([6778e3, 0.0, 0.0, 0.0, 4500.0, 6200.0]),
    "eccentric": np.array([7000e3, 1000e3, -500e3, -500.0, 9500.0, 2000.0]),
}


@pytest.mark.parametrize("start", STARTS)
@pytest.mark.parametrize("case", CASES)
def test_against_scipy(case: str, start: str) -> None:
    """A quarter of a day both ways: the integrators differ by less than 0.1 mm."""
    forces, field = CASES[case]
    ours = propagator(STARTS[start], forces, motions=_MOTIONS)

    def rate(t: float, y: np.ndarray) -> np.ndarray:
        r, v = y[:3], y[3:]
        a = -GM * r / (r @ r) ** 1.5 + field(t, r, v)
        return np.concatenate([v, a])

    times = np.linspace(0.0, 21600.0, 37)
    for sign in (1.0, -1.0):
        theirs = integrate.solve_ivp(
            rate, (0.0, sign * 21600.0), STARTS[start], "DOP853", sign * times, rtol=1e-13,
            atol=[1e-7] * 3 + [1e-10] * 3,
        )  # fmt: skip
        apart = np.linalg.norm(ours.states(sign * times)[:, :3] - theirs.y[:3].T, axis=1)
        assert apart.max() < 1e-4, f"{case}, {start}: {apart.max()} m"
        if case != "two-body":  # the force is there: without it the orbit is elsewhere
            plain = propagator(STARTS[start]).states(sign * times)[:, :3]
            assert np.linalg.norm(plain - theirs.y[:3].T, axis=1).max() > 0.1


def acceleration(forces: Any, r: np.ndarray, v: np.ndarray, **keys: Any) -> np.ndarray:
    """What the forces add to the point mass at a place, from the second difference of positions
    that a very short step gives: (r(h) - 2 r + r(-h))/h^2 - the same without forces."""
    h = 1.0
    state = np.concatenate([r, v])
    t = np.array([-h, h])
    with_forces = propagator(state, forces, 1e-15, **keys).states(t)
    without = propagator(state, [], 1e-15, **keys).states(t)
    return (with_forces - without)[:, :3].sum(axis=0) / h**2


@pytest.mark.parametrize("behind_m", [2.6e6, 3e7])
def test_penumbra_by_quadrature(behind_m: float) -> None:
    """Push through the penumbra against the area of the Sun's disc by quadrature."""
    direction = np.array([0.3, -0.5, 0.1])
    direction /= np.linalg.norm(direction)
    sun = {"kind": "kepler", "gm": 1e-3, "frame": "icrf",
           "state": [*(direction * AU), 0.0, 1e-9, 0.0]}  # fmt: skip
    aside = np.cross(direction, [0.0, 0.0, 1.0])
    aside /= np.linalg.norm(aside)
    push = {"kind": "radiation_pressure", "area_to_mass_m2_kg": 1e5, "cr": 1.0,
            "radius_m": RADIUS, "motion": "sun"}  # fmt: skip
    width = behind_m * 695700e3 / AU
    got, expected = [], []
    for offset in np.linspace(-1.2 * width, 1.2 * width, 13):
        r = -behind_m * direction + aside * (RADIUS + offset)
        full = 1361.0 / 299792458.0 * 1e5 * (AU / np.linalg.norm(direction * AU - r)) ** 2
        a = acceleration([push], r, np.zeros(3), motions={"sun": sun})
        got.append(-a @ direction / full)
        expected.append(lit_fraction(r, direction * AU))
    assert min(expected) == 0.0
    assert max(expected) == 1.0
    # The object falls by 5 m or less while the acceleration is measured: 5 m of the width.
    np.testing.assert_allclose(got, expected, atol=5.0 / width + 1e-5)


def harmonic_potential(c: Any, s: Any, degree: int, gm: float, radius: float) -> Any:
    """The potential by SciPy's associated Legendre functions, latitude and longitude."""

    def at(r: np.ndarray) -> float:
        d = math.sqrt(r @ r)
        lon, z = math.atan2(r[1], r[0]), r[2] / d
        total = 0.0
        for n in range(1, degree + 1):
            for m in range(n + 1):
                norm = math.sqrt(
                    (2 if m else 1) * (2 * n + 1) * math.factorial(n - m) / math.factorial(n + m)
                )
                p = (-1) ** m * special.lpmv(m, n, z) * norm
                k = n * (n + 1) // 2 + m
                total += (
                    (radius / d) ** n * p * (c[k] * math.cos(m * lon) + s[k] * math.sin(m * lon))
                )
        return gm / d * total

    return at


@settings(max_examples=25)
@given(
    seed=st.integers(0, 2**31),
    degree=st.integers(2, 12),
    latitude=st.floats(-1.5, 1.5),
    longitude=st.floats(-3.1, 3.1),
    distance=st.floats(1.01, 6.0),
)
def test_harmonics_against_scipy(
    seed: int, degree: int, latitude: float, longitude: float, distance: float
) -> None:
    """Any field, anywhere: the work from one place to another is the difference of SciPy's
    potential. Energy ties acceleration to potential without a difference quotient's error."""
    rng = np.random.default_rng(seed)
    count = (degree + 1) * (degree + 2) // 2
    c, s = rng.normal(size=count) * 1e-5, rng.normal(size=count) * 1e-5
    force = {"kind": "harmonics", "q": UPRIGHT, "radius_m": RADIUS, "c": c, "s": s}
    potential = harmonic_potential(c, s, degree, GM, RADIUS)
    r = distance * RADIUS * np.array([
        math.cos(latitude) * math.cos(longitude),
        math.cos(latitude) * math.sin(longitude),
        math.sin(latitude),
    ])  # fmt: skip
    v = rng.normal(size=3) * 3e3
    v -= min(v @ r, 0.0) / (r @ r) * r  # not down: deep inside, high degrees have no bounds
    states = propagator(np.concatenate([r, v]), [force]).states(np.linspace(0.0, 600.0, 5))
    energy = [0.5 * y[3:] @ y[3:] - GM / np.linalg.norm(y[:3]) - potential(y[:3]) for y in states]
    # Of the harmonics' own 1e-5 of gm/r eight digits are seen.
    assert np.ptp(energy) < 1e-13 * GM / np.linalg.norm(r) * (1.0 + 10.0 * degree)


def test_pole_overflight() -> None:
    """An orbit through the pole's axis, in a field of all orders, keeps its energy: nothing is
    divided by the cosine of the latitude."""
    rng = np.random.default_rng(5)
    c, s = rng.normal(size=91) * 1e-6, rng.normal(size=91) * 1e-6
    force = {"kind": "harmonics", "q": UPRIGHT, "radius_m": RADIUS, "c": c, "s": s}
    potential = harmonic_potential(c, s, 12, GM, RADIUS)
    start = np.array([0.0, 0.0, 7000e3, 7500.0, 0.0, 0.0])
    states = propagator(start, [force]).states(np.linspace(0.0, 60000.0, 200))
    assert np.abs(states[:, 2]).max() > 6.99e6
    energy = np.array([
        0.5 * y[3:] @ y[3:] - GM / np.linalg.norm(y[:3]) - potential(y[:3]) for y in states[1:]
    ])  # fmt: skip
    assert np.ptp(energy) < 1e-12 * abs(energy[0])


@settings(max_examples=30)
@given(
    t=st.lists(st.floats(-3e5, 3e5), min_size=1, max_size=8),
    tilt=st.floats(0.0, math.pi),
    speed=st.floats(0.9, 1.3),
)
def test_zonal_invariants(t: list[float], tilt: float, speed: float) -> None:
    """Zonal fields keep the energy and the angular momentum about the pole; single and joint calls
    give the same bits."""
    v = speed * math.sqrt(GM / 8000e3)
    start = np.array([8000e3, 0.0, 0.0, 0.0, v * math.cos(tilt), v * math.sin(tilt)])
    force = {"kind": "zonal", "q": UPRIGHT, "radius_m": RADIUS, "j": J[:1]}

    def energy(y: np.ndarray) -> float:
        d = np.linalg.norm(y[:3])
        j2 = GM * J[0] * RADIUS**2 / d**3 * 0.5 * (3 * (y[2] / d) ** 2 - 1)
        return float(0.5 * y[3:] @ y[3:] - GM / d + j2)

    orbit = propagator(start, [force])
    states = orbit.states(np.array(t))
    for y in states:
        assert energy(y) == pytest.approx(energy(start), rel=1e-10)
        hz, hz0 = np.cross(y[:3], y[3:])[2], np.cross(start[:3], start[3:])[2]
        assert abs(hz - hz0) < 1e-10 * 8000e3 * v
    alone = [propagator(start, [force]).states(np.array([x]))[0] for x in t[::-1]]
    np.testing.assert_array_equal(states, alone[::-1])


@settings(max_examples=20)
@given(seed=st.integers(0, 2**31), span=st.floats(1e3, 2e5))
def test_time_reversal(seed: int, span: float) -> None:
    """There, and from there back: the start, within ten times what the tolerance allows a day."""
    rng = np.random.default_rng(seed)
    r = rng.normal(size=3)
    r *= 9000e3 / np.linalg.norm(r)
    v = np.cross(r, rng.normal(size=3))
    v *= math.sqrt(GM / 9000e3) / np.linalg.norm(v)
    force = {"kind": "zonal", "q": UPRIGHT, "radius_m": RADIUS, "j": J}
    there = propagator(np.concatenate([r, v]), [force]).states(np.array([span]))[0]
    back = propagator(there, [force]).states(np.array([-span]))[0]
    assert np.linalg.norm(back[:3] - r) < 1e-9 * 9000e3
