"""Plots of orbits, camera paths, ground tracks, sunlight and what accuracy costs.

They need matplotlib (extra `plot`). Each function returns a matplotlib Figure and opens no window:
call `figure.savefig(...)`, or end a notebook's cell with it."""

from __future__ import annotations

from perilune.show.plots.cost import plot_cost
from perilune.show.plots.ground import plot_ground_track
from perilune.show.plots.light import plot_light_curve
from perilune.show.plots.orbits import plot_orbits
from perilune.show.plots.trajectory import plot_trajectory

__all__ = [
    "plot_cost",
    "plot_ground_track",
    "plot_light_curve",
    "plot_orbits",
    "plot_trajectory",
]
