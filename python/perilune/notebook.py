"""Samples as pictures in Jupyter: `%load_ext perilune.notebook`, or `show(sample)`.

Nothing of Jupyter is imported: a notebook asks an object for `_repr_png_`, and hands its shell to
`load_ipython_extension`.
"""

from __future__ import annotations

from typing import Any

from perilune import preview
from perilune.preview.panels import Names
from perilune.sample import Sample


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


def load_ipython_extension(shell: Any) -> None:
    """Makes samples show as their sheets."""
    shell.display_formatter.formatters["image/png"].for_type(Sample, _sample_png)


def unload_ipython_extension(shell: Any) -> None:
    """Undoes it."""
    shell.display_formatter.formatters["image/png"].pop(Sample, None)
