"""Plot of what accuracy costs: error against time of a frame's knobs and of whole settings."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

from perilune.show.plots.figures import PALETTE, new_figure

if TYPE_CHECKING:
    from perilune.cost.report import Point, Report

_LEAST_DN = 0.01
"""Errors below it are drawn at it: axes are logarithmic."""
_MARKS = "osD^vP*X"
_CURVES = 3
"""A knob with so many settings or more is a curve; switches are bars."""
_BARS = 14


def plot_cost(report: Report, figure: Any = None) -> Any:
    """Left: error against CPU time. A curve is a knob with all others exact; the thick line is the
    front of whole settings, which combine knobs. Right: what each effect errs when it is left out,
    and the time that this saves. Returns the Figure."""
    target = figure if figure is not None else new_figure(11.0, 4.8)
    left, right = target.subplots(1, 2, width_ratios=(3, 2))
    knobs: dict[str, list[Point]] = {}
    for point in report.points:
        if math.isfinite(point.rmse_dn):
            knobs.setdefault(point.knob, []).append(point)
    curves = {name: rows for name, rows in knobs.items() if len(rows) >= _CURVES}
    for number, (name, rows) in enumerate(curves.items()):
        style = {"color": PALETTE[number % len(PALETTE)], "marker": _MARKS[number % len(_MARKS)]}
        left.plot([p.cpu_ms for p in rows], [_dn(p.rmse_dn) for p in rows], label=name,
                  linewidth=1.0, markersize=4.5, **style)  # fmt: skip
    _settings(left, report)
    left.axhline(report.reference_dn, color="0.6", linewidth=0.8, linestyle=":")
    left.set_xscale("log")
    left.set_yscale("log")
    left.set_xlabel("CPU time of a frame (ms)")
    left.set_ylabel("RMS error (DN)")
    left.set_title(f"{report.name}, frame {report.index}, {report.size[0]}x{report.size[1]}")
    left.grid(which="both", color="0.92", linewidth=0.6)
    left.legend(fontsize=7.5, loc="best")
    _bars(right, {name: rows for name, rows in knobs.items() if len(rows) < _CURVES})
    return target


def _dn(error: float) -> float:
    return max(error, _LEAST_DN)


def _settings(axes: Any, report: Report) -> None:
    front = [setting for _, setting in report.front]
    line = {"color": "black", "linewidth": 2.2, "marker": "o", "markersize": 5}
    star = {"color": "black", "linestyle": "", "marker": "*", "markersize": 14}
    times, errors = [s.cpu_ms for s in front], [_dn(s.rmse_dn) for s in front]
    axes.plot(times, errors, label="combined: front", zorder=5, **line)
    own = [report.own.cpu_ms], [_dn(report.own.rmse_dn)]
    axes.plot(*own, label="the configuration as it is", zorder=6, **star)


def _bars(axes: Any, switches: dict[str, list[Point]]) -> None:
    """Effects by what they err when left out, most first, with their part of the time."""
    rows = sorted(switches.items(), key=lambda item: -item[1][0].rmse_dn)[:_BARS][::-1]
    for at, (_, (off, on)) in enumerate(rows):
        axes.barh(at, _dn(off.rmse_dn), left=0.0, color=PALETTE[1], height=0.7)
        saved = 100.0 * (1.0 - off.cpu_ms / on.cpu_ms) if on.cpu_ms > 0.0 else 0.0
        axes.text(_dn(off.rmse_dn) * 1.15, at, f"{saved:+.0f} %", va="center", fontsize=7.5)
    axes.set_xscale("log")
    low, high = _LEAST_DN, max([_dn(r[0].rmse_dn) for _, r in rows], default=1.0)
    axes.set_xlim(low, 6.0 * max(high, 1.0))
    axes.set_yticks(range(len(rows)), [name for name, _ in rows], fontsize=8)
    axes.set_xlabel("RMS error when left out (DN); %: time that it saves")
    axes.set_title("Effects, one left out at a time")
