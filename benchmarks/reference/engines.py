"""Runs the other renderers on a scene; images that are there already are not made again."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

import numpy as np

from . import by_mitsuba
from .scene import Array, Scene
from .scenes import ROOT


def cycles(
    scene: Scene,
    folder: Path,
    python: str,
    renders: list[tuple[int, int]],
    threads: int,
    passes: bool = False,
) -> tuple[Array, list[float]]:
    """(renders, H, W, 3) radiance and seconds of CPU time, of (samples, seed) each."""
    scene.save(folder)
    job = {"threads": threads, "passes": passes, "renders": renders}
    (folder / "job.json").write_text(json.dumps(job))
    command = [python, "-m", "benchmarks.reference.by_cycles", str(folder.resolve())]
    done = subprocess.run(command, capture_output=True, text=True, cwd=ROOT)
    if done.returncode != 0 or not (folder / "seconds.json").exists():
        sys.exit(
            f"{python} failed. It needs Blender as a module: pip install bpy==4.5.*\n"
            f"{done.stdout[-2000:]}\n{done.stderr[-2000:]}"
        )
    return np.load(folder / "cycles.npy"), json.loads((folder / "seconds.json").read_text())


def converged(
    engine: str, scene: Scene, folder: Path, samples: int, runs: int, threads: int, python: str
) -> Array:
    """(runs, H, W, 3) of "mitsuba" or "cycles"; kept in the folder for as many samples and runs."""
    folder.mkdir(parents=True, exist_ok=True)
    kept = folder / f"{engine}_{samples}x{runs}.npy"
    if kept.exists():
        images: Array = np.load(kept)
        return images
    if engine == "mitsuba":
        images = by_mitsuba.render(scene, samples, list(range(runs)), folder)
    else:
        renders = [(samples, seed) for seed in range(1, runs + 1)]
        images = cycles(scene, folder, python, renders, threads)[0]
    np.save(kept, images)
    return images
