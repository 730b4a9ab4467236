"""Bounds of effects beside what they change: violations, and how tight bounds are.

Draws scenes (a configuration that ships, a frame, a tolerance), measures each effect of the plan
(`sim.plan(i, measure=True)`), and prints for each effect in how many scenes it could matter, how
often what it changes at the 99.9th percentile of the pixels was above its bound by more than the
noise of both, and the median and the least of bound over change where that is above 0.5 DN.

    python benchmarks/bounds.py [--scenes 500] [--seed 0] [--width 32] [--samples 64]
"""

import argparse
import collections
import warnings
from pathlib import Path

import numpy as np

import perilune
from perilune.config import ConfigError
from perilune.frame.shown import Plan

CONFIGS = Path(__file__).resolve().parents[1] / "configs"
SEEN_DN = 0.5


def plans(scenes: int, seed: int, width: int, samples: int) -> list[tuple[str, Plan]]:
    rng, found = np.random.default_rng(seed), []
    names, shut = sorted(CONFIGS.glob("*.yaml")), set()
    while len(found) < scenes:
        name = names[rng.integers(len(names))]
        index, tolerance = int(rng.integers(0, 100)), float(10.0 ** rng.uniform(-1.0, 2.0))
        if name in shut:
            continue
        changes = {
            "camera.width": width,
            "camera.height": 3 * width // 4,
            "render.quality": "adaptive",
            "render.samples": samples,
            "render.tolerance_dn": tolerance,
        }
        try:
            sim = perilune.open(name, overrides=changes)
            found.append((f"{name.stem} {index}", sim.plan(index, measure=True)))
        except ValueError as error:  # a frame that cannot be drawn: a camera below the ground
            if not isinstance(error, ConfigError):
                continue
            shut.add(name)
            print(f"{name.stem}: left out: {str(error).splitlines()[-1][:80]}", flush=True)
    return found


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--scenes", type=int, default=500)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--width", type=int, default=32)
    parser.add_argument("--samples", type=int, default=64)
    args = parser.parse_args()
    warnings.simplefilter("ignore")
    seen: dict[str, int] = collections.Counter()
    over: dict[str, list[str]] = collections.defaultdict(list)
    ratios: dict[str, list[float]] = collections.defaultdict(list)
    for scene, plan in plans(args.scenes, args.seed, args.width, args.samples):
        noise = next(
            (
                row["measured_p999_dn"]
                for row in plan
                if row["name"] == "antialiasing" and "measured_p999_dn" in row
            ),
            0.0,
        )
        for row in plan:
            if "measured_p999_dn" not in row or row["name"] == "antialiasing":
                continue
            name, change = row["name"], row["measured_p999_dn"]
            seen[name] += 1
            if row["measured_dn"] > SEEN_DN:
                ratios[name].append(row["bound_dn"] / change)
            if row["measured_dn"] > row["bound_dn"] or change > row["bound_dn"] + noise:
                over[name].append(scene)
    print("| effect | scenes | above its bound | median bound / change | least |")
    print("| --- | --- | --- | --- | --- |")
    for name, count in sorted(seen.items(), key=lambda item: -item[1]):
        tight = ratios[name]
        told = f"{np.median(tight):.2g} | {min(tight):.2g}" if tight else "– | –"
        print(f"| `{name}` | {count} | {len(over[name])} | {told} |")
    for name, scenes in over.items():
        print(f"{name}: {', '.join(scenes[:9])}")


if __name__ == "__main__":
    main()
