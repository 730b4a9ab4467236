"""Renders a frame in as many passes of the core as its camera needs."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from numpy.typing import NDArray

from perilune import _core

COLOURS = frozenset(row["name"] for row in _core.CHANNELS if row["colour"])
"""Channels other than labels."""


def render(
    renderer: _core.Renderer,
    request: _core.FrameRequest,
    arrays: Mapping[str, NDArray[Any]],
    threads: int,
    undistorted: bool,
) -> _core.FrameResult:
    """Fills the arrays. undistorted: labels are those of a camera without distortion, which needs a
    separate pass if colour is requested too; times are sums over both."""
    colour = {name: array for name, array in arrays.items() if name in COLOURS}
    if not undistorted:
        return renderer.render(request, arrays, threads)
    pinhole: _core.FrameRequest = {**request, "lens": None}
    if not colour:
        return renderer.render(pinhole, arrays, threads)
    result = renderer.render(request, colour, threads)
    labels = {name: array for name, array in arrays.items() if name not in COLOURS}
    if labels:
        times = renderer.render(pinhole, labels, threads)["timings_s"]
        result["timings_s"] = {name: t + times[name] for name, t in result["timings_s"].items()}
    return result
