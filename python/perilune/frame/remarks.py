"""Warnings about what model readers repair, clamp or ignore, once per model of a simulation.

Copies of a simulation in other processes know the warnings given before they were made. Of a
DataLoader's workers only the first one warns."""

from __future__ import annotations

import math
import warnings
from collections.abc import Iterable
from typing import TYPE_CHECKING

from perilune import _core
from perilune.base.workers import torch_worker
from perilune.config.errors import ConfigWarning, ModelWarning
from perilune.config.render import Render

if TYPE_CHECKING:
    from perilune.cost.budget import Budgeted


class Remarks:
    """The warnings of one simulation."""

    def __init__(self) -> None:
        self._told: set[tuple[str, str]] = set()
        self._missed: set[str] = set()

    def tell_of_key(self, where: str, text: str) -> None:
        """Warns about a key of the configuration once. where: file and key."""
        if (where, text) not in self._told:
            self._told.add((where, text))
            if torch_worker()[0] == 0:
                warnings.warn(f"{where}: {text}", ConfigWarning, stacklevel=2)

    def tell_of_ground(self, source: str, ground: _core.GroundUse) -> None:
        """Warns once of ground that is coarser than asked, and of a patch that is not in sight.

        source: the configuration's file."""
        if ground["widened"] > 1.0:
            self.tell_of_key(
                f"{source}: bodies.{ground['widened_body']}.terrain",
                "the view needs more tiles than the limit: cells are"
                f" {ground['widened']:.3g} times as wide as cells_per_pixel asks",
            )
        if ground["missed_body"] is not None:
            self.tell_of_key(
                f"{source}: bodies.{ground['missed_body']}.terrain.patch",
                "the camera sees none of it: all ground in sight is coarse. Move center_lon_lat_deg"
                " or the camera, or leave the patch out",
            )

    def tell_of_target(self, source: str, render: Render, missed: float) -> None:
        """Warns once of pixels that render.samples did not bring to the stated error.

        missed: their fraction of the frame; nan: samples were not chosen."""
        where = f"{source}: render.target_error_dn"
        if math.isnan(missed):
            self.tell_of_key(
                where,
                "is not used behind a lens with an aperture or in a frame with motion blur: every"
                f" pixel has render.samples, {render.samples}",
            )
        elif missed > 0.0 and where not in self._missed:
            self._missed.add(where)  # the fraction of the first frame alone is told
            self.tell_of_key(
                where,
                f"{100.0 * missed:.2g} % of the pixels are not within {render.target_error_dn:g} DN"
                f" after render.samples, {render.samples}; meta says how many of each frame",
            )

    def tell_of_budget(self, source: str, kept: Budgeted) -> None:
        """Warns once of a budget that no plan keeps."""
        where = f"{source}: render.time_budget_ms"
        if not kept.met and where not in self._missed:
            self._missed.add(where)
            self.tell_of_key(
                where,
                f"{kept.budget_ms:g} ms cannot be met: with all that has a bound left out a frame"
                f" is expected to take {kept.expected.ms:.3g} ms; meta says what each is",
            )

    def tell(self, where: str, path: str, lines: Iterable[str]) -> None:
        """Warns of each line about a file once.

        where: the configuration's file and the key of the object that uses the model."""
        for line in lines:
            if (path, line) in self._told:
                continue
            self._told.add((path, line))
            if torch_worker()[0] == 0:
                warnings.warn(f"{where}: {path}: {line}", ModelWarning, stacklevel=2)
