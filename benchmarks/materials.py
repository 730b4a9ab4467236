"""What filtering pictures and evaluating material graphs cost.

Filters: error against time of each level of `render.texture_filter`, and of none at all, on a
mapped planet: root mean square over pixels and bands, in digital numbers of 255 before rounding,
against the finest filter with many samples at the same exposure. With one sample a pixel all that
smooths is the filter.

Graphs: for each ready material the time of an evaluation with all its drivers at their ideals, and
the share of a close view of our satellite's frame that it takes when all the satellite is of it:
what the frame takes less with the same surface model and constants for a graph.

Times are CPU seconds on one thread, the least of repeats; shares and ratios are of one run.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from pathlib import Path
from typing import Any, get_args

import numpy as np
import report

import perilune
from perilune.config.render import TextureFilter
from perilune.materials import drivers
from perilune.materials.graph import values

FILTERS = ("none", *get_args(TextureFilter))
FINEST = FILTERS[-1]
PLAIN = {"base_color": [0.6, 0.5, 0.4], "roughness": 0.4, "metallic": 0.5}
POINTS = 20000
FOOTPRINT_M = 0.003


def cpu_seconds(work: Callable[[], Any], repeats: int) -> float:
    """Least CPU time of a call: what else runs on a machine only ever adds to it."""
    times = []
    for _ in range(repeats):
        start = time.process_time()
        work()
        times.append(time.process_time() - start)
    return min(times)


def encode(radiance: np.ndarray, white: float) -> np.ndarray:
    """Display values of 255, sRGB (IEC 61966-2-1), not rounded."""
    x = np.clip(radiance.astype(float) / white, 0.0, 1.0)
    low = x <= 0.0031308
    return 255.0 * np.where(low, 12.92 * x, 1.055 * np.maximum(x, 1e-9) ** (1 / 2.4) - 0.055)


def planet(config: str, height_km: float, **render: Any) -> perilune.Simulation:
    """A view from so high up, aslant to the limb."""
    overrides: dict[str, Any] = {
        "spacecraft": {},
        "camera.width": 640,
        "camera.height": 480,
        "camera.fov_deg": 40.0,
        "camera.trajectory": {
            "kind": "hover",
            "target": "planet",
            "lon_deg": 10.0,
            "lat_deg": 40.0,
            "height_m": height_km * 1e3,
            "off_nadir_deg": 25.0,
        },
        "render.channels": ["rgb"],
    }
    overrides |= {f"render.{key}": value for key, value in render.items()}
    return perilune.open(config, overrides=overrides)


def filter_rows(config: str, height_km: float, samples: int, repeats: int) -> list[list[object]]:
    """Filter, samples, error, seconds and their ratio to the finest's."""
    truth = planet(config, height_km, samples=256, tolerance_dn=0.0)
    sample = truth.frame(0, channels=["radiance", "rgb"], threads=1)
    white = sample.meta["white_radiance"]
    expected = encode(sample["radiance"], white)
    rows: list[list[object]] = []
    for name in FILTERS:
        off = {"force_off": ["texture_filter"]} if name == "none" else {"texture_filter": name}
        sim = planet(config, height_km, samples=samples, tolerance_dn=0.0, **off)
        sim.frame(0, channels=["depth"], threads=1)  # the map is loaded once
        image = encode(sim.frame(0, channels=["radiance"], threads=1)["radiance"], white)
        seconds = cpu_seconds(
            lambda sim=sim: sim.frame(0, channels=["radiance"], threads=1), repeats
        )
        rows.append([name, samples, float(np.sqrt(np.mean((image - expected) ** 2))), seconds])
    return [[*row, row[3] / rows[-1][3]] for row in rows]  # type: ignore[operator]


def painted(config: str, material: dict[str, Any]) -> perilune.Simulation:
    """Our satellite close by, all of one material."""
    overrides: dict[str, Any] = {
        "materials": {"m": material},
        "spacecraft.smallsat.materials": [{"material": "*", "use": "m"}],
        "camera.width": 320,
        "camera.height": 240,
        "camera.trajectory": {"kind": "orbit_object", "target": "smallsat", "distance_m": 7.0},
        "render.samples": 4,
        "render.tolerance_dn": 0.0,
    }
    return perilune.open(config, overrides=overrides)


def evaluation_ns(sim: perilune.Simulation, repeats: int) -> tuple[int, float]:
    """Nodes evaluated at a hit, and the time of one, ns."""
    config = sim.config_at(0)[0]
    (graph,) = sim._mine().assignments.of(config).crafts["smallsat"].graphs
    given = values(graph, drivers.applied(config, "m", "smallsat"))
    parameters = np.zeros((len(given), 4), dtype=np.float32)
    parameters[:, :3] = given
    points = np.random.default_rng(1).uniform(-2.0, 2.0, size=(POINTS, 3))
    seconds = cpu_seconds(lambda: graph.core.evaluate(points, FOOTPRINT_M, parameters), repeats)
    return graph.core.instructions, seconds / POINTS * 1e9


def frame_seconds(sim: perilune.Simulation, repeats: int) -> float:
    sim.frame(0, channels=["rgb"], threads=1)
    return cpu_seconds(lambda: sim.frame(0, channels=["rgb"], threads=1), repeats)


def graph_rows(config: str, folder: Path, repeats: int) -> list[list[object]]:
    """Material, nodes, ns a hit, seconds of a frame and the graph's share of it."""
    plain_s: dict[str, float] = {}
    rows: list[list[object]] = []
    for path in sorted(folder.glob("*.yaml")):
        sim = painted(config, {"file": str(path)})
        nodes, ns = evaluation_ns(sim, repeats)
        seconds = frame_seconds(sim, repeats)
        material = sim.config.materials["m"]
        kinds = [raw["type"] for raw in material.nodes.values()]
        kind = "principled" if "principled" in kinds else "lambert"
        if kind not in plain_s:
            keys = PLAIN if kind == "principled" else {"base_color": PLAIN["base_color"]}
            plain = painted(config, {"nodes": {"skin": {"type": kind, **keys}}})
            plain_s[kind] = frame_seconds(plain, repeats)
        share = max(0.0, 1.0 - plain_s[kind] / seconds)
        rows.append([path.stem, nodes, ns, seconds, share])
    return rows


def main() -> None:
    parser = report.arguments(__doc__)
    parser.add_argument("--config", default=str(report.ROOT / "configs" / "demo.yaml"))
    parser.add_argument("--materials", type=Path, default=report.ROOT / "assets" / "materials")
    parser.add_argument("--height-km", type=float, default=3000.0)
    parser.add_argument("--repeats", type=int, default=7)
    options = parser.parse_args()
    filters = [
        row
        for samples in (1, 16)
        for row in filter_rows(options.config, options.height_km, samples, options.repeats)
    ]
    graphs = graph_rows(options.config, options.materials, options.repeats)
    filter_keys = ["filter", "samples", "rms_dn", "cpu_seconds", "time_ratio"]
    graph_keys = ["material", "nodes", "ns_per_hit", "frame_cpu_seconds", "graph_share"]
    report.publish(
        options.json,
        {
            "config": options.config,
            "filters": [dict(zip(filter_keys, row, strict=True)) for row in filters],
            "graphs": [dict(zip(graph_keys, row, strict=True)) for row in graphs],
        },
        [
            report.table(["filter", "samples", "RMS error, DN", "CPU s", "time ratio"], filters),
            report.table(["material", "nodes", "ns a hit", "CPU s a frame", "share"], graphs),
        ],
    )


if __name__ == "__main__":
    main()
