"""Progress of a run: its number, and the fraction of it at opening and closing."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from perilune.base.random import generator
from perilune.config.trajectory import Run
from perilune.world import World

_MASK = (1 << 63) - 1


@dataclass(frozen=True)
class Progress:
    """Progress of a run in a frame."""

    run: int
    """Number of the repetition, which keys the run's random numbers."""
    share: tuple[float, float]
    """Fraction of the run, from 0 to 1, at the shutter's opening and closing."""

    def random(self, world: World, what: str) -> np.random.Generator:
        """The run's random numbers for `what`."""
        return generator(world.config.seed, what, self.run & _MASK)


def _by_time(world: World, spec: Run, duration_s: float) -> Progress:
    share = world.t_s / duration_s
    run = 0 if spec.after == "hold" else math.floor(share)
    opening = min(max(share - run, 0.0), 1.0)
    # The run that begins while the shutter is open is not this one's: it stays at the end.
    closing = min(max(share - run + world.window_s / duration_s, 0.0), 1.0)
    return Progress(run, (opening, closing))


def _by_steps(world: World, spec: Run, positions: int) -> Progress:
    run, place = divmod(world.step, positions)
    if spec.after == "hold" and run > 0:
        run, place = 0, positions - 1
    if positions == 1:
        return Progress(run, (0.0, 0.0))
    opening = place / (positions - 1)
    seconds = abs(world.config.time.step_s) * (positions - 1)
    moved = world.window_s / seconds if seconds > 0.0 else 0.0
    return Progress(run, (opening, min(opening + moved, 1.0)))


def progress(world: World, spec: Run) -> Progress:
    """By `positions`, by `duration_s`, by the kind's own duration, or by scenes."""
    duration_s = spec.duration_s
    if duration_s is None and spec.positions is None:
        duration_s = spec.natural_duration_s()
    if duration_s is not None:
        return _by_time(world, spec, duration_s)
    return _by_steps(world, spec, spec.positions or world.config.time.frames_per_scene)
