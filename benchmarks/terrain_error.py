"""Error against time of a ground's mesh: images and labels against cells_per_pixel.

Ground of fractal detail and craters, which needs no data, seen from orbit, from 500 m straight
down, aslant and at a grazing angle, and from a mast, with the Sun at `--sun` degrees.
Errors are root mean squares over pixels that see the ground in both, against `--reference` cells a
pixel: of rgb in digital numbers, of depth in widths of a pixel at the ground, of slope and of
normals in degrees; of the mask of shadows it is the share of pixels that differ. Beside rgb is what
the mean of the frame is off, and the standard deviation of the reference's pixels, its contrast.
The same samples are taken, and the Sun is a point, so that nothing else differs. Times are CPU
seconds on one thread: of a frame of depth alone that finds no tiles kept, and then of one of rgb
and labels that finds all.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import report
from terrain_frames import Drawn, Ground

CELLS = (0.25, 0.5, 1.0, 2.0, 4.0)
FOV_DEG = 50.0
VIEWS = {
    "orbit": (200e3, 0.0),
    "nadir": (500.0, 0.0),
    "aslant": (500.0, 45.0),
    "grazing": (500.0, 75.0),
    "mast": (1.5, 70.0),
}
"""Height, m, and angle off the nadir, degrees."""
CHANNELS = ["rgb", "depth", "slope", "normal", "shadow", "range"]


def config(view: str, cells: float, width: int, sun_deg: float) -> dict[str, Any]:
    height_m, off_nadir_deg = VIEWS[view]
    place = {"lon_deg": 10.0, "lat_deg": 20.0}
    terrain = {
        "detail": {"seed": 3, "strength": 0.5},
        "craters": {"seed": 3},
        "cells_per_pixel": cells,
        "finest_cell_m": 0.001,  # the mast is to be seen with many cells, too
    }
    moon = {"kind": "moon", "reflectance": "hapke", "albedo": 0.33, "terrain": terrain}
    hover = {"kind": "hover", "target": "moon", "height_m": height_m}
    return {
        "version": 1,
        "time": {"epoch": "2026-03-03T06:00:00Z", "step_s": 0.0},
        "root": "moon",
        "sun": {"at": place | {"azimuth_deg": 100.0, "elevation_deg": sun_deg}},
        "bodies": {"moon": moon},
        "camera": {
            "width": width,
            "height": width * 3 // 4,
            "fov_deg": FOV_DEG,
            "trajectory": hover | place | {"off_nadir_deg": off_nadir_deg},
            "exposure": {"mode": "fixed", "white_radiance_w_m2_sr": 60.0},
        },
        "render": {"samples": 16, "max_bounces": 1, "force_off": ["soft_sun"]},
    }


def picture(view: str, cells: float, width: int, sun_deg: float) -> tuple[Drawn, float, float]:
    """A frame; CPU seconds of a frame of depth with no tiles kept, and of this one with all."""
    ground = Ground(config(view, cells, width, sun_deg))
    first = ground.frame(0, ["depth"])
    drawn = ground.frame(0, CHANNELS)
    return drawn, first.cpu_s, drawn.cpu_s


def _rms(values: Any) -> float:
    return float(np.sqrt(np.mean(np.square(values))))


def errors(a: dict[str, Any], b: dict[str, Any]) -> tuple[float, ...]:
    """Of rgb in DN, of its mean, its contrast; of depth in pixels' widths, of slope and normals in
    degrees, of shadows."""
    seen = (a["range"] > 0.0) & (b["range"] > 0.0)
    rgb = (a["rgb"].astype(float) - b["rgb"])[seen]
    pixel_rad = math.radians(FOV_DEG) / a["range"].shape[1]
    depth = (a["depth"].astype(float) - b["depth"])[seen] / (b["range"][seen] * pixel_rad)
    slope = np.degrees((a["slope"].astype(float) - b["slope"])[seen])
    cosine = (a["normal"].astype(float) * b["normal"]).sum(axis=-1)[seen]
    normal = np.degrees(np.arccos(np.clip(cosine, -1.0, 1.0)))
    shadow = float((a["shadow"] != b["shadow"])[seen].mean())
    light = _rms(rgb), float(rgb.mean()), float(b["rgb"][seen].std())
    return *light, _rms(depth), _rms(slope), _rms(normal), shadow


def main() -> None:
    parser = report.arguments(__doc__ or "")
    parser.add_argument("--width", type=int, default=160)
    parser.add_argument("--reference", type=float, default=8.0, help="cells per pixel")
    parser.add_argument("--sun", type=float, default=20.0, help="elevation of the Sun, degrees")
    options = parser.parse_args()
    keys = [
        "view",
        "cells",
        "rgb_dn",
        "mean_dn",
        "contrast_dn",
        "depth_pixels",
        "slope_deg",
        "normal_deg",
        "shadow",
    ]
    keys += ["first_s", "frame_s"]
    rows: list[list[object]] = []
    for view in VIEWS:
        truth = picture(view, options.reference, options.width, options.sun)[0]
        for cells in CELLS:
            drawn, first_s, frame_s = picture(view, cells, options.width, options.sun)
            found = errors(drawn.arrays, truth.arrays)
            rows.append([view, cells, *found, first_s, frame_s])
    head = [
        "view",
        "cells/pixel",
        "rgb, DN",
        "mean, DN",
        "contrast, DN",
        "depth, pixels",
        "slope, deg",
        "normal, deg",
    ]
    head += ["shadow", "mesh, s", "frame, s"]
    numbers = {
        "width": options.width,
        "sun_deg": options.sun,
        "reference": options.reference,
        "rows": [dict(zip(keys, row, strict=True)) for row in rows],
    }
    report.publish(options.json, numbers, [report.table(head, rows)])


if __name__ == "__main__":
    main()
