"""Channels of motion: which other frames they lead to, and what of them has no motion."""

from __future__ import annotations

from collections.abc import Callable, Collection
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from perilune import _core
from perilune.base.timeline import Timeline
from perilune.config import Config
from perilune.document.references import TO_NEXT, TO_PREVIOUS
from perilune.world import World

Neighbour = Literal["next", "previous"]
NEIGHBOURS: dict[Neighbour, int] = {"next": 1, "previous": -1}
"""Key of the core's request -> frames of the same sensor from this one to it."""
_CHANNELS: dict[Neighbour, frozenset[str]] = {
    "next": frozenset(TO_NEXT),
    "previous": frozenset(TO_PREVIOUS),
}


ALONE = "1: every frame is a scene of its own, so that no channel of motion has a value"
"""The warning where time.frames_per_scene is 1."""


def _needs(channels: Collection[str], neighbour: Neighbour) -> bool:
    """Whether any of the channels leads to this frame."""
    return not _CHANNELS[neighbour].isdisjoint(channels)


def _changed_bodies(here: Config, there: Config) -> NDArray[np.bool_]:
    """(bodies,): whether a body has another shape or other ground in the other frame, so that no
    point of it is the same."""
    return np.array(
        [
            (body.shape, body.terrain) != (there.bodies[name].shape, there.bodies[name].terrain)
            for name, body in here.bodies.items()
        ],
        dtype=np.bool_,
    )


def add_neighbours(
    request: _core.FrameRequest,
    scene: World,
    channels: Collection[str],
    timeline: Timeline,
    world: Callable[[int], World],
    placed: Callable[[World], _core.FrameRequest],
) -> None:
    """Adds the frames of the scene that the channels lead to. world: of an index. placed: its
    request."""
    for key, frames in NEIGHBOURS.items():
        index = timeline.beside(scene.index, frames)
        if index is None or not _needs(channels, key):
            continue
        try:
            other = world(index)
            there = placed(other)
        except Exception as error:
            error.add_note(f"frame {index}, to which channels of frame {scene.index} lead")
            raise
        there["changed_bodies"] = _changed_bodies(scene.config, other.config)
        request[key] = there
