"""Time and memory of the ground: scenes, the size of images, the area that is seen, and NumPy.

Times are wall seconds of the stage that builds tiles, in frames of depth alone at --threads: of the
first frame, which finds none kept, and of the next, whose camera has moved (that of the orbiter to
another place, where none are kept). Without PERILUNE_DATA there is only the rover's scene. `kept`
is of tiles and their grids in 10^6 bytes. Frames of different heights have the same pixels. Last
comes the CPU time of the detail of one block of 257 x 257 nodes beside the same sum in NumPy
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
from terrain_frames import Ground

from perilune import _core

MOON_M = 1737.4e3
SCENES = {"lunar_orbiter": True, "lunar_lander": True, "lunar_rover": False}
"""Whether they need PERILUNE_DATA."""
WIDTHS = (64, 128, 256, 512)
HEIGHTS_M = (1e3, 1e4, 1e5, 1e6)
LEVELS = (14, 20, 26)
SEED, NODES, REPEATS = 3, 257, 5
HEAD = ["megapixels", "first, s", "next, s", "tiles", "kept, MB"]
KEYS = ["megapixels", "first_s", "next_s", "tiles", "kept_mb"]


def measure(ground: Ground, threads: int) -> list[float]:
    """Values of KEYS."""
    first = ground.frame(0, ["depth"], threads)
    later = ground.frame(1, ["depth"], threads)
    pixels = first.arrays["depth"].size / 1e6
    return [pixels, first.mesh_s, later.mesh_s, first.tiles, first.kept_bytes / 1e6]


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
    blocks = [[level, *beside_numpy(level)] for level in LEVELS]
    numbers: dict[str, Any] = {
        name: [dict(zip([name, *KEYS], row, strict=True)) for row in rows]
        for name, rows in parts.items()
    }
    keys = ["level", "cell_m", "core_s", "numpy_s", "ratio", "off_m"]
    numbers["numpy"] = [dict(zip(keys, row, strict=True)) for row in blocks]
    tables = [report.table([name, *HEAD], rows) for name, rows in parts.items()]
    head = ["level", "cell, m", "core, s", "NumPy, s", "ratio", "difference, m"]
    report.publish(options.json, numbers, [*tables, report.table(head, blocks)])


if __name__ == "__main__":
    main()
