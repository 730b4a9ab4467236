"""_core.Terrain: the type itself: rasters that it keeps, errors, levels, bounds."""

from __future__ import annotations

import gc
import math
import threading
import weakref
from typing import Any

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings, strategies as st
from numpy.typing import NDArray

from perilune import _core

RADIUS_M = 1737400.0
F64 = NDArray[np.float64]
RADII_M = np.full(3, RADIUS_M)


def patch(samples: NDArray[Any], step_m: float = 10.0, radius_m: float = RADIUS_M) -> _core.Raster:
    """Posts about a place at 60 degrees south, 170 east."""
    height, width = samples.shape
    return _core.Raster(
        samples, "orthographic", -0.5 * step_m * (width - 1), 0.5 * step_m * (height - 1), step_m,
        -step_m, lon0_rad=math.radians(170.0), lat0_rad=math.radians(-60.0), radius_m=radius_m,
    )  # fmt: skip


def posts_of(raster: _core.Raster, width: int, height: int) -> F64:
    rows, columns = np.mgrid[:height, :width]
    return raster.directions(np.stack([columns.ravel(), rows.ravel()], axis=1).astype(float))


def directions(count: int, seed: int = 0) -> F64:
    d = np.random.default_rng(seed).normal(size=(count, 3))
    return np.asarray(d / np.linalg.norm(d, axis=1, keepdims=True))


def test_it_keeps_its_rasters() -> None:
    samples = np.random.default_rng(1).normal(0.0, 5.0, (20, 20)).astype(np.float32)
    raster = patch(samples)
    posts = posts_of(raster, 20, 20)
    terrain = _core.Terrain(RADII_M, [(raster, "cubic", 0.0, 0.0)], {"seed": 5})
    held = weakref.ref(samples)
    before = terrain.heights(posts)
    del raster, samples
    gc.collect()
    assert held() is not None
    assert np.array_equal(terrain.heights(posts), before)
    del terrain
    gc.collect()
    assert held() is None


def test_directions_of_any_length() -> None:
    terrain = _core.Terrain(RADII_M, detail={})
    d = directions(50)
    assert np.allclose(terrain.heights(1e7 * d, 1.0), terrain.heights(d, 1.0), atol=1e-5)
    for bad in ([[0.0, 0.0, 0.0]], [[math.nan, 0.0, 1.0]]):
        with pytest.raises(ValueError, match="direction 0 is 0 or not finite"):
            terrain.heights(np.array(bad))


def test_blocks_are_heights_of_nodes() -> None:
    terrain = _core.Terrain(RADII_M, detail={"seed": 3})
    level = 9
    block = terrain.block(4, level, 100, 37, 5, 3)
    s = np.tan((-1.0 + 2.0 * (100 + np.arange(5)) / 2**level) * np.pi / 4)
    t = np.tan((-1.0 + 2.0 * (37 + np.arange(3)) / 2**level) * np.pi / 4)
    # Face 4 is the north pole's: s points to y, t away from x.
    d = np.array([[[-b, a, 1.0] for a in s] for b in t]).reshape(-1, 3)
    cell_m = terrain.cell_m(level)
    assert terrain.level(cell_m) == level
    assert np.allclose(terrain.heights(d, cell_m), block.ravel(), atol=1e-6)
    for bad in ({"face": 6}, {"level": 48}, {"width": 0}, {"i0": -9}, {"j0": 2**level + 6}):
        nodes = {"face": 4, "level": level, "i0": 0, "j0": 0, "width": 5, "height": 3}
        with pytest.raises(ValueError, match=r"face must be|8 beyond"):
            terrain.block(**(nodes | bad))


def test_threads_share_a_terrain() -> None:
    samples = np.random.default_rng(1).normal(0.0, 5.0, (30, 30)).astype(np.float32)
    raster = patch(samples)
    terrain = _core.Terrain(RADII_M, [(raster, "cubic", 2.0, 0.0)], {})
    d = raster.directions(np.random.default_rng(2).uniform(-2.0, 32.0, (3000, 2)))
    alone = terrain.heights(d)
    found: list[F64] = []
    workers = [threading.Thread(target=lambda: found.append(terrain.heights(d))) for _ in range(4)]
    for worker in workers:
        worker.start()
    for worker in workers:
        worker.join()
    assert len(found) == 4
    assert all(np.array_equal(h, alone) for h in found)
    order = np.random.default_rng(3).permutation(len(d))
    assert np.array_equal(terrain.heights(d[order]), alone[order])


def test_slopes() -> None:
    """A plane's slope, and that a wide baseline sees less of what is rough."""
    rows, columns = np.mgrid[:40, :40]
    samples = (1.0 * columns - 2.0 * rows).astype(np.float32)  # 10 m apart: 0.1 east, 0.2 north
    raster = patch(samples)
    d = raster.directions(np.array([[20.3, 19.6]]))
    plain = _core.Terrain(RADII_M, [(raster, "bilinear", 0.0, 0.0)])
    slope = plain.slopes(d, 5.0)
    assert math.hypot(0.1, 0.2) == pytest.approx(np.linalg.norm(slope), rel=1e-3)
    assert abs(np.sum(slope * d)) < 1e-12
    assert slope[0, 2] / math.cos(math.radians(60.0)) == pytest.approx(0.2, rel=1e-2)
    rough = _core.Terrain(RADII_M, detail={"ranges": [(0.0, 0.5)]})
    many = directions(400)
    fine, wide = (np.std(rough.slopes(many, baseline)) for baseline in (1.0, 100.0))
    assert fine > 5.0 * wide


