"""Time and memory of the ground: scenes, sizes of images, areas, a descent, raw Embree and NumPy.

Times are CPU seconds by which a frame of depth alone takes longer than the same frame again, whose
tiles are kept: of the first frame, which finds none kept, and of the next, whose camera has moved
(that of the orbiter to another place, where none are kept). Without PERILUNE_DATA there are only
the scenes of the rover and of Mars. `kept` is of tiles and their grids in 10^6 bytes. Frames of
different heights have the same pixels. Of the series of widths, tiles and times are fitted by a
constant, the rest of the body and what is coarser than any pixel, and a part that is linear in
pixels.

A descent straight down has frames of colours and depth of SAMPLES samples: the first, and the same
again, whose tiles are kept. Beside them is raw Embree on the same grids in one scene: the time of
the rays through pixels and of those to the sun, packed beforehand, times SAMPLES; `ratio` is that
of the second frame to it. `tracer` is raw Embree's time over our tracer's for the same rays,
medians of repeats. All is CPU time.

Last comes the CPU time of the detail of one block of 257 x 257 nodes beside the same sum in NumPy
(medians of 5), and the largest difference of their heights.
"""

from __future__ import annotations

import math
import os
import time
from collections.abc import Callable
from typing import Any

import numpy as np
import report
import terrain_numpy
from terrain_frames import Drawn, Ground

from perilune import _core

MOON_M = 1737.4e3
SCENES = {
    "lunar_orbiter": True,
    "lunar_lander": True,
    "lunar_rover": False,
    "lunar_pole": True,
    "apollo15": True,
    "mars_descent": False,
}
"""Whether they need PERILUNE_DATA."""
WIDTHS = (64, 128, 256, 512, 1024)
HEIGHTS_M = (1e3, 1e4, 1e5, 1e6)
DESCENT_M = (2e5, 7e4, 2e4, 7e3, 2e3, 700.0, 200.0, 70.0, 20.0, 7.0, 3.0, 1.5)
SAMPLES = 4
LEVELS = (14, 20, 26)
SEED, NODES, REPEATS = 3, 257, 5
DESCENT_HEAD = ["height, m", "first, s", "again, s", "raw Embree, s", "ratio", "tracer"]
DESCENT_KEYS = ["height_m", "first_s", "again_s", "raw_s", "ratio", "tracer_ratio"]
FIT_KEYS = ["quantity", "constant", "per_megapixel", "worst"]
HEAD = ["megapixels", "first, s", "next, s", "tiles", "kept, MB"]
KEYS = ["megapixels", "first_s", "next_s", "tiles", "kept_mb"]


def measure(ground: Ground, threads: int) -> list[float]:
    """Values of KEYS."""
    (first, first_s), (_, next_s) = (_frame(ground, index, threads) for index in (0, 1))
    pixels = first.arrays["depth"].size / 1e6
    return [pixels, first_s, next_s, first.tiles, first.kept_bytes / 1e6]


def _frame(ground: Ground, index: int, threads: int) -> tuple[Drawn, float]:
    """The frame, and the time of its tiles."""
    first, again = (ground.frame(index, ["depth"], threads) for _ in range(2))
    return first, first.cpu_s - again.cpu_s


def over(height_m: float, width: int) -> dict[str, Any]:
    """Straight down on ground that needs no data; the next frame's camera is elsewhere by up to
    a tenth of the height."""
    shift_deg = math.degrees(0.1 * height_m / MOON_M)
    place = {"lon_deg": 10.0, "lat_deg": 20.0}
    terrain = {"detail": {"seed": SEED, "strength": 0.5}, "craters": {"seed": SEED}}
    trajectory = {
        "kind": "hover",
        "target": "moon",
        "lon_deg": {"uniform": [10.0, 10.0 + shift_deg]},
        "lat_deg": 20.0,
        "height_m": height_m,
    }
    return {
        "version": 1,
        "time": {"epoch": "2026-03-03T06:00:00Z", "step_s": 0.0},
        "root": "moon",
        "sun": {"at": place | {"azimuth_deg": 100.0, "elevation_deg": 30.0}},
        "bodies": {"moon": {"kind": "moon", "albedo": 0.3, "terrain": terrain}},
        "camera": {
            "width": width,
            "height": width * 3 // 4,
            "fov_deg": 50.0,
            "trajectory": trajectory,
        },
    }


