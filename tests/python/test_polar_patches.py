"""Poles of cylindrical elevation models: one height, no spokes, nothing lost farther out."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

from perilune.bodies.elevation import ElevationRaster, read_elevation
from perilune.bodies.places import Place
from perilune.bodies.polar import with_patches
from perilune.config.elevation import Elevation

RADIUS_M = 1737400.0
F64 = NDArray[np.float64]


def whole(values: NDArray[np.float32], posts_at_poles: bool = False) -> ElevationRaster:
    rows, columns = values.shape
    step = math.pi / (rows - 1 if posts_at_poles else rows)
    north = 0.5 * math.pi - (0.0 if posts_at_poles else 0.5 * step)
    place = Place("cylindrical", -2.0, north, 2.0 * math.pi / columns, -step)
    return ElevationRaster(values, place, 1.0, 0.0, "whole")


def circle(colatitude: float, sign: float, count: int = 1440) -> F64:
    lon = np.arange(count) * (2.0 * math.pi / count)
    s, c = math.sin(colatitude), sign * math.cos(colatitude)
    return np.stack([s * np.cos(lon), s * np.sin(lon), np.full(count, c)], -1)


def blended(layers: tuple[ElevationRaster, ...], directions: F64) -> F64:
    heights = layers[0].heights(directions)
    for layer in layers[1:]:
        weight = layer.raster.weights(directions, layer.border_posts)
        over = np.where(weight > 0.0, layer.heights(directions), 0.0)
        heights = (1.0 - weight) * heights + weight * over
    return heights


def rough(heights: F64, above: int) -> float:
    """Standard deviation of what changes more often than `above` times around."""
    power = np.abs(np.fft.rfft(heights) / len(heights)) ** 2
    return math.sqrt(2.0 * float(power[above + 1 :].sum()))


@pytest.mark.parametrize("posts_at_poles", [False, True])
def test_the_pole_is_single_and_without_spokes(posts_at_poles: bool) -> None:
    noise = np.random.default_rng(5).normal(0.0, 100.0, (180 + posts_at_poles, 720))
    base = whole(noise.astype(np.float32), posts_at_poles)
    layers = with_patches(base, RADIUS_M)
    assert len(layers) == 3
    assert with_patches(base, RADIUS_M)[1] is layers[1]
    step = math.radians(1.0)
    for sign in (1.0, -1.0):
        near = blended(layers, circle(1e-9, sign))
        assert np.ptp(near) < 1e-3
        assert np.ptp(base.heights(circle(1e-9, sign))) > 100.0 or posts_at_poles
        for posts in (0.5, 1.0, 2.0, 3.0):
            around = circle(posts * step, sign)
            most = math.ceil(4.0 * math.pi * posts) + 8
            spokes = rough(base.heights(around), most)
            assert spokes > 15.0
            assert rough(blended(layers, around), most) < 0.06 * spokes


def test_planes_are_kept_and_far_places_untouched() -> None:
    """Heights that are straight across the pole come out as they were."""
    rows, columns = np.mgrid[:180, :720]
    lat, lon = np.radians(89.5 - rows), np.radians(0.5 * columns) - 2.0
    x, y = np.cos(lat) * np.cos(lon), np.cos(lat) * np.sin(lon)
    base = whole((1e4 * x - 3e4 * y + 200.0).astype(np.float32))
    layers = with_patches(base, RADIUS_M)
    for sign in (1.0, -1.0):
        for colatitude in np.radians([0.0, 0.3, 1.0, 2.5, 4.0, 6.0]):
            directions = circle(float(colatitude), sign)
            exact = directions @ [1e4, -3e4, 0.0] + 200.0
            np.testing.assert_allclose(blended(layers, directions), exact, atol=2.0)
        far = circle(math.radians(12.0), sign)
        np.testing.assert_array_equal(blended(layers, far), base.heights(far))


@pytest.mark.parametrize("shape", [(1, 4), (1, 1), (2, 5), (18, 36), (100, 100)])
def test_coarse_rasters(shape: tuple[int, int]) -> None:
    values = np.random.default_rng(6).normal(0.0, 10.0, shape).astype(np.float32)
    layers = with_patches(whole(values), RADIUS_M)
    for sign in (1.0, -1.0):
        near = blended(layers, circle(1e-8, sign))
        assert np.ptp(near) < 1e-3
        assert values.min() - 1e-3 <= near[0] <= values.max() + 1e-3
        # Both sides of the patch's edge are close: it is a patch of the same heights.
        reach = 2.0 * math.atan(0.5 * abs(layers[1].place.x0) / RADIUS_M)
        inside, outside = (blended(layers, circle(f * reach, sign)) for f in (0.99, 1.5))
        assert abs(inside.mean() - outside.mean()) < 12.0


def test_only_where_a_raster_reaches_the_pole() -> None:
    values = np.zeros((40, 720), np.float32)
    place = Place("cylindrical", 0.0, math.radians(79.75), math.radians(0.5), -math.radians(0.5))
    assert len(with_patches(ElevationRaster(values, place, 1.0, 0.0, "band"), RADIUS_M)) == 1
    place = Place("cylindrical", 0.0, math.radians(89.75), math.radians(0.5), -math.radians(0.5))
    layers = with_patches(ElevationRaster(values, place, 1.0, 0.0, "cap"), RADIUS_M)
    assert [layer.name for layer in layers] == ["cap", "cap (north pole)"]
    uneven = Place(
        "cylindrical", 0.0, place.y0, 1.0007 * place.dx, place.dy
    )  # no whole posts around
    assert len(with_patches(ElevationRaster(values, uneven, 1.0, 0.0, "gap"), RADIUS_M)) == 1
    sector = ElevationRaster(values[:, :300], place, 1.0, 0.0, "sector")
    assert len(with_patches(sector, RADIUS_M)) == 1


def test_poles_of_lola(data_dir: Path) -> None:
    given = Elevation.model_validate(
        {"file": "x", "projection": {"kind": "cylindrical", "west_deg": 0.0}, "scale_m": 0.5}
        | {"missing": 0.0}  # which holes about the north pole are in this file
    )
    path = data_dir / "lunar_dem" / "ldem_4.img"
    base = read_elevation(given, path, (RADIUS_M, RADIUS_M, RADIUS_M))
    layers = with_patches(base, RADIUS_M)
    assert [layer.samples.shape for layer in layers[1:]] == [(115, 115), (115, 115)]
    step = math.radians(0.25)
    for sign in (1.0, -1.0):
        assert np.ptp(blended(layers, circle(1e-9, sign))) < 1e-3
        for posts in (1.5, 3.5, 6.5):
            around = circle(posts * step, sign)
            old, new = base.heights(around), blended(layers, around)
            assert (new - old).std() < 0.4 * old.std()
            most = math.ceil(4.0 * math.pi * posts) + 8
            assert rough(new, most) < 0.5 * rough(old, most)
