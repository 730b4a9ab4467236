"""Warns of a camera that does not see its target, which mostly means a wrong sign or unit."""

from __future__ import annotations

from typing import Any

import numpy as np

from perilune.config import Config

FRAMES = 8
"""Number of frames without the target, from the first on, after which to warn."""


def target_of(config: Config) -> str | None:
    """The spacecraft that the camera's trajectory refers to; None for a body, or without a
    target."""
    target = getattr(config.camera.trajectory, "target", None)
    return target if target in config.spacecraft else None


class Unseen:
    """Counts the first frames of a simulation in this process."""

    def __init__(self) -> None:
        self._frames = 0
        self._done = False

    def look(self, config: Config, objects: np.ndarray[Any, Any] | None) -> str | None:
        """The warning after a frame, if any. objects: its labels, in the order of the
        spacecraft."""
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
