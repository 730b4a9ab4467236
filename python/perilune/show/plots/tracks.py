"""Where things are over time, for the plots: positions at any time, one revolution of an orbit."""

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
"""An open orbit is drawn until it is so many times farther than where it is now."""


def parent(config: Config, name: str) -> str | None:
    """What a body or spacecraft orbits; None for a body that an ephemeris places, and the root."""
    entry = config.bodies[name] if name in config.bodies else config.spacecraft[name]
    return entry.orbit.around if entry.orbit is not None else None


def relative(world: World, name: str, around: str, t_s: float) -> tuple[F64, F64]:
    """Position (3,) m and velocity m/s of a thing from another's centre, as the frame has it."""
    found = world.system.states(np.array([t_s]))
    return (
        found.poses[name][0, :3] - found.poses[around][0, :3],
        found.velocities_m_s[name][0] - found.velocities_m_s[around][0],
    )


def revolution_m(world: World, name: str, around: str) -> F64:
    """One revolution from where a thing is in a frame, (n, 3) from its parent's centre, ICRF axes.

    Followed in steps of about two degrees at the angular rate |r x v| / r^2 of the moment, so it
    serves any propagator. An open orbit ends where it has gone far; a thing that stays where it is
    has one point. Ends early where the propagator has no answer (a table's end).
    """
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
    """Frames in runs that share one orbit of `name` (and of what it orbits), in their order."""
    runs: list[list[World]] = []
    for world in worlds:
        if runs and _chain(runs[-1][-1], name) == _chain(world, name):
            runs[-1].append(world)
        else:
            runs.append([world])
    return runs


def _chain(world: World, name: str) -> list[object]:
    """The orbits that place a thing, its own first; what is drawn once a scene with its scene."""
    config, hooks = world.config, world.system.setting.hooks
    chain: list[object] = []
    at: str | None = name
    while at is not None:
        entry = config.bodies[at] if at in config.bodies else config.spacecraft[at]
        drawn = at in hooks or isinstance(entry.orbit, Drawn)
        chain.append((entry.orbit, world.scene if drawn else None))
        at = parent(config, at)
    return chain
