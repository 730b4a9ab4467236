"""The roughness of an elevation model: the power law that its heights follow at their shortest
baselines, by which detail continues them below the posts.

The law is nu(L) = deviation (L / baseline)^H, where nu is the RMS difference of heights over a
baseline L. It is fitted to differences over 1 to 8 posts and *assumed* to go on below them. That is
wrong where the model does not resolve its posts (smoothed or interpolated: H comes out too high),
or is noisy (too low). Both bend the law, which is what `bend` tells."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from perilune.bodies.elevation import ElevationRaster

F64 = NDArray[np.float64]
_LAGS = (1, 2, 3, 4, 6, 8)
_LONG = (12, 16)
"""Further differences, which tell whether the law bends."""
_BLOCK = 512
"""Posts on a side of the blocks that are looked at."""
_BLOCKS = 6
"""Blocks along a side of a large model, evenly spread."""
BEND = 0.2
"""Models whose law bends by more are not continued by it."""


@dataclass(frozen=True)
class Roughness:
    """The law of an elevation model."""

    hurst: float
    """In [0, 1]."""
    baseline_m: float
    deviation_m: float
    """RMS difference of heights over baseline_m."""
    bend: float
    """Exponent over 1 to 2 posts less that over 8 to 16, or the longest there are: near 0 for a
    power law, above if the model is smoothed, below if it is noisy."""


def roughness(blocks: list[F64], step_x_m: float | None, step_y_m: float) -> Roughness | None:
    """The law of blocks (rows, columns) of heights, m, from differences along columns and, unless
    step_x_m is None, along rows. None for less than 9 posts, and for flat models."""
    sums: dict[float, list[float]] = {}
    for block in blocks:
        for lag in _LAGS + _LONG:
            for axis, step in ((0, step_y_m), (1, step_x_m)):
                if step is None or block.shape[axis] <= lag:
                    continue
                ahead = np.moveaxis(block, axis, 0)
                squares = (ahead[lag:] - ahead[:-lag]) ** 2
                total = sums.setdefault(lag * step, [0.0, 0.0])
                total[0] += float(squares.sum())
                total[1] += squares.size
    points = {length: math.sqrt(total / count) for length, (total, count) in sums.items()}
    if len(points) < len(_LAGS) or min(points.values()) <= 0.0:
        return None
    baselines = np.array(sorted(points))
    deviations = np.array([points[length] for length in baselines])
    fitted = baselines <= max(_LAGS) * max(step_y_m, step_x_m or 0.0)
    ends = baselines <= 2.0 * baselines[0], baselines >= 0.5 * baselines[-1]
    bend = _exponent(baselines, deviations, ends[0]) - _exponent(baselines, deviations, ends[1])
    return Roughness(
        min(max(_exponent(baselines, deviations, fitted), 0.0), 1.0),
        float(np.exp(np.log(baselines[fitted]).mean())),
        float(np.exp(np.log(deviations[fitted]).mean())),
        bend,
    )


def _exponent(baselines: F64, deviations: F64, part: NDArray[np.bool_]) -> float:
    return float(np.polyfit(np.log(baselines[part]), np.log(deviations[part]), 1)[0])


def of_elevation(model: ElevationRaster, radius_m: float) -> Roughness | None:
    """The law of an elevation model on a body of this radius. Of cylindrical models, whose columns
    draw together towards the poles, only differences along columns count."""
    samples, place = model.samples, model.place
    cylindrical = place.projection == "cylindrical"
    unit = radius_m if cylindrical else 1.0
    rows, columns = (_starts(length) for length in samples.shape)
    blocks = [
        _metres(samples[row : row + _BLOCK, column : column + _BLOCK], model)
        for row in rows
        for column in columns
    ]
    return roughness(blocks, None if cylindrical else abs(place.dx) * unit, abs(place.dy) * unit)


def _starts(length: int) -> list[int]:
    last = max(length - _BLOCK, 0)
    count = min(_BLOCKS, -(-length // _BLOCK))
    return sorted({round(last * k / max(count - 1, 1)) for k in range(count)})


def _metres(samples: NDArray[Any], model: ElevationRaster) -> F64:
    return model.scale_m * samples.astype(float) + model.offset_m
