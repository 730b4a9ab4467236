"""The kinds of orbits: from a section of the configuration to a path about the central body.

A kind is a function of (section, Place). It returns a specification of one of the core's
propagators, a fixed position, or a function t_s (n,) -> states (n, 6), and raises ValueError with
the reason. To add one: its section in config/orbit.py, its file in kinds/, its line in KINDS."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from perilune.orbits.kinds.circular import circular
from perilune.orbits.kinds.database import database
from perilune.orbits.kinds.elements import kepler
from perilune.orbits.kinds.j2 import j2
from perilune.orbits.kinds.numerical import numerical
from perilune.orbits.kinds.powered_descent import powered_descent
from perilune.orbits.kinds.spice import spice
from perilune.orbits.kinds.surface import surface
from perilune.orbits.kinds.table import table
from perilune.orbits.kinds.tle import tle
from perilune.orbits.kinds.traverse import traverse
from perilune.orbits.place import Motion, Place

KINDS: dict[str, Callable[[Any, Place], Motion]] = {
    "kepler": kepler,
    "circular": circular,
    "j2": j2,
    "numerical": numerical,
    "tle": tle,
    "table": table,
    "spice": spice,
    "database": database,
    "surface": surface,
    "traverse": traverse,
    "powered_descent": powered_descent,
}
"""`kind` of an orbit's section -> function that makes its path. Hooks are not here but in the
system, because they need the positions of other objects."""


def make(orbit: Any, place: Place) -> Motion:
    """The path of an orbit's section."""
    return KINDS[orbit.kind](orbit, place)