def fits(rows: list[list[Any]]) -> list[list[Any]]:
    """Quantity, its constant, the part a megapixel, and the largest error of the fit over what is
    fitted, from rows of a width and the values of KEYS."""
    table = np.array([row[1:] for row in rows])
    lines = np.stack([np.ones(len(table)), table[:, 0]], axis=1)
    found = []
    for key in ("tiles", "first_s"):
        values = table[:, KEYS.index(key)]
        weights = 1.0 / values  # errors relative to each
        line, *_ = np.linalg.lstsq(lines * weights[:, None], values * weights, rcond=None)
        found.append([key, *line, np.abs(lines @ line / values - 1.0).max()])
    return found


def descent(threads: int) -> list[list[Any]]:
    """Values of DESCENT_KEYS."""
    rows = []
    for height_m in DESCENT_M:
        ground = Ground(over(height_m, 256), {"render.samples": SAMPLES})
        first, again = (ground.frame(0, ["rgb", "depth"], threads) for _ in range(2))
        rays = ground.simulation.measure_rays(0, REPEATS)
        ours_s = sum(ours for _, ours, _ in rays.values())
        raw_s = sum(raw for _, _, raw in rays.values())
        embree_s = SAMPLES * raw_s
        frames = [first.cpu_s, again.cpu_s, embree_s, again.cpu_s / embree_s]
        rows.append([height_m, *frames, raw_s / ours_s])
    return rows


def scenes(threads: int) -> list[list[Any]]:
    data = bool(os.environ.get("PERILUNE_DATA"))
    files = {name: report.ROOT / "configs" / f"{name}.yaml" for name in SCENES}
    here = [name for name, needs in SCENES.items() if data or not needs]
    return [[name, *measure(Ground(files[name]), threads)] for name in here]


def _median_s(work: Callable[[], Any]) -> float:
    times = []
    for _ in range(REPEATS):
        begin = time.process_time()
        work()
        times.append(time.process_time() - begin)
    return report.median(times)


def beside_numpy(level: int) -> list[Any]:
    """Width of a cell in m, seconds of both, their ratio, largest difference in m."""
    terrain = _core.Terrain(np.full(3, MOON_M), [], {"seed": SEED})
    place = 5 * 2 ** (level - 4), 7 * 2 ** (level - 4)
    d = terrain_numpy.directions(level, *place, NODES)
    detail = terrain_numpy.Detail(SEED, level)
    heights_m = terrain.block(4, level, *place, NODES, NODES)
    off_m = detail.fit(d, heights_m.ravel())
    core_s = _median_s(lambda: terrain.block(4, level, *place, NODES, NODES))
    numpy_s = _median_s(lambda: detail.heights(d))
    return [terrain.cell_m(level), core_s, numpy_s, numpy_s / core_s, off_m]


def main() -> None:
    options = report.arguments(__doc__ or "").parse_args()
    parts = {
        "scene": scenes(options.threads),
        "width": [[w, *measure(Ground(over(1e4, w)), options.threads)] for w in WIDTHS],
        "height_m": [[h, *measure(Ground(over(h, 256)), options.threads)] for h in HEIGHTS_M],
    }
    lines, steps = fits(parts["width"]), descent(options.threads)
    blocks = [[level, *beside_numpy(level)] for level in LEVELS]
    numbers: dict[str, Any] = {
        name: [dict(zip([name, *KEYS], row, strict=True)) for row in rows]
        for name, rows in parts.items()
    }
    keys = ["level", "cell_m", "core_s", "numpy_s", "ratio", "off_m"]
    numbers["fit"] = [dict(zip(FIT_KEYS, row, strict=True)) for row in lines]
    numbers["descent"] = [dict(zip(DESCENT_KEYS, row, strict=True)) for row in steps]
    numbers["numpy"] = [dict(zip(keys, row, strict=True)) for row in blocks]
    tables = [report.table([name, *HEAD], rows) for name, rows in parts.items()]
    tables.append(report.table(["fit", "constant", "a megapixel", "worst"], lines))
    tables.append(report.table(DESCENT_HEAD, steps))
    head = ["level", "cell, m", "core, s", "NumPy, s", "ratio", "difference, m"]
    report.publish(options.json, numbers, [*tables, report.table(head, blocks)])


if __name__ == "__main__":
    main()
