"""Size of a unit of an OAISYS scene in metres."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from perilune import _core
from perilune.base import rotations
from perilune.document.oaisys.node import Node

EARTH_M = 6.378e6
"""Radius of the Earth in the paper's listings: a scale of 1.06396989 is an altitude of 408 km."""


def known_body(*texts: str) -> str | None:
    """Entry of the core's table that one of some texts names."""
    for text in texts:
        name = text.lower()
        if name in _core.BODIES and name != "sun":
            return name
    return None


def mean_radius_m(body: str) -> float:
    """Mean radius of a body of the table; for the Earth that of the listings."""
    if body == "earth":
        return EARTH_M
    radii = _core.BODIES[body]["radii_m"]
    return float(sum(radii)) / 3.0


def synchronous_radius_m(body: str) -> float:
    """Radius of the synchronous circular orbit around a body of the table."""
    span_s = 600.0  # too short for half a turn of anything
    days = np.array([0.0, span_s / 86400.0])
    first, second = _core.body_orientation(body, 2451545.0, days)
    turn = rotations.multiply(rotations.conjugate(first), second)
    rate = 2.0 * math.atan2(float(np.linalg.norm(turn[1:])), abs(float(turn[0]))) / span_s
    return float((_core.BODIES[body]["gm_m3_s2"] / rate**2) ** (1.0 / 3.0))


def metres_per_unit(root: Node, bodies: list[str | None], orbits: bool) -> float:
    """Scene unit as given in the file; else the mean radius of the first known body; else Earth's
    or 1 m.

    bodies: table names of the scene's bodies, None for one that is not in the table. Central bodies
    come first, and of these the resting ones. orbits: whether anything is in orbit. A scene without
    orbits and bodies is a plain Blender scene in metres."""
    stated: Any = root.number("metres_per_unit", None)
    if stated is not None:
        if not stated > 0.0:
            root.fail("metres_per_unit", f"must be positive, not {stated:g}")
        return float(stated)
    known = next((name for name in bodies if name is not None), None)
    if known is not None:
        return mean_radius_m(known)
    return EARTH_M if orbits or bodies else 1.0
