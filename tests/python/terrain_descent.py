"""A descent to the ground of the Moon, from 200 km to 1.5 m straight down: holes, values that are
not finite, and changes from frame to frame beside those of a mesh of four cells a pixel's width.

Frames are a fixed factor of the height apart, so that the picture grows by the same factor."""

from __future__ import annotations

import argparse
import atexit
import sys
import tempfile
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from PIL import Image

import perilune

FRAMES = 300
HIGH_M, LOW_M = 200e3, 1.5
REFERENCE = 4.0
"""Cells per pixel of the mesh to compare with."""
MAGENTA_DN = 8.0
"""Red and blue above green that no ground has: one of 8 samples that meets the sky adds 30."""


@cache
def magenta() -> str:
    """A picture of the sky in one colour, which the ground has nowhere."""
    folder = tempfile.TemporaryDirectory()
    atexit.register(folder.cleanup)
    path = Path(folder.name) / "magenta.png"
    Image.new("RGB", (4, 2), (255, 0, 255)).save(path)
    return str(path)


def height_m(step: int, ideal: float) -> float:
    """The driver of the height: `ideal` at the first step, LOW_M at the last."""
    return float(ideal * (LOW_M / ideal) ** (step / (FRAMES - 1)))


def scene(width: int, height: int, cells_per_pixel: float) -> perilune.Simulation:
    """Ground of detail and craters, which needs no data, under a fixed exposure."""
    sys.path.insert(0, str(Path(__file__).resolve().parent))  # where the driver is found
    place = {"lon_deg": 10.0, "lat_deg": 20.0}
    terrain = {
        "detail": {"seed": 3, "strength": 0.5},
        "craters": {"seed": 3},
        "cells_per_pixel": cells_per_pixel,
    }
    moon = {"kind": "moon", "reflectance": "hapke", "albedo": 0.33, "terrain": terrain}
    hook = {
        "hook": "terrain_descent:height_m",
        "ideal": HIGH_M,
        "clip_min": 1.0,
        "clip_max": HIGH_M,
    }
    return perilune.open(
        {
            "version": 1,
            "time": {"epoch": "2026-03-03T06:00:00Z", "step_s": 0.0},
            "root": "moon",
            "sun": {"at": place | {"azimuth_deg": 100.0, "elevation_deg": 25.0}},
            "bodies": {"moon": moon},
            "sky": {"background": {"image": magenta()}},
            "camera": {
                "width": width,
                "height": height,
                "fov_deg": 50.0,
                "trajectory": {"kind": "hover", "target": "moon", "height_m": hook} | place,
                "exposure": {"mode": "fixed", "white_radiance_w_m2_sr": 60.0},
            },
            "render": {"samples": 8, "max_bounces": 1},
        }
    )


@dataclass(frozen=True)
class Frame:
    rgb: NDArray[np.float64]
    holes: int  # pixels of the sky at their middle
    leaks: int  # pixels through any sample of which the sky shines
    not_finite: int  # values of radiance, depth and normals


def frames(sim: perilune.Simulation, indices: Iterable[int], threads: int = 1) -> Iterator[Frame]:
    for k in indices:
        seen = sim.frame(k, ["rgb", "radiance", "depth", "normal", "instance"], threads=threads)
        values = [seen[name] for name in ("radiance", "depth", "normal")]
        bad = sum(int((~np.isfinite(of)).sum()) for of in values)
        sky = (seen["instance"] == 0) | ~(seen["depth"] > 0.0)
        rgb = seen["rgb"].astype(np.float64)
        leaks = np.minimum(rgb[..., 0], rgb[..., 2]) - rgb[..., 1] > MAGENTA_DN
        yield Frame(rgb, int(sky.sum()), int(leaks.sum()), bad)


def change_dn(a: Frame, b: Frame) -> float:
    """Root mean square over pixels and bands."""
    return float(np.sqrt(np.mean((a.rgb - b.rgb) ** 2)))


