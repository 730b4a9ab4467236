"""Error against time for the photometric laws: Hapke's and the cheaper ones, near and far.

A soil like the Moon's (median of Sato et al. 2014) on a sphere, by each law, as bright as Hapke's
on the mean of the picture: the error in digital numbers of 255, and the CPU time of a frame on one
thread, medians, and its ratio to Lambert's. All samples of the discs are shaded; close up one
shading stands for a pixel. Below, what the plan's row `regolith` chooses at tolerances: the step of
the ladder, its bound, the error that it makes.
"""

from __future__ import annotations

import math
import time
from typing import Any

import numpy as np
import report
from samples import encode

import perilune

RADIUS_M = 1737.4e3
LAWS = ("lambert", "minnaert", "lunar_lambert", "lommel_seeliger", "hapke_smooth", "hapke")
# Name, phase angle, height, field of view: a disc, a low orbit, a narrow view from it.
VIEWS = (
    ("disc", 30.0, 380000e3, 0.6),
    ("disc", 90.0, 380000e3, 0.6),
    ("100 km", 30.0, 100e3, 40.0),
    ("100 km", 60.0, 100e3, 5.0),
    ("100 km", 60.0, 100e3, 0.5),
)
TOLERANCES_DN = (0.3, 1.0, 3.0, 10.0)


def scene(view: tuple[str, float, float, float], law: str, size: int) -> dict[str, Any]:
    _, phase_deg, height_m, fov_deg = view
    g = math.radians(phase_deg)
    return {
        "version": 1,
        "time": {"epoch": "2026-03-03T06:00:00Z", "step_s": 0.0},
        "root": "moon",
        "bodies": {
            "moon": {
                "kind": "ellipsoid",
                "radii_km": RADIUS_M / 1e3,
                "gm_km3_s2": 4902.8,
                "albedo": 0.3854,
                "reflectance": law,
            }
        },
        "sun": {"direction": [math.cos(g), math.sin(g), 0.0]},
        "camera": {
            "width": size,
            "height": size,
            "fov_deg": fov_deg,
            "trajectory": {
                "kind": "fixed",
                "target": "moon",
                "position_m": [RADIUS_M + height_m, 0.0, 0.0],
            },
        },
    }


def rendered(config: dict[str, Any], repeats: int, **render: Any) -> tuple[Any, float]:
    """The sample, and CPU seconds of a frame."""
    sim = perilune.open(config | {"render": {"max_bounces": 0, **render}})
    times = []
    for _ in range(repeats):
        start = time.process_time()
        sample = sim.frame(0, channels=["radiance"], threads=1)
        times.append(time.process_time() - start)
    return sample, report.median(times)


def compare(view: tuple[str, float, float, float], size: int, repeats: int) -> list[list[object]]:
    """A row for each law."""
    frames = {
        law: rendered(scene(view, law, size), repeats, samples=16, tolerance_dn=0.0) for law in LAWS
    }
    exact, base_s = frames["hapke"][0]["radiance"].astype(float), frames["lambert"][1]
    white = float(np.percentile(exact[exact > 0.0], 99.0)) / 0.8
    rows: list[list[object]] = []
    for law, (sample, seconds) in frames.items():
        radiance = sample["radiance"].astype(float)
        fitted = radiance * float((radiance * exact).sum() / (radiance**2).sum())
        off = np.abs(encode(fitted, white) - encode(exact, white))
        rms = float(np.sqrt(np.mean(off**2)))
        name = f"{view[0]}, {view[1]:g} deg, {view[3]:g} deg wide"
        rows.append([name, law, rms, float(off.max()), 1e3 * seconds, seconds / base_s])
    return rows


def choose(view: tuple[str, float, float, float], size: int) -> list[list[object]]:
    """A row for each tolerance: what the plan takes, and what that changes."""
    rows: list[list[object]] = []
    for tolerance in TOLERANCES_DN:
        common = {"samples": 16, "tolerance_dn": tolerance}
        config = scene(view, "hapke", size)
        sim = perilune.open(config | {"render": {"max_bounces": 0, **common}})
        row = next(row for row in sim.plan(0) if row["name"] == "regolith")
        ours, _ = rendered(config, 1, **common)
        exact, _ = rendered(config, 1, **common, force_on=["regolith"])
        white = ours.meta["white_radiance"]
        off = np.abs(encode(ours["radiance"], white) - encode(exact["radiance"], white))
        name = f"{view[0]}, {view[1]:g} deg, {view[3]:g} deg wide"
        law = LAWS[row["value"]]
        rows.append([name, tolerance, law, row["residual_dn"], float(off.max())])
    return rows


def main() -> None:
    parser = report.arguments(__doc__)
    parser.add_argument("--size", type=int, default=160, help="pixels along a side")
    parser.add_argument("--repeats", type=int, default=3)
    options = parser.parse_args()
    laws = [row for view in VIEWS for row in compare(view, options.size, options.repeats)]
    plans = [row for view in VIEWS for row in choose(view, options.size)]
    head = ["view", "law", "RMS error, DN", "largest, DN", "CPU ms", "time ratio"]
    plan_head = ["view", "tolerance, DN", "law", "bound, DN", "largest error, DN"]
    keys = ["view", "law", "rms_dn", "max_dn", "cpu_ms", "time_ratio"]
    plan_keys = ["view", "tolerance_dn", "law", "bound_dn", "max_dn"]
    report.publish(
        options.json,
        {
            "size": options.size,
            "laws": [dict(zip(keys, row, strict=True)) for row in laws],
            "plans": [dict(zip(plan_keys, row, strict=True)) for row in plans],
        },
        [report.table(head, laws), report.table(plan_head, plans)],
    )


if __name__ == "__main__":
    main()
