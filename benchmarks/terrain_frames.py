"""What the benchmarks of ground share: frames of the core with what it says of its tiles."""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import perilune
from perilune.frame.request import arrays_of


@dataclass(frozen=True)
class Drawn:
    arrays: dict[str, Any]
    tiles: int
    kept_bytes: int
    wall_s: float
    cpu_s: float
    mesh_s: float  # wall time of the stage that builds tiles


class Ground:
    """A renderer of one configuration, whose first frame finds no tiles."""

    def __init__(self, config: Any, overrides: dict[str, Any] | None = None) -> None:
        self.simulation = perilune.open(config, overrides=overrides or {})
        self._handles = self.simulation._mine()  # so that models and maps are loaded before a time
        self._handles.renderer_of(self.simulation.config)

    def frame(self, index: int, channels: Sequence[str], threads: int = 1) -> Drawn:
        world = self.simulation.world(index)
        request = self.simulation._request(world)
        renderer = self._handles.renderer_of(world.config)
        arrays = arrays_of(world.config, list(channels), {}, self._handles.pool)
        wall, cpu = time.perf_counter(), time.process_time()
        result = renderer.render(request, arrays, threads)
        wall, cpu = time.perf_counter() - wall, time.process_time() - cpu
        use, mesh_s = result["ground"], result["timings_s"]["realise"]
        return Drawn(dict(arrays), use["tiles"], use["kept_bytes"], wall, cpu, mesh_s)
