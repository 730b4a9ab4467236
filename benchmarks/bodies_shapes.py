"""Bodies by meshes: error and time against the number of facets.

A ball of facets in place of the ellipsoid that it is cut of, under a Lambert and a Hapke law, 160 x
120, 16 samples, one thread: the 99th percentile of the difference of pixels in digital numbers of
255, of ranges in metres (the ball's radius is 1 km), and CPU time over that with the ellipsoid.
Where PERILUNE_DATA is set, configs/phobos.yaml with its shape and with its ellipsoid too.
"""

from __future__ import annotations

import math
import os
import tempfile
from pathlib import Path
from typing import Any

import numpy as np
import report

import perilune

RINGS = (8, 16, 32, 64, 128)
LAWS = ("lambert", "hapke")
PHOBOS = Path(__file__).resolve().parent.parent / "configs" / "phobos.yaml"
SMALL = {"camera.width": 160, "camera.height": 120}
_CALM = ["soft_sun", "limb_darkening"]
"""Sampled, and so noise in the difference."""


def ball(path: Path, rings: int) -> str:
    """An OBJ file of a ball of 1 km, of quadrilaterals, and triangles at the poles."""
    columns = 2 * rings
    lines = ["v 0 0 1"]
    for i in range(1, rings):
        lat = math.pi * i / rings
        for k in range(columns):
            lon = math.pi * k / rings
            x, y = math.sin(lat) * math.cos(lon), math.sin(lat) * math.sin(lon)
            lines.append(f"v {x:.9f} {y:.9f} {math.cos(lat):.9f}")
    lines.append("v 0 0 -1")
    south = 2 + (rings - 1) * columns
    for k in range(columns):
        a, b = 2 + k, 2 + (k + 1) % columns
        lines.append(f"f 1 {a} {b}")
        for i in range(rings - 2):
            row = i * columns
            lines.append(f"f {a + row} {a + row + columns} {b + row + columns} {b + row}")
        lines.append(f"f {a + south - 2 - columns} {south} {b + south - 2 - columns}")
    path.write_text("\n".join(lines))
    return str(path)


def config(law: str, shape: str | None, calm: bool) -> dict[str, Any]:
    """The ball, half lit, two radii off its surface."""
    rock = {"kind": "ellipsoid", "radii_km": 1.0, "gm_km3_s2": 1e-6, "albedo": 0.3}
    if shape is not None:
        rock["shape"] = shape
    return {
        "version": 1,
        "time": {"epoch": "2026-03-20T12:00:00Z"},
        "root": "rock",
        "sun": {"direction": [0.9, -0.4, 0.3]},
        "bodies": {"rock": rock | {"reflectance": law}},
        "camera": {
            "width": SMALL["camera.width"],
            "height": SMALL["camera.height"],
            "fov_deg": 50.0,
            "trajectory": {
                "kind": "fixed",
                "target": "rock",
                "position_m": [500.0, -2900.0, 700.0],
            },
            "exposure": {"mode": "fixed", "white_radiance_w_m2_sr": 130.0},
        },
        "render": {"samples": 16, "force_off": _CALM if calm else []},
    }


def _encoded(radiance: Any) -> Any:
    x = np.clip(radiance / 130.0, 0.0, 1.0)
    return 255.0 * np.where(x <= 0.0031308, 12.92 * x, 1.055 * x ** (1 / 2.4) - 0.055)


def _took(simulation: perilune.Simulation) -> float:
    def work() -> None:
        simulation.frame(0, channels=["rgb", "depth", "normal"], threads=1)

    work()
    return 1e3 * report.processor_s(work)


def measure(folder: Path, rings: int, law: str) -> tuple[float, float, float]:
    """Error in DN, in m, and the ratio of times."""
    shape = ball(folder / f"{rings}.obj", rings)
    seen = [
        perilune.open(config(law, of, True)).frame(0, channels=["radiance", "range"], threads=1)
        for of in (shape, None)
    ]
    both = (seen[0]["range"] > 0.0) & (seen[1]["range"] > 0.0)
    dn = np.abs(_encoded(seen[0]["radiance"]) - _encoded(seen[1]["radiance"]))[both]
    metres = np.abs(seen[0]["range"] - seen[1]["range"])[both]
    times = [_took(perilune.open(config(law, of, False))) for of in (shape, None)]
    return float(np.quantile(dn, 0.99)), float(np.quantile(metres, 0.99)), times[0] / times[1]


def phobos() -> float | None:
    """CPU time with the shape over that with the ellipsoid."""
    if not os.environ.get("PERILUNE_DATA"):
        return None
    times = [
        _took(perilune.open(PHOBOS, None, SMALL | keys))
        for keys in ({}, {"bodies.phobos.shape": None})
    ]
    return times[0] / times[1]


def part(_: int = 0) -> tuple[str, dict[str, Any], list[str]]:
    """Name, numbers and tables, for bodies.py."""
    with tempfile.TemporaryDirectory() as name:
        found = {n: [measure(Path(name), n, law) for law in LAWS] for n in RINGS}
    numbers: dict[str, Any] = {
        law: {
            n: dict(zip(("error_dn", "range_m", "shape_ratio"), found[n][i], strict=True))
            for n in RINGS
        }
        for i, law in enumerate(LAWS)
    }
    rows = [[str(4 * n * (n - 1)), *(x for law in found[n] for x in law)] for n in RINGS]
    head = ["facets", *(text for law in LAWS for text in (f"{law}, DN", "m", "ratio"))]
    tables = [report.table(head, rows)]
    ratio = phobos()
    if ratio is not None:
        numbers["phobos_ratio"] = ratio
        tables.append(f"Phobos by its shape takes {ratio:.2f} times the time of its ellipsoid.")
    return "shapes", numbers, tables


def main() -> None:
    arguments = report.arguments(__doc__ or "").parse_args()
    _, numbers, tables = part()
    report.publish(arguments.json, numbers, tables)


if __name__ == "__main__":
    main()
