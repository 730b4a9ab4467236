"""Contact sheets of samples in Jupyter: `show(sample)`, and an extension for older notebooks.

Samples, their objects and plans, simulations, configurations, labels, graphs and plots display
themselves: end a cell with `sim[12]`, `sim`, `sim.plan(12)`, `sim.taxonomy`, `sim.config.camera` or
`sim.plot_orbits()`; nothing needs to be loaded (see perilune.show.display; plots need the extra
`plot`). `show(sample)` is a sheet with every channel in one picture, as from `perilune preview`.
After `%load_ext perilune.show.notebook` samples have it in addition to their tables, for viewers
without HTML.

Nothing of Jupyter is imported: a notebook asks an object for `_repr_png_`, and passes its shell to
`load_ipython_extension`."""

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
    """The contact sheet of a sample, which a notebook displays as the value of a cell."""

    def __init__(self, png: bytes) -> None:
        self.png = png

    def _repr_png_(self) -> bytes:
        return self.png


def show(sample: Sample, title: str = "", names: Names | None = None) -> Sheet:
    """The sheet of the channels that a sample holds. names: `sim.taxonomy.channel_names`."""
    return Sheet(preview.png_bytes(preview.draw(sample, title, names)))


def _sample_png(sample: Sample) -> bytes | None:
    """PNG of a sample's sheet; None, which leaves the text, without pixel channels."""
    return show(sample).png if len(sample) else None


def _figure_png(figure: Any) -> bytes:
    buffer = io.BytesIO()
    figure.savefig(buffer, format="png")
    return buffer.getvalue()


def load_ipython_extension(shell: Any) -> None:
    """Displays samples as their sheets, and matplotlib's figures as pictures."""
    formatter = shell.display_formatter.formatters["image/png"]
    formatter.for_type(_SAMPLE, _sample_png)
    formatter.for_type(_FIGURE, _figure_png)  # by name: matplotlib need not be there


def unload_ipython_extension(shell: Any) -> None:
    """Reverts load_ipython_extension."""
    formatter = shell.display_formatter.formatters["image/png"]
    formatter.pop(_SAMPLE, None)
    formatter.pop(_FIGURE, None)
