"""What accuracy costs: error and time of the words of `render.quality`, for every configuration.

Errors are those of frame 0 in digital numbers of 255 before rounding, against `--seeds` frames of
`--reference` samples at a tolerance of 0, without the noise of the reference (convergence.py says
how): the root mean square over pixels and bands, and the 99th percentile of |error| over flat
pixels, from whose neighbours the reference differs by less than 4, with what noise the reference
has. Times are CPU seconds of the colour of that frame on one thread, the least of some.
"""

from __future__ import annotations

import os
import time
from collections.abc import Mapping
from typing import NamedTuple, get_args

import numpy as np
import report
from convergence import F64, Scene, needs_data, shipped

from perilune.config.render import QUALITIES, TextureFilter

FLAT_DN = 4.0


class Cost(NamedTuple):
    rms_dn: float
    flat_dn: float
    cpu_s: float


def settings(word: str) -> dict[str, float]:
    """What the core is asked for."""
    keys = QUALITIES[word]
    levels = get_args(TextureFilter)
    return {**keys, "texture_filter": 1 + levels.index(keys["texture_filter"])}  # type: ignore[dict-item]


def flat(picture: F64) -> F64:
    """(height, width): which pixels differ little from their four neighbours."""
    wide = np.pad(picture, ((1, 1), (1, 1), (0, 0)), mode="edge")
    sides = wide[:-2, 1:-1], wide[2:, 1:-1], wide[1:-1, :-2], wide[1:-1, 2:]
    return np.all([np.abs(side - picture).max(axis=2) < FLAT_DN for side in sides], axis=0)


def cost(scene: Scene, quality: Mapping[str, float], seeds: int) -> Cost:
    """Means over seeds."""
    truth = np.mean(scene.reference, axis=0)
    even = flat(truth)
    squares, flats, cpu = [], [], []
    for seed in range(seeds):
        start = time.process_time()
        picture = scene.shown(quality, seed)
        cpu.append(time.process_time() - start)
        squares.append(scene.square(picture))
        off = np.abs(picture - truth)[even]
        flats.append(float(np.percentile(off, 99.0)) if off.size else 0.0)
    return Cost(float(np.sqrt(max(np.mean(squares), 0.0))), float(np.mean(flats)), min(cpu))


def main() -> None:
    parser = report.arguments(__doc__)
    parser.add_argument("--only", nargs="*", help="names of configurations; all without")
    parser.add_argument("--width", type=int, default=96)
    parser.add_argument("--reference", type=int, default=512, help="samples of each of its frames")
    parser.add_argument("--seeds", type=int, default=2)
    options = parser.parse_args()
    found = shipped()
    size = (options.width, options.width * 3 // 4)
    results: dict[str, dict[str, Cost]] = {}
    for name in options.only or found:
        if needs_data(found[name]) and "PERILUNE_DATA" not in os.environ:
            continue
        scene = Scene(found[name], size, options.reference, options.threads)
        words = [word for word in QUALITIES if word != "reference"]
        results[name] = {word: cost(scene, settings(word), options.seeds) for word in words}
    head = ["configuration", *(f"{word}: {what}" for word in ("draft", "train")
                               for what in ("RMS", "flat 99 %", "CPU s"))]  # fmt: skip
    rows = [[name, *(value for word in costs.values() for value in word)]
            for name, costs in results.items()]  # fmt: skip
    report.publish(
        options.json,
        {name: {w: c._asdict() for w, c in costs.items()} for name, costs in results.items()},
        [report.table(head, rows)],
    )


if __name__ == "__main__":
    main()
