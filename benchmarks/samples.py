"""Error against time: adaptive sampling beside equal numbers everywhere, and bounces.

The error is the root mean square over pixels and bands, in digital numbers of 255 before rounding,
against a frame of many samples and bounces at the same exposure. Times are CPU seconds of whole
frames on one thread, medians, and their ratio to those of `--equal` samples in every pixel. The
last row says what the adaptive mode needs for the error of those: interpolated along its curve.
"""

from __future__ import annotations

import time
from typing import Any

import numpy as np
import report

import perilune

REFERENCE = {"samples": 1024, "max_bounces": 8, "tolerance_dn": 0.0}
SAMPLES = (2, 4, 8, 16, 32, 64)
BOUNCES = (0, 1, 2, 4, 8)
REPEATS = 3


def encode(radiance: np.ndarray, white: float) -> np.ndarray:
    """Display values of 255, sRGB (IEC 61966-2-1), not rounded."""
    x = np.clip(radiance.astype(float) / white, 0.0, 1.0)
    low = x <= 0.0031308
    return 255.0 * np.where(low, 12.92 * x, 1.055 * np.maximum(x, 1e-9) ** (1 / 2.4) - 0.055)


class Job:
    """A frame of a configuration, rendered with several qualities."""

    def __init__(self, config: str, frame: int, width: int) -> None:
        self.config, self.frame = config, frame
        self.size: dict[str, Any] = {"camera.width": width, "camera.height": width * 3 // 4}
        self.white = 0.0
        self.truth = np.empty(0)
        self.truth = self.picture(1, **REFERENCE)[0]

    def picture(self, repeats: int, **render: float) -> tuple[np.ndarray, float]:
        """Display values at the reference's exposure, and CPU seconds."""
        overrides = self.size | {f"render.{key}": value for key, value in render.items()}
        sim = perilune.open(self.config, overrides=overrides)
        sim.frame(self.frame, channels=["depth"], threads=1)  # models and maps are loaded once
        times = []
        for _ in range(repeats):
            start = time.process_time()
            sample = sim.frame(self.frame, channels=["rgb", "radiance"], threads=1)
            times.append(time.process_time() - start)
        self.white = self.white or sample.meta["white_radiance"]
        return encode(sample["radiance"], self.white), report.median(times)

    def error(self, **render: float) -> tuple[float, float]:
        """Root mean square error in digital numbers, and CPU seconds."""
        image, seconds = self.picture(REPEATS, **render)
        return float(np.sqrt(np.mean((image - self.truth) ** 2))), seconds


def seconds_at(error: float, curve: list[tuple[float, float]]) -> float:
    """Seconds for an error along a curve of (error, seconds), straight in the logarithms."""
    errors, seconds = (np.log(values) for values in zip(*sorted(curve), strict=True))
    return float(np.exp(np.interp(np.log(error), errors, seconds)))


def main() -> None:
    parser = report.arguments(__doc__)
    parser.add_argument("--config", default=str(report.ROOT / "configs" / "demo.yaml"))
    parser.add_argument("--frame", type=int, default=2)
    parser.add_argument("--width", type=int, default=320)
    parser.add_argument("--equal", type=int, default=16, help="samples to match")
    options = parser.parse_args()
    job = Job(options.config, options.frame, options.width)
    level, level_s = job.error(samples=options.equal, tolerance_dn=0.0)
    rows: list[list[object]] = []
    curve = []
    for mode, tolerance_dn in (("equal", 0.0), ("adaptive", 1.0)):
        for samples in SAMPLES:
            error, seconds = job.error(samples=samples, tolerance_dn=tolerance_dn)
            rows.append([f"{mode} samples", samples, error, seconds, seconds / level_s])
            if mode == "adaptive":
                curve.append((error, seconds))
    for bounces in BOUNCES:
        error, seconds = job.error(samples=64, tolerance_dn=0.0, max_bounces=bounces)
        rows.append(["bounces", bounces, error, seconds, seconds / level_s])
    matched_s = seconds_at(level, curve)
    rows.append([f"adaptive, as {options.equal} equal", "", level, matched_s, matched_s / level_s])
    keys = ["knob", "value", "rms_dn", "cpu_seconds", "time_ratio"]
    report.publish(
        options.json,
        {
            "config": options.config,
            "equal_samples": options.equal,
            "equal_rms_dn": level,
            "matched_over_equal_ratio": matched_s / level_s,
            "rows": [dict(zip(keys, row, strict=True)) for row in rows],
        },
        [report.table(["knob", "value", "RMS error, DN", "CPU s", "time ratio"], rows)],
    )


if __name__ == "__main__":
    main()
