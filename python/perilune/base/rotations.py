"""Quaternions (w, x, y, z) of a few bodies and cameras; rotation per pixel is done by the core.

They use Python's own floats: for three or four numbers NumPy's calls take several times as long.
Dot products remain NumPy's, so that rounding is consistent."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

F64 = NDArray[np.float64]


def multiply(a: F64, b: F64) -> F64:
    """Hamilton product: first b, then a."""
    aw, ax, ay, az = a.tolist()
    bw, bx, by, bz = b.tolist()
    return np.array(
        [
            aw * bw - ax * bx - ay * by - az * bz,
            aw * bx + ax * bw + ay * bz - az * by,
            aw * by - ax * bz + ay * bw + az * bx,
            aw * bz + ax * by - ay * bx + az * bw,
        ]
    )


def conjugate(q: F64) -> F64:
    """The inverse rotation."""
    w, x, y, z = q.tolist()
    return np.array([w, -x, -y, -z])


def norm(v: F64) -> float:
    """Length of a vector, to the bit that of numpy.linalg.norm, without its checks."""
    return math.sqrt(v.dot(v))


def cross(a: F64, b: F64) -> F64:
    """Cross product of two vectors; numpy.cross takes ten times as long for a single one."""
    ax, ay, az = a.tolist()
    bx, by, bz = b.tolist()
    return np.array([ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx])


def angle_rad(a: F64, b: F64) -> float:
    """Angle between two vectors, accurate near 0 and pi too."""
    return math.atan2(math.hypot(*cross(a, b).tolist()), float(a @ b))


def rotate(q: F64, v: F64) -> F64:
    """The vector v rotated by q."""
    w, x, y, z = q.tolist()
    return _rotated(w, x, y, z, v)


def rotate_back(q: F64, v: F64) -> F64:
    """The vector v rotated by the inverse of q."""
    w, x, y, z = q.tolist()
    return _rotated(w, -x, -y, -z, v)


def _rotated(w: float, x: float, y: float, z: float, v: F64) -> F64:
    a, b, c = v.tolist()
    tx, ty, tz = 2.0 * (y * c - z * b), 2.0 * (z * a - x * c), 2.0 * (x * b - y * a)
    return np.array(
        [
            a + w * tx + (y * tz - z * ty),
            b + w * ty + (z * tx - x * tz),
            c + w * tz + (x * ty - y * tx),
        ]
    )


def axis_angle(axis: Sequence[float] | F64, angle_rad: float) -> F64:
    """Rotation about a unit axis; the angle is reduced first, so that long spins stay accurate."""
    half = 0.5 * math.remainder(angle_rad, 4.0 * math.pi)
    sine = math.sin(half)
    x, y, z = axis.tolist() if isinstance(axis, np.ndarray) else axis
    return np.array([math.cos(half), x * sine, y * sine, z * sine])


def from_rpy_deg(rpy: Sequence[float]) -> F64:
    """Roll about x, then pitch about y, then yaw about z, all of the reference axes."""
    roll, pitch, yaw = (math.radians(angle) for angle in rpy)
    q = multiply(axis_angle((0.0, 1.0, 0.0), pitch), axis_angle((1.0, 0.0, 0.0), roll))
    return multiply(axis_angle((0.0, 0.0, 1.0), yaw), q)


def to_axis_angle(q: F64) -> tuple[F64, float]:
    """Unit axis and angle in [0, pi] of a unit quaternion; the z axis if there is no rotation."""
    w, v = (q[0], q[1:]) if q[0] >= 0.0 else (-q[0], -q[1:])
    size = norm(v)
    if size == 0.0:
        return np.array([0.0, 0.0, 1.0]), 0.0
    return np.asarray(v / size), 2.0 * math.atan2(size, float(w))


def to_matrix(q: F64) -> F64:
    """3x3 matrix of a unit quaternion."""
    w, x, y, z = q.tolist()
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]
    )


def from_matrix(m: F64) -> F64:
    """Unit quaternion of a rotation matrix (Shepperd 1978: the largest component is the pivot)."""
    return _from_rows(m.tolist())


def _from_rows(m: Sequence[Sequence[float]]) -> F64:
    trace = m[0][0] + m[1][1] + m[2][2]
    squares = [trace, m[0][0], m[1][1], m[2][2]]
    pivot = squares.index(max(squares))
    q = [1 + trace, m[2][1] - m[1][2], m[0][2] - m[2][0], m[1][0] - m[0][1]]
    if pivot > 0:
        i = pivot - 1
        j, k = (i + 1) % 3, (i + 2) % 3
        q[0] = m[k][j] - m[j][k]
        q[1 + i] = 1 + m[i][i] - m[j][j] - m[k][k]
        q[1 + j] = m[j][i] + m[i][j]
        q[1 + k] = m[k][i] + m[i][k]
    found = np.array(q)
    return np.asarray(found / norm(found))


def middle(a: F64, b: F64) -> F64:
    """Midpoint of two rotations along the shorter arc, as the core computes it for the middle of an
    exposure."""
    q = a + (b if float(a @ b) >= 0.0 else -b)
    return np.asarray(q / norm(q))


def look_at(forward: F64, up: F64) -> F64:
    """Camera axes (x right, y down, z forward) with z along forward and -y as close to `up` as
    possible.

    If the two are parallel, the axis farthest from `forward` replaces `up`."""
    z = forward / norm(forward)
    x = cross(z, up)
    size = norm(x)
    if size < 1e-9 * norm(up):
        x = cross(z, np.eye(3)[int(np.argmin(np.abs(z)))])
        size = norm(x)
    x = x / size
    return _from_rows(list(zip(x.tolist(), cross(z, x).tolist(), z.tolist(), strict=True)))