def test_without_anything_the_ground_is_flat() -> None:
    terrain = _core.Terrain(RADII_M)
    assert np.all(terrain.heights(directions(10), 1.0) == 0.0)
    assert terrain.bounds == (0.0, 0.0)


@pytest.mark.parametrize(
    ("given", "text"),
    [
        ({"radii_m": np.array([1.0, 0.0, 1.0])}, "radii of a terrain must be above 0"),
        ({"detail": {"seed": -1}}, "seed must be an integer from 0 to 2\\^64 - 1"),
        ({"detail": {"seed": 2**64}}, "seed must be an integer from 0 to 2\\^64 - 1"),
        ({"detail": {"ranges": [(0.0, 1.1)]}}, "Hurst exponents must be in \\[0, 1\\], not 1.1"),
        ({"detail": {"ranges": [(1.0, 0.5)]}}, "must begin at 0 m and ascend"),
        ({"detail": {"ranges": [(0.0, 0.5), (0.0, 0.6)]}}, "must begin at 0 m and ascend"),
        ({"detail": {"ranges": [(k, 0.5) for k in range(9)]}}, "1 to 8 ranges"),
        ({"detail": {"deviation_m": -1.0}}, "deviation_m must be at least 0"),
        ({"detail": {"baseline_m": 0.0}}, "baseline_m must be above 0"),
        ({"detail": {"strength": math.nan}}, "strength must be at least 0"),
        ({"detail": {"finest_m": 10.0, "longest_m": 1.0}}, "finest_m must be above 0 and at most"),
        ({"layers": [(None, "cubic", 0.0, 0.0)]}, "layer 0: raster must be"),
        ({"layers": ["cubic"]}, "layer 0: must be \\(raster"),
        ({"layers": [(None, "nearest", 0.0, 0.0)]}, "allowed: bilinear, cubic"),
    ],
)
def test_errors(given: dict[str, Any], text: str) -> None:
    with pytest.raises((ValueError, TypeError), match=text):
        _core.Terrain(**({"radii_m": RADII_M} | given))


@settings(max_examples=40, deadline=None, suppress_health_check=list(HealthCheck))
@given(
    seed=st.integers(0, 2**64 - 1),
    hurst=st.floats(0.0, 1.0),
    size_m=st.sampled_from([1e-6, 1.0, 1e5]),
    radius_m=st.sampled_from([1e3, RADIUS_M, 7.1e7]),
    interpolation=st.sampled_from(["bilinear", "cubic"]),
    shape=st.sampled_from([(1, 1), (1, 12), (9, 1), (8, 12)]),
    cell_m=st.floats(1e-2, 1e3),
)
def test_bounds_hold(
    seed: int, hurst: float, size_m: float, radius_m: float, interpolation: str,
    shape: tuple[int, int], cell_m: float,
) -> None:  # fmt: skip
    """Whatever the body, the model and the law: finite heights within bounds, posts to the bit."""
    samples = np.random.default_rng(seed).normal(0.0, size_m, shape).astype(np.float32)
    raster = patch(samples, 1e-2 * radius_m, radius_m)
    detail = {"seed": seed, "ranges": [(0.0, hurst)], "deviation_m": 0.1 * size_m}
    terrain = _core.Terrain(np.full(3, radius_m), [(raster, interpolation, 0.0, 0.0)], detail)
    near = np.random.default_rng(1).uniform(-1.0, 12.0, (60, 2))
    d = np.concatenate([raster.directions(near), directions(30)])
    h = terrain.heights(d, cell_m)
    low, high = terrain.bounds
    assert np.all(np.isfinite(h))
    assert low <= h.min() <= h.max() <= high
    posts = posts_of(raster, shape[1], shape[0])
    assert np.array_equal(terrain.heights(posts), samples.ravel().astype(float))


def test_craters() -> None:
    """Where posts are wide or absent craters are added, as the field itself gives them."""
    field = _core.CraterField({"radius_m": RADIUS_M, "min_diameter_m": 10.0, "max_diameter_m": 1e3})
    terrain = _core.Terrain(RADII_M, craters=field)
    gc.collect()
    d = directions(200)
    cell_m = terrain.cell_m(terrain.level(2.0))
    relief = terrain.heights(d, 2.0)
    assert np.array_equal(relief, field.heights(d, cell_m))
    assert np.std(relief) > 0.1
    raster = patch(np.zeros((40, 40), np.float32))
    within = raster.directions(np.random.default_rng(1).uniform(8.0, 31.0, (200, 2)))
    over = _core.Terrain(RADII_M, [(raster, "cubic", 0.0, 0.0)], craters=field)
    shown = np.std(over.heights(within, 2.0))
    assert 0.0 < shown < 0.7 * np.std(terrain.heights(within, 2.0))
    with pytest.raises(ValueError, match="craters of a body with a radius of"):
        _core.Terrain(2.0 * RADII_M, craters=field)
