"""Figures without a window: all uses of matplotlib's backend in one place."""

from __future__ import annotations

from functools import lru_cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from perilune.simulation import Simulation

F64 = NDArray[np.float64]

PALETTE = ("#d1495b", "#00798c", "#edae49", "#66499c", "#3a7d44", "#30638e", "#c17817", "#8d99ae")
"""Colours of tracks, in the order of the configuration."""
BODY_GREY = (0.62, 0.65, 0.70)
_MAP_WIDTH = 720
"""Width in pixels of a colour map kept for a plot."""


def new_figure(width_in: float, height_in: float) -> Any:
    """An empty matplotlib figure; ImportError that says what to install without matplotlib."""
    try:
        import matplotlib.figure  # noqa: F401 (what may be missing)

        from perilune.show.plots.picture import Picture
    except ImportError:
        raise ImportError(
            "plots need matplotlib, which is not installed: pip install 'perilune[plot]'"
        ) from None
    return Picture(figsize=(width_in, height_in), layout="constrained")


@lru_cache(maxsize=8)
def _read_map(path: str) -> NDArray[np.uint8]:
    from PIL import Image

    with Image.open(path) as image:
        width, height = image.size
        small = (min(width, _MAP_WIDTH), max(1, round(min(width, _MAP_WIDTH) * height / width)))
        return np.asarray(image.convert("RGB").resize(small, Image.Resampling.BOX))


def color_map(sim: Simulation, body: str) -> NDArray[np.uint8] | None:
    """A body's colour map (H, W, 3), reduced, with longitude -180 in its first column; or None."""
    entry = sim.config.bodies[body]
    if entry.color_map is None:
        return None
    path: Path = sim.document.path(entry.color_map, f"bodies.{body}.color_map")
    image = _read_map(str(path))
    shift = round(entry.map_center_lon_deg / 360.0 * image.shape[1])
    return np.roll(image, shift, axis=1)


def length_unit(extent_m: float) -> tuple[str, float]:
    """Name and size in metres of a readable unit for a plot of this extent."""
    return ("km", 1e3) if extent_m >= 5e3 else ("m", 1.0)
