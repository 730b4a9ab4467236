"""Eclipses: other integrals of the same light, orbits, and what the renderer makes of it."""

from __future__ import annotations

import math
from itertools import pairwise
from pathlib import Path
from typing import Any

import erfa
import mpmath
import numpy as np
import pytest
from hypothesis import given, settings, strategies as st
from numpy.typing import NDArray
from scipy.optimize import brentq
from tests.hard.glb import write_glb

import perilune
from perilune import _core
from perilune.orbits.solar_system import date_from_utc

F64 = NDArray[np.float64]
AU = 149597870700.0
SUN = 695700e3
A = mpmath.asin(mpmath.mpf(SUN) / mpmath.mpf(AU))
"""Angular radius of the Sun at 1 au."""
SMALL = 1737400.0
NECKEL = (
    (0.75267, -0.265577, 0.0), (0.93874, 0.265577, -0.004095), (-1.89287, 0.0, 0.012582),
    (2.42234, 0.0, -0.017117), (-1.7115, 0.0, 0.011977), (0.49062, 0.0, -0.003347),
)  # fmt: skip
"""Neckel (2005), Solar Physics 229, 13."""


def law(um: float) -> list[Any]:
    """Coefficients of mu^k; an even disc for 0."""
    if um == 0.0:
        return [mpmath.mpf(1)]
    return [mpmath.mpf(a) + mpmath.mpf(b) / um + mpmath.mpf(c) / mpmath.mpf(um) ** 5
            for a, b, c in NECKEL]  # fmt: skip


def sphere(b: float, c: float, turn: float = 0.0, far: float | None = None) -> tuple[F64, float]:
    """Centre and radius of a sphere of angular radius b, c from the Sun on z, at the origin."""
    distance = SMALL / math.sin(b) if far is None else far
    place = [math.sin(c) * math.cos(turn), math.sin(c) * math.sin(turn), math.cos(c)]
    return distance * np.array(place), distance * math.sin(b)


def light(spheres: list[tuple[F64, float]], um: float = 0.0, nodes: int = 24) -> float:
    """By the core."""
    poses = np.zeros((1, len(spheres), 7))
    poses[..., 3] = 1.0
    for k, (place, _) in enumerate(spheres):
        poses[0, k, :3] = place
    radii = np.array([[r] * 3 for _, r in spheres]).reshape(-1, 3)
    sun, here = np.array([[0.0, 0.0, AU]]), np.zeros((1, 3))
    return float(_core.sunlight(here, sun, SUN, poses, radii, np.array([um]), nodes)[0][0, 0])


def by_rings(spheres: list[tuple[F64, float]], um: float = 0.0) -> Any:
    """By rings of the disc, in 30 digits: of each the arcs that the spheres hide, united.

    Between the rings where limbs touch rings or cross each other; square roots at the ends of
    these steps are taken out by a cosine."""
    mp = mpmath
    with mp.workdps(30):
        here = []
        for place, radius in spheres:
            x, y, z = (mp.mpf(float(v)) for v in place)
            far = mp.sqrt(x * x + y * y + z * z)
            b, c = mp.asin(mp.mpf(radius) / far), mp.atan2(mp.sqrt(x * x + y * y), z)
            here.append((b, c, mp.atan2(y, x), (x / far, y / far, z / far)))
        sine = mp.mpf(SUN) / mp.mpf(AU)
        ends = {mp.mpf(0), mp.mpf(1)}
        for b, c, _, _ in here:
            ends |= {mp.sin(abs(t)) / sine for t in (c - b, c + b)}
        for k, (b1, _, _, u) in enumerate(here):
            for b2, _, _, v in here[:k]:
                ends |= crossings(u, v, mp.cos(b1), mp.cos(b2), sine)
        steps = sorted(r for r in ends if 0 <= r <= 1)
        terms = law(um)

        def hidden(r: Any) -> Any:
            theta = mp.asin(r * sine)
            arcs = []
            for b, c, turn, _ in here:
                below = mp.sin(theta) * mp.sin(c)
                q = (mp.cos(b) - mp.cos(theta) * mp.cos(c)) / below if below else None
                if q is None or abs(q) >= 1:
                    if abs(theta - c) < b:
                        return mp.mpf(1)
                    continue
                half = mp.acos(q)
                start = (turn - half) % (2 * mp.pi)
                arcs += [(s, s + 2 * half) for s in (start, start - 2 * mp.pi)]
            total, at = mp.mpf(0), mp.mpf(0)
            for start, end in sorted(arcs):
                total += max(min(end, 2 * mp.pi) - max(start, at), 0)
                at = max(at, end)
            return total / (2 * mp.pi)

        def step(low: Any, high: Any) -> Any:
            def f(t: Any) -> Any:
                r = low + (high - low) * (1 - mp.cos(mp.pi * t)) / 2
                mu = mp.sqrt(1 - r * r)
                shine = sum(k * mu**i for i, k in enumerate(terms))
                return shine * r * hidden(r) * (high - low) * mp.pi * mp.sin(mp.pi * t) / 2

            return mp.quad(f, [0, 0.5, 1], maxdegree=5)

        whole = sum(k / (i + 2) for i, k in enumerate(terms))
        return 1 - sum((step(low, high) for low, high in pairwise(steps)), mp.mpf(0)) / whole


