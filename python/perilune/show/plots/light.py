"""Plot of sunlight over time, with eclipses."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING, Any

import numpy as np

from perilune.show.plots.figures import PALETTE, new_figure

if TYPE_CHECKING:
    from perilune.orbits.sunlight import LightCurve
    from perilune.simulation import Simulation

_HOUR_S, _MINUTE_S = 3600.0, 60.0
_HEADROOM = 1.08
_POINTS = 60


def plot_light_curve(
    sim: Simulation,
    names: Iterable[str],
    frames: Iterable[int],
    figure: Any = None,
    place: Any = 111,
    title: str | None = None,
    legend: bool = True,
    **options: Any,
) -> Any:
    """Irradiance on a surface that faces the Sun, W/m^2 in the green band, against time.

    names: bodies, spacecraft or `camera`. frames: indices, in order; points are connected. options:
    as for Simulation.light_curve. figure, place: as in plot_orbits. The background is grey where a
    body covers a part of the Sun as seen from the first of the names. Returns the Figure."""
    listed = list(frames)
    curves = [sim.light_curve(name, listed, **options) for name in names]
    if not curves or not listed:
        raise ValueError("names, frames: at least one of each")
    target = figure if figure is not None else new_figure(8.0, 3.6)
    axes = target.add_subplot(place)
    first = curves[0].t_s[0]
    unit, unit_s = _unit(float(np.ptp(curves[0].t_s)))
    for number, curve in enumerate(curves):
        color = PALETTE[number % len(PALETTE)]
        t = (curve.t_s - first) / unit_s
        # Curves that agree lie on each other: later ones are dashed. Few frames are points, too:
        # a line of one has no length.
        style = {"linestyle": "--" if number else "-", "marker": "o" if len(t) <= _POINTS else ""}
        light = curve.irradiance_w_m2[:, 1]
        axes.plot(t, light, color=color, label=curve.name, markersize=3.0, **style)
    _shade(axes, curves[0], unit_s)
    begin = sim.system(listed[0]).setting.epoch.after(float(first)).utc()
    axes.set_xlabel(f"{unit} after {begin}")
    axes.set_ylabel("irradiance (W/m$^2$)")
    # Full sunlight is a level line: the limits of its own range would hide it under the frame.
    most = max(float(curve.irradiance_w_m2[:, 1].max()) for curve in curves)
    axes.set_ylim(0.0, _HEADROOM * most if most > 0.0 else 1.0)
    axes.set_title(title if title is not None else "Sunlight")
    if legend:
        axes.legend(loc="best", fontsize=8)
    return target


def _unit(span_s: float) -> tuple[str, float]:
    if span_s >= 3.0 * _HOUR_S:
        return "hours", _HOUR_S
    return ("minutes", _MINUTE_S) if span_s >= 3.0 * _MINUTE_S else ("seconds", 1.0)


def _shade(axes: Any, curve: LightCurve, unit_s: float) -> None:
    """Grey background during eclipses."""
    t = (curve.t_s - curve.t_s[0]) / unit_s
    hidden = curve.hides.any(axis=1)
    top = axes.get_xaxis_transform()
    axes.fill_between(t, 0.0, 1.0, where=hidden, color="0.9", transform=top, linewidth=0.0)
