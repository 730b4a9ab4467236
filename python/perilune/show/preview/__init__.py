"""A contact sheet of a frame: every channel with labels, for viewing."""

from __future__ import annotations

import io
import os
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from perilune import _core
from perilune.document.references import pixel_channels
from perilune.show.preview.overlays import OVERLAYS, render_overlay
from perilune.show.preview.panels import Names
from perilune.show.preview.sheet import draw_sheet

if TYPE_CHECKING:
    from perilune.sample import Sample
    from perilune.simulation import Simulation

__all__ = ["OVERLAYS", "draw", "png_bytes", "render_overlay", "render_sheet", "save"]


def draw(sample: Sample, title: str = "", names: Names | None = None) -> NDArray[np.uint8]:
    """The sheet of the channels that `sample` holds, (H, W, 3).

    title: the heading; parts after " | " are smaller. names: names of ids per channel ("instance",
    "part", "semantic/0") for the legends; ids without a name are shown as numbers."""
    units = {channel["name"]: channel["unit"] for channel in _core.CHANNELS}
    return draw_sheet(sample, title or frame_title(sample), names or {}, units)


def frame_title(sample: Sample, name: str = "frame") -> str:
    """The heading of a sample: its frame, sensor, date, seed and size."""
    camera, meta = sample.camera, sample.meta
    sensor = f" {camera.sensor}" if camera.sensor is not None else ""
    return (
        f"{name} {meta['index']}{sensor} | {meta['time_utc']} | seed {meta['seed']} | "
        f"{camera.width} x {camera.height}"
    )


def render_sheet(sim: Simulation, index: int, threads: int | None = None) -> NDArray[np.uint8]:
    """Renders a frame with every available channel, and draws its sheet."""
    names = pixel_channels(sim.config)
    sample = sim.frame(index, channels=[*names, "objects"], threads=threads)
    return draw(sample, frame_title(sample, sim.config.name), sim.taxonomy.channel_names)


def save(sheet: NDArray[np.uint8], path: str | Path) -> None:
    """Writes a sheet as PNG; OSError if it cannot be written, without leaving a file."""
    if Path(path).suffix.lower() != ".png":
        raise ValueError(f"{path}: a sheet is written as PNG; the name must end in .png")
    _core.png_write(os.fspath(path), sheet)


def png_bytes(sheet: NDArray[np.uint8]) -> bytes:
    """A sheet as the bytes of a PNG file."""
    file = io.BytesIO()
    Image.fromarray(sheet).save(file, "png")
    return file.getvalue()
