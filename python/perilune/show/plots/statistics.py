"""Plot of the distributions of a written dataset, as `perilune stats` prints them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from perilune.show.plots.figures import PALETTE, new_figure

_COLUMNS, _BINS = 3, 24


def plot_statistics(objects: Mapping[int, Mapping[str, Sequence[float]]], title: str = "") -> Any:
    """Histograms of each quantity, one colour an object. objects: id -> quantity -> values, as
    perilune.export.stats.measured gives them. Returns the Figure; ValueError without an object."""
    if not objects:
        raise ValueError("the dataset has no instance: there is nothing to draw")
    quantities = list(next(iter(objects.values())))
    lines = -(-len(quantities) // _COLUMNS)
    figure = new_figure(3.4 * _COLUMNS, 2.4 * lines)
    for place, quantity in enumerate(quantities, start=1):
        axes = figure.add_subplot(lines, _COLUMNS, place)
        values = [columns[quantity] for columns in objects.values()]
        colors = [PALETTE[k % len(PALETTE)] for k in range(len(values))]
        labels = [f"object {number}" for number in objects]
        axes.hist(values, bins=_BINS, stacked=True, color=colors, label=labels)
        axes.set_xlabel(quantity)
        if place == 1:
            axes.set_ylabel("instances")
            axes.legend(fontsize="small")
    figure.suptitle(title)
    return figure
