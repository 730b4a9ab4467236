"""The same frame by Blender's Cycles and by Perilune: error against time, side by side.

Each is compared with its own converged image, in digital numbers of 255 at one exposure, so that
differences of materials, filters and readers count for nothing, and with the other's, in which they
count. The last rows say how long Perilune needs for the error of Cycles' `--equal` samples by its
own image, and against Cycles' image. Times are CPU times, medians over frames of other seeds.
Cycles renders even samples without a denoiser, with the passes that labels need and its scene kept
from frame to frame; Perilune renders with all labels. Needs a Python that has Blender as a module
(pip install bpy==4.5.*, some 500 MB): `--python`.
"""

from __future__ import annotations

import math
import sys
import tempfile
import time
from pathlib import Path
from typing import Any

import numpy as np
import report
from reference import compare, engines, export, ours, scenes
from reference.scene import Array
from samples import seconds_at

CYCLES_SAMPLES = (4, 16, 64)
OWN_SAMPLES = (1, 2, 3, 4, 6, 8, 12, 16, 32, 64)
SEEDS = (1, 2, 3)


def rms(image: Array, truth: Array) -> float:
    return float(np.sqrt(np.mean((image - truth) ** 2)))


class Own:
    """Frames of Perilune at several numbers of samples."""

    def __init__(self, frame: scenes.Frame, width: int, folder: Path, threads: int) -> None:
        self.frame, self.width, self.folder, self.threads = frame, width, folder, threads

    def picture(self, **render: Any) -> tuple[Array, float]:
        """Radiance and seconds of CPU time, median of as many frames as Cycles renders."""
        sim = self.frame.open(self.width, self.folder, **render)
        channels = ["rgb", "radiance", *report.LABELS, "objects"]
        sample = sim.frame(self.frame.index, channels=channels, threads=self.threads)
        times = []
        for _ in SEEDS:
            start = time.process_time()
            sim.frame(self.frame.index, channels=channels, threads=self.threads)
            times.append(time.process_time() - start)
        return sample["radiance"], report.median(times)


def reached(error: float, curve: list[tuple[float, float]]) -> float:
    """Seconds for an error along a curve of (error, seconds); infinite where it stays above."""
    return seconds_at(error, curve) if error >= min(e for e, _ in curve) else math.inf


def main() -> None:
    parser = report.arguments(__doc__)
    parser.add_argument("--frame", default="voyager", choices=scenes.FRAMES)
    parser.add_argument("--width", type=int, default=640)
    parser.add_argument("--equal", type=int, default=16, choices=CYCLES_SAMPLES[:-1])
    parser.add_argument("--truth", type=int, default=256, help="samples of Cycles' converged image")
    parser.add_argument("--own-truth", type=int, default=1024)
    parser.add_argument("--tolerance", type=float, default=1.0, help="of Perilune, DN")
    parser.add_argument("--python", default=sys.executable, help="a Python that has bpy")
    options = parser.parse_args()
    frame = scenes.FRAMES[options.frame]
    with tempfile.TemporaryDirectory() as temporary:
        folder = Path(temporary)
        own = Own(frame, options.width, folder, options.threads)
        mine = ours.render(
            frame.open(options.width, folder), frame.index, options.own_truth, [7], options.threads
        )[0]
        sim = frame.open(options.width, folder)
        scene = export.export(sim, frame.index)
        renders = [(count, seed) for count in CYCLES_SAMPLES for seed in SEEDS]
        renders.append((options.truth, max(SEEDS) + 1))
        images, seconds = engines.cycles(
            scene, folder, options.python, renders, options.threads, passes=True
        )

        def shown(radiance: Array) -> Array:
            return compare.encode(radiance, scene.white_radiance)

        truths = {"Perilune": shown(mine), "Cycles": shown(images[-1])}
        rows: list[list[object]] = []
        levels = {}
        for k, count in enumerate(CYCLES_SAMPLES):
            runs = slice(k * len(SEEDS), (k + 1) * len(SEEDS))
            seen = np.stack([shown(image) for image in images[runs]])
            errors = [rms(seen, truths[word]) for word in ("Cycles", "Perilune")]
            levels[count] = (*errors, report.median(seconds[runs]))
            rows.append(["Cycles", count, *levels[count]])
        by_own, by_cycles = [], []
        for count in OWN_SAMPLES:
            image, took = own.picture(samples=count, tolerance_dn=options.tolerance)
            errors = [rms(shown(image), truths[word]) for word in ("Perilune", "Cycles")]
            by_own.append((errors[0], took))
            by_cycles.append((errors[1], took))
            rows.append(["Perilune", count, *errors, took])
    error, _, cycles_s = levels[options.equal]
    matched, against = reached(error, by_own), reached(error, by_cycles)
    rows.append([f"Perilune, as Cycles' {options.equal}", "", error, "", matched])
    rows.append(["the same against Cycles' image", "", "", error, against])
    head = ["renderer", "samples", "RMS to own image, DN", "to the other's, DN", "CPU s"]
    report.publish(
        options.json,
        {
            "frame": options.frame,
            "rows": rows[:-2],
            "cycles_rms_dn": error,
            "cycles_seconds": cycles_s,
            "perilune_seconds": matched,
            "ratio": cycles_s / matched,
            "perilune_seconds_against_cycles": against,
            "apart_dn": rms(truths["Cycles"], truths["Perilune"]),
        },
        [report.table(head, rows)],
    )


if __name__ == "__main__":
    main()
