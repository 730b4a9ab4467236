"""Sheets of samples in Jupyter: `show(sample)`, and for older notebooks an extension.

Samples, their objects and plans, simulations, configurations, labels, graphs and plots show
themselves: a cell ends in `sim[12]`, `sim`, `sim.plan(12)`, `sim.taxonomy`, `sim.config.camera` or
`sim.plot_orbits()`, and nothing is loaded (see perilune.show.display; plots need the extra `plot`).
`show(sample)` is the sheet with every channel in one picture, as `perilune preview` draws it; after
`%load_ext perilune.show.notebook` samples have it beside their tables, for what shows no HTML.

Nothing of Jupyter is imported: a notebook asks an object for `_repr_png_`, and hands its shell to
`load_ipython_extension`.
"""

from __future__ import annotations

import io
from typing import TYPE_CHECKING, Any

from perilune.show import preview
from perilune.show.preview.panels import Names

if TYPE_CHECKING:
    from perilune.sample import Sample

_SAMPLE = "perilune.sample.Sample"
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
    formatter.for_type(_SAMPLE, _sample_png)
    formatter.for_type(_FIGURE, _figure_png)  # by name: matplotlib need not be there


def unload_ipython_extension(shell: Any) -> None:
    """Undoes it."""
    formatter = shell.display_formatter.formatters["image/png"]
    formatter.pop(_SAMPLE, None)
    formatter.pop(_FIGURE, None)
