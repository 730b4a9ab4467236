"""What every label and every format takes beside rendering: CPU time in some scenes, and of 300
spacecraft.

A frame of 640x480 pixels with 16 samples, one thread, CPU time of the process, medians of some
frames. The colour alone is what all ratios are to. `labels` is what all label channels of the table
of channels at once, with objects, masks and tables, add to a frame of the colour; `labels alone`
are a frame of their own, which places the scene and casts a ray through each pixel, too. What a
scene has no value for is named, and so are channels in which every pixel says so. Files of a format
are those of a frame with all of these that it can hold, with the picture: encoded, summed, written,
and packed. The table tells each group of channels, too: what it adds to `depth` alone.
"""

from __future__ import annotations

import argparse
import math
import statistics
import tempfile
import time
from collections.abc import Callable
from contextlib import ExitStack
from pathlib import Path
from typing import Any

import numpy as np
import report

import perilune
from perilune import _core
from perilune.config.errors import ConfigError
from perilune.document.references import channel_names, check_channels
from perilune.export.writers.bop import open_bop
from perilune.export.writers.formats.folder import open_folder
from perilune.export.writers.formats.tables import FORMATS
from perilune.export.writers.run import NEXT, Begun, Dataset, tables_of

LIMITS = {1: 0.15, 300: 0.5}
"""Of the colour, at most, for all labels and the files of the default format."""
SCENES = ("demo", "voyager_phobos", "iss_leo")
"""Configurations; the last two need the sample data."""
DEFAULT = "bop"
FRAMES = 4
MODEL = str(report.ROOT / "assets/models/tango_like.glb")
"""A small satellite of 4 352 triangles, which stands 300 times in a view."""
COLOURS = {row["name"] for row in _core.CHANNELS if row["colour"]}
BASE = "depth"


def scene(config: str, count: int, frames: int) -> perilune.Simulation:
    """A configuration with some frames a scene; or the demo with this many small satellites, on a
    lattice in front of its planet."""
    sim = perilune.open(report.ROOT / f"configs/{config}.yaml")
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
        # Motion needs neighbours; a scene more than the frames that are timed.
        "time.frames_per_scene": frames + 2,
    }
    return perilune.open(tree, overrides=changes, base=sim.document.base)


def is_blank(array: Any) -> bool:
    """Whether all pixels of a channel say that there is nothing: 0, nan, or off the ground."""
    if array.dtype.kind == "f":
        return bool((np.isnan(array) | (array == 0.0)).all())
    return array.dtype.names is None and len(np.unique(array)) <= 1


def labels_of(sim: perilune.Simulation) -> tuple[list[str], list[str]]:
    """All label channels of the table that a scene gives, and why it does not give the others."""
    given, refused = [], []
    for name in channel_names():
        if name in COLOURS:
            continue
        try:
            check_channels([name], sim.config, name)
            given.append(name)
        except ConfigError as error:
            refused.append(str(error))
    sample = sim.frame(1, given)
    pixels = {row["name"] for row in _core.CHANNELS}
    blank = [name for name in given if name in pixels and is_blank(sample[name])]
    refused += [f"{name}: has no value in any pixel" for name in blank]
    return [name for name in given if name not in blank], refused


def timed(task: Callable[[], Any]) -> tuple[float, Any]:
    """CPU seconds of the process, and what came out."""
    start = time.process_time()
    result = task()
    return time.process_time() - start, result


def groups_of(names: list[str]) -> dict[str, list[str]]:
    """Channels that share what they cost, and each that is dear alone."""
    table: dict[str, list[str]] = {}
    for name in names:
        stem = "flow" if "flow" in name else name.partition("_")[0]
        own = stem in ("flow", "coverage", "shadow") or name in ("cloud_opacity", "albedo")
        own |= name in ("objects", "masks", "hierarchy", "keypoints")
        table.setdefault(stem if own else "all others", []).append(name)
    return table


