"""Ids of classes and parts as the core's scene takes them."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from perilune import _core, orbits
from perilune.bodies.areas import Areas, names_of, read_areas
from perilune.config.body import Body
from perilune.config.errors import ConfigError
from perilune.config.labels import GROUND, CraterLabels
from perilune.config.spacecraft import Spacecraft
from perilune.config.types import Latitudes
from perilune.document.document import Document
from perilune.frame.labels import CRATER, ROCK, Taxonomy, ground_class, object_class

_NONE_SO_LARGE_PX = 1e30
"""Least diameter of labelled craters where none are asked for."""
Told = Callable[[str, str, tuple[str, ...]], None]
"""Receives a key, a file and remarks about it."""


def class_ids(labels: Taxonomy, name: str, entry: Body | Spacecraft) -> NDArray[np.uint16]:
    """(parts, levels) of a body or spacecraft."""
    kind = "body" if isinstance(entry, Body) else "spacecraft"
    known = {"kind": kind, "object": object_class(name, entry), GROUND: ground_class(entry)}
    return labels.class_ids(*({**known, **part.classes} for part in labels.parts_of(name)))


def part_ids(labels: Taxonomy, name: str) -> NDArray[np.int32]:
    """(parts,) of a body or spacecraft."""
    return np.array([part.id for part in labels.parts_of(name)], dtype=np.int32)


def crater_criteria(given: CraterLabels | None) -> tuple[float, float, float]:
    """Which craters are labelled, as _core.Scene.add_body takes it."""
    if given is None:
        return _NONE_SO_LARGE_PX, 0.0, 0.0
    return given.least_px, given.least_depth, given.least_kept


def ground_labels(labels: Taxonomy, body: Body) -> tuple[int, int, int] | None:
    """Level at which rocks and craters of a body have classes of their own, and these; None if
    there is no such level."""
    if GROUND not in labels.levels or body.terrain is None:
        return None
    ids = labels.classes[GROUND]
    return labels.levels.index(GROUND), ids[ROCK], ids[CRATER]


def areas(
    document: Document, name: str, labels: Taxonomy, kept: dict[object, Areas], tell: Told
) -> tuple[tuple[_core.Raster, ...], NDArray[np.int32], NDArray[np.uint16]] | None:
    """The areas of a body's surface: rasters, part ids, class ids; None for a body without.

    kept: rasters that were read before. Raises ConfigError."""
    body = document.config.bodies[name]
    if not body.areas:
        return None
    x, y, z = orbits.radii_m(body).tolist()
    latitudes: Latitudes = "geodetic" if body.is_geodetic else "geocentric"
    names, found = tuple(names_of(body.areas)), []
    for k, given in enumerate(body.areas):
        key = f"bodies.{name}.areas[{k}]"
        path = document.path(given.file, f"{key}.file")
        read = (path, repr(given), names, (x, y, z), latitudes)
        if read not in kept:
            try:
                kept[read] = read_areas(given, path, names, (x, y, z), latitudes)
            except ValueError as error:
                raise ConfigError(f"{document.source}:\n  {key}.{error}") from error
        tell(key, str(path), kept[read].remarks)
        found.append(kept[read].raster)
    return tuple(found), part_ids(labels, name)[1:], class_ids(labels, name, body)[1:]
