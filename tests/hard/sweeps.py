"""Sweeps of `script/soak`: one scene at all sizes and distances beside closed forms, and tiny
frames of every configuration with drivers wide open.

    python -m tests.hard.sweeps [--sizes N] [--frames N]

sizes: steps along both axes. frames: of all configurations together; those whose data is not there
are left out by name.
"""

from __future__ import annotations

import argparse
import math
import os
import sys
import warnings
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

import perilune
from perilune.orbits.solar_system import AU_M

F64 = NDArray[np.float64]
ROOT = Path(__file__).resolve().parents[2]
RADII_M = (1.0, 1e8)
GAPS_M = (1e-2, 1e9)
SIDE = 17
SUN = np.array([0.8, 0.6, 0.0])
ALBEDO = 0.5


@dataclass(frozen=True)
class Ball:
    """A Lambert sphere and a camera beside it that looks at its centre."""

    radius_m: float
    gap_m: float

    @property
    def fov_deg(self) -> float:
        """The disc and a rim of sky, but at most 40 degrees."""
        half = math.asin(self.radius_m / (self.radius_m + self.gap_m))
        return min(40.0, math.degrees(2.6 * half))

    def frame(self) -> perilune.Sample:
        place = np.array([self.radius_m + self.gap_m, 0.0, 0.0])
        tree = {
            "version": 1,
            "time": {"epoch": "2026-03-20T12:00:00Z"},
            "root": "ball",
            "sun": {"direction": SUN.tolist()},
            "bodies": {
                "ball": {
                    "kind": "ellipsoid",
                    "radii_km": self.radius_m / 1e3,
                    "gm_km3_s2": 1.0,
                    "albedo": ALBEDO,
                    "reflectance": "lambert",
                }
            },
            "camera": {
                "width": SIDE,
                "height": SIDE,
                "fov_deg": self.fov_deg,
                "trajectory": {"kind": "fixed", "target": "ball", "position_m": place.tolist()},
            },
            "render": {"samples": 16, "tolerance_dn": 0.0, "max_bounces": 0},
        }
        sim = perilune.open(tree, trajectory=lambda world: perilune.look_at(world, "ball", place))
        return sim.frame(0, ["radiance", "depth", "normal", "instance"], threads=1)

    def expected(self) -> tuple[F64, F64, F64]:
        """Depths (inf: sky), normals in camera axes, and cosines of incidence, (H, W, ...), by the
        quadratic in units of the radius; its cancelling root is that of Vieta."""
        d = _directions(self)
        across = np.sum(d[..., :2] ** 2, axis=-1)  # |d|^2 - 1 would cancel
        gap = self.gap_m / self.radius_m
        c = gap * (2.0 + gap)
        inside = 1.0 - across * c  # b^2 - a c, without its cancellation
        sky = inside < 0.0
        t = c / (1.0 + gap + np.sqrt(np.where(sky, 0.0, inside)))
        n = d * t[..., None]
        n[..., 2] = -np.sqrt(np.maximum(1.0 - np.sum(n[..., :2] ** 2, axis=-1), 0.0))
        t[sky] = np.inf
        # Camera axes in root axes: x is +y, y is -z, z is -x.
        to_sun = np.array([SUN[1], -SUN[2], -SUN[0]])
        return t * self.radius_m, n, n @ to_sun


def off(ball: Ball, reference: float | None) -> tuple[dict[str, float], float]:
    """What is wrong with a ball: relative errors of depth, of normals, pixels on the wrong side of
    the limb, and of light against `reference`, that of a matt white plane that faces the Sun."""
    sample, (depth, normal, cosine) = ball.frame(), ball.expected()
    seen = sample["instance"] > 0
    both = seen & np.isfinite(depth)
    # Where the ray grazes, depth changes without bound over what a pose resolves.
    sure = both & (-np.sum(normal * _rays(ball), axis=-1) > 0.1)
    lit = sure & (cosine > 0.2)
    found = {
        "limb": float(np.mean(seen != np.isfinite(depth))),
        "depth": float(np.max(np.abs(sample["depth"][sure] / depth[sure] - 1.0), initial=0.0)),
        "normal": float(np.max(np.abs(sample["normal"][sure] - normal[sure]), initial=0.0)),
    }
    distance = (AU_M - cosine * ball.radius_m) / AU_M  # the Sun is nearer than the centre
    white = sample["radiance"][..., 1] * distance**2 / np.where(lit, cosine, 1.0)
    light = float(np.median(white[lit]))
    found["light"] = 0.0 if reference is None else abs(light / reference - 1.0)
    finite = np.isfinite(sample["radiance"]).all() and (sample["radiance"] >= 0.0).all()
    found["not finite"] = 0.0 if finite else 1.0
    return found, light


def _directions(ball: Ball) -> F64:
    """(H, W, 3): camera rays of depth 1."""
    half = math.tan(math.radians(0.5 * ball.fov_deg))
    steps = (np.arange(SIDE) - 0.5 * (SIDE - 1)) * 2.0 * half / SIDE
    return np.stack([*np.meshgrid(steps, steps), np.ones((SIDE, SIDE))], axis=-1)


