"""Error against time for the two knobs of light transport: colour samples and bounces.

The error is the root mean square over pixels and bands, in digital numbers of 255, against a frame
of many samples and bounces; times are medians and given as a ratio to the reference frame's.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import report

import perilune

REFERENCE = {"render.samples": 1024, "render.max_bounces": 8, "render.tolerance_dn": 0.0}
KNOBS: dict[str, tuple[int, ...]] = {
    "samples": (1, 2, 4, 8, 16, 32, 64, 128),
    "max_bounces": (0, 1, 2, 4),
}
BASE = {"samples": 64, "max_bounces": 8}


def picture(config: str, index: int, threads: int, **render: float) -> tuple[np.ndarray, float]:
    """Colours at a fixed exposure, and the seconds of the core's render stage."""
    size: dict[str, Any] = {"camera.width": 320, "camera.height": 240}
    sim = perilune.open(config, overrides=size | {f"render.{k}": v for k, v in render.items()})
    sample = sim.frame(index, channels=["rgb"], threads=threads)
    times = [sample.meta["timings_s"]["render"]]
    for _ in range(2):
        repeat = sim.frame(index, channels=["rgb"], threads=threads)
        times.append(repeat.meta["timings_s"]["render"])
    return sample["rgb"].astype(float), report.median(times)


def main() -> None:
    parser = report.arguments(__doc__)
    parser.add_argument("--config", default=str(report.ROOT / "configs" / "demo.yaml"))
    parser.add_argument("--frame", type=int, default=2)
    options = parser.parse_args()
    reference = {key.split(".")[1]: value for key, value in REFERENCE.items()}
    truth, truth_s = picture(options.config, options.frame, options.threads, **reference)
    rows: list[list[object]] = []
    for knob, values in KNOBS.items():
        for value in values:
            image, time_s = picture(
                options.config, options.frame, options.threads, **(BASE | {knob: value})
            )
            error = float(np.sqrt(np.mean((image - truth) ** 2)))
            rows.append([knob, value, error, time_s, time_s / truth_s])
    keys = ["knob", "value", "rms_dn", "seconds", "time_ratio"]
    report.publish(
        options.json,
        {
            "config": options.config,
            "reference_seconds": truth_s,
            "rows": [dict(zip(keys, row, strict=True)) for row in rows],
        },
        [report.table(["knob", "value", "RMS error, DN", "s", "time ratio"], rows)],
    )


if __name__ == "__main__":
    main()
