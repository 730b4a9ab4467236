"""Poses at instants within an exposure, as many as the motion needs.

The core interpolates between instants (keys): positions linearly, rotations along the shorter arc.
The number of keys is chosen so that this is within a tenth of a pixel of the true paths."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from perilune import orbits
from perilune.base import rotations
from perilune.world import World

F64 = NDArray[np.float64]

State = tuple[F64, dict[str, F64], F64, F64]
"""State at one instant: camera, objects by name, Sun, movers."""

KEYS_MAX = 257
"""Largest number of keys; faster motion is rendered only at these instants, without
interpolation."""
NEAR_PX = 0.1
"""Largest error of the interpolation between keys, in pixels."""


@dataclass(frozen=True)
class Keys:
    """All poses at `count` instants, evenly spread over the time of a frame."""

    camera: F64
    """(count, 7) camera poses."""
    entities: dict[str, F64]
    """Name of a body or spacecraft -> poses (count, 7)."""
    sun_m: F64
    """(count, 3) position of the Sun."""
    movers: F64
    """(count, nodes, 3, 4) motions of moving nodes."""
    held: bool = False
    """Whether poses are constant around each key, because interpolation would be wrong."""

    @property
    def count(self) -> int:
        """Number of keys: odd, at least 3."""
        return len(self.camera)


class Exposure:
    """A frame's world at other instants of its exposure, with a cache."""

    def __init__(
        self,
        world: World,
        camera: Callable[[World], F64],
        movers: Callable[[World], F64],
        hooked: bool,
    ) -> None:
        """camera: poses (2, 7) at opening and closing. movers: (nodes, 3, 4) in the middle. hooked:
        the camera's poses come from a hook, which may return two that ignore when the shutter
        closes."""
        self._world, self._camera, self._movers = world, camera, movers
        self._ends = camera(world)
        self._known: dict[float, State] = {}
        self._pair = False
        if hooked and not np.array_equal(*self._ends):
            t_s = np.array([world.t_s, world.t_s + 0.5 * world.window_s])
            half = self._camera_at(0.5, world.system.states(t_s), 1)
            self._pair = np.array_equal(half, self._ends[1])

    def _camera_at(self, share: float, states: orbits.States, k: int) -> F64:
        """The pose at closing for a shutter that closes at this time."""
        world = self._world
        if share in (0.0, 1.0):
            return np.asarray(self._ends[int(share)])
        if self._pair:
            return between(self._ends, share)
        early = replace(
            world,
            window_s=share * world.window_s,
            poses={name: rows[[0, k]] for name, rows in states.poses.items()},
            velocities_m_s={name: rows[[0, k]] for name, rows in states.velocities_m_s.items()},
            longest=world.shared,
        )
        return np.asarray(self._camera(early)[1])

    def at(self, shares: list[float]) -> list[State]:
        """Camera, objects, Sun and movers at fractions of the frame's time."""
        world = self._world
        new = [share for share in shares if share not in self._known]
        if new:
            t_s = np.array([world.t_s, *(world.t_s + share * world.window_s for share in new)])
            states = world.system.states(t_s)
            for k, share in enumerate(new, start=1):
                now = instant(world, float(t_s[k]), states, k)
                poses = {name: rows[k] for name, rows in states.poses.items()}
                camera = self._camera_at(share, states, k)
                self._known[share] = camera, poses, now.sun_position_m, self._movers(now)
        return [self._known[share] for share in shares]


def instant(world: World, t_s: float, states: orbits.States, k: int) -> World:
    """The world at one instant, row k of `states`, as if the shutter opened and closed then."""
    return replace(
        world,
        t_s=t_s,
        window_s=0.0,
        poses={name: rows[[k, k]] for name, rows in states.poses.items()},
        velocities_m_s={name: rows[[k, k]] for name, rows in states.velocities_m_s.items()},
        sun_position_m=orbits.sun_position_m(world.config, world.epoch, t_s),
    )


def middle(world: World) -> World:
    """The world in the middle of the frame's time."""
    if world.window_s == 0.0:
        return world
    t_s = world.t_s + 0.5 * world.window_s
    return instant(world, t_s, world.system.states(np.array([t_s])), 0)


def between(ends: F64, share: float) -> F64:
    """The pose at a fraction from the first to the second: linear position, shorter arc."""
    turn = rotations.multiply(rotations.conjugate(ends[0, 3:]), ends[1, 3:])
    axis, angle = rotations.to_axis_angle(turn)
    q = rotations.multiply(ends[0, 3:], rotations.axis_angle(axis, share * angle))
    return np.concatenate([ends[0, :3] + share * (ends[1, :3] - ends[0, :3]), q])


def _seen(camera: F64, pose: F64) -> tuple[F64, F64]:
    """Position and rotation in the camera's axes."""
    back = rotations.conjugate(camera[3:])
    return rotations.rotate(back, pose[:3] - camera[:3]), rotations.multiply(back, pose[3:])


def _off_px(world: World, focal_px: float, truth: State, guess: State) -> float:
    """Distance in pixels between the true state at an instant and the interpolated one."""
    (camera, entities, _, movers), (camera_k, entities_k, _, movers_k) = truth, guess
    most = 0.0
    for name in entities:
        radius = world.radius_m(name)
        place, turn = _seen(camera, entities[name])
        place_k, turn_k = _seen(camera_k, entities_k[name])
        distance = max(float(np.linalg.norm(place)) - radius, 0.1 * radius)
        _, angle = rotations.to_axis_angle(rotations.multiply(rotations.conjugate(turn), turn_k))
        own = 0.0
        if name in world.craft_radius_m and movers.size:
            # Parts turn about places within the craft; slides do not move within a frame.
            own = 2.0 * radius * float(np.abs(movers[:, :, :3] - movers_k[:, :, :3]).max())
        moved = float(np.linalg.norm(place - place_k)) + radius * angle + own
        most = max(most, focal_px * moved / distance)
    return most


def _checks(count: int) -> Iterator[tuple[int, float]]:
    """A segment and a position in it, unevenly spaced, so that no spin rate escapes all of them."""
    for k in range(count - 1):
        yield k, 0.25 + 0.5 * ((0.381966 + 0.618034 * k) % 1.0)


def _near(world: World, focal_px: float, exposure: Exposure, count: int) -> bool:
    known = exposure.at([k / (count - 1) for k in range(count)])
    checks = list(_checks(count))
    truths = exposure.at([(k + part) / (count - 1) for k, part in checks])
    for (k, part), truth in zip(checks, truths, strict=True):
        a, b = known[k], known[k + 1]
        guess = (
            between(np.stack([a[0], b[0]]), part),
            {name: between(np.stack([a[1][name], b[1][name]]), part) for name in a[1]},
            a[2],
            a[3] + part * (b[3] - a[3]),
        )
        if _off_px(world, focal_px, truth, guess) > NEAR_PX:
            return False
    return True


def keys(world: World, focal_px: float, exposure: Exposure) -> Keys:
    """Keys of a frame with an exposure time."""
    count, held = 3, False
    while not _near(world, focal_px, exposure, count):
        if count >= KEYS_MAX:
            held = True
            break
        count = 2 * count - 1
    found = exposure.at([k / (count - 1) for k in range(count)])
    return Keys(
        np.stack([row[0] for row in found]),
        {name: np.stack([row[1][name] for row in found]) for name in found[0][1]},
        np.stack([row[2] for row in found]),
        np.stack([row[3] for row in found]),
        held,
    )
