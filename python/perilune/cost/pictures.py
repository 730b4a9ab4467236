"""Pictures of a scene at a setting, with what they took: the measurements of a study."""

from __future__ import annotations

import ctypes
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from perilune.simulation import Simulation

F64 = NDArray[np.float64]
_SENSOR = "sensor_rgb"
_GROUND = ("position", "geometric_normal", "slope", "depth", "instance")
_DAY_S = 86400.0
_TIMES = 25
_PERCENTILE = 99.9
_OUTLINES = 99.0
"""Per cent of pixels whose ground is compared: at outlines something else is seen."""


@dataclass(frozen=True)
class Took:
    """What a frame took: CPU time of all threads and wall time, in milliseconds; those of the first
    frame, with what it builds and keeps; how far memory rose then, in 10^6 bytes (nan: not known
    on this system)."""

    cpu_ms: float
    wall_ms: float
    first_ms: float
    memory_mb: float


@dataclass(frozen=True)
class Shot:
    """Linear light of a frame, (H, W, 3) in units of white, or values of a sensor's picture."""

    light: F64
    encoded: bool
    """Whether the values are digital numbers already."""

    @property
    def dn(self) -> F64:
        """Digital numbers of 255, not rounded."""
        return self.light if self.encoded else 255.0 * srgb(self.light)


def srgb(light: F64) -> F64:
    """Display values 0 to 1 (IEC 61966-2-1) of linear ones."""
    x = np.clip(light, 0.0, 1.0)
    return np.where(x <= 0.0031308, 12.92 * x, 1.055 * np.maximum(x, 1e-9) ** (1 / 2.4) - 0.055)


class Camera:
    """Takes pictures of one frame of a simulation at several settings."""

    def __init__(self, sim: Simulation, index: int, threads: int | None) -> None:
        self.sim, self.index, self.threads = sim, index, threads
        asked = sim.config.render.channels
        self.sensor = bool({_SENSOR, "raw"} & set(asked)) and _has_colour(sim)
        picture = (_SENSOR,) if self.sensor else ("rgb", "radiance")
        self.channels = tuple(dict.fromkeys((*asked, *picture)))
        self.ground = any(body.terrain is not None for body in sim.config.bodies.values())
        self.white = 0.0

    def at(self, changes: Mapping[str, Any]) -> Simulation:
        """The simulation at a setting; models and maps are shared."""
        return self.sim.with_overrides(changes)

    def shoot(self, sim: Simulation) -> Shot:
        """A picture of the frame."""
        sample = sim.frame(self.index, self.channels, self.threads)
        if self.sensor:
            return Shot(sample[_SENSOR].astype(np.float64), True)
        self.white = self.white or float(sample.meta["white_radiance"] or 1.0)
        return Shot(sample["radiance"].astype(np.float64) / self.white, False)

    def timed(self, changes: Mapping[str, Any], noises: Sequence[int]) -> tuple[list[Shot], Took]:
        """Pictures at a setting, the first of which builds what is kept, and what they took. Their
        samples are drawn with noise of their own; drivers draw as ever."""
        sim = self.at(changes)
        before = _begin_peak()
        shots, times = [], []
        for noise in noises:
            begin, cpu = time.perf_counter(), time.process_time()
            shots.append(self.shoot(sim.with_noise(noise)))
            times.append((time.process_time() - cpu, time.perf_counter() - begin))
        memory = _peak_mb() - before
        later = times[1:] or times
        cpu_ms, wall_ms = (1e3 * min(each) for each in zip(*later, strict=True))
        rise_mb = max(memory, 0.0) if before else float("nan")
        return shots, Took(cpu_ms, wall_ms, 1e3 * times[0][1], rise_mb)

    def ground_of(self, changes: Mapping[str, Any]) -> dict[str, F64]:
        """Labels of the ground at a setting."""
        sample = self.at(changes).frame(self.index, _GROUND, self.threads)
        found = {name: np.asarray(sample[name], dtype=np.float64) for name in _GROUND}
        found["pixel_rad"] = np.asarray(1.0 / sample.camera.K[0, 0])
        return found

    def orbit(self, changes: Mapping[str, Any], craft: str) -> tuple[F64, Took]:
        """Places of a spacecraft about its central body, (n, 3) in metres, from the epoch to the
        frame, but at least for a day."""
        sim = self.at(changes)
        world = sim.world(self.index)
        t_s = np.linspace(0.0, max(_DAY_S, abs(world.t_s)), _TIMES)
        begin, cpu = time.perf_counter(), time.process_time()
        found = sim.system(self.index).states(t_s).poses
        took = 1e3 * (time.process_time() - cpu), 1e3 * (time.perf_counter() - begin)
        around = sim.config.spacecraft[craft].orbit.around
        places = found[craft][:, :3] - found[around][:, :3]
        return places, Took(*took, took[1], 0.0)


