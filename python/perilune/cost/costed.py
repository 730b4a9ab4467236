"""What a simulation has of studies of cost."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable
from typing import TYPE_CHECKING, cast

from perilune.base import arguments

if TYPE_CHECKING:
    from perilune.cost.report import Report
    from perilune.simulation import Simulation


class Costed:
    """A simulation whose frames can be studied."""

    def cost(
        self,
        index: int = 0,
        targets: Iterable[float] = (4.0, 2.0, 1.0),
        *,
        quick: bool = False,
        reference_samples: int | None = None,
        threads: int | None = None,
        folder: str | os.PathLike[str] | None = None,
        progress: Callable[[int, int], object] | None = None,
    ) -> Report:
        """Measures what accuracy costs in a frame: every knob of the scene from cheap to exact, and
        for each of `targets`, an RMS error in digital numbers, the cheapest setting that keeps it.

        quick: fewer settings and samples. reference_samples: of each of the reference's two
        pictures (default: 16 times render.samples, at least 512, quick 128). folder: keeps what is
        measured, so that a study that was stopped goes on. progress: called with settings done and
        in all. docs/cost.md explains the report."""
        from perilune.cost import study

        options = study.Options(quick, reference_samples, threads, folder, progress)
        return study.run(cast("Simulation", self), arguments.frame_index(index), targets, options)