def _rays(ball: Ball) -> F64:
    d = _directions(ball)
    return np.asarray(d / np.linalg.norm(d, axis=-1, keepdims=True))


LIMITS = {"limb": 0.02, "depth": 1e-6, "normal": 1e-5, "light": 0.01, "not finite": 0.0}
"""Limb: pixels of 289 within what rounding of the pose decides."""


def sizes(steps: int) -> tuple[list[str], dict[str, float]]:
    """Findings over all radii and gaps, and the largest errors."""
    _, white = off(Ball(1e3, 1e3), None)
    findings, most = [], dict.fromkeys(LIMITS, 0.0)
    for radius_m in np.geomspace(*RADII_M, steps):
        for gap_m in np.geomspace(*GAPS_M, steps):
            found, _ = off(Ball(float(radius_m), float(gap_m)), white)
            for name, error in found.items():
                most[name] = max(most[name], error)
                if not error <= LIMITS[name]:
                    findings.append(f"radius {radius_m:g} m, gap {gap_m:g} m: {name} {error:.3g}")
    return findings, most


# Tiny frames of every configuration.

CHANNELS = ["rgb", "radiance", "depth", "semantic", "part", "instance", "objects"]


def configurations() -> Iterator[Path]:
    """Every configuration that is shipped."""
    yield from sorted((ROOT / "configs").glob("*.yaml"))
    yield from sorted((ROOT / "configs" / "oaisys").glob("*.json"))


def opened(path: Path) -> perilune.Simulation | None:
    """A configuration at a few pixels, its drivers as wide as they are; None without its data."""
    if "data:" in path.read_text(encoding="utf-8") and not os.environ.get("PERILUNE_DATA"):
        return None
    small: dict[str, Any] = {"render.samples": 1, "drivers.strength": 4.0}
    sim = perilune.open(path, overrides=small)
    scale = 12.0 / sim.config.camera.width
    size = {"camera.width": 12, "camera.height": max(1, round(scale * sim.config.camera.height))}
    sized: dict[str, Any] = dict(size)
    for name, sensor in sim.config.sensors.items():
        if sensor.width is not None:
            sized |= {f"sensors.{name}.width": 12, f"sensors.{name}.height": 9}
    return sim.with_overrides(sized)


def faults(sim: perilune.Simulation, index: int) -> list[str]:
    """What is wrong with a frame."""
    sample = sim.frame(index, CHANNELS, threads=1)
    wrong = []
    light = sample["radiance"]
    if not np.isfinite(light).all():
        wrong.append("radiance is not finite")
    elif (light < 0.0).any():
        wrong.append("radiance is negative")
    depth = sample["depth"]
    if np.isnan(depth).any() or (depth < 0.0).any():
        wrong.append("depth is nan or negative")
    known = {0, *sim.taxonomy.instances.values()}
    if not set(np.unique(sample["instance"]).tolist()) <= known:
        wrong.append("an instance that the taxonomy does not know")
    if not set(np.unique(sample["part"]).tolist()) <= {0, *(p.id for p in sim.taxonomy.parts)}:
        wrong.append("a part that the taxonomy does not know")
    for name in sample.objects.dtype.names or ():
        if name in ("R_m2c", "t_m2c") and not np.isfinite(sample.objects[name]).all():
            wrong.append(f"{name} is not finite")
    return wrong


def resident_mb() -> float:
    """Memory that the process holds."""
    pages = int(Path("/proc/self/statm").read_text(encoding="ascii").split()[1])
    return pages * os.sysconf("SC_PAGESIZE") / 1e6


def frames(count: int, draw: int = 1) -> list[str]:
    """Findings among so many frames at random indices, and of growth of memory."""
    paths = list(configurations())
    each, findings = max(1, count // len(paths)), []
    for path in paths:
        sim = opened(path)
        if sim is None:
            print(f"    {path.stem}: left out, its data is not there", flush=True)
            continue
        chosen = np.random.default_rng((draw, len(path.stem))).integers(0, 100_000, each)
        middle = 0.0
        for number, index in enumerate(chosen.tolist()):
            try:
                wrong = faults(sim, index)
            except ValueError:
                continue  # refused by name: an orbit below the ground, say
            findings += [f"{path.stem}, frame {index}: {text}" for text in wrong]
            if number == each // 2:
                middle = resident_mb()
        if each >= 200 and middle > 0.0 and resident_mb() > 1.1 * middle + 5.0:
            findings.append(f"{path.stem}: memory grows, {middle:.0f} to {resident_mb():.0f} MB")
        print(f"    {path.stem}: {each} frames", flush=True)
    return findings


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--sizes", type=int, default=24)
    parser.add_argument("--frames", type=int, default=100_000)
    asked = parser.parse_args()
    warnings.simplefilter("ignore")
    found, most = sizes(asked.sizes)
    print(f"    {asked.sizes}^2 sizes and distances; largest errors: ", end="")
    print(", ".join(f"{name} {error:.3g}" for name, error in most.items()), flush=True)
    found += frames(asked.frames) if asked.frames else []
    print("\n".join(found) if found else "    no findings")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
