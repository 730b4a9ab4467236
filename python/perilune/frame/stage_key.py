"""What a scene of the core is built from: configurations with equal keys share it."""

from __future__ import annotations

from typing import Any

from perilune import orbits
from perilune.bodies import ground
from perilune.config.body import Body
from perilune.config.schema import Config


def air_key(body: Body) -> tuple[Any, ...]:
    """All inputs of the tables of a body's atmosphere that may differ from frame to frame."""
    return (body.atmosphere, body.atmosphere and tuple(orbits.radii_m(body)))


def _body_key(body: Body) -> tuple[Any, ...]:
    """All inputs of a body in the scene that may differ from frame to frame."""
    return (
        body.color_map,
        body.shape,
        body.reflectance,
        body.photometry.maps if body.photometry else (),
        air_key(body),
        body.rings,
        body.clouds.map if body.clouds else None,
        body.is_geodetic,
        body.has_geodetic_clouds,
        ground.files(body),
        body.terrain,
        body.terrain and tuple(orbits.radii_m(body)),
    )


class StageKey:
    """The inputs of a scene. Their hash is computed once, because every frame looks its scene
    up."""

    def __init__(self, built_from: Any, config: Config) -> None:
        self._parts = (built_from, *map(_body_key, config.bodies.values()))
        self._hash = hash(self._parts)

    def __hash__(self) -> int:
        return self._hash

    def __eq__(self, other: object) -> bool:
        return isinstance(other, StageKey) and self._parts == other._parts