def _has_colour(sim: Simulation) -> bool:
    sensor = sim.config.camera.sensor
    return sensor is not None and sensor.mosaic not in ("planes",)


def ground_errors(found: Mapping[str, F64], true: Mapping[str, F64]) -> tuple[float, float]:
    """RMS distance between two grounds along the normal, in pixels, and RMS difference of slopes,
    in degrees, of pixels that show the same ground in both."""
    same = (found["instance"] == true["instance"]) & np.isfinite(true["slope"] + found["slope"])
    if not same.any():
        return float("nan"), float("nan")
    between = found["position"][same] - true["position"][same]
    off_m = np.abs(np.sum(between * true["geometric_normal"][same], axis=-1))
    off = off_m / (true["depth"][same] * true["pixel_rad"])
    turned = np.degrees(np.abs(found["slope"][same] - true["slope"][same]))
    return _rms_without_outlines(off), _rms_without_outlines(turned)


def rms(values: F64) -> float:
    """Root mean square."""
    return float(np.sqrt(np.mean(values**2)))


def _rms_without_outlines(values: F64) -> float:
    return rms(values[values <= np.percentile(values, _OUTLINES)])


def errors(shots: Sequence[Shot], truth: F64) -> tuple[float, float]:
    """RMS error and percentile of the absolute error, over all pictures, digital numbers."""
    off = np.stack([shot.dn for shot in shots]) - truth
    return rms(off), float(np.percentile(np.abs(off), _PERCENTILE))


def difference(shots: Sequence[Shot], others: Sequence[Shot]) -> tuple[float, float]:
    """RMS and percentile of the difference between pictures, with the noise of both."""
    off = np.stack([a.dn - b.dn for a, b in zip(shots, others, strict=True)])
    return rms(off), float(np.percentile(np.abs(off), _PERCENTILE))


def without_noise(shots: Sequence[Shot], others: Sequence[Shot]) -> tuple[float, float]:
    """RMS and percentile of the difference between pictures of the same samples, two draws of each.
    The mean of the products of both differences has no noise of either."""
    first, second = (a.dn - b.dn for a, b in zip(shots, others, strict=True))
    square = float(np.mean(first * second))
    mean = np.abs(0.5 * (first + second))
    return float(np.sqrt(max(square, 0.0))), float(np.percentile(mean, _PERCENTILE))


def _status(name: str) -> float:
    """A line of /proc/self/status in 10^6 bytes; 0 where there is none."""
    try:
        lines = Path("/proc/self/status").read_text(encoding="ascii").splitlines()
    except OSError:
        return 0.0
    kilobytes = [line.split()[1] for line in lines if line.startswith(f"{name}:")]
    return int(kilobytes[0]) * 1024 / 1e6 if kilobytes else 0.0


def _begin_peak() -> float:
    """Gives unused memory back, resets the peak, and returns what is held."""
    try:
        trim: Callable[[int], int] = ctypes.CDLL(None).malloc_trim
        trim(0)
        Path("/proc/self/clear_refs").write_text("5", encoding="ascii")
    except (OSError, AttributeError):
        return 0.0
    return _status("VmRSS")


def _peak_mb() -> float:
    return _status("VmHWM")
