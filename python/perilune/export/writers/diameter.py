"""The largest distance between any two points of a set, exactly, without visiting all pairs."""

import numpy as np
from numpy.typing import NDArray

F64 = NDArray[np.float64]

_LEAF_POINTS = 16
_SWEEPS = 8
_PAIRS_AT_ONCE = 1 << 13


def _farthest_pair_guess(points: F64) -> float:
    """A lower bound: walk from a point to the one farthest from it until that stops helping."""
    index, best = 0, 0.0
    for _ in range(_SWEEPS):
        distance2 = ((points - points[index]) ** 2).sum(axis=1)
        index = int(distance2.argmax())
        found = float(distance2[index])
        if found <= best:
            break
        best = found
    return best


def _worth_keeping(points: F64, best2: float) -> F64:
    """Points that may end a longer segment: |p - c| + max |q - c| must exceed the lower bound."""
    center = 0.5 * (points.min(axis=0) + points.max(axis=0))
    radius = np.linalg.norm(points - center, axis=1)
    return np.asarray(points[radius + radius.max() >= np.sqrt(best2) * (1.0 - 1e-12)])


def _sorted_into_tree(points: F64) -> tuple[F64, int]:
    """Points in the order of a balanced k-d tree with 2^depth equal leaves, (points, depth).

    The last point is repeated to fill the leaves: that changes no distance.
    """
    depth = max(0, int(np.ceil(np.log2(max(1, len(points) / _LEAF_POINTS)))))
    leaf = -(-len(points) // (1 << depth))
    fill = (leaf << depth) - len(points)
    ordered = np.concatenate([points, np.repeat(points[-1:], fill, axis=0)])
    for level in range(depth):
        groups = ordered.reshape(1 << level, -1, 3)
        axis = np.ptp(groups, axis=1).argmax(axis=1)
        keys = np.take_along_axis(groups, axis[:, None, None], axis=2)[:, :, 0]
        order = np.argsort(keys, axis=1, kind="stable")
        ordered = np.take_along_axis(groups, order[:, :, None], axis=1).reshape(-1, 3)
    return ordered, depth


def _bound2(low: F64, high: F64, first: NDArray[np.int64], second: NDArray[np.int64]) -> F64:
    """Upper bound of the squared distance between points of two boxes."""
    reach = np.maximum(high[first] - low[second], high[second] - low[first])
    return np.asarray((reach * reach).sum(axis=1))


def _best_of_leaves(
    leaves: F64,
    first: NDArray[np.int64],
    second: NDArray[np.int64],
    bound2: F64,
    best2: float,
) -> float:
    """Visits pairs of leaves, the most promising first, until no bound exceeds the best."""
    order = np.argsort(-bound2, kind="stable")
    for start in range(0, len(order), _PAIRS_AT_ONCE):
        batch = order[start : start + _PAIRS_AT_ONCE]
        batch = batch[bound2[batch] > best2]
        if batch.size == 0:
            break
        delta = leaves[first[batch], :, None, :] - leaves[second[batch], None, :, :]
        best2 = max(best2, float(np.einsum("abcd,abcd->abc", delta, delta).max()))
    return best2


def diameter(points: F64) -> float:
    """Largest distance between two of the points (n, 3); 0 for a single one.

    Branch and bound on pairs of boxes of a k-d tree: a pair is split only while its farthest
    corners are farther apart than the best pair of points found so far.
    """
    points = np.asarray(points, dtype=np.float64)
    if len(points) == 0:
        raise ValueError("diameter: no points")
    best2 = _farthest_pair_guess(points)
    ordered, depth = _sorted_into_tree(_worth_keeping(points, best2))
    first = second = np.zeros(1, dtype=np.int64)
    low = high = bound2 = np.empty(0)
    for level in range(depth + 1):
        groups = ordered.reshape(1 << level, -1, 3)
        low, high = groups.min(axis=1), groups.max(axis=1)
        if level > 0:
            first = (2 * first[:, None] + np.array([0, 0, 1, 1])).ravel()
            second = (2 * second[:, None] + np.array([0, 1, 0, 1])).ravel()
        # The pair (i, j) stands for (j, i) as well; splitting (i, i) makes both.
        once = first <= second
        first, second = first[once], second[once]
        bound2 = _bound2(low, high, first, second)
        promising = bound2 > best2
        first, second, bound2 = first[promising], second[promising], bound2[promising]
    leaves = ordered.reshape(1 << depth, -1, 3)
    return float(np.sqrt(_best_of_leaves(leaves, first, second, bound2, best2)))
