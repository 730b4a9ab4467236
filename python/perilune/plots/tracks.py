"""Where things are over time, for the plots: positions at any time, one revolution of an orbit."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

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


def relative_m(world: World, name: str, around: str, t_s: float) -> F64:
    """Position (3,) of a thing from another's centre at a time, as the frame's orbits have it."""
    poses = world.system.states(np.array([t_s])).poses
    return poses[name][0, :3] - poses[around][0, :3]


def revolution_m(world: World, name: str, around: str) -> F64:
    """One revolution from where a thing is in a frame, (n, 3) from its parent's centre, ICRF axes.

    Followed in steps of two degrees by finite differences, so it serves any propagator. An open
    orbit ends where it has gone far; a thing that stays where it is has one point.
    """
    t_s, turned = world.t_s, 0.0
    place = relative_m(world, name, around, t_s)
    first = float(np.linalg.norm(place))
    points = [place]
    while turned < 2.0 * math.pi and len(points) < _MOST_POINTS:
        rate = _rate_rad_s(world, name, around, t_s, place)
        if rate == 0.0:
            break
        t_s += _TURN_RAD / rate
        after = relative_m(world, name, around, t_s)
        turned += _angle_rad(place, after)
        place = after
        points.append(place)
        if float(np.linalg.norm(place)) > _FARTHEST * first:
            break
    return np.array(points)


def _angle_rad(a: F64, b: F64) -> float:
    return math.atan2(float(np.linalg.norm(np.cross(a, b))), float(a @ b))


def _rate_rad_s(world: World, name: str, around: str, t_s: float, place: F64) -> float:
    """Angular rate now, from a step that turns by about 1e-4 rad."""
    step = 1e-3
    for _ in range(60):
        angle = _angle_rad(place, relative_m(world, name, around, t_s + step))
        if angle >= 1e-5:
            return angle / step
        step *= 4.0 if angle < 1e-6 else 1.5
        if step > 1e9:
            break
    return 0.0


def rows(worlds: list[World], name: str) -> list[list[World]]:
    """Frames in runs that share one orbit of `name` (and of what it orbits), in their order."""
    runs: list[list[World]] = []
    for world in worlds:
        if runs and _chain(runs[-1][-1].config, name) == _chain(world.config, name):
            runs[-1].append(world)
        else:
            runs.append([world])
    return runs


def _chain(config: Config, name: str) -> list[object]:
    """The orbits that place a thing, its own first."""
    chain: list[object] = []
    at: str | None = name
    while at is not None:
        entry = config.bodies[at] if at in config.bodies else config.spacecraft[at]
        chain.append(entry.orbit)
        at = parent(config, at)
    return chain