def crossings(u: Any, v: Any, cos1: Any, cos2: Any, sine: Any) -> set[Any]:
    """Radii on the disc where two circles on the sphere of directions cross."""
    mp = mpmath
    g = sum(a * b for a, b in zip(u, v, strict=True))
    if abs(g) == 1:
        return set()
    p, q = (cos1 - g * cos2) / (1 - g * g), (cos2 - g * cos1) / (1 - g * g)
    w = (u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0])
    rest = (1 - p * p - q * q - 2 * p * q * g) / (1 - g * g)
    if rest <= 0:
        return set()
    places = [[p * a + q * b + s * mp.sqrt(rest) * c for a, b, c in zip(u, v, w, strict=True)]
              for s in (1, -1)]  # fmt: skip
    return {mp.hypot(x, y) / sine for x, y, z in places if z > 0}


ANGLES = float(A)
SINGLE = {
    "total but a sliver": (1.02 * ANGLES, 0.03 * ANGLES),
    "annular": (0.97 * ANGLES, 0.02 * ANGLES),
    "equal discs": (ANGLES, 0.7 * ANGLES),
    "equal discs, at each other's limb": (ANGLES, ANGLES),
    "small, at the edge": (ANGLES / 30.0, 0.98 * ANGLES),
    "small, inside": (ANGLES / 30.0, 0.3 * ANGLES),
    "Earth from a low orbit": (1.2, 1.2023),
    "Earth, half the sun": (1.2, 1.2),
    "Earth, nearly out": (1.2, 1.2 + 0.999 * ANGLES),
    "Earth, nearly in": (1.2, 1.2 - 0.999 * ANGLES),
}


@pytest.mark.parametrize("um", [0.0, 0.55])
@pytest.mark.parametrize("case", SINGLE)
def test_one_sphere_to_1e_12(case: str, um: float) -> None:
    """Against the exact overlap on the sphere of directions."""
    spheres = [sphere(*SINGLE[case])]
    assert light(spheres, um) == pytest.approx(float(by_rings(spheres, um)), abs=1e-12)


DOUBLE = {
    "apart": ((0.4, 0.6, 0.0), (0.3, 0.7, 2.5)),
    "overlapping inside": ((0.4, 0.3, 0.0), (0.35, 0.4, 1.2)),
    "overlapping at the edge": ((0.5, 0.8, 0.1), (0.6, 0.9, 0.7)),
    "a moon at a planet's limb": ((200.0, 200.3, 0.4), (0.4, 0.35, 0.5)),
    "two limbs crossing before the sun": ((80.0, 80.2, 0.0), (60.0, 60.1, 1.9)),
}


@pytest.mark.parametrize("case", DOUBLE)
def test_two_spheres_are_not_counted_twice(case: str) -> None:
    """The union of the arcs of every ring of a darkened disc, to 1e-11."""
    um = 0.465
    spheres = [
        sphere(b * ANGLES, c * ANGLES, turn, far)
        for (b, c, turn), far in zip(DOUBLE[case], (7e9, 5e9), strict=True)
    ]
    assert light(spheres, um) == pytest.approx(float(by_rings(spheres, um)), abs=1e-11)


