"""Powered descents: a gravity turn from a state to the ground, in the rotating axes of a body."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from perilune.config.standing import Descent
from perilune.orbits.ground import Ground, vertical
from perilune.orbits.motion import Kept

F64 = NDArray[np.float64]
Vec = tuple[float, float, float]

_STEPS = 256
"""Steps of a turn, even in the logarithm of the speed."""
_G0_M_S2 = 9.80665
"""Standard gravity, by which a specific impulse is an exhaust speed."""


class DescentError(ValueError):
    """A descent that no throttle makes; the text begins with the key."""


@dataclass(frozen=True)
class Field:
    """What pulls: a point mass, in axes that rotate."""

    gm_m3_s2: float
    omega_rad_s: Vec
    """Angular velocity of the body's axes in the ICRF, in the body's axes."""

    def acceleration(self, place: Vec, velocity: Vec) -> Vec:
        """Gravity, Coriolis and centrifugal acceleration."""
        x, y, z = place
        a, b, c = self.omega_rad_s
        pull = -self.gm_m3_s2 / (x * x + y * y + z * z) ** 1.5
        # -2 w x v - w x (w x p) = -w x (2 v + w x p)
        u, v, w = velocity
        u, v, w = 2.0 * u + b * z - c * y, 2.0 * v + c * x - a * z, 2.0 * w + a * y - b * x
        return (pull * x - (b * w - c * v), pull * y - (c * u - a * w), pull * z - (a * v - b * u))


@dataclass(frozen=True)
class Turn:
    """A gravity turn: states while the speed falls from the first to the last."""

    t_s: F64
    states: F64
    """(n, 6): places and velocities over the ground, body axes."""
    acceleration_m_s2: float
    """Acceleration by the thrust at the start."""


def uniform_acceleration_m_s2(g: float, drop_m: float, down: float, across: float) -> float:
    """Thrust's acceleration of a turn that stops after a drop, in uniform gravity g without
    rotation.

    With k the ratio of thrust to weight, v the speed and u its part downwards, v^2 + 2 k u v + u^2
    changes by 4 g (1 - k^2) u in a second (Citron, Dunin and Meissinger 1964 have the like), so
    that 4 g H (k^2 - 1) = v^2 + 2 k u v + u^2."""
    square = across**2 + down**2
    b = down * math.sqrt(square)
    c = 4.0 * g * drop_m
    return g * (b + math.sqrt(b * b + c * (c + square + down**2))) / c


def turn(
    field: Field, place: F64, velocity: F64, a0: float, end_m_s: float, exhaust_m_s: float | None
) -> Turn | None:
    """The turn with an acceleration a0 by the thrust; None if gravity wins, so that the speed does
    not fall to end_m_s, or if there would be less than a tenth of the mass left."""
    speed = float(np.linalg.norm(velocity))
    step = math.log(end_m_s / speed) / _STEPS
    state = (0.0, *place.tolist(), *(velocity / speed).tolist())
    rows = [(*state, speed)]

    def slope(log_v: float, y: tuple[float, ...]) -> tuple[float, ...] | None:
        v = math.exp(log_v)
        left = 1.0 if exhaust_m_s is None else 1.0 - a0 * y[0] / exhaust_m_s
        if left < 0.1:
            return None
        d = y[4:]
        g = field.acceleration((y[1], y[2], y[3]), (v * d[0], v * d[1], v * d[2]))
        along = g[0] * d[0] + g[1] * d[1] + g[2] * d[2]
        fall = along - a0 / left
        if not fall < 0.0:
            return None
        dt = v / fall  # time over the change of log v
        turns = tuple((g[i] - along * d[i]) / v * dt for i in range(3))
        return (dt, v * d[0] * dt, v * d[1] * dt, v * d[2] * dt, *turns)

    log_v = math.log(speed)
    for _ in range(_STEPS):
        after = _runge_kutta(slope, log_v, state, step)
        if after is None:
            return None
        size = math.hypot(*after[4:])
        state = (*after[:4], *(value / size for value in after[4:]))
        log_v += step
        rows.append((*state, math.exp(log_v)))
    table = np.array(rows)
    return Turn(table[:, 0], np.hstack([table[:, 1:4], table[:, 4:7] * table[:, 7:]]), a0)


def _runge_kutta(slope: Any, at: float, y: tuple[float, ...], h: float) -> Any:
    """A step of the classical method of order 4; None where there is no slope."""
    k: list[tuple[float, ...]] = []
    for share in (0.0, 0.5, 0.5, 1.0):
        here = y if not k else tuple(a + share * h * b for a, b in zip(y, k[-1], strict=True))
        found = slope(at + share * h, here)
        if found is None:
            return None
        k.append(found)
    return tuple(
        a + h / 6.0 * (p + 2.0 * q + 2.0 * r + s) for a, p, q, r, s in zip(y, *k, strict=True)
    )


@dataclass(frozen=True)
class Track:
    """A descent from its start to its touch-down. Body axes."""

    turn: Turn
    up: F64
    """(3,) the vertical at the touch-down."""
    feet_m: F64
    """(3,) the place of the touch-down."""
    drop_m: float
    """Height of the turn's end over it."""
    speed_m_s: float
    """That of the vertical descent."""
    left: F64
    """(3,) to the left of the horizontal heading at the start."""

    @property
    def turned_s(self) -> float:
        """Time at which the turn ends."""
        return float(self.turn.t_s[-1])

    @property
    def end_s(self) -> float:
        """Time of the touch-down."""
        return self.turned_s + self.drop_m / self.speed_m_s

    def state(self, t_s: float) -> tuple[F64, F64]:
        """Place (3,) and velocity (3,) over the ground; straight on before the start, at rest after
        the touch-down."""
        times, rows = self.turn.t_s, self.turn.states
        if t_s >= self.end_s:
            return self.feet_m, np.zeros(3)
        if t_s >= self.turned_s:
            height = (self.end_s - t_s) * self.speed_m_s
            return self.feet_m + height * self.up, -self.speed_m_s * self.up
        if t_s <= 0.0:
            return rows[0, :3] + t_s * rows[0, 3:], rows[0, 3:]
        k = int(np.clip(np.searchsorted(times, t_s, "right") - 1, 0, len(times) - 2))
        h = float(times[k + 1] - times[k])
        return _hermite(rows[k], rows[k + 1], h, (t_s - float(times[k])) / h)

    def axes(self, t_s: float) -> F64:
        """(3, 3), columns x, y, z: z along the thrust, y to the left of the heading."""
        _, velocity = self.state(min(t_s, self.turned_s))
        z = self.up if t_s >= self.turned_s else -velocity / np.linalg.norm(velocity)
        y = self.left - (self.left @ z) * z
        y /= np.linalg.norm(y)
        return np.column_stack([np.cross(y, z), y, z])