def local_change_dn(a: Frame, b: Frame) -> NDArray[np.float64]:
    """The same over squares of an eighth of the frame's height, at all places: a tile that jumps
    shows, where the rest of the frame hides it in the mean of all."""
    squares = ((a.rgb - b.rgb) ** 2).mean(axis=2)
    side = max(2, a.rgb.shape[0] // 8)
    sums = np.pad(squares, ((1, 0), (1, 0))).cumsum(axis=0).cumsum(axis=1)
    boxes = sums[side:, side:] - sums[:-side, side:] - sums[side:, :-side] + sums[:-side, :-side]
    return np.asarray(np.sqrt(np.maximum(boxes, 0.0)) / side)


@dataclass
class Report:
    frames: int = 0
    holes: int = 0
    leaks: int = 0
    not_finite: int = 0
    change_dn: float = 0.0  # largest between consecutive frames
    reference_dn: float = 0.0  # of the reference
    excess: float = 0.0  # largest ratio of the two, over the same frames
    excess_at: int = 0  # its first frame
    local_dn: float = 0.0  # largest local change
    local_reference_dn: float = 0.0
    local_excess_dn: float = 0.0  # most that a local change is above the reference's there
    local_excess_at: int = 0
    darkest_dn: float = 255.0  # least mean of a frame


def descend(
    size: tuple[int, int], runs: Iterable[Iterable[int]], threads: int = 1, compare: bool = True
) -> Report:
    """Runs: each of consecutive frames. Without `compare` there is no reference."""
    report = Report()
    sims = [scene(*size, 1.0)] + ([scene(*size, REFERENCE)] if compare else [])
    for run in runs:
        indices = list(run)
        before: list[Frame] | None = None
        ways = zip(*(frames(sim, indices, threads) for sim in sims), strict=True)
        for k, now in zip(indices, ways, strict=True):
            report.frames += 1
            report.holes += now[0].holes
            report.leaks += now[0].leaks
            report.not_finite += now[0].not_finite
            report.darkest_dn = min(report.darkest_dn, float(now[0].rgb.mean()))
            if before is not None:
                pairs = list(zip(before, now, strict=True))
                _compare(report, k - 1, [change_dn(*pair) for pair in pairs])
                compare_local(report, k - 1, [local_change_dn(*pair) for pair in pairs])
            before = list(now)
    return report


def _compare(report: Report, k: int, changes: list[float]) -> None:
    report.change_dn = max(report.change_dn, changes[0])
    if len(changes) < 2:
        return
    report.reference_dn = max(report.reference_dn, changes[1])
    if changes[0] / changes[1] > report.excess:
        report.excess, report.excess_at = changes[0] / changes[1], k


def compare_local(report: Report, k: int, changes: list[NDArray[np.float64]]) -> None:
    report.local_dn = max(report.local_dn, float(changes[0].max()))
    if len(changes) < 2:
        return
    report.local_reference_dn = max(report.local_reference_dn, float(changes[1].max()))
    excess = float((changes[0] - changes[1]).max())
    if excess > report.local_excess_dn:
        report.local_excess_dn, report.local_excess_at = excess, k


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--size", type=int, nargs=2, default=(160, 120), metavar=("W", "H"))
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--last", type=int, default=FRAMES - 1)
    parser.add_argument("--threads", type=int, default=2)
    parser.add_argument("--alone", action="store_true", help="no reference")
    asked: Any = parser.parse_args()
    run = range(asked.first, asked.last + 1)
    found = descend(tuple(asked.size), [run], asked.threads, not asked.alone)
    print(
        f"{found.frames} frames: {found.holes} holes, {found.leaks} pixels with light of the sky,"
        f" {found.not_finite} values not finite;"
        f" largest change {found.change_dn:.2f} DN"
    )
    if not asked.alone:
        print(
            f"with {REFERENCE:g} cells a pixel {found.reference_dn:.2f} DN;"
            f" largest ratio {found.excess:.3f}, after frame {found.excess_at}"
        )
        print(
            f"local changes up to {found.local_dn:.1f} DN, {found.local_reference_dn:.1f} with it;"
            f" {found.local_excess_dn:.1f} DN above it at one place, after frame"
            f" {found.local_excess_at}"
        )
    jumps = found.excess > 1.1 or found.local_excess_dn > 6.0
    return 1 if found.holes or found.leaks or found.not_finite or jumps else 0


if __name__ == "__main__":
    raise SystemExit(main())
