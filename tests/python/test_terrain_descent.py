"""A descent from 200 km to 1.5 m: no holes, and no jumps that a far finer mesh does not have."""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parent))
import terrain_descent as descent

SIZE = (48, 36)
PLACES = (0, 75, 150, 224, 298)
"""First frames of pairs; heights of 200 km, 10 km, 0.5 km, 30 m, 1.5 m."""


def test_a_descent_has_no_holes_and_no_jumps():
    found = descent.descend(SIZE, [(k, k + 1) for k in PLACES])
    assert found.frames == 10
    assert (found.holes, found.leaks, found.not_finite) == (0, 0, 0)
    assert found.darkest_dn > 20.0  # there is something to see
    assert 1.0 < found.change_dn < 1.15 * found.reference_dn
    assert found.excess < 1.25
    assert 1.0 < found.local_dn < 1.15 * found.local_reference_dn
    assert found.local_excess_dn < 4.0  # of changes up to 50


def test_a_local_step_shows():
    """A tile of a sixteenth of the frame that jumps by 12 DN is nothing in the mean of all."""
    rng = np.random.default_rng(1)
    before, true = (
        descent.Frame(rng.normal(128.0, 3.0, (*SIZE[::-1], 3)), 0, 0, 0) for _ in range(2)
    )
    stepped = true.rgb.copy()
    stepped[9:18, 12:24] += 12.0
    report = descent.Report()
    found = [
        descent.local_change_dn(before, frame) for frame in (descent.Frame(stepped, 0, 0, 0), true)
    ]
    descent.compare_local(report, 7, found)
    assert descent.change_dn(before, descent.Frame(stepped, 0, 0, 0)) < 1.35 * descent.change_dn(
        before, true
    )
    assert report.local_excess_dn > 6.0
    assert report.local_excess_at == 7


def test_the_sky_is_counted():
    sim = descent.scene(*SIZE, 0.5).with_overrides({"camera.trajectory.off_nadir_deg": 60.0})
    (frame,) = descent.frames(sim, [0])
    assert 0 < frame.holes < SIZE[0] * SIZE[1]
    assert frame.holes <= frame.leaks < frame.holes + 2 * SIZE[0]  # the limb's pixels have both
    assert frame.not_finite == 0