def _hermite(a: F64, b: F64, h: float, s: float) -> tuple[F64, F64]:
    """Cubic through places and velocities of two states h seconds apart."""
    step = b[:3] - a[:3]
    place = (
        a[:3]
        + s * h * a[3:]
        + s * s * (3.0 * step - h * (2.0 * a[3:] + b[3:]))
        + s**3 * (h * (a[3:] + b[3:]) - 2.0 * step)
    )
    velocity = (
        a[3:]
        + 2.0 * s * (3.0 * step / h - (2.0 * a[3:] + b[3:]))
        + 3.0 * s * s * ((a[3:] + b[3:]) - 2.0 * step / h)
    )
    return np.asarray(place), np.asarray(velocity)


_NEAR_M = 1e-3
"""How far from its site a descent may end."""
_TRIES = 100
_CLOSE_M = 1e-6
"""How far above its goal a turn may end."""


def _root(
    f: Callable[[float], float], low: tuple[float, float], high: tuple[float, float]
) -> float:
    """Where a function is at most _CLOSE_M above 0, between one value below and one not below.

    False position, with the weight of an end that stays halved ("Illinois"; Dowell and Jarratt
    1971); halves, where the function is minus infinity."""
    (a, below), (b, above) = low, high
    value, kept = above, 0
    for _ in range(_TRIES):
        if value <= _CLOSE_M or b - a <= 1e-15 * b:
            break
        c = b - (b - a) * above / (above - below) if math.isfinite(below) else 0.5 * (a + b)
        off = f(c)
        if off >= 0.0:
            b, above, value = c, off, off
            below *= 0.5 if kept == 1 else 1.0
            kept = 1
        else:
            a, below = c, off
            above *= 0.5 if kept == -1 else 1.0
            kept = -1
    return b


_tracks: Kept[Track] = Kept(32)


def track(spec: Descent, ground: Ground, field: Field, height_m: float) -> Track:
    """The descent of a section. height_m: that of the origin over the ground as it stands.

    DescentError (ValueError) where no throttle does it, or more than there is."""
    key = (*(getattr(spec, name) for name in Descent.model_fields), ground, field, height_m)
    return _tracks.get(key, lambda: _Solver(spec, ground, field, height_m).track())


