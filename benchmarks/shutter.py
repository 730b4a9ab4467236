"""Error against time for what bends rays and time: motion blur, rolling shutter, depth of field.

A spinning satellite before a body. The error is the root mean square over pixels and bands, in
digital numbers of 255 before rounding, against a frame of many samples with every instant and row
there may be. Times are CPU milliseconds of whole frames on one thread, medians; the ratio is to the
same frame, sharp and still, with as many samples in every pixel.
"""

from __future__ import annotations

import time
from typing import Any

import numpy as np
import report
from samples import encode

import perilune

SAMPLES = (4, 16, 64)
TOLERANCES_DN = (0.0, 30.0, 60.0, 120.0)
REPEATS = 3
WHITE = 900.0


def scene(width: int) -> dict[str, Any]:
    """A satellite of 3 m at 5 m that turns by 30 degrees a second."""
    sat = {
        "model": "assets/models/smallsat.glb",
        "size_m": 3.0,
        "orbit": {"around": "moonlet", "position_km": [0.0, 0.025, 0.0]},
        "attitude": {"rotation_deg": [20.0, 30.0, 40.0], "spin_rate_deg_s": 30.0},
    }
    return {
        "version": 1,
        "time": {"epoch": "2026-03-20T12:00:00Z", "step_s": 1.0},
        "root": "moonlet",
        "bodies": {
            "moonlet": {
                "kind": "ellipsoid",
                "radii_km": [0.02, 0.015, 0.015],
                "gm_km3_s2": 1e-12,
                "albedo": 0.3,
            }
        },
        "spacecraft": {"sat": sat},
        "sun": {"direction": [0.4, 0.8, 0.45]},
        "camera": {
            "width": width,
            "height": width * 3 // 4,
            "fov_deg": 40.0,
            "exposure": {"mode": "fixed", "white_radiance_w_m2_sr": WHITE},
            "trajectory": {"kind": "fixed", "target": "sat", "position_m": [1.0, 5.0, 0.5],
                           "frame": "icrf"},
        },
        "render": {"max_bounces": 1},
    }  # fmt: skip


class Job:
    """The scene with one effect."""

    def __init__(self, effect: str, camera: dict[str, Any], width: int, reference: int) -> None:
        self.effect, self.tree = effect, scene(width)
        self.tree["camera"] |= camera
        self.truth = self.picture(1, samples=reference, tolerance_dn=0.0)[0]

    def picture(self, repeats: int, **render: Any) -> tuple[np.ndarray, float, int]:
        """Display values, CPU seconds, and the value of the effect's row."""
        tree = {**self.tree, "render": {**self.tree["render"], **render}}
        sim = perilune.open(tree, base=report.ROOT)
        sim.frame(0, channels=["depth"], threads=1)  # models are loaded once
        times = []
        for _ in range(repeats):
            start = time.process_time()
            sample = sim.frame(0, channels=["radiance"], threads=1)
            times.append(time.process_time() - start)
        value = next(row["value"] for row in sample.plan if row["name"] == self.effect)
        return encode(sample["radiance"], WHITE), report.median(times), value

    def row(self, label: str, still_s: float, **render: Any) -> list[object]:
        """Of the table."""
        image, seconds, value = self.picture(REPEATS, **render)
        error = float(np.sqrt(np.mean((image - self.truth) ** 2)))
        return [self.effect, label, value, error, 1e3 * seconds, seconds / still_s]


def main() -> None:
    parser = report.arguments(__doc__)
    parser.add_argument("--width", type=int, default=640)
    parser.add_argument("--reference", type=int, default=256, help="samples of the reference")
    options = parser.parse_args()
    height = options.width * 3 // 4
    cases = [
        ("motion_blur", {"exposure_time_s": 0.1}),
        ("motion_blur", {"exposure_time_s": 1.0}),
        ("rolling_shutter", {"line_time_us": 1e6 * 0.2 / height}),
        ("depth_of_field", {"lens": {"focus_distance_m": 6.0, "aperture_mm": 200.0}}),
    ]
    still = Job("motion_blur", {}, options.width, 1)
    still_s = {n: still.picture(REPEATS, samples=n, tolerance_dn=0.0)[1] for n in SAMPLES}
    rows = []
    for effect, camera in cases:
        job = Job(effect, camera, options.width, options.reference)
        told = f"{camera['exposure_time_s']} s" if "exposure_time_s" in camera else ""
        off = {"samples": 16, "tolerance_dn": 0.0, "force_off": [effect]}
        rows.append(job.row(f"{told} off".strip(), still_s[16], **off))
        for n in SAMPLES:
            label = f"{told} {n} samples".strip()
            rows.append(job.row(label, still_s[n], samples=n, tolerance_dn=0.0))
        for dn in TOLERANCES_DN if effect == "rolling_shutter" else ():
            keep = {"samples": 16, "tolerance_dn": dn, "force_on": ["antialiasing"]}
            rows.append(job.row(f"tolerance {dn:g} DN", still_s[16], **keep))
    keys = ["effect", "setting", "value", "rms_dn", "cpu_ms", "still_ratio"]
    head = ["effect", "setting", "value", "RMS error, DN", "CPU ms", "to still"]
    report.publish(
        options.json,
        {"width": options.width, "rows": [dict(zip(keys, row, strict=True)) for row in rows]},
        [report.table(head, rows)],
    )


if __name__ == "__main__":
    main()
