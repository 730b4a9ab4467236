"""Time of the plan and of labels against the number of spacecraft and of bodies.

Spacecraft stand in a block before the camera, all of them in the frame, with one planet behind;
or moons about a planet, with one spacecraft. Milliseconds on one thread; the last column is the
frame's time over the number of things.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import report

import perilune
from perilune.base import rotations

SPACECRAFT = (1, 10, 100, 1000)
BODIES = (1, 10, 100)
LABELS = ["depth", "instance", "objects"]
AWAY_KM = 8000.0
"""Of the block from the planet's centre."""
APART_M = 25.0


def scene(spacecraft: int, bodies: int) -> tuple[dict[str, Any], float]:
    """The configuration, and the side of the block in metres."""
    rng = np.random.default_rng(7)
    side = math.ceil(round(spacecraft ** (1.0 / 3.0), 6))
    planet = {"kind": "ellipsoid", "radii_km": 6371.0, "gm_km3_s2": 398600.0, "albedo": 0.3}
    worlds: dict[str, Any] = {"planet": planet}
    for i in range(bodies - 1):
        place = rng.normal(size=3)
        place *= rng.uniform(2e5, 4e5) / np.linalg.norm(place)
        orbit = {"around": "planet", "position_km": place.tolist()}
        worlds[f"moon_{i}"] = {**planet, "radii_km": 100.0, "gm_km3_s2": 1.0, "orbit": orbit}
    crafts = {}
    for i in range(spacecraft):
        cell = np.array([i % side, i // side % side, i // side**2]) - 0.5 * (side - 1)
        place = np.array([AWAY_KM, 0, 0]) + 1e-3 * APART_M * (cell + rng.uniform(-0.2, 0.2, 3))
        orbit = {"around": "planet", "position_km": place.tolist()}
        crafts[f"craft_{i}"] = {
            "model": str(report.ROOT / "assets" / "models" / "smallsat.glb"),
            "size_m": 8.0,
            "orbit": orbit,
        }
    return {
        "version": 1,
        "name": "scaling",
        "time": {"epoch": "2026-03-20T12:00:00Z", "step_s": 0},
        "root": "planet",
        "bodies": worlds,
        "spacecraft": crafts,
        "sun": {"direction": [1.0, 0.4, 0.2]},
        "camera": {
            "width": 128,
            "height": 128,
            "fov_deg": 60.0,
            "exposure": {"mode": "fixed", "white_radiance_w_m2_sr": 320.0},
            "trajectory": {"kind": "fixed", "target": "craft_0", "position_m": [1500.0, 0, 0]},
        },
        "render": {"samples": 1, "channels": ["rgb"]},
    }, side * APART_M


def measure(spacecraft: int, bodies: int) -> list[object]:
    tree, side_m = scene(spacecraft, bodies)
    back_m = 1e3 * AWAY_KM + 1.6 * side_m + 20.0
    look = rotations.look_at(np.array([-1.0, 0, 0]), np.array([0, 0, 1.0]))
    pose = np.concatenate([[back_m, 0, 0], look])
    sim = perilune.open(tree, trajectory=lambda _: pose)
    sample = sim.frame(0, LABELS, threads=1)  # models are read, accelerators built
    inside = int((sample.objects["in_view"] > 0).sum())
    plan_ms = []
    for _ in range(3):
        plan_ms.append(1e3 * sim.frame(0, ["rgb"], threads=1).meta["timings_s"]["plan"])
    labels_ms = 1e3 * report.processor_s(lambda: sim.frame(0, LABELS, threads=1))
    things = spacecraft + bodies
    return [spacecraft, bodies, inside, min(plan_ms), labels_ms, labels_ms / things]


def main() -> None:
    options = report.arguments(__doc__).parse_args()
    rows = [measure(n, 1) for n in SPACECRAFT]
    rows += [measure(1, n) for n in BODIES[1:]]
    rows.append(measure(SPACECRAFT[-1], BODIES[-1]))
    head = ["spacecraft", "bodies", "in view", "plan, ms", "labels, ms", "a thing, ms"]
    report.publish(options.json, {"rows": rows, "columns": head}, [report.table(head, rows)])


if __name__ == "__main__":
    main()
