"""Eclipses: error and processor time of the light that bodies leave of the sun, by the number of
nodes of its quadrature.

Each row is a scene seen from places across a penumbra, 1 au from the sun. The error is the largest
against 64 nodes, for an even disc and one darkened at 0.465 um; tests/python/test_sunlight.py has
that against other integrals. The cost is processor time of a place in three bands, and of a place
that no body comes near.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
import report
from numpy.typing import NDArray

from perilune import _core

F64 = NDArray[np.float64]

AU_M, SUN_M = 149597870700.0, 695700e3
ANGLE = math.asin(SUN_M / AU_M)
NODES = (2, 4, 6, 8, 12, 16, 24, 32)
EVEN, DARKENED = np.zeros(1), np.array([0.465])
BANDS = np.array([0.612, 0.549, 0.465])
PLACES = 2000


@dataclass(frozen=True)
class Case:
    """Bodies before the sun, which is on z; the places are all at the origin."""

    name: str
    poses: F64
    """(n, bodies, 7)."""
    radii: F64
    """(bodies, 3)."""

    def light(self, wavelengths_um: F64, nodes: int) -> F64:
        n = len(self.poses)
        sun = np.tile([0.0, 0.0, AU_M], (n, 1))
        here = np.zeros((n, 3))
        found = _core.sunlight(here, sun, SUN_M, self.poses, self.radii, wavelengths_um, nodes)
        return found[0]


def passing(name: str, radii_m: list[tuple[float, float, float]], far_m: list[float]) -> Case:
    """The first body from touching the sun's disc to leaving or covering it, the others beside."""
    poses = np.zeros((PLACES, len(radii_m), 7))
    poses[..., 3] = 1.0
    aside = np.linspace(-0.999, 0.999, PLACES) * ANGLE
    for k, (radii, far) in enumerate(zip(radii_m, far_m, strict=True)):
        size = math.asin(max(radii) / far)
        c = np.abs(size + (aside if k == 0 else 0.3 * aside[::-1]))
        turn = 0.4 + 1.1 * k
        poses[:, k, 0] = far * np.sin(c) * math.cos(turn)
        poses[:, k, 1] = far * np.sin(c) * math.sin(turn)
        poses[:, k, 2] = far * np.cos(c)
    return Case(name, poses, np.array(radii_m))


def cases() -> list[Case]:
    """From the common to the odd."""
    earth = (6378.137e3, 6378.137e3, 6356.752e3)
    moon = (1737.4e3,) * 3
    return [
        passing("Earth from 400 km", [earth], [6778e3]),
        passing("Earth from the Moon", [earth], [3.844e8]),
        passing("Moon from Earth", [moon], [3.75e8]),
        passing("Phobos from Mars", [(13e3, 11.4e3, 9.1e3)], [6e6]),
        passing("Venus in transit", [(6051.8e3,) * 3], [4.1e10]),
        passing("Earth and Moon", [earth, moon], [1.5e9, 1.4e9]),
    ]


def main() -> None:
    options = report.arguments(__doc__).parse_args()
    rows: list[dict[str, Any]] = []
    for case in cases():
        best = {key: case.light(um, 64) for key, um in (("even", EVEN), ("dark", DARKENED))}
        for nodes in NODES:
            took = report.processor_s(lambda c=case, n=nodes: c.light(BANDS, n), 0.05)
            rows.append(
                {
                    "case": case.name,
                    "nodes": nodes,
                    "error_even": float(np.abs(case.light(EVEN, nodes) - best["even"]).max()),
                    "error_dark": float(np.abs(case.light(DARKENED, nodes) - best["dark"]).max()),
                    "us": took / PLACES * 1e6,
                }
            )
    clear = cases()[0]
    clear.poses[..., 2] *= -1.0
    clear_us = report.processor_s(lambda: clear.light(BANDS, 16), 0.05) / PLACES * 1e6
    keys = ["case", "nodes", "error_even", "error_dark", "us"]
    report.publish(
        options.json,
        {"rows": rows, "clear_us": clear_us},
        [
            report.table(
                ["scene", "nodes", "error, even", "error, darkened", "us a place"],
                [[row[key] for key in keys] for row in rows],
            ),
            f"no body near the sun: {clear_us:.3f} us a place",
        ],
    )


if __name__ == "__main__":
    main()
