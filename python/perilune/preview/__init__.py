"""One picture of a frame with every channel, labelled: for looking, not for learning from."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from perilune import _core
from perilune.preview.panels import Names
from perilune.preview.sheet import draw_sheet

if TYPE_CHECKING:
    from perilune.sample import Sample

__all__ = ["draw"]


def draw(sample: Sample, title: str = "", names: Names | None = None) -> NDArray[np.uint8]:
    """The sheet of the channels that `sample` holds, (H, W, 3).

    title: the heading; parts after " | " are set smaller. names: names of ids per channel
    ("instance", "part", "semantic/0") for the legends; ids are shown where a name is missing.
    """
    units = {channel["name"]: channel["unit"] for channel in _core.CHANNELS}
    return draw_sheet(sample, title, names or {}, units)
