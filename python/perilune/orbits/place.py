"""Context of an orbit's section: its object and its central body."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from perilune.base.random import generator
from perilune.orbits.setting import Parent, Setting, parent_of
from perilune.orbits.solar_system import Date

F64 = NDArray[np.float64]
Motion = Mapping[str, Any] | Callable[[F64], F64]


@dataclass(frozen=True)
class Place:
    """Object of an orbit and its central body."""

    setting: Setting
    name: str
    key: str
    """Path of the orbit's section, for errors and draws: spacecraft.iss.orbit."""
    around: str

    @property
    def parent(self) -> Parent:
        """The central body, in this frame."""
        return parent_of(self.setting, self.around)

    @property
    def epoch(self) -> Date:
        """Date at t_s = 0."""
        return self.setting.epoch

    @property
    def step_s(self) -> float:
        """Time from one step to the next."""
        return self.setting.config.time.step_s

    @property
    def _bounds_m(self) -> F64:
        """(2, 3): the spacecraft's box, in its axes about its origin."""
        if self.setting.craft_bounds_m is not None:
            return self.setting.craft_bounds_m(self.name)
        return np.outer([-1.0, 1.0], np.full(3, self.setting.craft_radius_m(self.name)))

    @property
    def feet_m(self) -> float:
        """Height of the spacecraft's origin over its lowest point, along its axis z."""
        return -float(self._bounds_m[0, 2])

    @property
    def footprint_m(self) -> tuple[float, float]:
        """Length and width of the spacecraft along its axes x and y."""
        low, high = self._bounds_m
        return float(high[0] - low[0]), float(high[1] - low[1])

    def file(self, text: str, key: str) -> Path:
        """The file that a key of the section names."""
        return self.setting.file(text, f"{self.key}.{key}")

    def scene_random(self, key: str) -> np.random.Generator:
        """The scene's random numbers for a key of the section."""
        seed, scene = self.setting.config.seed, self.setting.scene
        return generator(seed, f"scene:{self.key}.{key}", scene)
