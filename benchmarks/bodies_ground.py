"""Ground: what relief, water with its glint and lights of the night cost, and errors of frames.

The Earth without air in the views of bodies.py, with the repository's map as colours, heights and
water: by day, and for the lights with the sun below. `off` has all three rows forced off. Errors
are those of frames 160 wide at a tolerance of 1 DN against 256 samples in every pixel (which a lens
that is sharp everywhere asks for), mean of digital numbers of 255; beside them those of the bare
map.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import report
from numpy.typing import NDArray

from perilune import _core

F64 = NDArray[np.float64]
MAP = str(report.ROOT / "assets/maps/earth_like.jpg")
ROWS = ("relief", "glint", "night_lights")
VIEWS = ("nadir", "whole", "limb")
CENTER_DEG = 15.5
"""Longitude of the map's middle: a coast lies below the views."""


def scene() -> _core.Scene:
    world = _core.Scene(1)
    heights = _core.Map(MAP, srgb=False)
    world.add_body(
        name="earth",
        map=_core.Map(MAP),
        map_center_lon_rad=np.radians(CENTER_DEG),
        reflectance="lambert",
        instance_id=1,
        part_id=1,
        class_ids=np.array([1], np.uint16),
        regolith_map=None,
        air=None,
        ground={
            "heights": heights,
            "ocean": True,
            "water": _core.Map(MAP, water=True),
            "lights": _core.Map(MAP),
        },
    )
    return world


def request(view: str, width: int, row: str | None) -> dict[str, Any]:
    """With one row, or none."""
    import bodies  # which imports this module

    asked: Any = bodies.request(view, width, [name for name in ROWS if name != row])
    if row == "night_lights":
        asked["sun_position"] = -asked["sun_position"]
        asked["exposure"] = {**asked["exposure"], "white_radiance": 1e-3}
    asked["body_ground"] = np.array([[8e3, 1.0, 7.0, *[0.02] * 3, *[1e-3] * 3, math.nan]])
    return dict(asked)


def error_dn(renderer: _core.Renderer, view: str, row: str | None) -> float:
    frames = []
    for tolerance, samples in ((1.0, 16), (0.0, 256)):
        asked: Any = request(view, 160, row)
        asked["quality"] = {**asked["quality"], "tolerance_dn": tolerance, "samples": samples}
        if tolerance == 0.0:
            asked["focus"] = (1e-7, math.inf)
            asked["quality"]["force_on"] = ["depth_of_field"]
        out = {"rgb": np.empty((asked["height"], asked["width"], 3), np.uint8)}
        renderer.render(asked, out, 1)
        frames.append(out["rgb"].astype(np.float64))
    return float(np.abs(frames[0] - frames[1]).mean())


def cost_ms(renderer: _core.Renderer, view: str, width: int, row: str | None) -> float:
    asked: Any = request(view, width, row)
    out = {"rgb": np.empty((asked["height"], asked["width"], 3), np.uint8)}
    return 1e3 * report.processor_s(lambda: renderer.render(asked, out, 1))


def part(width: int) -> tuple[str, dict[str, Any], list[str]]:
    """Name, numbers and tables, for bodies.py."""
    renderer = _core.Renderer(scene())
    numbers: dict[str, Any] = {}
    rows = []
    for view in VIEWS:
        off = cost_ms(renderer, view, width, None)
        bare = error_dn(renderer, view, None)
        for row in ROWS:
            on, error = cost_ms(renderer, view, width, row), error_dn(renderer, view, row)
            numbers[f"{view}_{row}"] = {"off_ms": off, "on_ms": on, "ratio": on / off,
                                        "error_dn": error, "bare_dn": bare}  # fmt: skip
            rows.append([view, row, off, on, on / off, error, bare])
    head = ["view", "row", "off, ms", "on, ms", "ratio", "error, DN", "bare map, DN"]
    return "ground", numbers, [report.table(head, rows)]
