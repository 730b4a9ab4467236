"""What LiDARs cost: beams a second of each pattern, beside raw Embree on the same rays, and error
against time for the rays of a beam.

`ns a beam` is CPU time of a whole scan (placing, tracing, shading, returns) on one thread, the
ground's tiles kept; `tracer` and `raw` are those of closest hits alone, of the tracer and of
Embree's packet call on the same rays packed beforehand, medians of repeats in one run.
"""

from __future__ import annotations

import numpy as np
import report

import perilune

SCENES = ("demo", "iss_leo", "lunar_lander")
NAME = "bench"
SUB_RAYS = (1, 4, 16, 64)
MOST = 256
DIVERGENCE_DEG, NARROW_DEG = 0.2, 0.05
NEAR_M = 1e5
"""Errors are those of beams that meet something nearer: not the planet behind a spacecraft."""
RESOLUTION_M = 1.0
"""Surfaces nearer to each other are one return, at the mean range by power."""


def patterns(width: float, height: float, beams: int) -> dict[str, dict[str, object]]:
    """Of each kind about as many beams, over the camera's view; all leave at nearly the same time,
    so that scenes stand still."""
    side = max(round(beams**0.5), 2)
    size = {"width_deg": width, "height_deg": height}
    angle = 0.25 * min(width, height)
    fast = {"rate_hz": 1e9}
    return {
        "flash": {"kind": "flash", "columns": side, "rows": side, **size},
        "spinning": {
            "kind": "spinning",
            "elevations_deg": np.linspace(-0.5 * height, 0.5 * height, side).tolist(),
            "steps": side,
            "from_deg": -0.5 * width,
            "to_deg": 0.5 * width,
            **fast,
        },
        "raster": {"kind": "raster", "columns": side, "rows": side, **size, **fast},
        "lissajous": {"kind": "lissajous", "pulses": beams, **size, **fast,
                      "x_hz": 1.3e6, "y_hz": 1.7e6},
        "rosette": {"kind": "rosette", "pulses": beams, "first_deg": angle, "second_deg": angle,
                    "first_hz": 1.3e6, "second_hz": -1.7e6, **fast},
    }  # fmt: skip


def scene(name: str) -> perilune.Simulation:
    return perilune.open(report.ROOT / "configs" / f"{name}.yaml")


def view_deg(sim: perilune.Simulation) -> tuple[float, float]:
    """Width and height of the camera's view."""
    camera = sim.frame(0, ["depth"]).camera
    half = np.arctan([0.5 * camera.width / camera.K[0, 0], 0.5 * camera.height / camera.K[1, 1]])
    width, height = 2.0 * np.degrees(half)
    return float(width), float(height)


def with_lidar(sim: perilune.Simulation, **keys: object) -> perilune.Simulation:
    entry = {"range_m": [0.0, 1e12], "instants": 1, **keys}
    return sim.with_overrides({"lidars": {NAME: entry}})


def speed_rows(name: str, beams: int, repeats: int) -> list[list[object]]:
    """A row a pattern: beams, share with a return, beams a second, ns a beam, tracer, raw."""
    sim = scene(name)
    rows: list[list[object]] = []
    for kind, pattern in patterns(*view_deg(sim), beams).items():
        scan = with_lidar(sim, pattern=pattern, divergence_deg=NARROW_DEG)
        found = scan.lidar(0, threads=1)
        spent = report.processor_s(lambda scan=scan: scan.lidar(0, threads=1))
        rays, ours, raw = scan.measure_scan(0, repeats)
        share = len(np.unique(found["beam"])) / rays
        each = [1e9 * seconds / rays for seconds in (spent, ours, raw)]
        rows.append([f"{name} {kind}", rays, share, rays / spent, *each, raw / ours])
    return rows


def first_returns(sim: perilune.Simulation, keys: dict[str, object], count: int) -> np.ndarray:
    """Range (inf where there is none) and intensity of each first return, (2, count)."""
    found = with_lidar(sim, range_resolution_m=RESOLUTION_M, returns="first", **keys)
    scan = found.lidar(0, threads=1)
    out = np.stack([np.full(count, np.inf), np.zeros(count)])
    out[:, scan["beam"]] = scan["true_range_m"], scan["intensity"]
    return out


def error_rows(name: str, beams: int) -> list[list[object]]:
    """A row for each number of rays: microseconds a beam; share of beams whose first return is of
    something else than with many rays; of the others RMS of the range; RMS of the intensity over
    its mean."""
    sim = scene(name)
    pattern = patterns(*view_deg(sim), beams)["flash"]
    keys: dict[str, object] = {"pattern": pattern, "divergence_deg": DIVERGENCE_DEG}
    count = int(pattern["columns"]) * int(pattern["rows"])  # type: ignore[call-overload]
    exact = first_returns(sim, {**keys, "sub_rays": MOST}, count)
    seen = exact[0] < NEAR_M
    rows: list[list[object]] = []
    for number in SUB_RAYS:
        own = {**keys, "sub_rays": number}
        scan = with_lidar(sim, range_resolution_m=RESOLUTION_M, returns="first", **own)
        spent = report.processor_s(lambda scan=scan: scan.lidar(0, threads=1))
        found = first_returns(sim, own, count)
        off = np.where(seen, found[0], 0.0) - np.where(seen, exact[0], 0.0)
        same = seen & (np.abs(off) <= RESOLUTION_M)
        range_m = float(np.sqrt(np.mean(off[same] ** 2)))
        dim = (found[1] - exact[1])[seen]
        bright = float(np.sqrt(np.mean(dim**2)) / np.mean(exact[1][seen]))
        other = 1.0 - same.sum() / seen.sum()
        rows.append([f"{name} {number}", 1e6 * spent / count, other, range_m, bright])
    return rows


def main() -> None:
    parser = report.arguments(__doc__)
    parser.add_argument("--beams", type=int, default=4000)
    parser.add_argument("--repeats", type=int, default=7)
    parser.add_argument("--scenes", nargs="+", default=list(SCENES))
    options = parser.parse_args()
    speeds = [
        r for name in options.scenes for r in speed_rows(name, options.beams, options.repeats)
    ]
    errors = [row for name in options.scenes for row in error_rows(name, options.beams // 2)]
    head = ["scene, pattern", "beams", "hit", "beams/s", "ns a beam", "tracer", "raw", "ratio"]
    report.publish(
        options.json,
        {
            "ns_a_beam": {str(row[0]): row[4] for row in speeds},
            "ratio_to_raw": {str(row[0]): row[7] for row in speeds},
            "range_rms_m": {str(row[0]): row[3] for row in errors},
        },
        [
            report.table(head, speeds),
            report.table(["scene, rays", "us a beam", "other", "RMS m", "intensity"], errors),
        ],
    )


if __name__ == "__main__":
    main()
