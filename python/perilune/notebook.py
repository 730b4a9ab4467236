"""Samples and plots as pictures in Jupyter: `%load_ext perilune.notebook`, or `show(sample)`.

After that a cell that ends in `sim[12]`, `sim.plot_orbits(frames=range(10))`,
`sim.plot_trajectory(frames=range(10))` or `sim.ground_track(frames=range(100))` shows its picture,
without matplotlib's own machinery for notebooks (plots need the extra `plot`). A graph of a
material, `sim.graph("foil")`, shows itself.

Nothing of Jupyter is imported: a notebook asks an object for `_repr_png_`, and hands its shell to
`load_ipython_extension`.
"""

from __future__ import annotations

import io
from typing import Any

from perilune import preview
from perilune.preview.panels import Names
from perilune.sample import Sample

_FIGURE = "matplotlib.figure.Figure"


class Sheet:
    """The sheet of a sample; a notebook shows it as the value of a cell."""

    def __init__(self, png: bytes) -> None:
        self.png = png

    def _repr_png_(self) -> bytes:
        return self.png


def show(sample: Sample, title: str = "", names: Names | None = None) -> Sheet:
    """The sheet of the channels a sample holds. names: `sim.taxonomy.channel_names`."""
    return Sheet(preview.png_bytes(preview.draw(sample, title, names)))


def _sample_png(sample: Sample) -> bytes | None:
    """None, for a sample without pixel channels, leaves its text."""
    return show(sample).png if len(sample) else None


def _figure_png(figure: Any) -> bytes:
    buffer = io.BytesIO()
    figure.savefig(buffer, format="png")
    return buffer.getvalue()


def load_ipython_extension(shell: Any) -> None:
    """Makes samples show as their sheets, and matplotlib's figures as pictures."""
    formatter = shell.display_formatter.formatters["image/png"]
    formatter.for_type(Sample, _sample_png)
    formatter.for_type(_FIGURE, _figure_png)  # by name: matplotlib need not be there


def unload_ipython_extension(shell: Any) -> None:
    """Undoes it."""
    formatter = shell.display_formatter.formatters["image/png"]
    formatter.pop(Sample, None)
    formatter.pop(_FIGURE, None)
