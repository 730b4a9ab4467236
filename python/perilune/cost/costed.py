"""What a simulation has of studies of cost."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable
from typing import TYPE_CHECKING, cast

from perilune.base import arguments
from perilune.cost.budget import within
from perilune.cost.model import expect, plan_rows
from perilune.frame.shown import Plan

if TYPE_CHECKING:
    from perilune.cost.report import Report
    from perilune.simulation import Simulation


def _within(sim: Simulation, index: int, budget_ms: float) -> Plan:
    kept = within(sim, index, arguments.positive("budget_ms", budget_ms))
    if not kept.met:
        raise ValueError(
            f"{sim._document.source}: frame {index}: {budget_ms:g} ms cannot be met. The cheapest "
            f"plan leaves out all that has a bound; {kept.expected.text}"
        )
    planned = Plan(kept.expected.rows)
    planned.expected, planned.tolerance_dn = kept.expected, kept.tolerance_dn
    return planned


class Costed:
    """A simulation whose frames can be planned and studied."""

    def plan(
        self,
        index: int,
        *,
        measure: bool = False,
        predict: bool = False,
        budget_ms: float | None = None,
        threads: int | None = None,
        progress: Callable[[int, int], object] | None = None,
    ) -> Plan:
        """The effects kept and left out in a frame, with reasons.

        It includes the sensor's effects if render.channels has one of its channels. Nothing is
        rendered, unless measure: then the frame is, twice without each effect that is on and twice
        with each that was left out, on `threads`, and rows say what effects take and change (see
        docs/effects.md). progress: called with effects done and in all.

        predict: also counts the work of a part of the picture, for `expected_ms` of the plan (see
        docs/cost.md). budget_ms: the plan at the least tolerance that is expected to keep the frame
        within so many ms of CPU; ValueError, with the least that is possible, if none does."""
        sim, frame = cast("Simulation", self), arguments.frame_index(index)
        if budget_ms is not None:
            if measure:
                raise ValueError(
                    "plan: effects are measured as the configuration says, not within"
                    " a budget: leave out measure or budget_ms"
                )
            return _within(sim, frame, budget_ms)
        planned = Plan(plan_rows(sim, frame))
        if predict:
            planned.expected = expect(sim, frame)
        if measure:
            from perilune.cost.rows import Rows

            planned.spread_ms = Rows(sim, frame, threads).measure(planned, progress)
        return planned

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
