"""Images come to the truth: the error of every configuration falls as its samples grow.

`benchmarks/convergence.py` draws whole curves; here are tiny images of a few of their points.
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
import pytest

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "benchmarks"))
import convergence  # noqa: E402

CONFIGS = convergence.shipped()
TOLERANCE_DN = 1.0
SAMPLES = (4, 16, 64)


def params() -> list:
    """One parameter a configuration; those that use data: paths need the data."""
    out = []
    for name, path in CONFIGS.items():
        marks = [pytest.mark.needs_data] if convergence.needs_data(path) else []
        out.append(pytest.param(name, marks=marks))
    return out


@pytest.mark.parametrize("name", params())
def test_errors_fall_with_samples(name):
    scene = convergence.Scene(CONFIGS[name], (16, 12), 256)
    errors = scene.curve(SAMPLES, TOLERANCE_DN)
    if convergence.converges(SAMPLES, errors, TOLERANCE_DN):
        return
    # Frames of few pixels whose noise has a slope of its own: as that of all samples everywhere.
    even = scene.curve(SAMPLES[-1:], 0.0)[0]
    assert errors[-1] < 1.3 * even, (errors, even)


def stands_dark(name, changes, samples=128):
    """Error of a night side, that of all samples everywhere, and how much is wrongly black."""
    scene = convergence.Scene(CONFIGS[name], (64, 48), 1024, changes=changes)
    reference = np.mean(scene.reference, axis=0).max(axis=-1)
    picture = scene.picture(samples, TOLERANCE_DN)
    lit = reference > 2.0
    black = np.count_nonzero(lit & (picture.max(axis=-1) == 0.0)) / np.count_nonzero(lit)
    return scene.error(picture), scene.error(scene.picture(samples, 0.0)), black


@pytest.mark.parametrize(
    "changes",
    [
        pytest.param({}, id="smallsat"),
        pytest.param(
            {"spacecraft.craft.model": "data:spacecraft/plain/tdrs_a.glb"},
            id="tdrs",
            marks=[pytest.mark.needs_data],
        ),
    ],
)
def test_a_night_side_is_not_left_in_the_dark(changes):
    """Pixels that have found no light yet are not quiet."""
    adaptive, even, black = stands_dark("night_side", changes)
    assert adaptive < 1.1 * even
    assert black < 0.05
