"""What can be kept of a frame within a time, by the model of costs."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

from perilune import _core
from perilune.cost import calibration
from perilune.cost.model import Expected, expect

if TYPE_CHECKING:
    from perilune.simulation import Simulation

MOST_DN: Final = 255.0
"""At this tolerance every effect that has a bound is left out."""
LEAST_DN: Final = 0.125


def rungs(from_dn: float) -> list[float]:
    """Tolerances that are tried: doubled from the first to MOST_DN."""
    found = [from_dn]
    while found[-1] < MOST_DN:
        found.append(min(MOST_DN, max(LEAST_DN, 2.0 * found[-1])))
    return found


def at_tolerance(request: _core.FrameRequest, tolerance_dn: float) -> _core.FrameRequest:
    """The same frame at another tolerance."""
    quality: _core.Quality = {**request["quality"], "tolerance_dn": tolerance_dn}
    return {**request, "quality": quality}


@dataclass(frozen=True)
class Budgeted:
    """The least tolerance at which a frame is expected to take no more than a budget."""

    budget_ms: float
    tolerance_dn: float
    expected: Expected
    met: bool
    """False: even what is expected at MOST_DN, which this is then, takes more."""


def within(
    sim: Simulation,
    index: int,
    budget_ms: float,
    from_dn: float = 0.0,
    costs: calibration.Costs | None = None,
) -> Budgeted:
    """The least of the tolerances from `from_dn` up that keeps a frame within a budget.

    What a tolerance leaves out is what saves most for its bound, so that it is the knob between
    time and error; it also lowers samples and bounces. It is found by bisection: costs fall as it
    rises."""
    tried = rungs(from_dn)
    low, high = 0, len(tried) - 1
    found: dict[int, Expected] = {}
    while low < high:
        middle = (low + high) // 2
        found[middle] = expect(sim, index, costs, tried[middle])
        if found[middle].ms <= budget_ms:
            high = middle
        else:
            low = middle + 1
    if low not in found:
        found[low] = expect(sim, index, costs, tried[low])
    return Budgeted(budget_ms, tried[low], found[low], found[low].ms <= budget_ms)
