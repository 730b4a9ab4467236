"""Bounded volumes: error and time against the steps along a ray.

A ball of even mist, one whose density is a noise, and a comet's coma that thins out with the square
of the distance, with and without a core; 96 x 72, one sample a pixel, one thread. Errors are the
99th percentile and the largest of pixels against 1024 steps, in digital numbers of 255, before
rounding; times are CPU milliseconds of a frame over one without its volume, the least of several,
with the table of what shades the volume's parts.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import report
from numpy.typing import NDArray

import perilune

F64 = NDArray[np.float64]

STEPS = (4, 8, 16, 32, 64, 128)
MANY = 1024
_PLACE = {"type": "coordinates"}
_MEDIUM = {"type": "lambert", "base_color": 0.9, "alpha": "density"}
NOISE = {
    "place": _PLACE,
    "holes": {"type": "noise", "vector": "place", "scale": 3.0, "octaves": 4.0},
    "less": {"type": "math", "function": "subtract", "a": "holes", "b": 0.4},
    "density": {"type": "math", "function": "multiply", "a": "less", "b": 4.0},
    "medium": _MEDIUM,
}
COMA = {
    "place": _PLACE,
    "square": {"type": "vector_math", "function": "dot", "a": "place", "b": "place"},
    "density": {"type": "math", "function": "divide", "a": 4e-4, "b": "square.value"},
    "medium": _MEDIUM,
}
VOLUMES: dict[str, tuple[dict[str, Any] | None, dict[str, Any]]] = {
    "even": (None, {"extinction_per_m": 2.0}),
    "noise": (NOISE, {"extinction_per_m": 4.0}),
    "coma": (COMA, {"extinction_per_m": 40.0}),
    "coma, core": (COMA, {"extinction_per_m": 40.0, "core_m": 0.02}),
}
"""Nodes of the graph, and keys of a ball of a metre."""


def config(nodes: dict[str, Any] | None, keys: dict[str, Any] | None, steps: int) -> dict[str, Any]:
    """The ball five metres before the camera, the sun from the side; keys None: no ball."""
    ball = {"parent": "rock", "shape": "ellipsoid", "radii_m": 1.0, "position_m": [0, 0, 9.0]}
    if nodes is not None:
        ball["material"] = "medium"
    return {
        "version": 1,
        "time": {"epoch": "2026-03-20T12:00:00Z"},
        "root": "rock",
        "sun": {"direction": [1.0, 0.6, 0.2]},
        "bodies": {
            "rock": {"kind": "ellipsoid", "radii_km": 1e-4, "gm_km3_s2": 1e-15, "albedo": 0.5}
        },
        "volumes": {} if keys is None else {"ball": ball | keys},
        "materials": {} if nodes is None else {"medium": {"nodes": nodes}},
        "camera": {
            "width": 96,
            "height": 72,
            "fov_deg": 24.0,
            "trajectory": {
                "kind": "fixed",
                "target": "rock",
                "position_m": [0.0, -5.0, 9.0],
                "aim_offset_m": [0.0, 0.0, 9.0],
            },
            "exposure": {"mode": "fixed", "white_radiance_w_m2_sr": 150.0},
        },
        "render": {"samples": 1, "volume_steps": steps, "channels": ["radiance"]},
    }


def shown(radiance: F64) -> F64:
    """Display values of 255, sRGB (IEC 61966-2-1), not rounded."""
    x = np.clip(radiance / 150.0, 0.0, 1.0)
    curve: F64 = np.where(
        x <= 0.0031308, 12.92 * x, 1.055 * np.maximum(x, 1e-9) ** (1 / 2.4) - 0.055
    )
    return 255.0 * curve


def part() -> tuple[dict[str, Any], list[str]]:
    """What `--json` and the tables have of volumes."""
    result: dict[str, Any] = {}
    rows: list[list[object]] = [[str(steps)] for steps in STEPS]
    bare = perilune.open(config(None, None, 1))
    bare_s = report.processor_s(lambda: bare.frame(0, threads=1))
    for name, (nodes, keys) in VOLUMES.items():
        # The dense middle is exact by the core's spacing alone.
        best = {**keys, "core_m": 0.02} if nodes is COMA else keys
        exact = shown(perilune.open(config(nodes, best, MANY)).frame(0)["radiance"])
        result[name] = {}
        for row, steps in zip(rows, STEPS, strict=True):
            sim = perilune.open(config(nodes, keys, steps))
            off = np.abs(shown(sim.frame(0, threads=1)["radiance"]) - exact)
            took = report.processor_s(lambda sim=sim: sim.frame(0, threads=1))  # type: ignore[misc]
            ms = 1e3 * (took - bare_s)
            cells = [float(np.quantile(off, 0.99)), float(off.max()), ms]
            row += cells
            result[name][steps] = dict(zip(("p99_dn", "max_dn", "ms"), cells, strict=True))
    head = ["steps", *(f"{name}{what}" for name in VOLUMES for what in (", DN", ", max", ", ms"))]
    return result, [report.table(head, rows)]


def main() -> None:
    arguments = report.arguments(__doc__ or "").parse_args()
    result, tables = part()
    report.publish(arguments.json, result, tables)


if __name__ == "__main__":
    main()
