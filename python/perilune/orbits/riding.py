"""Motion that is stated in the axes of a rotating body: standing, driving, coming down."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from perilune.base import rotations
from perilune.orbits.descent import Field
from perilune.orbits.motion import evaluate
from perilune.orbits.setting import Setting, gm_m3_s2
from perilune.orbits.turns import body_turn

F64 = NDArray[np.float64]

_STEP_S = 0.05
"""Half the interval of differences by which velocities are found."""
_LONG_S = 30.0
"""The same for the rotation of a body."""


def body_axes(setting: Setting, name: str, t_s: F64) -> F64:
    """Quaternions (n, 4) from the axes of a body to the root's."""
    still: Mapping[str, Any] = {"kind": "fixed", "position_m": np.zeros(3)}
    turn = body_turn(setting.config.bodies[name], setting)
    node = {"name": name, "parent": -1, "motion": still, "rotation": turn}
    return evaluate([node], setting.epoch, t_s).poses[name][:, 3:]


def field_of(setting: Setting, name: str) -> Field:
    """Gravity and rotation of a body, as they are at the epoch."""
    before, after = body_axes(setting, name, np.array([-_LONG_S, _LONG_S]))
    turned = rotations.multiply(rotations.conjugate(before), after)
    axis, angle = rotations.to_axis_angle(turned)
    x, y, z = (axis * (angle / (2.0 * _LONG_S))).tolist()
    return Field(gm_m3_s2(setting.config.bodies[name]), (x, y, z))


@dataclass(frozen=True)
class Ride:
    """A path relative to a body's centre, with axes of its own."""

    setting: Setting
    body: str
    state: Callable[[float], tuple[F64, F64]]
    """Seconds after the epoch -> place (3,), metres, and axes x, y, z as columns (3, 3), both in
    the body's axes."""

    def __call__(self, t_s: F64) -> F64:
        """States (n, 6): places and velocities in ICRF axes."""
        places = [self._places(t_s + shift) for shift in (0.0, -_STEP_S, _STEP_S)]
        return np.hstack([places[0], (places[2] - places[1]) / (2.0 * _STEP_S)])

    def _places(self, t_s: F64) -> F64:
        turns = body_axes(self.setting, self.body, t_s)
        rows = [
            rotations.rotate(q, self.state(t)[0]) for q, t in zip(turns, t_s.tolist(), strict=True)
        ]
        return np.stack(rows)

    def axes(self, t_s: F64) -> F64:
        """Quaternions (n, 4) from the ride's axes to ICRF."""
        turns = body_axes(self.setting, self.body, t_s)
        own = [rotations.from_matrix(self.state(t)[1]) for t in t_s.tolist()]
        return np.stack([rotations.multiply(q, a) for q, a in zip(turns, own, strict=True)])
