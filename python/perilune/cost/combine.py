"""The cheapest combination of knobs that is predicted to stay below an error.

Predicted squared error: the noise at a number of samples, times what the tolerance makes of it,
plus what each other knob adds. Predicted time: the product of the ratios of all knobs. Both only
order settings; what a study reports of a combination is measured.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

from perilune.cost.knobs import Knob, Rung
from perilune.cost.report import Point


def _squares(knob: Knob, points: Sequence[Point]) -> list[float]:
    """What each rung of a knob without noise adds to the squared error."""
    return [0.0 if knob.noisy else p.rmse_dn**2 for p in points]


def _factors(knob: Knob, points: Sequence[Point]) -> list[float]:
    """What each rung of a knob with noise multiplies the squared noise by."""
    if not knob.noisy:
        return [1.0] * len(points)
    if knob.name == "samples":
        return [p.raw_dn**2 for p in points]
    return [(p.raw_dn / max(points[-1].raw_dn, 1e-9)) ** 2 for p in points]


def more_samples(knob: Knob, points: Sequence[Point], most: int) -> tuple[Knob, list[Point]]:
    """The knob `samples` up to `most`: noise falls as their root, time grows as their number."""
    rungs, rows, last = list(knob.rungs), list(points), points[-1]
    count = int(last.changes["render.samples"])
    for factor in (2**k for k in range(1, 12)):
        if count * factor > most:
            break
        root, rung = (
            math.sqrt(factor),
            Rung(str(count * factor), {"render.samples": count * factor}),
        )
        point = replace(
            last,
            rung=rung.name,
            changes=dict(rung.changes),
            rmse_dn=last.rmse_dn / root,
            raw_dn=last.raw_dn / root,
            cpu_ms=last.cpu_ms * factor,
        )
        rungs.append(rung)
        rows.append(point)
    return replace(knob, rungs=rungs), rows


@dataclass(frozen=True)
class _Row:
    squares: list[float]
    factors: list[float]
    times: list[float]


def _row(knob: Knob, points: Sequence[Point]) -> _Row:
    last_ms = max(points[-1].cpu_ms, 1e-3)
    times = [max(p.cpu_ms, 1e-3) / last_ms for p in points]
    return _Row(_squares(knob, points), _factors(knob, points), times)


def cheapest(
    knobs: Sequence[Knob], points: Mapping[str, Sequence[Point]], target_dn: float
) -> dict[str, Rung]:
    """Rung by knob. Begins with every knob exact, and turns down the one that saves most time for
    the squared error it adds, as long as the sum stays below the target."""
    rows = {knob.name: _row(knob, points[knob.name]) for knob in knobs}
    at = {knob.name: len(knob.rungs) - 1 for knob in knobs}

    def square(where: Mapping[str, int]) -> float:
        noise = math.prod(row.factors[where[name]] for name, row in rows.items())
        return noise + sum(row.squares[where[name]] for name, row in rows.items())

    while True:
        best, most = None, 0.0
        for name, now in at.items():
            for rung in range(now):
                saved = math.log(rows[name].times[now] / rows[name].times[rung])
                moved = {**at, name: rung}
                if saved <= _WORTH or square(moved) > target_dn**2:
                    continue
                gain = saved / max(square(moved) - square(at), _LEAST_DN2)
                if gain > most:
                    best, most = moved, gain
        if best is None:
            return {knob.name: knob.rungs[at[knob.name]] for knob in knobs}
        at = best


_WORTH = 0.05
"""Logarithm of the ratio of times from which turning a knob down pays: less is noise of clocks."""
_LEAST_DN2 = 1e-6
