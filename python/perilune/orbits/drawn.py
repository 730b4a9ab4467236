"""From drawn elements to a path: common to database and hook orbits."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from pydantic import ValidationError

from perilune.config.errors import from_validation
from perilune.config.orbit import J2, Drawn, Elements, Kepler
from perilune.orbits.kinds.elements import two_body
from perilune.orbits.kinds.j2 import j2
from perilune.orbits.place import Motion, Place

_SECTIONS: dict[str, type[Elements]] = {"kepler": Kepler, "j2": J2}


def start_rev(orbit: Drawn, place: Place) -> float:
    """Position on a circular path at the epoch, in revolutions."""
    low, high = orbit.orbit_start or (0.0, 1.0)
    return low + (high - low) * float(place.scene_random("orbit_start").random())


def run_through(propagator: str, elements: Mapping[str, Any], place: Place) -> Motion:
    """The path for elements (or a state), named by the keys of the configuration.

    ValueError that names the key for invalid elements."""
    tree = {"kind": propagator, "around": place.around, **elements}
    try:
        section = _SECTIONS[propagator].model_validate(tree)
    except ValidationError as error:
        raise ValueError(str(from_validation(error, tree, "the elements"))) from None
    return j2(section, place) if isinstance(section, J2) else two_body(section, place)