class Written:
    """A dataset of one format in a folder of its own, that is written frame by frame."""

    def __init__(self, name: str, sim: perilune.Simulation, frames: range, held: ExitStack) -> None:
        root = Path(held.enter_context(tempfile.TemporaryDirectory())) / "data"
        begun = Begun(sim, root, len(frames) + 1, "train", held, None)
        begin = open_bop(begun) if name == "bop" else open_folder(FORMATS[name], begun)
        self.job: Dataset = begin()
        self.job.find({0: dict(zip(frames, frames, strict=True))}, len(frames) + 1)
        self.job.begin(0)
        self.seconds: list[float] = []

    def write(self, sim: perilune.Simulation, sample: perilune.Sample) -> None:
        """Writes the files of a frame."""
        names = [name for name in self.job.tables if name != NEXT]
        tables = tables_of(sim, sample, names, 1)
        index = sample.meta["index"]
        self.seconds.append(timed(lambda: self.job.write(index, sample, tables))[0])

    def median(self) -> float:
        """Seconds a frame, with its part of packing the chunk."""
        packed, _ = timed(lambda: self.job.end(0))
        return statistics.median(self.seconds) + packed / len(self.seconds)


def open_formats(
    sim: perilune.Simulation, frames: range, held: ExitStack
) -> tuple[dict[str, Written], list[str]]:
    """All formats that can hold something of the scene, and what the others say."""
    found, refused = {}, []
    for name in ("bop", *FORMATS):
        try:
            own = Written(name, sim, frames, held)
        except (ConfigError, ValueError) as error:
            refused.append(str(error))
            continue
        if NEXT in own.job.tables:  # it renders the next frame, which is no file's cost
            refused.append(f"{name}: renders every frame's neighbour")
            continue
        found[name] = own
    return found, refused


def measure(
    config: str, count: int, frames: int
) -> tuple[dict[str, float], dict[str, float], list[str]]:
    """Medians in seconds: colour, labels and groups; files by format; what is left out."""
    sim = scene(config, count, frames)
    names, refused = labels_of(sim)
    sim = perilune.open(
        sim.document.tree,
        overrides={"render.channels": ["rgb", *names]},
        base=sim.document.base,
    )
    times: dict[str, list[float]] = {}
    indices = range(1, 1 + frames)
    sim.frame(0, ["rgb"], threads=1)
    with ExitStack() as held:
        written, more = open_formats(sim, indices, held)
        for index in indices:
            asked = {"colour": ["rgb"], "labels": ["rgb", *names], "labels alone": names}
            asked[BASE] = [BASE]
            asked |= {f"+ {group}": [BASE, *own] for group, own in groups_of(names).items()}
            for key, own in asked.items():
                spent, _ = timed(lambda index=index, own=own: sim.frame(index, own, threads=1))
                base = times[BASE][-1] if key.startswith("+") else 0.0
                base = times["colour"][-1] if key == "labels" else base
                times.setdefault(key, []).append(spent - base)
            whole = sim.frame(index, ["rgb", *names])
            seen = float((whole.objects["px_count_visib"] > 0).sum())
            times.setdefault("seen", []).append(seen)
            for own_format in written.values():
                own_format.write(sim, whole)
        files = {name: own.median() for name, own in written.items()}
    medians = {name: statistics.median(values) for name, values in times.items()}
    return medians, files, [*refused, *more]


def report_on(config: str, count: int, frames: int) -> None:
    """Prints the table of a scene."""
    found, files, refused = measure(config, count, frames)
    # Alone, as the steadier: beside the colour they are a small difference of two long times.
    colour, labels = found.pop("colour"), found["labels alone"]
    print(f"{config}: {count} spacecraft, {found.pop('seen'):.0f} seen; colour {colour:.2f} s")
    print("| what | s | of colour | with labels |")
    print("| --- | --- | --- | --- |")
    for name, seconds in found.items():
        print(f"| {name} | {seconds:.3f} | {seconds / colour:.3f} | |")
    for name, seconds in files.items():
        both = (seconds + labels) / colour
        print(f"| `{name}` | {seconds:.3f} | {seconds / colour:.3f} | {both:.3f} |")
    limit = f", limit {LIMITS[count]}" if count in LIMITS else ""
    ratio = (labels + files[DEFAULT]) / colour
    print(f"all labels and {DEFAULT}, the default format: {ratio:.3f} of colour{limit}")
    print("left out: " + "; ".join(" ".join(text.split()) for text in refused))


def main() -> None:
    """Prints a table a scene, and one a number of spacecraft."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--scenes", nargs="*", default=SCENES)
    parser.add_argument("--counts", type=int, nargs="*", default=[300], help="of spacecraft")
    parser.add_argument("--frames", type=int, default=FRAMES)
    given = parser.parse_args()
    for config in given.scenes:
        report_on(config, 1, given.frames)
    for count in given.counts:
        report_on("demo", count, given.frames)


if __name__ == "__main__":
    main()
