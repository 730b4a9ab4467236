"""The size of a scene unit: what one unit of an OAISYS scene is in metres."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from perilune import _core
from perilune.base import rotations
from perilune.document.oaisys.node import Node

EARTH_M = 6.378e6
"""The Earth of the paper's listings: a scale of 1.06396989 is an altitude of 408 km."""


def known_body(*texts: str) -> str | None:
    """The entry of the core's table that one of some texts names."""
    for text in texts:
        name = text.lower()
        if name in _core.BODIES and name != "sun":
            return name
    return None


def mean_radius_m(body: str) -> float:
    """Of a body of the table; the Earth's is that of the listings."""
    if body == "earth":
        return EARTH_M
    radii = _core.BODIES[body]["radii_m"]
    return float(sum(radii)) / 3.0


def synchronous_radius_m(body: str) -> float:
    """Of the circle that goes around a body of the table once in its sidereal day."""
    span_s = 600.0  # too short for half a turn of anything
    days = np.array([0.0, span_s / 86400.0])
    first, second = _core.body_orientation(body, 2451545.0, days)
    turn = rotations.multiply(rotations.conjugate(first), second)
    rate = 2.0 * math.atan2(float(np.linalg.norm(turn[1:])), abs(float(turn[0]))) / span_s
    return float((_core.BODIES[body]["gm_m3_s2"] / rate**2) ** (1.0 / 3.0))


def metres_per_unit(root: Node, bodies: list[str | None], orbits: bool) -> float:
    """As the file states it; else the mean radius of the first known body; else Earth's or 1 m.

    bodies: the table's names of what is a body in the scene, None for one that the table does not
    have; those that are orbited come first, and of these those that stand still. orbits: whether
    anything is in orbit. A scene without orbits and bodies is one of Blender's, whose unit is the
    metre.
    """
    stated: Any = root.number("metres_per_unit", None)
    if stated is not None:
        if not stated > 0.0:
            root.fail("metres_per_unit", f"must be positive, not {stated:g}")
        return float(stated)
    known = next((name for name in bodies if name is not None), None)
    if known is not None:
        return mean_radius_m(known)
    return EARTH_M if orbits or bodies else 1.0
