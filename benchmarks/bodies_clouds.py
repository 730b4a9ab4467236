"""Clouds: what they cost, and their error against the octaves of their noise.

From 400 km straight down, from 30 000 km the whole Earth, and from 300 m below them: the part that
clouds of 12 octaves cover of the pixels of a picture 640 wide. Errors are those of the light of
clouds on black under an overhead sun, by so many octaves against all: the 99th percentile in
digital numbers of 255 beside the time of a look-up. Then frames with air, with and without clouds
of a noise of 10 octaves: CPU milliseconds at a tolerance of 1 DN, and the octaves of the plan.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import report
from numpy.typing import NDArray

from perilune import _core
from perilune.bodies import clouds
from perilune.config.clouds import CloudNoise, Clouds

F64 = NDArray[np.float64]
RADIUS_M = 6371e3
OCTAVES = (0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12)
PIXELS_M = {"nadir": 720.0, "whole": 22e3, "below": 14.0}
"""Widths of pixels on the shell."""
REFLECTED, WHITE = 0.53, 330.0 * np.pi / 1361.0


def settings(octaves: float) -> _core.CloudSettings:
    return clouds.settings(Clouds(noise=CloudNoise(octaves=octaves)), 0.0)


def encode(cover: F64) -> F64:
    """Display values of 255, not rounded (IEC 61966-2-1)."""
    x = np.clip(REFLECTED * cover / WHITE, 0.0, 1.0)
    root = 1.055 * np.maximum(x, 1e-9) ** (1.0 / 2.4) - 0.055
    return np.asarray(255.0 * np.where(x <= 0.0031308, 12.92 * x, root))


def errors(width_m: float) -> list[tuple[float, float]]:
    """Of each of OCTAVES: digital numbers, and microseconds a look-up."""
    given = settings(12.0)
    points = np.random.default_rng(4).normal(size=(4000, 3))
    points *= (RADIUS_M + 8e3) / np.linalg.norm(points, axis=1, keepdims=True)
    exact = encode(_core.cloud_cover(given, points, width_m, 16))
    found = []
    for octaves in OCTAVES:

        def look(octaves: int = octaves) -> F64:
            return _core.cloud_cover(given, points, width_m, octaves)

        off = np.abs(encode(look()) - exact)
        took = report.processor_s(look, 0.05)
        found.append((float(np.quantile(off, 0.99)), 1e6 * took / len(points)))
    return found


def frames(width: int) -> list[tuple[str, float, float, float, int]]:
    """View, milliseconds without and with clouds, their ratio, octaves."""
    import bodies  # which imports this module

    air = bodies.earth_air()
    rows = []
    for view in ("limb", "nadir", "whole", "sky"):
        took, octaves = [], 0
        for row in (None, settings(10.0)):
            scene = bodies.scene_of(air)
            asked: Any = {**bodies.request(view, width, []), "body_clouds": [row]}
            out = {"rgb": np.empty((asked["height"], width, 3), np.uint8)}
            renderer = _core.Renderer(scene)
            result: Any = renderer.render(asked, out, 1)
            octaves = next(int(r["value"]) for r in result["plan"] if r["name"] == "clouds")

            def frame(renderer: Any = renderer, asked: Any = asked, out: Any = out) -> None:
                renderer.render(asked, out, 1)

            took.append(1e3 * report.processor_s(frame))
        rows.append((view, took[0], took[1], took[1] / took[0], octaves))
    return rows


def part(width: int) -> tuple[str, dict[str, Any], list[str]]:
    """Name, numbers and tables, for bodies.py."""
    curves = {name: errors(width_m) for name, width_m in PIXELS_M.items()}
    costs = frames(width)
    numbers: dict[str, Any] = {
        name: {"error_dn": dict(zip(OCTAVES, (e for e, _ in curve), strict=True)),
               "look_us": dict(zip(OCTAVES, (t for _, t in curve), strict=True))}
        for name, curve in curves.items()
    }  # fmt: skip
    numbers["frames"] = {view: {"off_ms": off, "on_ms": on, "clouds_ratio": ratio, "octaves": n}
                         for view, off, on, ratio, n in costs}  # fmt: skip
    rows = [
        [str(n), *(value for curve in curves.values() for value in curve[i])]
        for i, n in enumerate(OCTAVES)
    ]
    head = ["octaves", *(text for name in curves for text in (f"{name}, DN", "us"))]
    return "clouds", numbers, [
        report.table(head, rows),
        report.table(["view", "no clouds, ms", "clouds, ms", "ratio", "octaves"], costs),
    ]  # fmt: skip
