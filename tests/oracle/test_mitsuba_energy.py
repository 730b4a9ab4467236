"""Energy where metal lights metal, against Mitsuba 3: two facing mirrors, a metal box with a hole,
a glossy ball in a glossy box.

All metals here mirror all light, so that what is lost or won on the way adds up. Light that sharp
lobes hand on to sharp lobes is what path regularisation would blur: at a tolerance of 0 there is
none. What the two define differently hardly matters for lobes as smooth as these: Mitsuba's metals
lose what a second facet would have to turn, ours send it everywhere: PART of the light on all
bounces together, and DIM where nothing else is seen.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from tests.oracle import test_mitsuba as base
from tests.oracle.test_mitsuba import Shape, ball, rectangle

GROUND = Shape(rectangle((0, 0, -0.02), (30, 0, 0), (0, 30, 0)), (0.3, 0.3, 0.3))
PART, DIM = 5e-3, 0.02  # DIM: W m-2 sr-1, the lamp has 900
OUR_SAMPLES, THEIR_SAMPLES = 64, 128


def metal(corners: np.ndarray, roughness: float) -> Shape:
    return Shape(corners, (1.0, 1.0, 1.0), roughness=roughness)


def box(roughness: float, half: float, height: float, hole: float) -> list[Shape]:
    """A box on the ground whose lid has a square hole of half the side `hole`."""
    h, z = half, 0.5 * height
    walls = [
        rectangle((0, 0, 0), (h, 0, 0), (0, h, 0)),
        rectangle((-h, 0, z), (0, h, 0), (0, 0, z)),
        rectangle((h, 0, z), (0, 0, z), (0, h, 0)),
        rectangle((0, -h, z), (0, 0, z), (h, 0, 0)),
        rectangle((0, h, z), (h, 0, 0), (0, 0, z)),
    ]
    rim, middle = 0.5 * (h - hole), 0.5 * (h + hole)
    if rim > 0.0:
        walls += [
            rectangle((0, side * middle, height), (h, 0, 0), (0, rim, 0)) for side in (-1.0, 1.0)
        ]
        walls += [
            rectangle((side * middle, 0, height), (rim, 0, 0), (0, hole, 0)) for side in (-1.0, 1.0)
        ]
    return [metal(np.concatenate(walls), roughness)]


def smooth_ball(center: tuple[float, float, float], radius: float, roughness: float) -> Shape:
    shape = metal(ball(center, radius, 48, 96), roughness)
    out = shape.corners - np.array(center)
    shape.normals = out / np.linalg.norm(out, axis=-1, keepdims=True)
    return shape


def mirrors(roughness: float) -> list[Shape]:
    """Two that face each other, along the view."""
    a = rectangle((-1.2, 0, 1.0), (0, 2.4, 0), (0, 0, 1.0))
    b = rectangle((1.2, 0, 1.0), (0, 0, 1.0), (0, 2.4, 0))
    return [metal(np.concatenate([a, b]), roughness)]


LAMP = Shape(
    rectangle((0.0, 0.3, 3.2), (0, 0.6, 0), (0.6, 0, 0)), (0.0, 0.0, 0.0), None, (900, 750, 300)
)
# Shapes, irradiance, bounces.
CASES = {
    "two facing mirrors": ([GROUND, *mirrors(0.1), LAMP], 0.0, 6),
    "box with a hole": ([GROUND, *box(0.1, 1.6, 1.8, 1.2), LAMP], 0.0, 5),
    "ball in a box": (
        [GROUND, *box(0.1, 1.7, 1.3, 1.7), smooth_ball((0.1, 0.3, 0.75), 0.6, 0.1), LAMP],
        0.0,
        5,
    ),
}


@pytest.mark.slow
@pytest.mark.parametrize(
    "case",
    [pytest.param(case, marks=[pytest.mark.soak] if "box" in case else []) for case in CASES],
)
def test_energy(case: str, tmp_path: Path):
    a = base.ours(*CASES[case], tmp_path, samples=OUR_SAMPLES)
    b = base.theirs(*CASES[case], tmp_path, samples=THEIR_SAMPLES)
    p = base.worst_p_value(a, b, PART, DIM)
    ratio = a.mean() / b.mean()
    print(f"{case}: p = {p:.3g} over all blocks, mean ratio {ratio:.5f}")
    assert p > base.FALSE_ALARM
    assert abs(ratio - 1.0) < 0.02
