"""Renders a frame in as many passes of the core as its camera needs."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from numpy.typing import NDArray

from perilune import _core
from perilune.frame.motion import NEIGHBOURS

COLOURS = frozenset(row["name"] for row in _core.CHANNELS if row["colour"])
"""Channels other than labels."""


def render(
    renderer: _core.Renderer,
    request: _core.FrameRequest,
    arrays: Mapping[str, NDArray[Any]],
    threads: int,
    undistorted: bool,
    colours: _core.FrameRequest | None = None,
) -> _core.FrameResult:
    """Fills the arrays. undistorted: labels are those of a camera without distortion. colours: the
    request of what is no label, if it is another. Either needs a separate pass if both colour and
    labels are asked for; times are sums over both."""
    colour = {name: array for name, array in arrays.items() if name in COLOURS}
    labelled = _without_lens(request) if undistorted else request
    if not colour:
        return renderer.render(labelled, arrays, threads)
    if not undistorted and colours is None:
        return renderer.render(request, arrays, threads)
    result = renderer.render(colours or request, colour, threads)
    labels = {name: array for name, array in arrays.items() if name not in COLOURS}
    if labels:
        times = renderer.render(labelled, labels, threads)["timings_s"]
        result["timings_s"] = {name: t + times[name] for name, t in result["timings_s"].items()}
    return result


def _without_lens(request: _core.FrameRequest) -> _core.FrameRequest:
    """The same for cameras without distortion, in the frames that labels lead to, too."""
    pinhole: _core.FrameRequest = {**request, "lens": None}
    for key in NEIGHBOURS:
        other = request.get(key)
        if other is not None:
            pinhole[key] = {**other, "lens": None}
    return pinhole


def expose(request: _core.FrameRequest, metered: _core.FrameResult) -> None:
    """Applies the exposure that was metered on another frame."""
    sensor = dict(request["sensor"] or {})
    sensor.update(auto_time=None, exposure_s=metered["exposure_s"], gain=metered["gain_e_dn"])
    request["sensor"] = sensor
