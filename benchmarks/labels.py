"""What labels and files take beside rendering: CPU time, for the demo and for 300 spacecraft.

A frame of 640x480 pixels with 16 samples: the colour alone; then every label in view; then the
files of each format. Times are the process's CPU time on one thread, medians of some frames; ratios
are to the colour alone. Frames are made once for all formats: files do not count rendering.
"""

from __future__ import annotations

import argparse
import math
import statistics
import time
from collections.abc import Callable
from typing import Any

import report

import perilune
from perilune.export.writers.formats import record as records
from perilune.export.writers.formats.folder import frame_of
from perilune.export.writers.formats.info import folder_info
from perilune.export.writers.formats.tables import FORMATS

LABELS = ["depth", "normal", "semantic", "part", "instance", "objects", "masks"]
TREE = "hierarchy"
"""A channel that is timed by itself, as what it adds to the others."""
MEASURED = ("bop-webdataset", "coco", "yolo", "png", "npz", "exr", "webdataset")
LIMITS = {1: 0.15, 300: 0.5}
"""Of the colour, at most, for all labels and a format's files."""
FRAMES = 4
MODEL = str(report.ROOT / "assets/models/tango_like.glb")
"""A small satellite of 4 352 triangles, which stands 300 times in a view."""


def scene(count: int) -> perilune.Simulation:
    """The demo as it is; or this many small satellites, on a lattice in front of its planet."""
    sim = perilune.open(report.ROOT / "configs/demo.yaml")
    tree, changes = dict(sim.document.tree), {}
    if count > 1:
        ((name, craft),) = tree["spacecraft"].items()
        orbit = craft["orbit"]
        side = math.ceil(count ** (1.0 / 3.0))
        places = [(i, j, k) for i in range(side) for j in range(side) for k in range(side)]
        crafts = {}
        for number, (i, j, k) in enumerate(places[:count]):
            # Neighbours are some seven metres away; the first one is what the camera looks at.
            # One period for all, so that they stay together.
            own = {
                "eccentricity": 1e-6 * i,
                "mean_anomaly_deg": 6e-5 * (j - side // 2),
                "raan_deg": 8e-5 * (k - side // 2),
            }
            key = f"{name}_{number:03d}" if number else name
            crafts[key] = {"model": MODEL, "size_m": 2.0, "orbit": {**orbit, **own}}
        tree["spacecraft"] = crafts
        # Far enough that most are in view; they hide each other in part.
        changes["camera.trajectory.distance_m"] = [75.0, 85.0]
    changes |= {
        "camera.width": 640,
        "camera.height": 480,
        "render.samples": 16,
        "render.channels": ["rgb", *LABELS],
    }
    return perilune.open(tree, overrides=changes, base=sim.document.base)


def timed(task: Callable[[], Any]) -> tuple[float, Any]:
    """CPU seconds of the process, and what came out."""
    start = time.process_time()
    result = task()
    return time.process_time() - start, result


def measure(count: int, frames: int) -> dict[str, float]:
    """Medians in seconds: colour, labels, and files by format."""
    sim = scene(count)
    crafts = list(sim.config.spacecraft)
    times: dict[str, list[float]] = {}
    sim.frame(0, ["rgb"], threads=1)
    infos = {name: folder_info(FORMATS[name], sim, 1000, "train") for name in MEASURED}
    for index in range(1, 1 + frames):
        colour, picture = timed(lambda index=index: sim.frame(index, ["rgb"], threads=1))
        # Alone, which is more than beside colour: the scene is placed once more.
        labels, sample = timed(lambda index=index: sim.frame(index, LABELS, threads=1))
        sample._channels["rgb"] = picture["rgb"]
        times.setdefault("colour", []).append(colour)
        times.setdefault("labels", []).append(labels)
        more, _ = timed(lambda index=index: sim.frame(index, [*LABELS, TREE], threads=1))
        times.setdefault(TREE, []).append(more - labels)
        for name in MEASURED:

            def encoded(sample: perilune.Sample = sample, name: str = name) -> Any:
                base = records.record_of(sample, crafts)
                frame = frame_of(infos[name], sample, {}, base)
                return records.text_of({**base, "files": {}}), FORMATS[name].encode(
                    infos[name], frame
                )

            spent, _ = timed(encoded)
            times.setdefault(name, []).append(spent)
        times.setdefault("seen", []).append(float((sample.objects["px_count_visib"] > 0).sum()))
    return {name: statistics.median(values) for name, values in times.items()}


def main() -> None:
    """Prints a table a number of spacecraft."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--counts", type=int, nargs="+", default=[1, 300])
    parser.add_argument("--frames", type=int, default=FRAMES)
    given = parser.parse_args()
    for count in given.counts:
        found = measure(count, given.frames)
        colour = found.pop("colour")
        print(f"{count} spacecraft, {found.pop('seen'):.0f} seen; colour {colour:.2f} s")
        print("| what | s | of colour | with labels |")
        print("| --- | --- | --- | --- |")
        for name, seconds in found.items():
            both = seconds + (0.0 if name == "labels" else found["labels"])
            print(f"| {name} | {seconds:.3f} | {seconds / colour:.3f} | {both / colour:.3f} |")
        dearest = max(value for name, value in found.items() if name not in ("labels", TREE))
        ratio = (found["labels"] + max(found[TREE], 0.0) + dearest) / colour
        limit = f", limit {LIMITS[count]}" if count in LIMITS else ""
        print(f"all labels, the hierarchy and the dearest format: {ratio:.3f} of colour{limit}")


if __name__ == "__main__":
    main()
