"""What the effects of a plan truly take and change: each alone, against the frame as planned."""

from __future__ import annotations

import time
import warnings
from typing import TYPE_CHECKING, Any

from perilune.config.errors import ConfigWarning
from perilune.cost.kept import Progress
from perilune.cost.knobs import OF_CHANCE
from perilune.cost.pictures import Camera, Shot, difference, without_noise

if TYPE_CHECKING:
    from perilune._core_records import PlanRow
    from perilune.simulation import Simulation

_NOISES = (21, 22)
_NOISY = frozenset({"antialiasing"})
"""Effects that change the noise of pictures: what they change has it."""


class Rows:
    """Renders a frame as planned, without each effect that is on, and with each that was left out.

    Noise of one exposure is left out of all pictures."""

    def __init__(self, sim: Simulation, index: int, threads: int | None) -> None:
        self.camera = Camera(sim, index, threads)
        render = sim.config_at(index)[0].render
        self.spelt_out = render.spelt_out
        self.on, self.off = set(render.force_on), set(render.force_off)
        self.exposed = self._exposure()

    def _exposure(self) -> dict[str, Any]:
        """Overrides that expose every picture as the frame: an effect must not change the others'
        light by the metering."""
        meta = self.camera.sim.frame(self.camera.index, self.camera.channels).meta
        if self.camera.sensor:
            return self._sensor_exposure(float(meta["exposure_s"]), float(meta["gain_e_dn"]))
        self.camera.white = float(meta["white_radiance"] or 1.0)
        fixed = {"mode": "fixed", "white_radiance_w_m2_sr": self.camera.white}
        return {"camera.exposure": fixed}

    def _sensor_exposure(self, exposure_s: float, gain_e_dn: float) -> dict[str, Any]:
        """The metered time and gain as the only ones that the sensor's metering may choose."""
        sensor = self.camera.sim.config_at(self.camera.index)[0].camera.sensor
        if sensor is None or sensor.exposure.mode == "fixed":
            return {}
        only = {
            "min_ms": 1e3 * exposure_s,
            "max_ms": 1e3 * exposure_s,
            "step_ms": 0.0,
            "times_ms": None,
            "gains": [sensor.gain_e_dn / gain_e_dn],
        }
        return {f"camera.sensor.exposure.{key}": value for key, value in only.items()}

    def _changes(self, name: str | None = None, on: bool = False) -> dict[str, Any]:
        """Overrides that leave an effect out or keep it, and all else as planned."""
        forced_on = self.on - OF_CHANCE - {name}
        forced_off = (self.off | OF_CHANCE) - {name}
        if name is not None:
            (forced_on if on else forced_off).add(name)
        return {
            **self.exposed,
            **self.spelt_out,
            "render.force_on": sorted(forced_on),
            "render.force_off": sorted(forced_off),
        }

    def _pictures(self, changes: dict[str, Any]) -> tuple[list[Shot], float]:
        """Pictures of two draws, and the CPU time of one, ms: the less of two whose first frame,
        which builds what is kept, was another."""
        sim, shots, times = self.camera.at(changes), [], []
        for noise in _NOISES:
            drawn = sim.with_noise(noise)
            shots.append(self.camera.shoot(drawn))
            begin = time.process_time()
            self.camera.shoot(drawn)
            times.append(1e3 * (time.process_time() - begin))
        return shots, min(times)

    def measure(self, rows: list[PlanRow], progress: Progress | None) -> float:
        """Adds to each row that can matter what the effect takes and changes; returns how far two
        measurements of the same frame differ, ms."""
        there = [row for row in rows if row["ceiling"] > 0 and row["name"] not in OF_CHANCE]
        with warnings.catch_warnings():
            # Of our own overrides: what the configuration has to tell was told when it opened.
            warnings.simplefilter("ignore", ConfigWarning)
            return self._measured(there, progress)

    def _measured(self, there: list[PlanRow], progress: Progress | None) -> float:
        planned, before_ms = self._pictures(self._changes())
        found: list[tuple[PlanRow, float]] = []
        for done, row in enumerate(there, 1):
            shots, cpu_ms = self._pictures(self._changes(row["name"], not row["on"]))
            compare = difference if row["name"] in _NOISY else without_noise
            row["measured_dn"], row["measured_p999_dn"] = compare(shots, planned)
            found.append((row, cpu_ms))
            if progress is not None:
                progress(done, len(there))
        after_ms = self._pictures(self._changes())[1]
        for row, cpu_ms in found:
            more = 0.5 * (before_ms + after_ms) - cpu_ms
            row["measured_ms"] = more if row["on"] else -more
        return abs(after_ms - before_ms)
