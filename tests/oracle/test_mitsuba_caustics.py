"""Sunlight that a mirror throws onto diffuse surfaces, against Mitsuba 3.

Mitsuba meets the mirror by chance, and is noisy. On rougher mirrors it loses the light that
microfacets reflect to each other. What is compared, and how, is in test_mitsuba.py.
"""

from __future__ import annotations

from pathlib import Path

import pytest
from tests.oracle import test_mitsuba as oracle

# Throws the Sun onto the ground before it, the box and the ball.
WING = oracle.Shape(
    oracle.rectangle((-0.4, -2.4, 0.9), (1.1, 0.2, 0.0), (-0.05, 0.3, 0.75)),
    (1.0, 1.0, 1.0),
    roughness=0.2,
)


@pytest.mark.slow
def test_caustics(tmp_path: Path) -> None:
    bounces = 2
    shapes = [oracle.GROUND, oracle.BOX, oracle.BALL, WING]
    a = oracle.ours(shapes, oracle.SOLAR, bounces, tmp_path, samples=oracle.OUR_SAMPLES)
    b = oracle.theirs(shapes, oracle.SOLAR, bounces, tmp_path, samples=oracle.THEIR_SAMPLES)
    without = oracle.ours(shapes[:-1], oracle.SOLAR, bounces, tmp_path, samples=64)
    p = oracle.worst_p_value(a, b)
    ratio = a.mean() / b.mean()
    print(f"p = {p:.3g} over all blocks, mean ratio {ratio:.5f}")
    assert p > oracle.FALSE_ALARM
    assert abs(ratio - 1.0) < 5e-3
    # The caustic is there, and the test sees a tenth of it.
    added = (a - without).clip(min=0.0)
    assert added.max() > 0.2 * a.max()
    assert oracle.worst_p_value(a - 0.1 * added, b) < oracle.FALSE_ALARM
