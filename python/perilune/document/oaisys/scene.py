"""State common to the sections of a file during translation: units, names, sizes, our tree."""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from perilune.config.errors import nearest
from perilune.document.oaisys.node import Node, Notes

ORIGIN = "origin"
"""Our entry at the scene's origin, if no mesh of the file is a body at rest there."""


@dataclass
class Entity:
    """A mesh of the file as a body or a spacecraft."""

    name: str
    """Name of our entry."""
    aliases: tuple[str, ...]
    """`name` and `meshInstanceName` in the file."""
    node: Node
    """Its entry in the file."""
    section: str
    """`bodies` or `spacecraft`."""
    table: str | None
    """Its entry in the core's table of bodies, if any."""
    rotation_deg: list[float]
    """Roll, pitch, yaw at the epoch."""
    radii_m: Callable[[], tuple[float, float, float]]
    """Semi-axes of a body; for a mesh, the bounding radius about its origin three times. Reads the
    model, so it is called only when needed."""


@dataclass
class Scene:
    """State of a translation."""

    base: Path
    """Folder that relative paths refer to."""
    notes: Notes
    metres_per_unit: float
    tree: dict[str, Any] = field(default_factory=dict)
    entities: dict[str, Entity] = field(default_factory=dict)
    """Our name -> object, in the order of the file."""
    steps: int = 1
    """Steps per batch."""
    passes: set[str] = field(default_factory=set)
    """Render passes requested by sensors."""

    def find(self, node: Node, key: str) -> Entity:
        """The object that a key names: by `name`, then by `meshInstanceName`."""
        wanted = node.text(key)
        for position in (0, 1):
            for entity in self.entities.values():
                if entity.aliases[position] == wanted:
                    return entity
        known = dict.fromkeys(
            alias for entity in self.entities.values() for alias in entity.aliases
        )
        node.fail(key, f"no mesh named '{wanted}'{nearest(wanted, known)}")

    def lengths_m(self, units: list[float]) -> list[float]:
        """Lengths in metres, from scene units."""
        return [self.metres_per_unit * value for value in units]


def clean_name(text: str, taken: Any) -> str:
    """A name that is valid in our configuration and not taken."""
    name = re.sub(r"[^A-Za-z0-9_-]", "_", text) or "mesh"
    if not re.match(r"[A-Za-z_]", name):
        name = f"_{name}"
    candidate, number = name, 2
    while candidate in taken:
        candidate, number = f"{name}_{number}", number + 1
    return candidate
