"""The exact diameter of a point set, against all pairs."""

from __future__ import annotations

import numpy as np
import pytest

from perilune.export.writers.diameter import diameter


def brute_force(points):
    delta = points[:, None, :] - points[None, :, :]
    return np.sqrt((delta**2).sum(axis=2).max())


@pytest.mark.parametrize("seed", range(60))
def test_random_sets(seed):
    random = np.random.default_rng(seed)
    points = random.normal(size=(random.integers(1, 600), 3))
    points *= random.choice([0.0, 1e-3, 1.0, 40.0], 3)
    assert diameter(points) == pytest.approx(brute_force(points), rel=1e-12, abs=1e-300)


@pytest.mark.parametrize("seed", range(10))
def test_points_on_a_sphere(seed):
    """The worst case: every point is an end of a segment nearly as long as the longest."""
    points = np.random.default_rng(seed).normal(size=(900, 3))
    points /= np.linalg.norm(points, axis=1, keepdims=True)
    assert diameter(points) == pytest.approx(brute_force(points), rel=1e-12)


def test_all_pairs_of_a_cube_tie():
    corners = np.array(np.meshgrid([0, 1], [0, 1], [0, 1])).reshape(3, 8).T
    assert diameter(np.repeat(corners, 50, axis=0)) == pytest.approx(np.sqrt(3.0))


def test_single_and_repeated_points():
    assert diameter(np.ones((1, 3))) == 0.0
    assert diameter(np.ones((500, 3))) == 0.0
    with pytest.raises(ValueError, match="no points"):
        diameter(np.empty((0, 3)))
