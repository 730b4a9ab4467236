"""Planetshine between bodies: earthshine on the Moon, the row's bound, the same bits everywhere."""

from __future__ import annotations

import math
import sys
from pathlib import Path
from typing import Any

import numpy as np
from hypothesis import given, settings, strategies as st
from numpy.typing import NDArray

from perilune import _core

sys.path.insert(0, str(Path(__file__).resolve().parent))
import air_worlds

F64 = NDArray[np.float64]

EARTH_M, MOON_M, APART_M = 6371e3, 1737.4e3, 384400e3
GEOMETRIC_ALBEDO = 0.434
"""Of the Earth (Allen's Astrophysical Quantities, 4th ed., table 12.10): 2/3 of a Lambert
sphere's albedo."""
MOON_ALBEDO = 0.12


def lambert_phase(angle_rad: float) -> float:
    """Light of a Lambert sphere at a phase angle, over that at full phase (Russell 1916)."""
    return (math.sin(angle_rad) + (math.pi - angle_rad) * math.cos(angle_rad)) / math.pi


def new_moon(phase_deg: float, **changes: Any) -> dict[str, Any]:
    """The Moon from the Earth's side, 20000 km from it, the sun beyond it; the Earth at the
    root."""
    angle = math.radians(phase_deg)
    asked = air_worlds.request(
        [[EARTH_M] * 3, [MOON_M] * 3],
        (APART_M - 2e7, 0.0, 0.0),
        (1.0, 0.0, 0.0),
        (math.cos(angle), math.sin(angle), 0.0),
        centers_m=[(0.0, 0.0, 0.0), (APART_M, 0.0, 0.0)],
        fov_deg=8.0,
        white=0.01,
        **changes,
    )
    asked["body_albedo"][0] = 1.5 * GEOMETRIC_ALBEDO
    asked["body_albedo"][1] = MOON_ALBEDO
    asked["quality"]["max_bounces"] = 1
    return asked


def light_of_sphere(albedo: float, radius_m: float, phase_rad: float, away_m: float) -> float:
    """W m-2 on a plate that faces a Lambert sphere, so far from its centre: the cosine law
    integrated over what it sees of the sunlit side, by 200 Gauss nodes of the cosine from below
    the plate."""
    nodes, weights = np.polynomial.legendre.leggauss(200)
    horizon = radius_m / away_m
    z = (0.5 * (1 + horizon) + 0.5 * (1 - horizon) * nodes)[:, None]
    turns = 2 * math.pi * (np.arange(400) + 0.5) / 400
    n = np.stack(np.broadcast_arrays(z, np.sqrt(1 - z * z) * np.cos(turns)), axis=-1)
    lit = np.maximum(0.0, n @ np.array([math.cos(phase_rad), math.sin(phase_rad)]))
    gap_x = away_m - radius_m * n[..., 0]
    square = gap_x**2 + radius_m**2 * (1 - n[..., 0] ** 2)
    out = (away_m * n[..., 0] - radius_m) / np.sqrt(square)  # cosine at the ground
    areas = radius_m**2 * 0.5 * (1 - horizon) * weights[:, None] * 2 * math.pi / 400
    kernel = lit * np.maximum(0.0, out) * gap_x / square**1.5
    return float(albedo / math.pi * air_worlds.SOLAR * (kernel * areas).sum())


def earthlight(phase_deg: float, away_m: float = APART_M - MOON_M) -> float:
    """W m-2 on ground of the Moon that faces the Earth."""
    return light_of_sphere(1.5 * GEOMETRIC_ALBEDO, EARTH_M, math.radians(phase_deg), away_m)


def test_the_integral_from_afar() -> None:
    for phase_deg in (0.0, 60.0, 120.0):
        closed = air_worlds.SOLAR * GEOMETRIC_ALBEDO * 1e-8
        closed *= lambert_phase(math.radians(phase_deg))
        assert abs(earthlight(phase_deg, 1e4 * EARTH_M) / closed - 1.0) < 1e-3


