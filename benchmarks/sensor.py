"""Error against time of the sensor's stages: what leaving one out changes, and what it costs.

One frame is taken with all stages of the sensor (`tolerance_dn: 0`), then again with each of them
left out; the error is the root mean square and the largest difference of `sensor_rgb`, in digital
numbers of 255 (rounding alone makes 1), beside the bound of the row. `shot_noise`, `blooming` and
`black_sun` are in their own rows alone: a changed mean draws other noise of the same kind, what is
full flows elsewhere, and more light may be less charge, so that with them frames would differ by
more than what the stage changes; likewise `compression`, whose artefacts are of the whole picture.
The cost is the difference of CPU times of the frames on one thread, medians; below some ten
milliseconds it is noise of the machine.
"""

from __future__ import annotations

import time
from typing import Any

import numpy as np
import report

import perilune

SENSOR: dict[str, Any] = {
    "preset": "ccd47_20",
    "point_spread": {"core": "airy", "wings": 0.01},
    "cosmic_rays": {"flux_cm2_s": 100.0},
    "hot_pixels": 2e-4,
    "dead_pixels": 1e-4,
    "shift_us": 0.2,
    "lens_flare": {},
    "reset_us": 1.0,
    "compression": {"quality": 90.0},
    "row_noise_e": 4.0,
    "column_noise_e": 4.0,
    "temperature_c": 20.0,
}
STAGES = ("lens_flare", "vignetting", "point_spread", "fixed_pattern", "smear", "dark_current",
          "defects", "shot_noise", "cosmic_rays", "blooming", "black_sun", "read_noise",
          "compression")  # fmt: skip

NONLINEAR = ("shot_noise", "blooming", "black_sun", "compression")


def frame(options: Any, force_off: tuple[str, ...]) -> tuple[np.ndarray, float, dict[str, float]]:
    """The picture, milliseconds of the sensor, and each row's bound."""
    size = {"camera.width": options.width, "camera.height": options.width * 3 // 4}
    render = {"render.tolerance_dn": 0.0, "render.samples": 1, "render.force_off": force_off}
    sim = perilune.open(options.config, overrides=size | render | {"camera.sensor": SENSOR})
    sim.frame(options.frame, channels=["depth"], threads=1)  # models and maps are loaded once
    times = []
    for _ in range(options.repeats):
        start = time.process_time()
        sample = sim.frame(options.frame, channels=["sensor_rgb"], threads=1)
        times.append(1e3 * (time.process_time() - start))
    bounds = {row["name"]: row["bound_dn"] for row in sample.plan}
    return sample["sensor_rgb"].astype(float), report.median(times), bounds


def main() -> None:
    parser = report.arguments(__doc__)
    parser.add_argument("--config", default=str(report.ROOT / "configs" / "demo.yaml"))
    parser.add_argument("--frame", type=int, default=2)
    parser.add_argument("--width", type=int, default=640)
    parser.add_argument("--repeats", type=int, default=3)
    options = parser.parse_args()
    rows: list[list[object]] = []
    references: dict[tuple[str, ...], Any] = {}
    for name in STAGES:
        others = tuple(other for other in NONLINEAR if other != name)
        if others not in references:
            references[others] = frame(options, others)
        full, full_ms, bounds = references[others]
        image, ms, _ = frame(options, (*others, name))
        error = np.abs(image - full)
        rms = float(np.sqrt(np.mean(error**2)))
        rows.append([name, rms, float(error.max()), bounds[name], full_ms - ms])
    head = ["left out", "rms, DN", "largest, DN", "bound, DN", "ms"]
    result = {"rows": [dict(zip(head, row, strict=True)) for row in rows]}
    report.publish(options.json, result, [report.table(head, rows)])


if __name__ == "__main__":
    main()
