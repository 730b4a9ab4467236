"""_core.Raster: interpolation beside SciPy's, borrowed memory, and errors."""

from __future__ import annotations

import gc
import math
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.ndimage import map_coordinates

from perilune import _core

RADIUS_M = 1737400.0


def patch(samples: NDArray[Any], **more: Any) -> _core.Raster:
    """Posts 10 m apart about a place at 60 degrees south, 170 east."""
    how = {"lon0_rad": math.radians(170.0), "lat0_rad": math.radians(-60.0), "radius_m": RADIUS_M}
    height, width = samples.shape[0], samples.shape[-1]
    return _core.Raster(
        samples, "orthographic", -5.0 * (width - 1), 5.0 * (height - 1), 10.0, -10.0, **how, **more
    )


def heights(height: int, width: int) -> NDArray[np.float32]:
    return np.random.default_rng(3).normal(0.0, 100.0, (height, width)).astype(np.float32)


def catmull_rom(samples: NDArray[Any], posts: NDArray[np.float64]) -> NDArray[np.float64]:
    """The kernel of Keys (1981) with a = -1/2, as a sum over all posts."""

    def kernel(x: NDArray[np.float64]) -> NDArray[np.float64]:
        x = np.abs(x)
        near = 1.5 * x**3 - 2.5 * x**2 + 1.0
        far = -0.5 * x**3 + 2.5 * x**2 - 4.0 * x + 2.0
        return np.where(x < 1.0, near, np.where(x < 2.0, far, 0.0))

    height, width = samples.shape
    across = kernel(posts[:, :1] - np.arange(width))
    down = kernel(posts[:, 1:] - np.arange(height))
    return np.einsum("ni,nj,ij->n", down, across, samples.astype(np.float64))


def test_interpolation_is_that_of_others() -> None:
    samples = heights(30, 40)
    raster = patch(samples, scale=2.0, offset=-7.0)
    posts = np.random.default_rng(4).uniform((1.0, 1.0), (38.0, 28.0), (5000, 2))
    directions = raster.directions(posts)
    np.testing.assert_allclose(raster.posts(directions), posts, atol=1e-8)
    expected = map_coordinates(samples.astype(np.float64), posts.T[::-1], order=1)
    np.testing.assert_allclose(raster.values(directions), 2.0 * expected - 7.0, atol=1e-6)
    cubic = raster.values(directions, "cubic")
    np.testing.assert_allclose(cubic, 2.0 * catmull_rom(samples, posts) - 7.0, atol=1e-6)
    low, high = raster.bounds("cubic")
    assert low < cubic.min() < cubic.max() < high


def test_levels_are_means() -> None:
    samples = heights(32, 64)
    raster = patch(samples)
    assert raster.levels == 7
    means = samples.astype(np.float64).reshape(8, 4, 16, 4).mean(axis=(1, 3))
    rows, columns = np.mgrid[:8, :16]
    posts = np.stack([4.0 * columns.ravel() + 1.5, 4.0 * rows.ravel() + 1.5], axis=1)
    values = raster.values(raster.directions(posts), level=2)
    np.testing.assert_allclose(values, means.ravel(), atol=2e-4)


def test_outside_is_nan_and_weightless() -> None:
    raster = patch(heights(30, 40))
    inside, outside = raster.directions(np.array([[20.0, 15.0], [40.0, 15.0]]))
    directions = np.array([inside, outside, -inside, (np.nan, 0.0, 0.0), (0.0, 0.0, 0.0)])
    values, weights = raster.values(directions), raster.weights(directions, 4.0)
    assert np.isfinite(values).tolist() == [True, False, False, False, False]
    assert weights.tolist() == [1.0, 0.0, 0.0, 0.0, 0.0]
    assert np.isnan(raster.posts(directions)[1:]).all()
    assert raster.spacing_m(2.0 * RADIUS_M) == pytest.approx(20.0)
    assert not raster.whole


def test_samples_are_borrowed(tmp_path: Path) -> None:
    samples = heights(200, 300)
    path = tmp_path / "samples.raw"
    samples.tofile(path)
    mapped = np.memmap(path, np.float32, "r", shape=samples.shape)
    window = mapped[10:100, 20:250]
    before = sys.getrefcount(window)
    raster = patch(window)
    assert sys.getrefcount(window) == before + 1
    posts = np.array([[3.0, 4.0], [200.0, 80.0]])
    directions = raster.directions(posts)
    del window, mapped
    gc.collect()
    assert raster.values(directions).tolist() == [samples[14, 23], samples[90, 220]]
    owned = np.zeros((4, 4), np.uint8)
    held = patch(owned)
    with pytest.raises(ValueError, match="resize"):
        owned.resize((2, 2), refcheck=False)
    assert held.values(held.directions(np.zeros((1, 2)))).tolist() == [0.0]


@pytest.mark.parametrize(
    ("samples", "fault"),
    [
        (np.zeros((3, 3)), "uint8, int16, uint16 or float32"),
        (np.zeros(9, np.uint8), "2 dimensions"),
        (np.zeros((3, 6), np.int16)[:, ::2], "adjacent"),
        (np.zeros((6, 3), np.int16)[::-1], "from first to last"),
        (np.zeros((3, 3), ">i2"), "byte order"),
        (np.zeros((0, 3), np.int16), "0 posts|3 x 0"),
        (np.full((3, 3), np.nan, np.float32), "column 0, row 0"),
    ],
)
def test_bad_samples(samples: NDArray[Any], fault: str) -> None:
    with pytest.raises(ValueError, match=fault):
        patch(samples)


def test_bad_arguments() -> None:
    samples = np.zeros((2, 4), np.int16)
    with pytest.raises(TypeError, match="array"):
        _core.Raster([[1, 2]], "cylindrical", 0.0, 0.0, 0.1, -0.1)  # type: ignore[arg-type]
    with pytest.raises(ValueError, match=r"mercator.*cylindrical, stereographic, orthographic"):
        _core.Raster(samples, "mercator", 0.0, 0.0, 0.1, -0.1)
    raster = _core.Raster(samples, "cylindrical", 0.0, 0.0, 0.1, -0.1)
    with pytest.raises(ValueError, match="bilinear"):
        raster.values(np.zeros((1, 3)), "nearest")
    with pytest.raises(ValueError, match="directions: shape"):
        raster.values(np.zeros((1, 2)))
