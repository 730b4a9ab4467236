"""The section `camera.trajectory` of the schema: how the camera moves.

To add a kind: its section in a file of this folder, its line in `Trajectory`; its function and its
line in perilune.camera.trajectories.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated

from pydantic import Field

from perilune.config.errors import fail, nearest
from perilune.config.standing import check_datum
from perilune.config.trajectory.common import Aimed, Pointing, Redrawn, Run
from perilune.config.trajectory.given import Deterministic, Hook
from perilune.config.trajectory.over_ground import PoweredDescent, Traverse
from perilune.config.trajectory.places import Fixed, Hover, OrbitObject, RandomBox
from perilune.config.trajectory.runs import CentredTarget, Flyby, Linear, Relative, Spiral

if TYPE_CHECKING:
    from perilune.config.schema import Config

__all__ = [
    "Aimed",
    "CentredTarget",
    "Deterministic",
    "Fixed",
    "Flyby",
    "Hook",
    "Hover",
    "Linear",
    "OrbitObject",
    "Pointing",
    "PoweredDescent",
    "RandomBox",
    "Redrawn",
    "Relative",
    "Run",
    "Spiral",
    "Trajectory",
    "Traverse",
    "check_trajectory",
]

Trajectory = Annotated[
    OrbitObject
    | Fixed
    | RandomBox
    | Hover
    | Linear
    | Spiral
    | Flyby
    | CentredTarget
    | Relative
    | Traverse
    | PoweredDescent
    | Deterministic
    | Hook,
    Field(discriminator="kind"),
]


_OVER_GROUND = (Hover, Traverse, PoweredDescent)


def check_trajectory(config: Config) -> None:
    """Inside a validator: checks names of other entries, and the time."""
    spec = config.camera.trajectory
    bodies = list(config.bodies)
    entities = [*config.spacecraft, *bodies]
    for key, allowed in (
        ("target", bodies if isinstance(spec, _OVER_GROUND) else entities),
        ("background", bodies),
        ("around", entities),
    ):
        name = getattr(spec, key, None)
        if name is not None and name not in allowed:
            fail(f"camera.trajectory.{key}", f"no entry named '{name}'{nearest(name, allowed)}")
    moving = ("lvlh", "rsw")
    name = getattr(spec, "around" if isinstance(spec, RandomBox) else "target", None)
    if getattr(spec, "frame", "icrf") in moving and name == config.root:
        fail("camera.trajectory.frame", f"{name} is the root body and orbits nothing")
    if isinstance(spec, Flyby):
        if spec.altitude_above is not None and spec.target not in config.bodies:
            fail("camera.trajectory.altitude_above", f"{spec.target} is no body with a ground")
    else:
        check_datum(config, "camera.trajectory", spec, getattr(spec, "target", None))
    if isinstance(spec, Run):
        _check_run(spec, config)


def _check_run(spec: Run, config: Config) -> None:
    time = config.time
    duration = spec.duration_s or spec.natural_duration_s()
    if not spec.needs_run():
        return
    if spec.positions is None and duration is None and time.frames_per_scene == 1:
        fail(
            "camera.trajectory.positions",
            "required (over how many steps), or duration_s, or time.frames_per_scene",
        )
    if spec.positions is None and duration is not None and time.step_s == 0.0:
        fail("camera.trajectory.duration_s", "counts time, which stands with time.step_s = 0")
