"""Rings: light against integrals, a map's columns, sections of the configuration."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st
from numpy.typing import NDArray
from scipy.integrate import quad

from perilune import _core
from perilune.bodies import rings
from perilune.config.rings import Rings

F64 = NDArray[np.float64]

EDGES_M = np.array([1e8, 2e8])


def even(depth: float, albedo: float = 0.6) -> _core.Rings:
    """Rings whose particles scatter to all sides alike."""
    return _core.Rings(EDGES_M, np.array([depth]), np.full((1, 3), albedo), 0.0, 0.0, 0.0)


def sun(sine: float) -> tuple[float, float, float]:
    return (math.sqrt(1.0 - sine**2), 0.0, sine)


def look(made: _core.Rings, sine: float, sun_sine: float) -> tuple[float, float]:
    """Radiance and what passes for a thin ray that falls on the middle of the rings from north."""
    mu = np.array([[0.0, math.sqrt(1.0 - sine**2), -sine]])
    point = np.array([[1.5e8, 0.0, 0.0]]) - 1e6 * mu
    light, passed = made.scatter(point, mu, sun(sun_sine), 1e-6, 0.0, 1e-9)
    return float(light[0, 0]), float(passed[0])


def single_scattering(depth: float, mu: float, sun_sine: float) -> float:
    """By QUADPACK, over the optical depth t along the normal at which light is scattered."""
    mu0 = abs(sun_sine)

    def at(t: float) -> float:
        above = t if sun_sine > 0.0 else depth - t
        return math.exp(-above / mu0 - t / mu) / mu

    scale = min(1.0, depth, mu * mu0)
    stops = [x for x in (scale, 5.0 * scale, 20.0 * scale) if x < depth]
    return quad(at, 0.0, depth, points=stops or None, epsabs=1e-13, limit=200)[0] / (4.0 * math.pi)


@pytest.mark.parametrize("sun_sine", [0.9, 0.3, 0.05, -0.05, -0.31, -0.9])
@pytest.mark.parametrize("sine", [1.0, 0.31, 0.06])
@pytest.mark.parametrize("depth", [0.01, 0.6, 3.0])
def test_light_is_that_of_the_integral(depth: float, sine: float, sun_sine: float) -> None:
    light, passed = look(even(depth), sine, sun_sine)
    expected = 0.6 * single_scattering(depth, sine, sun_sine)
    assert light == pytest.approx(expected, rel=1e-5, abs=1e-12)
    assert passed == pytest.approx(math.exp(-depth / sine), rel=1e-6, abs=1e-7)


@settings(max_examples=100, deadline=None)
@given(
    depth=st.floats(1e-6, 100.0),
    sine=st.floats(1e-6, 1.0),
    sun_sine=st.floats(-1.0, 1.0),
    radius=st.floats(0.0, 0.02),
)
def test_never_more_light_than_falls_in(
    depth: float, sine: float, sun_sine: float, radius: float
) -> None:
    """Of a white sheet that scatters evenly no direction gets more than 1/(4 pi) a steradian: the
    light that comes out is emitted along a way whose emissivity and absorption are alike."""
    mu = np.array([[0.0, math.sqrt(1.0 - sine**2), -sine]])
    point = np.array([[1.5e8, 0.0, 0.0]]) - 1e5 * mu
    light, passed = even(depth, 1.0).scatter(point, mu, sun(sun_sine), radius, 0.0, 1e-9)
    assert np.all(light >= 0.0)
    assert np.all(light * 4.0 * math.pi <= 1.0 - passed + 1e-6)


def test_a_wide_cone_is_the_mean_of_narrow_ones() -> None:
    generator = np.random.default_rng(3)
    edges = np.cumsum(np.r_[1e8, generator.uniform(1e5, 1e6, 200)])
    albedo = generator.uniform(0.0, 1.0, (200, 3))
    made = _core.Rings(edges, generator.uniform(0.0, 2.0, 200), albedo, 0.0, 0.0, 0.0)
    origin = np.array([4e8, 0.0, 1e8])
    aim = np.array([1.3e8, 5e7, 0.0])
    middle = (aim - origin) / np.linalg.norm(aim - origin)
    across = np.cross(np.cross(middle, [0.0, 0.0, 1.0]), middle)
    across /= np.linalg.norm(across)
    spread, count = 0.08, 4000
    steps = spread * ((np.arange(count) + 0.5) / count - 0.5)
    lines = middle + steps[:, None] * across
    lines /= np.linalg.norm(lines, axis=1)[:, None]
    thin, thin_passed = made.scatter(np.tile(origin, (count, 1)), lines, sun(0.4), 1e-6, 0.0, 1e-9)
    wide, wide_passed = made.scatter(origin[None], middle[None], sun(0.4), 1e-6, 0.0, spread)
    assert wide_passed[0] == pytest.approx(thin_passed.mean(), abs=0.01)
    np.testing.assert_allclose(wide[0], thin.mean(axis=0), rtol=0.03)


def write_map(path: Path, texels: NDArray[np.uint8]) -> _core.Map:
    _core.png_write(str(path), texels)
    return _core.Map(str(path))


def srgb(value: float) -> float:
    return float(value / 12.92 if value <= 0.04045 else ((value + 0.055) / 1.055) ** 2.4)


def test_columns_of_a_map(tmp_path: Path) -> None:
    texels = np.zeros((4, 3, 4), dtype=np.uint8)
    texels[:, 0] = (255, 128, 0, 51)
    texels[:, 2] = (10, 20, 30, 255)
    texels[1::2, 2] = (30, 20, 10, 255)
    columns = write_map(tmp_path / "map.png", texels).columns()
    assert columns.shape == (3, 4)
    np.testing.assert_allclose(columns[0], [1.0, srgb(128 / 255), 0.0, 0.2], atol=1e-6)
    np.testing.assert_allclose(columns[1], 0.0, atol=1e-7)
    mean = 0.5 * (srgb(10 / 255) + srgb(30 / 255))
    np.testing.assert_allclose(columns[2], [mean, srgb(20 / 255), mean, 1.0], atol=1e-6)


@pytest.mark.parametrize("width", [1, 2, 16384])
def test_maps_of_all_widths(tmp_path: Path, width: int) -> None:
    texels = np.full((1, width, 4), 128, dtype=np.uint8)
    columns = write_map(tmp_path / "map.png", texels).columns()
    section = Rings(inner_radius_km=1e5, outer_radius_km=2e5, color_map="m", phase_exponent=0.0)
    made = rings.rings_of(section, columns)
    _, passed = look(made, 1.0, 0.5)
    assert passed == pytest.approx(1.0 - 128 / 255, abs=1e-6)
    # the whole ring within one cone, from afar
    _, wide = made.scatter(
        np.array([[0.0, 0.0, 1e12]]), np.array([[0.0, 0.0, -1.0]]), sun(0.5), 1e-6, 0.0, 4e-4
    )
    assert wide[0] == pytest.approx(1.0 - 0.5 * 128 / 255, abs=2e-3)


def test_a_map_becomes_depth_and_albedo() -> None:
    columns = np.array([[0.5, 0.25, 0.8, 0.0], [0.5, 0.25, 0.8, 0.5], [1.0, 1.0, 1.0, 1.0]])
    section = Rings(
        inner_radius_km=1.0, outer_radius_km=4.0, color_map="m", optical_depth=2.0,
        albedo=(1.0, 2.0, 3.0),
    )  # fmt: skip
    made = rings.profile(section, columns)
    np.testing.assert_allclose(made.edges_m, [1e3, 2e3, 3e3, 4e3])
    np.testing.assert_allclose(made.depth[:2], [0.0, 2.0 * math.log(2.0)])
    assert 12.0 < made.depth[2] < 13.0  # opaque, to half a step of eight bits
    np.testing.assert_allclose(made.albedo[1], [0.5, 0.5, 1.0])


def test_ringlets_have_gaps() -> None:
    section = Rings(
        ringlets=(
            {"inner_radius_km": 1.0, "outer_radius_km": 2.0, "optical_depth": 1.0, "albedo": 0.5},
            {"inner_radius_km": 3.0, "outer_radius_km": 4.0, "optical_depth": 2.0, "albedo": 0.2},
        )
    )
    made = rings.profile(section, None)
    np.testing.assert_allclose(made.edges_m, [1e3, 2e3, 3e3, 4e3])
    np.testing.assert_allclose(made.depth, [1.0, 0.0, 2.0])
    np.testing.assert_allclose(made.albedo, [[0.5] * 3, [0.0] * 3, [0.2] * 3])


GOOD = {"inner_radius_km": 1.0, "outer_radius_km": 2.0, "optical_depth": 1.0, "albedo": 0.5}


@pytest.mark.parametrize(
    ("section", "text"),
    [
        ({**GOOD, "outer_radius_km": 1.0}, "more than inner_radius_km"),
        ({**GOOD, "albedo": 1.5}, "at most 1"),
        ({**GOOD, "optical_depth": -1.0}, "optical_depth"),
        ({**GOOD, "dust_g": 1.0}, "dust_g"),
        ({**GOOD, "inner_radius": 1.0}, "inner_radius_km"),
        ({key: GOOD[key] for key in GOOD if key != "albedo"}, "required without a color_map"),
        ({"color_map": "map.png"}, "required without ringlets"),
        ({}, "required without ringlets"),
        ({**GOOD, "ringlets": [GOOD]}, "give ringlets, or one ring"),
        ({"ringlets": [{**GOOD, "outer_radius_km": 3.0}, GOOD]}, "within the one before it"),
    ],
)
def test_bad_sections(section: dict[str, Any], text: str) -> None:
    with pytest.raises(ValueError, match=text):
        Rings.model_validate(section)


def test_bad_arrays() -> None:
    with pytest.raises(ValueError, match="radii must rise"):
        _core.Rings(EDGES_M[::-1].copy(), np.ones(1), np.ones((1, 3)), 0.0, 0.0, 0.0)
    with pytest.raises(ValueError, match="edges_m"):
        _core.Rings(EDGES_M, np.ones(2), np.ones((2, 3)), 0.0, 0.0, 0.0)
    with pytest.raises(ValueError, match="intervals"):
        _core.Rings(np.ones(1), np.ones(0), np.ones((0, 3)), 0.0, 0.0, 0.0)
