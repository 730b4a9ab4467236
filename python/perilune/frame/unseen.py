"""Tells of a camera whose target is not in its frames: a sign or a unit that is wrong, mostly."""

from __future__ import annotations

from typing import Any

import numpy as np

from perilune.config import Config

FRAMES = 8
"""So many frames without the target, from the first on, are told of."""


def target_of(config: Config) -> str | None:
    """The spacecraft that the camera's trajectory is about; None for a body, or without one."""
    target = getattr(config.camera.trajectory, "target", None)
    return target if target in config.spacecraft else None


class Unseen:
    """Counts the first frames of a simulation in this process."""

    def __init__(self) -> None:
        self._frames = 0
        self._done = False

    def look(self, config: Config, objects: np.ndarray[Any, Any] | None) -> str | None:
        """What is to be told after a frame. objects: its labels, in the order of the spacecraft."""
        if self._done or objects is None:
            return None
        target = target_of(config)
        if target is None or objects["px_count_visib"][list(config.spacecraft).index(target)] > 0:
            self._done = True
            return None
        self._frames += 1
        if self._frames < FRAMES:
            return None
        self._done = True
        return f"'{target}' is visible in none of the first {FRAMES} frames that were made"
