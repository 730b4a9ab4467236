"""The model of costs: what a frame is expected to take, by counts of what it does."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

from perilune import _core
from perilune.cost import calibration
from perilune.document.references import OBJECTS, OF_SENSOR, TABLES
from perilune.frame import passes
from perilune.frame.request import arrays_of

if TYPE_CHECKING:
    from perilune.simulation import Simulation
    from perilune.world import World

_LARGE: Final = 8
"""Parts of an expectation that are told."""


@dataclass(frozen=True)
class Expected:
    """What a frame is expected to take, and the plan that it is expected of."""

    counts: Mapping[str, int]
    """Counts of units of work, by names of `_core.COSTS`."""
    costs: calibration.Costs
    rows: list[_core.PlanRow]

    @property
    def ms(self) -> float:
        """CPU time of all threads, milliseconds, without the first frame's making of what is
        kept."""
        return math.fsum(self.parts.values())

    @property
    def parts(self) -> dict[str, float]:
        """Milliseconds by unit of work, the largest first."""
        found = {name: 1e-6 * self.costs.ns[name] * n for name, n in self.counts.items()}
        return dict(sorted(found.items(), key=lambda part: -part[1]))

    @property
    def text(self) -> str:
        """One sentence."""
        named = [f"{name} {ms:.2g}" for name, ms in self.parts.items() if ms > 0.02 * self.ms]
        return (
            f"expected: {self.ms:.3g} ms of CPU by {self.costs.source} "
            f"({', '.join(named[:_LARGE])})"
        )


def _asked(sim: Simulation, scene: World) -> tuple[_core.FrameRequest, _core.Renderer]:
    """A frame's request, exposed, with the sensor if the configuration's channels need it. The
    handles' lock is held."""
    handles, request = sim._mine(), sim._request(scene)
    if not set(OF_SENSOR) & set(scene.config.render.channels):
        request["sensor"] = None
    metered = sim._metered(scene) if request["sensor"] is not None else None
    if metered is not None:
        passes.expose(request, handles.renderer_of(metered[0]).plan(metered[1]))
    return request, handles.renderer_of(scene.config)


def plan_rows(sim: Simulation, index: int) -> list[_core.PlanRow]:
    """The plan of a frame; nothing is rendered but the metering."""
    scene = sim.world(index)
    with sim._mine().lock:
        request, renderer = _asked(sim, scene)
        return renderer.plan(request)["plan"]


def expect(
    sim: Simulation,
    index: int,
    costs: calibration.Costs | None = None,
    tolerance_dn: float | None = None,
) -> Expected:
    """What a frame with the channels of its configuration is expected to take, and its plan.

    A sixteenth of its pixels is rendered and counted, but at least 4 096: counts depend neither on
    the machine nor on threads. costs: None for those of `perilune calibrate` if there are any.
    tolerance_dn: None for that of the configuration."""
    scene, handles = sim.world(index), sim._mine()
    with handles.lock:
        request, renderer = _asked(sim, scene)
        if tolerance_dn is not None:
            request["quality"]["tolerance_dn"] = tolerance_dn
        arrays = arrays_of(scene.config, ["rgb"], {}, handles.pool)
        result = renderer.render(request, arrays, 1, True)
    names = scene.config.render.channels
    counts = dict(result["work"])
    pixels = scene.camera.width * scene.camera.height
    labels = [name for name in names if name not in passes.COLOURS and name not in TABLES]
    counts["label_values"] += pixels * len(labels)
    counts["object_pixels"] += pixels * (OBJECTS in names)
    return Expected(counts, costs or calibration.current(), result["plan"])
