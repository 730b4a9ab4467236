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
LONG = {"apollo15", "articulated", "comet", "lunar_rover", "mars_descent", "mli_randomised"}
"""Left to script/soak: a third of the time of all configurations."""


def params() -> list:
    """One parameter a configuration; those that use data: paths need the data."""
    out = []
    for name, path in CONFIGS.items():
        marks = [pytest.mark.needs_data] if convergence.needs_data(path) else []
        marks += [pytest.mark.soak] if name in LONG else []
        out.append(pytest.param(name, marks=marks))
    return out


@pytest.mark.parametrize("name", params())
def test_errors_fall_with_samples(name):
    scene = convergence.Scene(CONFIGS[name], (16, 12), 256)
    curve = scene.curve(SAMPLES, TOLERANCE_DN)
    if curve.verdict(TOLERANCE_DN) == "yes":
        return
    # Frames of few pixels whose noise has a slope of its own: as that of all samples everywhere.
    even = scene.curve(SAMPLES[-1:], 0.0).errors[0]
    assert curve.errors[-1] < 1.3 * even, (curve.errors, even)


def test_stars_of_the_reference_are_spread_as_those_of_frames(tmp_path):
    """A frame shares out a star to four pixels: means of smaller pixels alone would be 2 DN off."""
    draw = np.random.default_rng(3)
    stars = tmp_path / "stars.csv"
    lines = [f"{a},{b},{m},0.5" for a, b, m in zip(
        draw.uniform(0.0, 360.0, 4000), np.degrees(np.arcsin(draw.uniform(-1.0, 1.0, 4000))),
        draw.uniform(0.0, 4.0, 4000), strict=True)]  # fmt: skip
    stars.write_text("ra_deg,dec_deg,vmag,bv\n" + "\n".join(lines) + "\n")
    scene = convergence.Scene(
        CONFIGS["star_tracker"], (16, 12), 9, changes={"sky.stars.catalogue": str(stars)}
    )
    picture = scene.picture(4, 0.0)
    assert np.count_nonzero(picture > 1.0) > 50
    assert scene.error(picture) < 0.05


class Stuck(convergence.Scene):
    """An estimator that stops converging: it draws no more than so many samples."""

    most = 4

    def radiance(self, samples, tolerance_dn, noise=0):
        return super().radiance(min(samples, self.most), tolerance_dn, noise)


class Slow(convergence.Scene):
    """An estimator whose error falls with a quarter of the slope that it should have."""

    def radiance(self, samples, tolerance_dn, noise=0):
        return super().radiance(round(4 * (samples / 4) ** 0.25), tolerance_dn, noise)


class Bright(convergence.Scene):
    """An estimator that is too bright by 5 %, at any number of samples."""

    def radiance(self, samples, tolerance_dn, noise=0):
        return super().radiance(samples, tolerance_dn, noise) * 1.05


@pytest.mark.parametrize(
    ("kind", "verdict"),
    [(convergence.Scene, "yes"), (Stuck, "NO"), (Slow, "NO"), (Bright, "NO")],
)
def test_an_estimator_that_stops_converging_is_seen(kind, verdict):
    scene = kind(ROOT / "configs" / "oaisys" / "custom.json", (16, 12), 256, seeds=4)
    curve = scene.curve((4, 16, 64, 256), 0.0, seeds=2)
    assert curve.verdict(0.0) == verdict, (curve.errors, curve.slope())


def test_slopes_have_the_standard_errors_that_are_stated():
    """Errors of eight frames a point that fall as n^-0.5, their squares as uneven as those of a few
    bright pixels (gamma, k = 4)."""
    draw = np.random.default_rng(7)
    off = []
    for _ in range(400):
        squares = [draw.gamma(4.0, 0.25 / n, 8) for n in (4, 16, 64, 256)]
        slope, deviation = convergence.Curve((4, 16, 64, 256), squares).slope()
        off.append((slope + 0.5) / deviation)
    assert 0.85 < np.std(off) < 1.3
    assert abs(np.mean(off)) < 0.25


def stands_dark(name, changes, samples=128):
    """Error of a night side, that of all samples everywhere, and how much is wrongly black."""
    scene = convergence.Scene(CONFIGS[name], (48, 36), 1024, changes=changes)
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


def test_pixels_beside_glints_are_not_left_early():
    """Four by three pixels of foil that the sun's glints make white, but not all of them: the
    neighbours of a dark one are white on average, where noise is not seen."""
    scene = convergence.Scene(CONFIGS["moonlet"], (4, 3), 1024, windows=[(284, 228)])
    adaptive, even = (scene.squares(256, dn, 4) for dn in (TOLERANCE_DN, 0.0))
    assert np.mean(adaptive) < 1.5 * np.mean(even), (adaptive, even)
