"""Frames a second of the scenes that ship, and what raw Embree would take of them.

`rates` and `labels`: colour with every label, and labels alone, at each size, for frames that
follow each other: medians of wall time (as frames a second) and of CPU time of all threads. Each
scene renders a frame first, which loads models and maps. `share`: all rays that colour casts at
meshes and terrain on one thread, cast again by raw Embree in packets of eight, over the CPU time of
that frame; at the first size. `lines`: of csrc/render.

A part of it, in two minutes:

    python benchmarks/speed.py --scenes demo iss_leo --sizes 256x256 --frames 2
"""

from __future__ import annotations

import argparse
import os
import time
from typing import Any, NamedTuple

import report
from convergence import needs_data

import perilune

SCENES = (
    *("demo", "iss_leo", "voyager_phobos", "rendezvous", "clouds", "mli_randomised", "lro_moon"),
    *("apollo15", "lunar_lander", "lunar_orbiter", "lunar_pole", "lunar_rover"),
)
SIZES = ((256, 256), (640, 480))
PARTS = ("rates", "labels", "share", "lines")
JOBS = {"rates": ["rgb", *report.LABELS], "labels": report.LABELS}
REPEATS = 3


class Times(NamedTuple):
    """Medians over frames, seconds."""

    wall: float
    cpu: float


def size_of(text: str) -> tuple[int, int]:
    try:
        width, height = (int(side) for side in text.split("x"))
    except ValueError:
        raise argparse.ArgumentTypeError(f"{text}: must be WIDTHxHEIGHT, as 256x256") from None
    return width, height


def sized(scene: str, size: tuple[int, int], quality: str | None) -> perilune.Simulation:
    """Of every camera that the scene has; quality: None for that of the configuration."""
    sim = perilune.open(report.ROOT / "configs" / f"{scene}.yaml")
    places = [f"sensors.{name}" for name in sim.config.sensors] or ["camera"]
    changes: dict[str, Any] = {
        f"{place}.{side}": value
        for place in places
        for side, value in zip(("width", "height"), size, strict=True)
    }
    if quality is not None:
        changes["render.quality"] = quality
    return sim.with_overrides(changes)


def times_of(sim: perilune.Simulation, channels: list[str], frames: int, threads: int) -> Times:
    """Of frames 1, 2, ... after frame 0, Python included."""
    sim.frame(0, channels=channels, threads=threads)
    wall, cpu = [], []
    for index in range(1, frames + 1):
        start = time.perf_counter(), time.process_time()
        sim.frame(index, channels=channels, threads=threads)
        wall.append(time.perf_counter() - start[0])
        cpu.append(time.process_time() - start[1])
    return Times(report.median(wall), report.median(cpu))


def share_of(sim: perilune.Simulation) -> dict[str, float]:
    """Raw Embree's part of frame 0, and of the tracer's time for the same rays."""
    rays = sim.measure_frame(0, REPEATS).values()
    cpu = []
    for _ in range(REPEATS):
        start = time.process_time()
        sim.frame(0, channels=["rgb"], threads=1)
        cpu.append(time.process_time() - start)
    traced, raw = (sum(times[k] for times in rays) for k in (1, 2))
    whole = report.median(cpu)
    return {
        "rays": float(sum(times[0] for times in rays)),
        "frame_cpu_s": whole,
        "raw_share": raw / whole,
        "tracer_share": traced / whole,
    }


def lines() -> dict[str, int]:
    """Lines of the renderer, and of its files."""
    files = [
        path for path in (report.ROOT / "csrc" / "render").iterdir() if path.suffix in (".c", ".h")
    ]
    return {"files": len(files), "lines": sum(len(path.read_text().splitlines()) for path in files)}


def measure(options: argparse.Namespace) -> dict[str, Any]:
    """Scene -> size -> part -> numbers."""
    found: dict[str, Any] = {}
    for scene in options.scenes:
        path = report.ROOT / "configs" / f"{scene}.yaml"
        if needs_data(path) and "PERILUNE_DATA" not in os.environ:
            continue
        for size in options.sizes:
            sim = sized(scene, size, options.quality)
            parts: dict[str, Any] = {
                part: times_of(sim, channels, options.frames, options.threads)._asdict()
                for part, channels in JOBS.items()
                if part in options.parts
            }
            if "share" in options.parts and size == options.sizes[0]:
                parts["share"] = share_of(sim)
            found.setdefault(scene, {})["{}x{}".format(*size)] = parts
    return found


def rate_rows(found: dict[str, Any]) -> list[list[object]]:
    rows: list[list[object]] = []
    for scene, sizes in found.items():
        for size, parts in sizes.items():
            row: list[object] = [f"{scene} {size}"]
            for part in JOBS:
                times = parts.get(part)
                row += [1.0 / times["wall"], times["cpu"]] if times else ["", ""]
            rows.append(row)
    return rows


def share_rows(found: dict[str, Any]) -> list[list[object]]:
    return [
        [f"{scene} {size}", int(share["rays"]), share["frame_cpu_s"], share["raw_share"],
         share["tracer_share"]]
        for scene, sizes in found.items()
        for size, parts in sizes.items()
        if (share := parts.get("share")) is not None
    ]  # fmt: skip


def main() -> None:
    parser = report.arguments(__doc__)
    parser.add_argument("--scenes", nargs="+", choices=SCENES, default=SCENES)
    parser.add_argument("--sizes", nargs="+", type=size_of, default=SIZES, metavar="WxH")
    parser.add_argument("--parts", nargs="+", choices=PARTS, default=PARTS)
    parser.add_argument("--frames", type=int, default=5)
    parser.add_argument("--quality", help="render.quality; default: as configured")
    options = parser.parse_args()
    found = measure(options) if set(options.parts) - {"lines"} else {}
    tables = []
    if set(JOBS) & set(options.parts):
        head = ["scene", "frames a s", "CPU s", "labels a s", "CPU s"]
        tables.append(report.table(head, rate_rows(found)))
    if "share" in options.parts:
        head = ["colour alone, 1 thread", "rays", "CPU s", "raw Embree", "our tracer"]
        tables.append(report.table(head, share_rows(found)))
    counted = lines() if "lines" in options.parts else {}
    if counted:
        tables.append(f"csrc/render: {counted['lines']} lines in {counted['files']} files")
    result = {"threads": options.threads, "frames": options.frames, "quality": options.quality}
    report.publish(options.json, result | {"scenes": found, "render": counted}, tables)


if __name__ == "__main__":
    main()
