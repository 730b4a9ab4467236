"""Writers of every format under SIGKILL at random times of the clock: run again, they must leave
the bytes of a run that nothing disturbed. `script/soak` runs it; stops at counted operations are
tests (test_stops.py, test_formats.py).

python -m tests.python.output.kill_times [FORMAT ...] [--kills 20]
"""

from __future__ import annotations

import argparse
import json
import os
import shutil
import signal
import tempfile
import time
from pathlib import Path

import numpy as np

import perilune
from perilune.export.writers import WRITERS, write
from perilune.export.writers.formats.channels import described
from perilune.export.writers.formats.tables import FORMATS

from .conftest import write_probe
from .stops import Canned, tree_bytes

FRAMES = range(12)
CHANNELS = ["rgb", "depth", "semantic", "part", "instance", "objects", "masks", "flow"]
CHANNELS += ["keypoints", "flow_occlusion", "radiance", "range", "position", "normal"]


def scene(folder: Path) -> Path:
    """A configuration of one probe."""
    write_probe(folder / "probe.glb")
    orbit = {"around": "planet", "altitude_km": 500.0, "inclination_deg": 30.0,
             "mean_anomaly_deg": 10.0}  # fmt: skip
    keypoints = {"points": {"nose": [0.9, 0.0, 0.4]}}
    probe = {"model": "probe.glb", "size_m": 4.0, "orbit": orbit, "keypoints": keypoints}
    tree = {
        "version": 1,
        "time": {"epoch": "2026-03-20T12:00:00Z", "step_s": 1.0, "frames_per_scene": 4},
        "root": "planet",
        "bodies": {"planet": {"kind": "ellipsoid", "radii_km": [6378.0, 6378.0, 6357.0],
                              "gm_km3_s2": 398600.0, "albedo": 0.3}},
        "spacecraft": {"probe": probe},
        "camera": {"width": 64, "height": 48, "fov_deg": 40.0, "trajectory": {
            "kind": "orbit_object", "target": "probe", "distance_m": [9.0, 14.0]}},
        "render": {"samples": 1, "max_bounces": 0},
    }  # fmt: skip
    path = folder / "scene.json"
    path.write_text(json.dumps(tree))
    return path


def put(name: str, sim: object, out: Path) -> None:
    write(name, sim, FRAMES, out, chunk_size=5, threads=1)  # type: ignore[arg-type]


def killed(name: str, sim: object, out: Path, after_s: float) -> bool:
    """Writes in a child that is killed after a time; whether it was not done by then."""
    child = os.fork()
    if child == 0:
        put(name, sim, out)
        os._exit(0)
    time.sleep(after_s)
    os.kill(child, signal.SIGKILL)
    _, status = os.waitpid(child, 0)
    return os.WIFSIGNALED(status)


def attempt(name: str, sim: object, folder: Path, kills: int) -> tuple[int, int]:
    """How many kills came in time, and after how many the bytes were not those of the truth."""
    truth, out = folder / "truth", folder / "out"
    put(name, sim, truth)
    start = time.perf_counter()
    put(name, sim, out)
    lasts_s = time.perf_counter() - start
    expected, random, hit, wrong = tree_bytes(truth), np.random.default_rng(4), 0, 0
    for _ in range(kills):
        shutil.rmtree(out, ignore_errors=True)
        while not killed(name, sim, out, float(random.uniform(0.0, lasts_s))):
            shutil.rmtree(out, ignore_errors=True)
        hit += 1
        killed(name, sim, out, float(random.uniform(0.0, 0.5 * lasts_s)))  # and once more
        put(name, sim, out)
        wrong += tree_bytes(out) != expected
    shutil.rmtree(out, ignore_errors=True)
    shutil.rmtree(truth)
    return hit, wrong


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("formats", nargs="*", default=list(WRITERS))
    parser.add_argument("--kills", type=int, default=20)
    asked = parser.parse_args()
    failed = 0
    with tempfile.TemporaryDirectory() as place:
        folder = Path(place)
        sim = perilune.open(scene(folder))
        made = Canned(sim, range(len(FRAMES) + 1), CHANNELS)
        for name in asked.formats:
            known = described(sim, CHANNELS).items()
            fits = FORMATS[name].problem if name in FORMATS else lambda row: ""
            own = sim.with_overrides({"render.channels": [k for k, row in known if not fits(row)]})
            if name == "ply":
                own = own.with_overrides({"render.scans": ["points"]})
            canned = Canned(own, (), ())
            canned._samples = made._samples
            hit, wrong = attempt(name, canned, folder, asked.kills)
            print(f"{name}: killed {hit} times, other bytes after {wrong}", flush=True)
            failed += wrong
    return 1 if failed else 0


if __name__ == "__main__":
    raise SystemExit(main())
