"""Kepler orbits with secular drift by the oblateness of the central body."""

from __future__ import annotations

from perilune.config.orbit import J2
from perilune.orbits.gravity import ZONALS
from perilune.orbits.kinds.elements import two_body
from perilune.orbits.place import Motion, Place


def j2(orbit: J2, place: Place) -> Motion:
    """Mean elements, or osculating ones (always for a state), which the core converts to mean
    ones."""
    parent = place.parent
    zonals = ZONALS.get(parent.table or "")
    if orbit.j2 is not None:
        value, radius = orbit.j2, parent.mean_radius_m
    elif zonals is not None:
        value, radius = zonals.j[0], zonals.radius_m
    else:
        known = ", ".join(ZONALS)
        raise ValueError(f"the oblateness of {parent.name} is not known, only of {known}: give j2")
    return {
        **two_body(orbit, place),
        "kind": "j2",
        "parent_body": parent.table,  # whose pole it is, whatever the frame of the elements
        "j2": value,
        "radius_m": radius,
        "osculating": orbit.osculating or orbit.state is not None,
    }