ELLIPSOIDS = {
    "Earth's limb at mid latitude": ((6378.137e3, 6378.137e3, 6356.752e3), (7e6, 0.8)),
    "Saturn, far": ((60268e3, 60268e3, 54364e3), (1.3e10, 0.3)),
    "Phobos from Mars": ((13e3, 11.4e3, 9.1e3), (6e6, 1.0)),
    "a needle": ((30e3, 3e3, 3e3), (9e6, 0.5)),
    "a plate": ((40e3, 40e3, 4e3), (9e6, 1.2)),
}


@pytest.mark.parametrize("case", ELLIPSOIDS)
@pytest.mark.parametrize("offset", [-0.6, 0.0, 0.4, 0.9])
def test_ellipsoids(case: str, offset: float) -> None:
    """Against spokes: on each, from the Sun's centre to its limb, the quadratic of ray and
    ellipsoid says what is hidden. 200 000 of them by the midpoint rule leave less than 1e-7."""
    radii, (far, tilt) = ELLIPSOIDS[case]
    w, (x, y, z) = math.cos(tilt / 2), math.sin(tilt / 2) * np.array([0.6, -0.48, 0.64])
    turn = np.array([
        [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
        [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
        [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
    ])  # fmt: skip
    wide = math.asin(float(np.median(radii)) / far)
    c = wide + offset * ANGLES if wide > ANGLES else abs(offset) * ANGLES
    place = far * np.array([math.sin(c), 0.0, math.cos(c)])
    to_unit = (turn / np.array(radii)).T  # root axes to those in which it is the unit sphere
    p, sine = -to_unit @ place, SUN / AU
    phi = 2.0 * np.pi * (np.arange(200_000) + 0.5) / 200_000
    along = np.stack([np.cos(phi), np.sin(phi), np.zeros_like(phi)], axis=1) @ to_unit.T
    middle = to_unit[:, 2]
    m0, m1 = np.cross(p, middle), np.cross(p, along)
    # |p x q|^2 - |q|^2 = k2 t^2 + 2 k1 t + k0 <= 0 where the ray q = middle + t along hits.
    k0, k1 = m0 @ m0 - middle @ middle, m1 @ m0 - along @ middle
    k2 = (m1 * m1).sum(axis=1) - (along * along).sum(axis=1)
    root = np.sqrt(np.maximum(k1 * k1 - k0 * k2, 0.0))
    edge = math.tan(math.asin(sine))
    cuts = np.stack([0.0 * phi, (-k1 - root) / k2, (-k1 + root) / k2, 0.0 * phi + edge])
    cuts = np.sort(np.clip(cuts, 0.0, edge), axis=0)
    hidden = np.zeros_like(phi)
    for low, high in pairwise(cuts):
        t = 0.5 * (low + high)
        ahead = (middle + t[:, None] * along) @ p < 0.0
        inside = ahead & (k2 * t * t + 2.0 * k1 * t + k0 <= 0.0)
        hidden += inside * (np.sin(np.arctan(high)) ** 2 - np.sin(np.arctan(low)) ** 2) / sine**2
    want = 1.0 - float(hidden.mean())
    pose = np.array([[[*place, w, x, y, z]]])
    got = _core.sunlight(np.zeros((1, 3)), np.array([[0.0, 0.0, AU]]), SUN, pose,
                         np.array([radii]), np.zeros(1), 24)[0][0, 0]  # fmt: skip
    assert 0.0 <= got < 1.0
    assert got == pytest.approx(want, abs=1e-7)


spots = st.tuples(
    st.floats(0.02, 300.0), st.floats(-1.05, 1.05), st.floats(0.0, 6.2), st.floats(1e8, 1e10)
)


def spot(row: tuple[float, float, float, float], grow: float = 1.0) -> tuple[F64, float]:
    b, aside, turn, far = row
    return sphere(b * grow * ANGLES, abs(b + aside) * ANGLES, turn, far)


@settings(max_examples=200, deadline=None)
@given(rows=st.lists(spots, min_size=1, max_size=4), um=st.sampled_from([0.0, 0.465, 0.612]))
def test_a_union_is_between_its_parts_and_their_sum(
    rows: list[tuple[float, float, float, float]], um: float
) -> None:
    """In [0, 1]; no more than any alone; no less than 1 minus the sum; in any order and turn."""
    spheres = [spot(row) for row in rows]
    alone = [light([one], um) for one in spheres]
    together = light(spheres, um)
    assert 0.0 <= together <= 1.0
    assert together <= min(alone) + 1e-9
    assert 1.0 - together <= sum(1.0 - one for one in alone) + 1e-9
    assert light(spheres[::-1], um) == pytest.approx(together, abs=1e-9)
    turned = [spot((b, c, turn + 1.0, far)) for b, c, turn, far in rows]
    assert light(turned, um) == pytest.approx(together, abs=1e-9)


@settings(max_examples=100, deadline=None)
@given(row=spots, more=st.floats(1.0, 1.1), um=st.sampled_from([0.0, 0.55]))
def test_a_larger_body_hides_more(
    row: tuple[float, float, float, float], more: float, um: float
) -> None:
    b, aside, turn, far = row
    c = abs(b + aside) * ANGLES
    small = light([sphere(b * ANGLES, c, turn, far)], um)
    large = light([sphere(b * more * ANGLES, c, turn, far)], um)
    assert large <= small + 1e-9


# --- orbits --------------------------------------------------------------------------------------

EPOCH = "2026-03-20T12:00:00Z"
GM = 3.986004418e14
EARTH_M = 6371e3


def low_orbit(step_s: float, axis_km: float = 6778.137, **changes: Any) -> perilune.Simulation:
    """A round Earth, a circle inclined by 51.6 degrees; the model is never read."""
    tree = {
        "version": 1,
        "time": {"epoch": EPOCH, "step_s": step_s},
        "root": "earth",
        "bodies": {"earth": {"kind": "earth", "radii_km": [6371.0] * 3, "gm_km3_s2": GM / 1e9}},
        "spacecraft": {
            "sat": {
                "model": "none.glb",
                "metres_per_unit": 1.0,
                "orbit": {
                    "around": "earth", "kind": "kepler", "frame": "icrf",
                    "semi_major_axis_km": axis_km, "eccentricity": 0.0, "inclination_deg": 51.6,
                    "raan_deg": 20.0, "arg_periapsis_deg": 0.0, "true_anomaly_deg": 0.0,
                },
            }
        },
        "camera": {"width": 16, "height": 16, "fov_deg": 10.0,
                   "trajectory": {"kind": "hover", "target": "earth", "lon_deg": 0.0,
                                  "lat_deg": 0.0, "height_m": 5e5}},
    }  # fmt: skip
    return perilune.open(tree, overrides=changes)


def satellite_m(t_s: F64, axis_m: float = 6778137.0) -> F64:
    """The circle, apart from the core."""
    u = np.sqrt(GM / axis_m**3) * t_s
    node, tilt = np.radians([20.0, 51.6])
    x = np.array([np.cos(node), np.sin(node), 0.0])
    y = np.array([-np.sin(node) * np.cos(tilt), np.cos(node) * np.cos(tilt), np.sin(tilt)])
    return np.asarray(axis_m * (np.cos(u)[:, None] * x + np.sin(u)[:, None] * y))


def sun_m(t_s: F64) -> F64:
    """From the Earth's centre: ERFA's epv00."""
    date = date_from_utc((2026, 3, 20, 12, 0, 0.0))
    rows = [-erfa.epv00(date.day, date.fraction + t / 86400.0)[0]["p"] * AU for t in t_s]
    return np.array(rows)


def limbs_apart(t: float) -> tuple[float, float, float]:
    """Angular radii of Sun and Earth, their distance, from the satellite."""
    r, sun = satellite_m(np.array([t]))[0], sun_m(np.array([t]))[0]
    to_sun = sun - r
    a = math.asin(SUN / np.linalg.norm(to_sun))
    b = math.asin(EARTH_M / np.linalg.norm(r))
    c = math.atan2(np.linalg.norm(np.cross(to_sun, -r)), -to_sun @ r)
    return a, b, c


def beyond(t: float, sign: float) -> float:
    """0 where the limbs touch: from outside (1) or from inside (-1)."""
    a, b, c = limbs_apart(t)
    return c - b - sign * a


def test_light_curve_of_a_low_orbit() -> None:
    """Entry and exit of penumbra and umbra within a step of 0.02 s of where the cones of the two
    spheres are by another computation; between them the curve of two discs; outside the
    constant over the distance squared."""
    step = 0.02
    coarse = low_orbit(10.0).light_curve("sat", range(556))
    dark = coarse.fraction[:, 1] < 0.5
    edges = [float(coarse.t_s[k]) for k in np.flatnonzero(dark[1:] != dark[:-1])]
    assert len(edges) == 2
    fine = low_orbit(step)
    for edge, sign in zip(edges, (1.0, -1.0), strict=True):
        first = round((edge - 12.0) / step)
        curve = fine.light_curve("sat", range(first, first + 1700))
        partial = np.flatnonzero((curve.fraction[:, 1] > 0.0) & (curve.fraction[:, 1] < 1.0))
        found = curve.t_s[partial[[0, -1]]] if sign > 0 else curve.t_s[partial[[-1, 0]]]
        outer = brentq(lambda t: beyond(t, 1.0), edge - 40.0, edge + 40.0)
        inner = brentq(lambda t: beyond(t, -1.0), edge - 40.0, edge + 40.0)
        assert abs(found[0] - outer) < step * 1.01
        assert abs(found[1] - inner) < step * 1.01
        assert 7.0 < abs(outer - inner) < 14.0  # the Sun sets in about 8 s / sin of the angle
        even = fine.light_curve("sat", range(first, first + 1700, 170), limb_darkening=False)
        for t, value in zip(even.t_s.tolist(), even.fraction[:, 0].tolist(), strict=True):
            a, b, c = limbs_apart(t)
            # A disc of this place's size: the Sun is not at 1 au. Its limb is nearly straight.
            scaled = sphere(b, b + (c - b) * ANGLES / a)
            want = float(by_rings([scaled])) if b - a < c < a + b else float(c > b)
            assert value == pytest.approx(want, abs=2e-6)
    lit = coarse.fraction[:, 0] == 1.0
    distance = np.linalg.norm(sun_m(coarse.t_s) - satellite_m(coarse.t_s), axis=1)
    np.testing.assert_allclose(
        coarse.irradiance_w_m2[lit, 0], 1361.0 * (AU / distance[lit]) ** 2, rtol=1e-9
    )
    assert np.array_equal(coarse.hides[:, 0], ~lit)
    assert coarse.bodies == ("earth",)


def test_shadow_time_at_beta_0() -> None:
    """An orbit through the Sun's direction is dark for asin(R/r) / pi of its period (the cylinder,
    e.g. Larson and Wertz, Space Mission Analysis and Design, 5.1); the light missed in both
    penumbrae is that of a half of each, to a second."""
    axis = 6778137.0
    sun = sun_m(np.zeros(1))[0]
    # 51.6 degrees is more than the Sun's declination: a node exists for which it is in the plane.
    alpha, delta = math.atan2(sun[1], sun[0]), math.asin(sun[2] / np.linalg.norm(sun))
    node = math.degrees(alpha - math.asin(math.tan(delta) / math.tan(math.radians(51.6))))
    sim = low_orbit(1.0, **{"spacecraft.sat.orbit.raan_deg": node % 360.0})
    period = 2.0 * math.pi * math.sqrt(axis**3 / GM)
    curve = sim.light_curve("sat", range(round(period)))
    missed = float((1.0 - curve.fraction[:, 1]).sum()) * period / round(period)
    expected = period * math.asin(EARTH_M / axis) / math.pi
    assert expected == pytest.approx(36.0 * 60.0, abs=60.0)  # of 92.5 minutes
    assert missed == pytest.approx(expected, abs=3.0)


# --- the renderer --------------------------------------------------------------------------------


def ball(radii_km: float | list[float], **more: Any) -> dict[str, Any]:
    radii = [radii_km] * 3 if isinstance(radii_km, float) else radii_km
    return {"kind": "ellipsoid", "radii_km": radii, "gm_km3_s2": 1.0, "albedo": 0.0, **more}


MOON = {"orbit": {"around": "ball", "kind": "kepler", "position_km": [70.0, 0.0, -1000.0]}}
PLATES: dict[str, tuple[dict[str, Any], list[float]]] = {
    "lit": ({"ball": ball(6378.0)}, [8000.0, 0.0, -1000.0]),
    "outer penumbra": ({"ball": ball(6378.0)}, [6380.0, 0.0, -2400.0]),
    "inner penumbra": ({"ball": ball(6378.0)}, [6373.0, 0.0, -2400.0]),
    "umbra": ({"ball": ball(6378.0)}, [6300.0, 0.0, -2400.0]),
    "annular": ({"ball": ball(100.0)}, [10.0, 0.0, -30000.0]),
    "oblate": ({"ball": ball([6378.0, 6378.0, 5000.0])}, [0.0, 6382.0, -2400.0]),
    "triaxial": ({"ball": ball([60.0, 140.0, 100.0])}, [50.0, 30.0, -30000.0]),
    "double": ({"ball": ball(100.0), "moon": ball(90.0, **MOON)}, [10.0, 0.0, -30000.0]),
}


@pytest.mark.parametrize("case", PLATES)
def test_a_plate_gets_what_the_light_curve_says(case: str, tmp_path: Path) -> None:
    """The mean radiance of a Lambert plate that faces the Sun at 1 au, times pi over its albedo,
    against the light curve: within 0.1 % of the solar constant where it is lit, and within noise
    (four standard errors) in penumbrae. All bands."""
    bodies, place = PLATES[case]
    corners = np.array([[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]], dtype=np.float32)
    halves = np.array([[0, 1, 2], [0, 2, 3]], dtype=np.uint32)
    model = write_glb(tmp_path / "plate.glb", corners, halves)
    tree = {
        "version": 1,
        "seed": 1,
        "time": {"epoch": EPOCH, "step_s": 0.0},
        "root": "ball",
        "sun": {"direction": [0.0, 0.0, 1.0]},
        "bodies": bodies,
        "spacecraft": {
            "plate": {
                "model": str(model), "metres_per_unit": 1.0, "centre": "origin",
                "orbit": {"around": "ball", "kind": "kepler", "position_km": place},
                "attitude": {"pointing": "inertial"},
                "materials": [{"material": "*", "use": "half"}],
            }
        },
        "materials": {"half": {"nodes": {"skin": {"type": "lambert", "base_color": [0.5] * 3}}}},
        "camera": {
            "width": 16, "height": 16, "fov_deg": 8.0,
            "exposure": {"mode": "fixed", "white_radiance_w_m2_sr": 433.0},
            "trajectory": {"kind": "fixed", "target": "plate", "position_m": [1.0, 0.5, 8.0]},
        },
        "render": {"samples": 256, "tolerance_dn": 0.0, "max_bounces": 0},
    }  # fmt: skip
    sim = perilune.open(tree)
    image = sim.frame(0, channels=["radiance"])["radiance"].astype(float) * math.pi / 0.5
    curve = sim.light_curve("plate", [0])
    got, want = image.mean(axis=(0, 1)), curve.irradiance_w_m2[0]
    noise = 4.0 * image.std(axis=(0, 1)) / 16.0
    assert (np.abs(got - want) <= 1e-3 * want + noise).all()
    assert (noise < 3e-3 * 1361.0).all()
    if case == "lit":
        assert np.abs(got - 1361.0).max() < 1e-3 * 1361.0
        assert (curve.fraction == 1.0).all()
    elif case == "umbra":
        assert (image == 0.0).all()
        assert (curve.fraction == 0.0).all()
    else:
        assert ((curve.fraction > 0.05) & (curve.fraction < 0.95)).all()
        assert curve.hides.all()
    camera = sim.light_curve("camera", [0])  # 8 m away: the same light
    np.testing.assert_allclose(camera.fraction, curve.fraction, atol=5e-3)


def test_errors_name_what_is_wrong() -> None:
    sim = low_orbit(10.0)
    with pytest.raises(ValueError, match=r"no body or spacecraft 'satt'.*sat"):
        sim.light_curve("satt", range(2))
    with pytest.raises(ValueError, match="nodes is 0"):
        sim.light_curve("sat", range(2), nodes=0)
    for at in (-0.5, 2.0, float("nan")):
        with pytest.raises(ValueError, match=r"at is .* from 0 to 1"):
            sim.light_curve("sat", range(2), at=at)
    with pytest.raises(TypeError, match="integer"):
        sim.light_curve("sat", [0.5])
    with pytest.raises(ValueError, match="inside the sun"):
        low_orbit(10.0, **{"sun.direction": [0, 0, 1], "sun.distance_au": 1e-4}).light_curve(
            "sat", range(2)
        )
    assert sim.light_curve("sat", []).fraction.shape == (0, 3)
    with pytest.raises(ValueError, match="points"):
        _core.sunlight(np.zeros((1, 2)), np.zeros((1, 3)), SUN, np.zeros((1, 0, 7)),
                       np.zeros((0, 3)), np.zeros(1))  # fmt: skip
