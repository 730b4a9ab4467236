"""Representations of samples and simulations in notebooks.

Their methods `_repr_html_` call this package, which imports nothing of Jupyter. Tables and small
pictures are self-contained HTML in the colours of the page around it."""

from perilune.show.display.frame import sample_html
from perilune.show.display.scene import simulation_html

__all__ = ["sample_html", "simulation_html"]
