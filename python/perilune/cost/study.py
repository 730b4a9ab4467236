"""A study of a frame: each knob from cheap to exact, settings that combine them, and advice."""

from __future__ import annotations

import hashlib
import json
import math
import os
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from perilune.base.version import VERSION
from perilune.config.errors import ConfigError
from perilune.cost.combine import cheapest, more_samples
from perilune.cost.kept import Kept, Progress
from perilune.cost.knobs import IMAGE, OF_CHANCE, ORBIT, Knob, Rung, Scene, knobs_of
from perilune.cost.pictures import Camera, Shot, errors, ground_errors, rms, without_noise
from perilune.cost.report import Advice, Point, Report, Setting

if TYPE_CHECKING:
    from perilune.simulation import Simulation

F64 = NDArray[np.float64]
_REFERENCE_NOISE = (0x5EED0001, 0x5EED0002)
_NOISE = (1, 2)
_CHECK_NOISE = (11, 12)
"""Settings that combine knobs are judged by pictures that had no part in choosing them."""
_TRIES = 4


@dataclass(frozen=True)
class Options:
    """How a frame is studied."""

    quick: bool = False
    reference_samples: int | None = None
    threads: int | None = None
    folder: str | os.PathLike[str] | None = None
    progress: Progress | None = None


class Study:
    """Measures a frame; what is measured is kept in a folder, and another run goes on there."""

    def __init__(self, sim: Simulation, index: int, options: Options) -> None:
        self.camera = Camera(sim, index, options.threads)
        config = sim.config_at(index)[0]
        self.own, self.quick = config.render.samples, options.quick
        exact = sim.with_overrides(_exact_changes(self.own, ()))
        present = {row["name"] for row in exact.plan(index) if row["on"] or row["bound_dn"] > 0.0}
        self.scene = Scene(config, frozenset(present), options.quick)
        self.notes: list[str] = []
        self.knobs = [
            knob for knob in map(self._possible, knobs_of(self.scene)) if knob is not None
        ]
        least = 128 if options.quick else 512
        self.samples = options.reference_samples or max(16 * self.own, least)
        # What measurements depend on; times are of this machine and of what else runs on it.
        parts = (VERSION, repr(self.scene), config.seed, index, options.threads, self.samples)
        self.kept = Kept(options.folder, repr(parts), options.progress)

    def _possible(self, knob: Knob) -> Knob | None:
        """A knob without the orbits that this scene cannot have; None if less than two are left."""
        if knob.of != ORBIT:
            return knob
        rungs = []
        for rung in knob.rungs:
            try:
                self.camera.at(rung.changes)
            except ConfigError as error:
                self.notes.append(
                    f"{knob.name}: no {rung.name}: {str(error).splitlines()[-1].strip()}"
                )
            else:
                rungs.append(rung)
        return replace(knob, rungs=rungs) if len(rungs) > 1 else None

    # Settings.

    def changes(self, rungs: Mapping[str, Rung], samples: int | None = None) -> dict[str, Any]:
        """Overrides that set every knob: to the given rungs, others to their exact ones."""
        chosen = [rungs.get(knob.name, knob.rungs[-1]) for knob in self._of_image()]
        off = {effect for rung in chosen for effect in rung.off}
        made = _exact_changes(samples or self.own, tuple(sorted(off | self._chance())))
        for knob, rung in zip(self._of_image(), chosen, strict=True):
            if knob.name in rungs or (rung.changes and knob.name not in ("samples", "tolerance")):
                made.update(rung.changes)
        return made

    def _new(self, changes: Mapping[str, Any]) -> dict[str, Any]:
        """Those of some overrides that the configuration does not have already."""
        tree = self.scene.config.model_dump(mode="json")
        return {path: value for path, value in changes.items() if _at(tree, path) != value}

    def _chance(self) -> frozenset[str]:
        return OF_CHANCE & self.scene.present

    def _of_image(self) -> list[Knob]:
        return [knob for knob in self.knobs if knob.of == IMAGE]

    # Measurements.

    def run(self, targets: Sequence[float]) -> Report:
        """Everything, and advice for each wanted error."""
        self.kept.total = 3 + sum(len(knob.rungs) for knob in self.knobs) + 2 * len(targets)
        exact = self.changes({})
        self.reference = self._kept_pictures("reference", self._reference)
        halves = [shot.dn for shot in self.reference]
        mean = np.mean([shot.light for shot in self.reference], axis=0)
        self.truth = Shot(mean, self.reference[0].encoded).dn
        floor = 0.5 * rms(halves[0] - halves[1])
        self.exact = self._kept_pictures("exact", lambda: self.camera.timed(exact, _NOISE)[0])
        self.true_ground = self.camera.ground_of(exact) if self.camera.ground else None
        points = [point for knob in self.knobs for point in self._ladder(knob)]
        own = self._whole(self._own_changes())
        advice = [self._advice(target, points) for target in targets]
        camera, config = self.camera, self.scene.config
        return Report(
            name=str(camera.sim.config.name),
            index=camera.index,
            size=(config.camera.width, config.camera.height),
            samples=self.own,
            reference_samples=self.samples,
            reference_dn=floor,
            points=points,
            own=own,
            advice=advice,
            notes=self.notes,
        )

    def _kept_pictures(self, name: str, work: Callable[[], list[Shot]]) -> list[Shot]:
        def arrays() -> dict[str, Any]:
            shots = work()
            light = np.stack([shot.light for shot in shots])
            return {"light": light, "encoded": shots[0].encoded, "white": self.camera.white}

        found = self.kept.arrays(name, arrays)
        self.camera.white = float(found["white"])
        return [Shot(light, bool(found["encoded"])) for light in found["light"]]

    def _reference(self) -> list[Shot]:
        sim = self.camera.at(self.changes({}, self.samples))
        return [self.camera.shoot(sim.with_noise(noise)) for noise in _REFERENCE_NOISE]

    def _ladder(self, knob: Knob) -> list[Point]:
        return [
            Point(
                knob.name, rung.name, dict(rung.changes), list(rung.off), **self._rung(knob, rung)
            )
            for rung in knob.rungs
        ]

    def _rung(self, knob: Knob, rung: Rung) -> dict[str, Any]:
        name = f"{knob.name}: {rung.name}"
        if knob.of == ORBIT:
            return self.kept.once(name, lambda: self._orbit(knob, rung))
        return self.kept.once(name, lambda: self._image(knob, rung))

    def _orbit(self, knob: Knob, rung: Rung) -> dict[str, Any]:
        craft = knob.name.partition(", ")[2]
        true, _ = self.camera.orbit(knob.rungs[-1].changes, craft)
        places, took = self.camera.orbit(rung.changes, craft)
        off_m = float(np.linalg.norm(places - true, axis=1).max())
        return {"orbit_m": off_m, **asdict(took)}

    def _image(self, knob: Knob, rung: Rung) -> dict[str, Any]:
        changes = self.changes({knob.name: rung})
        shots, took = self.camera.timed(changes, _NOISE)
        raw = errors(shots, self.truth)
        found = {"raw_dn": raw[0], **asdict(took)}
        found["rmse_dn"], found["p999_dn"] = raw if knob.noisy else without_noise(shots, self.exact)
        if self.true_ground is not None and any(".terrain." in key for key in rung.changes):
            ground = ground_errors(self.camera.ground_of(changes), self.true_ground)
            found["geometry_px"], found["slope_deg"] = ground
        return found

    def _own_changes(self) -> dict[str, Any]:
        """The configuration as it is, but for noise of one exposure."""
        render = self.scene.config.render
        chance = self._chance()
        if not chance:
            return {}
        kept = [name for name in render.force_on if name not in chance]
        off = sorted({*render.force_off, *chance})
        return {
            **render.spelt_out,
            "render.force_on": kept,
            "render.force_off": off,
        }

    def _whole(self, changes: dict[str, Any]) -> Setting:
        """A setting as it is, against the reference, by pictures of their own noise."""

        def work() -> dict[str, Any]:
            shots, took = self.camera.timed(changes, _CHECK_NOISE)
            rmse, p999 = errors(shots, self.truth)
            return {"rmse_dn": rmse, "p999_dn": p999, **asdict(took)}

        text = json.dumps(changes, sort_keys=True)
        found = self.kept.once(f"setting {hashlib.sha256(text.encode()).hexdigest()[:12]}", work)
        return Setting(self._new(changes), **found)

    def _advice(self, target: float, points: Sequence[Point]) -> Advice:
        """The cheapest setting whose measured error is at most the target. After one that misses
        it the next aims lower by as much, and may tolerate half."""
        aim, tried = target, list[Setting]()
        for attempt in range(_TRIES):
            most = 0.0 if attempt == _TRIES - 1 else target / 2**attempt
            knobs, rows = self._choices(points, most)
            tried.append(self._whole(self.changes(cheapest(knobs, rows, aim))))
            if tried[-1].rmse_dn <= target:
                break
            aim *= min(0.95 * target / tried[-1].rmse_dn, 0.9)
        good = [setting for setting in tried if setting.rmse_dn <= target]
        best = good[-1] if good else min(tried, key=lambda setting: setting.rmse_dn)
        return Advice(target, best, bool(good), tried)

    def _choices(
        self, points: Sequence[Point], tolerated_dn: float
    ) -> tuple[list[Knob], dict[str, list[Point]]]:
        """Knobs and their points by name: more samples than were measured, no coarser tolerance."""
        knobs, rows = [], {}
        for knob in self._of_image():
            found = [point for point in points if point.knob == knob.name]
            if knob.name == "samples":
                knob, found = more_samples(knob, found, self.samples)
            if knob.name == "tolerance":
                kept = [k for k, p in enumerate(found) if _tolerance(p) <= tolerated_dn]
                found = [found[k] for k in kept]
                knob = replace(knob, rungs=[knob.rungs[k] for k in kept])
            knobs.append(knob)
            rows[knob.name] = found
        return knobs, rows


def _tolerance(point: Point) -> float:
    return float(point.changes["render.tolerance_dn"])


def run(sim: Simulation, index: int, targets: Iterable[float], options: Options) -> Report:
    """A study of a frame, with advice for each wanted RMS error, in digital numbers."""
    wanted = [float(target) for target in targets]
    for target in wanted:
        if not (math.isfinite(target) and target > 0.0):
            raise ValueError(f"targets: must be above 0 and finite, not {target}")
    return Study(sim, index, options).run(wanted)


def _exact_changes(samples: int, off: Sequence[str]) -> dict[str, Any]:
    """Everything that can matter, at its finest value."""
    return {
        "render.quality": "adaptive",
        "render.tolerance_dn": 0.0,
        "render.force_on": [],
        "render.force_off": list(off),
        "render.samples": samples,
    }


def _at(tree: Any, path: str) -> Any:
    """The value at a key path of a configuration; None where there is none."""
    for key in path.split("."):
        tree = tree.get(key) if isinstance(tree, Mapping) else None
    return tree