class _Solver:
    """Looks for the thrust and the start."""

    def __init__(self, spec: Descent, ground: Ground, field: Field, height_m: float) -> None:
        self._spec, self._ground, self._field, self._height_m = spec, ground, field, height_m
        _, normal, north = ground.site(spec)
        heading = math.radians(spec.heading_deg)
        east = np.cross(north, normal)
        self._ahead = math.cos(heading) * north + math.sin(heading) * east
        isp = spec.specific_impulse_s
        self._exhaust_m_s = None if isp is None else isp * _G0_M_S2

    def _base_m(self, toward: F64) -> float:
        """Distance from the centre of what heights count from."""
        datum = self._spec.altitude_above == "datum"
        base = self._ground.datum_m if datum else self._ground.ground_m
        return float(base(toward[np.newaxis])[0])

    def _start(self, toward: F64) -> tuple[F64, F64, F64]:
        """Place, velocity and the direction to the left, over a direction from the centre."""
        spec = self._spec
        place = toward * self._base_m(toward)
        up = vertical(self._ground.radii_m, place)
        ahead = self._ahead - (self._ahead @ up) * up
        ahead /= np.linalg.norm(ahead)
        velocity = spec.horizontal_speed_m_s * ahead - spec.descent_speed_m_s * up
        return place + spec.start_height_m * up, velocity, np.cross(up, ahead)

    def _final(self, place: F64) -> float:
        """Height of the origin over that at which the turn shall end."""
        low = self._ground.height_m(place) - self._height_m
        return low - self._spec.final_height_m

    def _solved(self, place: F64, velocity: F64, guess: float | None) -> Turn:
        """The turn that ends where it shall. guess: the thrust's acceleration from before."""
        end_m_s = self._spec.touchdown_speed_m_s

        def made(a0: float) -> Turn | None:
            return turn(self._field, place, velocity, a0, end_m_s, self._exhaust_m_s)

        def miss(found: Turn | None) -> float:
            return -math.inf if found is None else self._final(found.states[-1, :3])

        low = high = guess or self._uniform_m_s2(place, velocity)
        step = 1.1 if guess is None else 1.0001
        below, found = 0.0, made(high)
        above = miss(found)
        while above < 0.0:
            if high > 1e6 * low:
                raise DescentError(
                    f"start_height_m: {self._spec.start_height_m:g}: no thrust stops the fall"
                )
            low, below, high, step = high, above, high * step, step**2
            found = made(high)
            above = miss(found)
        step = 1.1 if guess is None else 1.0001
        while low == high or below >= 0.0:
            low, step = low / step, step**2
            below = miss(made(low))
        made_at = _root(lambda a0: miss(made(a0)), (low, below), (high, above))
        found = made(made_at)
        assert found is not None  # it ends above the ground
        if miss(found) > _NEAR_M:
            raise DescentError(
                f"start_height_m: {self._spec.start_height_m:g}: too high for a turn from this "
                "speed: the thrust would be no more than the weight; start lower or faster"
            )
        return found

    def _uniform_m_s2(self, place: F64, velocity: F64) -> float:
        drop = max(self._final(place), 1e-9)
        up = vertical(self._ground.radii_m, place)
        down = -float(velocity @ up)
        across = math.sqrt(max(float(velocity @ velocity) - down**2, 0.0))
        g = self._field.gm_m3_s2 / float(place @ place)
        return uniform_acceleration_m_s2(g, drop, down, across)

    def track(self) -> Track:
        spec = self._spec
        place, _, _ = self._ground.site(spec)
        goal = place / np.linalg.norm(place)
        toward, guess = goal, None
        for _ in range(40):
            start, velocity, left = self._start(toward)
            found = self._solved(start, velocity, guess)
            guess = found.acceleration_m_s2
            end = found.states[-1, :3] / np.linalg.norm(found.states[-1, :3])
            off_m = (goal - end) * float(np.linalg.norm(place))
            if spec.place == "start" or float(np.linalg.norm(off_m)) < _NEAR_M:
                break
            toward = toward + (goal - end)
            toward /= np.linalg.norm(toward)
        else:
            raise DescentError(
                "place: touchdown: the start is on ground too rough to be found; give that of the "
                "start, or altitude_above: datum"
            )
        self._check(found)
        feet = found.states[-1, :3]
        up = vertical(self._ground.radii_m, feet)
        drop = max(self._ground.height_m(feet) - self._height_m, 0.0)
        return Track(found, up, feet - drop * up, drop, spec.touchdown_speed_m_s, left)

    def _check(self, found: Turn) -> None:
        limit, needed = self._spec.max_acceleration_m_s2, found.acceleration_m_s2
        if limit is not None and needed > limit:
            raise DescentError(
                f"max_acceleration_m_s2: {limit:g}: the descent needs {needed:.4g} m/s2; start "
                "higher or slower"
            )
