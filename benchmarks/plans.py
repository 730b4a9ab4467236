"""Plans of the configurations that ship: how many effects are off or reduced, and expected times.

Prints a row per configuration: of the effects that can matter in frame 0, how many are off or
reduced at the configuration's tolerance; CPU time that the model of costs expects of the colour
from a part of the picture, beside the time of the frame; and the time with everything on (a
tolerance of 0) beside it. Times are of one thread, the least of two frames after a first one.

    python benchmarks/plans.py [--width 160] [CONFIG ...]
"""

import argparse
import time
import warnings
from pathlib import Path
from typing import Any

import numpy as np

import perilune
from perilune.cost import calibration, model
from perilune.frame.plan_rows import applies

CONFIGS = Path(__file__).resolve().parents[1] / "configs"


def opened(name: str, width: int, **changes: Any) -> perilune.Simulation:
    camera = perilune.open(name).config.camera
    scale = min(1.0, width / camera.width)
    size = {
        "camera.width": max(1, round(scale * camera.width)),
        "camera.height": max(1, round(scale * camera.height)),
    }
    sized = {} if scale == 1.0 else size
    return perilune.open(name, overrides={"render.channels": ["rgb"], **sized, **changes})


def frame_ms(sim: perilune.Simulation) -> float:
    took = []
    for _ in range(3):
        begin = time.process_time()
        sim.frame(0, ["rgb"], threads=1)
        took.append(1e3 * (time.process_time() - begin))
    return min(took[1:])


def row(name: str, width: int) -> tuple[int, int, int, float, float, float]:
    sim = opened(name, width)
    rows = [r for r in sim.plan(0) if applies(r)]
    off = sum(not r["on"] for r in rows)
    reduced = sum(r["on"] and r["value"] < r["ceiling"] for r in rows)
    sim.frame(0, ["rgb"], threads=1)
    expected = model.expect(sim, 0).ms
    whole = opened(name, width, **{"render.quality": "adaptive", "render.tolerance_dn": 0.0})
    return len(rows), off, reduced, expected, frame_ms(sim), frame_ms(whole)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("configs", nargs="*")
    parser.add_argument("--width", type=int, default=160)
    args = parser.parse_args()
    warnings.simplefilter("ignore")
    print(f"costs: {calibration.current().source}")
    print("| configuration | apply | off | reduced | expected ms | measured | ratio | all on |")
    print("| --- | --- | --- | --- | --- | --- | --- | --- |")
    ratios, lefts = [], []
    for file in args.configs or sorted(map(str, CONFIGS.glob("*.yaml"))):
        try:
            apply, off, reduced, expected, ms, whole = row(file, args.width)
        except perilune.config.ConfigError as error:
            print(f"| {Path(file).stem} | {str(error).splitlines()[0][:60]} |")
            continue
        ratios.append(expected / ms)
        lefts.append((off + reduced) / apply)
        print(
            f"| {Path(file).stem} | {apply} | {off} | {reduced} | {expected:.0f} | {ms:.0f} | "
            f"{expected / ms:.2f} | {whole:.0f} |",
            flush=True,
        )
    print(
        f"within 30 %: {np.mean(np.abs(np.array(ratios) - 1.0) < 0.3):.0%} of {len(ratios)}; half "
        f"of the effects or more off or reduced: {np.mean(np.array(lefts) >= 0.5):.0%}"
    )


if __name__ == "__main__":
    main()
