"""Motion over time for the plots: positions at any time, one revolution of an orbit."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from perilune.base import rotations
from perilune.config.orbit import Drawn
from perilune.config.schema import Config
from perilune.world import World

F64 = NDArray[np.float64]
_TURN_RAD = math.radians(2.0)
_MOST_POINTS = 720
_FARTHEST = 12.0
"""Distance at which an open orbit ends, relative to the present distance."""


def parent(config: Config, name: str) -> str | None:
    """The central body of a body or spacecraft; None for the root and bodies with an ephemeris."""
    entry = config.bodies[name] if name in config.bodies else config.spacecraft[name]
    return entry.orbit.around if entry.orbit is not None else None


def relative(world: World, name: str, around: str, t_s: float) -> tuple[F64, F64]:
    """Position (3,), m, and velocity, m/s, of an object relative to another's centre in a frame."""
    found = world.system.states(np.array([t_s]))
    return (
        found.poses[name][0, :3] - found.poses[around][0, :3],
        found.velocities_m_s[name][0] - found.velocities_m_s[around][0],
    )


def revolution_m(world: World, name: str, around: str) -> F64:
    """One revolution from an object's position in a frame, (n, 3) from its central body's centre,
    ICRF axes.

    Its steps are about two degrees at the present angular rate |r x v| / r^2, so it works for any
    propagator. An open orbit ends far away; an object at rest has one point. The line ends where
    the propagator has no state (at a table's end)."""
    t_s, turned = world.t_s, 0.0
    place, velocity = relative(world, name, around, t_s)
    first = float(np.linalg.norm(place))
    points = [place]
    while turned < 2.0 * math.pi and len(points) < _MOST_POINTS:
        moment = float(np.linalg.norm(np.cross(place, velocity)))
        if moment == 0.0 or float(np.linalg.norm(place)) > _FARTHEST * first:
            break
        t_s += _TURN_RAD * float(place @ place) / moment
        try:
            after, velocity = relative(world, name, around, t_s)
        except ValueError:
            break
        turned += rotations.angle_rad(place, after)
        place = after
        points.append(place)
    return np.array(points)


def rows(worlds: list[World], name: str) -> list[list[World]]:
    """Frames in runs that share one orbit of `name` (and of its central body), in their order."""
    runs: list[list[World]] = []
    for world in worlds:
        if runs and _chain(runs[-1][-1], name) == _chain(world, name):
            runs[-1].append(world)
        else:
            runs.append([world])
    return runs


def _chain(world: World, name: str) -> list[object]:
    """The orbits that determine an object's position, its own first; with the scene for those drawn
    once a scene."""
    config, hooks = world.config, world.system.setting.hooks
    chain: list[object] = []
    at: str | None = name
    while at is not None:
        entry = config.bodies[at] if at in config.bodies else config.spacecraft[at]
        drawn = at in hooks or isinstance(entry.orbit, Drawn)
        chain.append((entry.orbit, world.scene if drawn else None))
        at = parent(config, at)
    return chain
