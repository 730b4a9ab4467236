"""Converged frames of Perilune, Mitsuba 3 and Cycles, how far apart they are, and where.

Differences are root mean squares over pixels and bands in digital numbers of 255, not rounded, at
one exposure, without noise: products of the differences of independent halves. The second table
says in which pixels they are, by what Mitsuba meets there first: outlines are pixels that several
things share. Blocks are 4 x 4 pixels whose means differ by Welch's t-test, 0.001 for all together.

The frames and what is left out of them: reference/scenes.py. Cycles needs a Python that has Blender
as a module (pip install bpy==4.5.*, some 500 MB, Python 3.11): `--cycles PYTHON`. `--keep FOLDER`
holds the images of the others, which need many minutes; delete it when frames or models change.
"""

from __future__ import annotations

import tempfile
from pathlib import Path
from typing import Any

import numpy as np
import report
from reference import compare, engines, export, ours, pixels, scenes
from reference.scene import Array

ABSENT = "-"
"""Where a renderer has no such frame: air is not exported to Cycles."""


def pairs_of(images: dict[str, Array], white: float) -> dict[str, Array]:
    """Mean square differences (H, W) by names joined by "-"."""
    names = list(images)
    return {
        f"{a}-{b}": compare.apart(images[a], images[b], white)
        for i, a in enumerate(names)
        for b in names[i + 1 :]
    }


def save_sheet(path: Path, images: dict[str, Array], white: float) -> None:
    """The images, and below them their differences, four times as large about grey."""
    from PIL import Image

    shown = {name: compare.encode(runs.mean(0), white) for name, runs in images.items()}
    names = list(shown)
    above = [shown[name] for name in names]
    below = [
        np.clip(128.0 + 4.0 * (shown[a] - shown[b]), 0.0, 255.0)
        for i, a in enumerate(names)
        for b in names[i + 1 :]
    ]
    below += [np.zeros_like(above[0])] * (len(above) - len(below))
    rows = [np.hstack(above), np.hstack(below[: len(above)])]
    Image.fromarray(np.vstack(rows).round().astype(np.uint8)).save(path)


def measure(name: str, options: Any, folder: Path) -> tuple[list[Any], list[list[Any]]]:
    """A row of the first table, and those of the second."""
    frame = scenes.FRAMES[name]
    sim = frame.open(options.width, folder)
    scene = export.export(sim, frame.index)
    white, threads = scene.white_radiance, options.threads
    seeds = list(range(100, 100 + options.runs))
    images = {"Perilune": ours.render(sim, frame.index, options.own, seeds, threads)}
    for engine, word in (("cycles", "Cycles"), ("mitsuba", "Mitsuba")):
        if engine == "mitsuba" or (options.cycles and not scene.air):
            images[word] = engines.converged(
                engine, scene, folder, options.samples, options.runs, threads, options.cycles
            )
    if options.sheets:
        options.sheets.mkdir(parents=True, exist_ok=True)
        save_sheet(options.sheets / f"{name}.png", images, white)
    square = pairs_of(images, white)
    row: list[Any] = [name]
    for pair in wanted(options):
        if pair not in square:
            row += [ABSENT, ABSENT]
            continue
        a, b = (images[word] for word in pair.split("-"))
        apart = float(np.sqrt(max(0.0, square[pair].mean())))
        row += [apart, float(compare.differing(a, b).mean())]
    hits = pixels.first_hits(scene, folder)
    empty = np.full(hits["owner"].shape, np.nan)
    every = {pair: square.get(pair, empty) for pair in wanted(options)}
    return row, [[name, *r] for r in pixels.shares(scene, hits, every)]


def wanted(options: Any) -> list[str]:
    """Pairs of names, in the order of the tables."""
    words = ["Perilune", *(["Cycles"] if options.cycles else []), "Mitsuba"]
    return [f"{a}-{b}" for i, a in enumerate(words) for b in words[i + 1 :]]


def main() -> None:
    parser = report.arguments(__doc__)
    parser.add_argument("--frames", nargs="+", default=list(scenes.FRAMES), choices=scenes.FRAMES)
    parser.add_argument("--width", type=int, default=320)
    parser.add_argument("--own", type=int, default=256, help="samples of a run of Perilune")
    parser.add_argument("--samples", type=int, default=64, help="samples of a run of the others")
    parser.add_argument("--runs", type=int, default=4, help="even, with other seeds")
    parser.add_argument("--cycles", default="", metavar="PYTHON", help="a Python that has bpy")
    parser.add_argument("--keep", type=Path, help="a folder for the others' images")
    parser.add_argument("--sheets", type=Path, help="a folder for images and differences (PNG)")
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as temporary:
        folder = options.keep or Path(temporary)
        measured = [measure(name, options, folder / name) for name in options.frames]
    pairs = wanted(options)
    head = ["frame", *[text for pair in pairs for text in (f"{pair}, DN", "blocks that differ")]]
    parts = ["frame", "what", "of pixels", *[t for pair in pairs for t in (f"{pair}, DN", "of it")]]
    rows, places = [row for row, _ in measured], [row for _, more in measured for row in more]
    report.publish(
        options.json,
        {"pairs": pairs, "frames": rows, "places": places},
        [report.table(head, rows), report.table(parts, places)],
    )


if __name__ == "__main__":
    main()