def test_earthshine() -> None:
    """The ashen light: 0.16 W m-2 at full Earth, a ten-thousandth of what the sun sends (Goode et
    al. 2001, GRL 28, 1671), falling off with the cosine from the middle of the disc."""
    world = air_worlds.scene([None, None])
    for phase_deg in (8.0, 45.0):
        asked = new_moon(phase_deg, samples=64, tolerance_dn=0.0)
        seen = air_worlds.render(world, asked)["radiance"].astype(np.float64).mean(axis=2)
        rays = air_worlds.directions(asked)
        off_axis = np.arccos(np.minimum(rays[..., 0], 1.0))
        # Of the ground from the middle of the Moon's disc, as the Moon's centre sees it.
        turn = np.arcsin(np.minimum(2e7 / MOON_M * np.sin(off_axis), 1.0)) - off_axis
        cosine = np.cos(turn + MOON_M / APART_M * np.sin(turn))
        cosine[2e7 * np.sin(off_axis) > 0.97 * MOON_M] = 0.0
        expected = MOON_ALBEDO / math.pi * earthlight(phase_deg)
        middle = cosine > 0.9
        assert np.count_nonzero(middle) > 50
        ratio = float((seen[middle] / cosine[middle]).mean() / expected)
        assert abs(ratio - 1.0) < 0.01
        steep = (cosine > 0.5) & (cosine < 0.7) & (rays[..., 1] < 0.0)
        assert abs(float((seen[steep] / cosine[steep]).mean() / expected) - 1.0) < 0.03
    assert 0.14 < earthlight(0.0) < 0.18
    assert 0.5e-4 < earthlight(0.0) / air_worlds.SOLAR < 2e-4


def test_off_and_threads() -> None:
    """Without the row that side is black; with it any number of threads gives the same bits."""
    world = air_worlds.scene([None, None])
    dark = air_worlds.render(world, new_moon(8.0, force_off=["planetshine"]))["radiance"]
    assert dark[18, 24].max() == 0.0
    one, two = (air_worlds.render(world, new_moon(8.0, size=(80, 60)), n) for n in (1, 2))
    assert one["radiance"].max() > 0.0
    assert np.array_equal(one["radiance"], two["radiance"])


def encode(radiance: NDArray[np.float32], white: float) -> F64:
    """Display values of 255, sRGB (IEC 61966-2-1), not rounded."""
    x = np.clip(radiance.astype(np.float64) / white, 0.0, 1.0)
    high = 1.055 * np.maximum(x, 1e-9) ** (1 / 2.4) - 0.055
    return np.asarray(255.0 * np.where(x <= 0.0031308, 12.92 * x, high))


@settings(max_examples=15, deadline=None)
@given(
    gap=st.floats(0.05, 30.0),
    size=st.floats(0.1, 4.0),
    turn=st.floats(-math.pi, math.pi),
    albedo=st.floats(0.05, 0.95),
    sun=st.floats(-math.pi, math.pi),
)
def test_bound(gap: float, size: float, turn: float, albedo: float, sun: float) -> None:
    """The row changes no pixel by more than it says, but for noise, and never takes light away."""
    away = 1e6 * (1.0 + size + gap)
    world = air_worlds.scene([None, None])
    white = 100.0
    asked = air_worlds.request(
        [[1e6] * 3, [1e6 * size] * 3],
        (-4e6, 0.0, 0.0),
        (1.0, 0.0, 0.0),
        (math.cos(sun), math.sin(sun), 0.0),
        centers_m=[(0.0, 0.0, 0.0), (0.0, away * math.cos(turn), away * math.sin(turn))],
        size=(24, 18),
        fov_deg=40.0,
        albedo=albedo,
        white=white,
        tolerance_dn=0.0,
        samples=64,
    )
    asked["quality"]["max_bounces"] = 2
    renderer = _core.Renderer(world)
    images, rows = [], []
    for off in ([], ["planetshine"]):
        asked["quality"]["force_off"] = off
        out = {"radiance": np.empty((18, 24, 3), np.float32)}
        result: Any = renderer.render(asked, out, 1)
        rows.append(next(row for row in result["plan"] if row["name"] == "planetshine"))
        images.append(encode(out["radiance"], white))
    change = images[0] - images[1]
    noise = 0.5 + 0.05 * rows[0]["bound_dn"]
    assert change.max() <= rows[1]["bound_dn"] + noise
    assert change.min() > -noise
