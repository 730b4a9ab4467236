"""The same frame by Blender's Cycles and by Perilune: error against time, side by side.

Each is compared with its own converged image, in digital numbers of 255 at one exposure, so that
differences of materials, filters and readers count for nothing. The last table says how long
Perilune needs for the error of Cycles' `--equal` samples. Cycles renders even samples without a
denoiser, with the passes that labels need and its scene kept from frame to frame; Perilune renders
with all labels. Needs a Python that has `bpy` (pip install bpy, some 500 MB): `--python`.
"""

from __future__ import annotations

import json
import math
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Any

import numpy as np
import report
from samples import encode, seconds_at

import perilune

CYCLES_SAMPLES = ((4, 1), (16, 1))
CYCLES_TRUTH = 64
OWN_SAMPLES = (1, 2, 3, 4, 6, 8, 12, 16, 32)
OWN_TRUTH = {"render.samples": 1024, "render.tolerance_dn": 0.0}


def rotated(pose: np.ndarray) -> np.ndarray:
    """(4, 4) of a pose x y z qw qx qy qz."""
    w, x, y, z = pose[3:]
    matrix = np.eye(4)
    matrix[:3, :3] = [
        [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
        [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
        [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
    ]
    matrix[:3, 3] = pose[:3]
    return matrix


def describe(sim: perilune.Simulation, frame: int, folder: Path, threads: int) -> dict[str, Any]:
    """The frame as plain data, relative to the camera (OpenCV axes), m."""
    sample, request = sim.frame(frame, channels=["objects"]), sim.request(frame)
    camera = np.eye(4)
    camera[:3, :3], camera[:3, 3] = sample.camera.R_w2c, sample.camera.t_w2c
    models = []
    for row, model in zip(sample.objects, sim.models.values(), strict=True):
        pose = np.eye(4)
        pose[:3, :3], pose[:3, 3] = row["R_m2c"], row["t_m2c"]
        models.append(
            {
                "path": model.model.path,
                "to_camera": pose.tolist(),
                "scale": model.metres_per_unit,
                "offset": model.offset.tolist(),
            }
        )
    bodies = []
    for i, (name, body) in enumerate(sim.config.bodies.items()):
        place = camera @ rotated(np.asarray(request["body_poses"][i]).mean(axis=0))
        bodies.append(
            {
                "name": name,
                "radii_m": request["body_radii"][i].tolist(),
                "to_camera": place.tolist(),
                "map": body.color_map
                and str(sim.document.path(body.color_map, f"bodies.{name}.color_map")),
                "center_lon_rad": math.radians(body.map_center_lon_deg),
                "albedo": request["body_albedo"][i].tolist(),
            }
        )
    sun = camera[:3, :3] @ request["sun_position"] + camera[:3, 3]
    away = float(np.linalg.norm(sun))
    au = 149597870700.0
    return {
        "threads": threads,
        "max_bounces": sim.config.render.max_bounces,
        "models": models,
        "bodies": bodies,
        "sun": {
            "direction": (sun / away).tolist(),
            "irradiance": request["sun_irradiance"] * (au / away) ** 2,
            "radius_rad": math.asin(request["sun_radius"] / away),
        },
        "camera": {
            "width": request["width"],
            "height": request["height"],
            "focal_px": float(request["K"][0, 0]),
        },
        "samples": [*CYCLES_SAMPLES, (CYCLES_TRUTH, 1)],
    }


def rms(image: np.ndarray, truth: np.ndarray) -> float:
    return float(np.sqrt(np.mean((image - truth) ** 2)))


def by_cycles(job: dict[str, Any], python: str, folder: Path) -> dict[str, float]:
    (folder / "job.json").write_text(json.dumps(job))
    script = Path(__file__).with_name("against_cycles_scene.py")
    done = subprocess.run([python, script, folder], capture_output=True, text=True)
    if done.returncode != 0 or not (folder / "seconds.json").exists():
        sys.exit(f"{python} failed: has it bpy?\n{done.stdout[-2000:]}\n{done.stderr[-2000:]}")
    seconds: dict[str, float] = json.loads((folder / "seconds.json").read_text())
    return seconds


class Own:
    """Frames of Perilune at several numbers of samples."""

    def __init__(self, config: str, frame: int, size: dict[str, int], threads: int) -> None:
        self.config, self.frame, self.size, self.threads = config, frame, size, threads
        self.truth, self.white, _ = self.picture(1, OWN_TRUTH)

    def picture(self, repeats: int, render: dict[str, Any]) -> tuple[np.ndarray, float, float]:
        """Radiance, the radiance shown as 255, and seconds."""
        sim = perilune.open(self.config, overrides=self.size | render)
        channels = ["rgb", "radiance", *report.LABELS, "objects"]
        sample = sim.frame(self.frame, channels=channels, threads=self.threads)
        times = report.seconds(
            lambda: sim.frame(self.frame, channels=channels, threads=self.threads), repeats
        )
        return sample["radiance"], sample.meta["white_radiance"], report.median(times)

    def error(self, samples: int) -> tuple[float, float]:
        image, _, seconds = self.picture(5, {"render.samples": samples})
        return rms(encode(image, self.white), encode(self.truth, self.white)), seconds


def main() -> None:
    parser = report.arguments(__doc__)
    parser.add_argument("--config", default=str(report.ROOT / "configs" / "voyager_phobos.yaml"))
    parser.add_argument("--frame", type=int, default=1)
    parser.add_argument("--width", type=int, default=640)
    parser.add_argument("--equal", type=int, default=16, help="samples of Cycles to match")
    parser.add_argument("--python", default=sys.executable, help="a Python that has bpy")
    parser.add_argument("--keep", type=Path, help="a folder for Cycles' images")
    options = parser.parse_args()
    size = {"camera.width": options.width, "camera.height": options.width * 3 // 4}
    own = Own(options.config, options.frame, size, options.threads)
    sim = perilune.open(options.config, overrides=size)
    with tempfile.TemporaryDirectory() as temporary:
        folder = options.keep or Path(temporary)
        folder.mkdir(parents=True, exist_ok=True)
        job = describe(sim, options.frame, folder, options.threads)
        seconds = by_cycles(job, options.python, folder)
        images = {n: np.load(folder / f"cycles_{n}.npy") for n in seconds}
        if options.keep:
            np.save(folder / "perilune.npy", own.truth)
    truth = encode(images[str(CYCLES_TRUTH)], own.white)
    rows: list[list[object]] = []
    level = level_s = 0.0
    for count, _ in CYCLES_SAMPLES:
        error = rms(encode(images[str(count)], own.white), truth)
        rows.append(["Cycles", count, error, seconds[str(count)]])
        if count == options.equal:
            level, level_s = error, seconds[str(count)]
    curve = []
    for count in OWN_SAMPLES:
        curve.append(own.error(count))
        rows.append(["Perilune", count, *curve[-1]])
    matched = seconds_at(level, curve)
    rows.append([f"Perilune, as Cycles' {options.equal}", "", level, matched])
    report.publish(
        options.json,
        {
            "config": options.config,
            "cycles_rms_dn": level,
            "cycles_seconds": level_s,
            "perilune_seconds": matched,
            "ratio": level_s / matched,
            "apart_dn": rms(truth, encode(own.truth, own.white)),
        },
        [report.table(["renderer", "samples", "RMS error, DN", "seconds"], rows)],
    )


if __name__ == "__main__":
    main()
