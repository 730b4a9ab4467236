"""The size of a scene unit: what one unit of an OAISYS scene is in metres."""

from __future__ import annotations

from typing import Any

from perilune import _core
from perilune.config.oaisys.node import Node

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


def metres_per_unit(root: Node, bodies: list[str | None], orbits: bool) -> float:
    """As the file states it; else the mean radius of the first known body; else Earth's or 1 m.

    bodies: the table's names of what is a body in the scene, those that are orbited first and of
    these those that stand still; None for one that the table does not have. orbits: whether anything is in orbit. A scene without orbits
    and bodies is one of Blender's, whose unit is the metre.
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
