"""A frame in a notebook: pictures with names, shapes and units, objects, plan."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from perilune import _core
from perilune.base.html import flat, folded, heading, picture, swatch, table, whole
from perilune.frame.html import objects_table, plan_table
from perilune.show.preview import canvas, png_bytes
from perilune.show.preview.panels import Panel
from perilune.show.preview.sheet import panels_of

if TYPE_CHECKING:
    from perilune.sample import Sample

_WIDTH = 200
_LARGE = 412
_TALLEST = 1.4
_SWATCHES = 6


def _caption(panel: Panel, channel: str, values: NDArray[Any] | None) -> Iterator[str]:
    if values is not None:
        unit = next((row["unit"] for row in _core.CHANNELS if row["name"] == channel), "")
        shape = " x ".join(map(str, values.shape))
        yield f"{values.dtype} {shape}{f', {unit}' if unit not in ('', '1') else ''}"
    if panel.bar is not None:
        yield f"{panel.bar[0]} to {panel.bar[1]}"
    elif panel.swatches:
        shown = "".join(swatch(color.tolist(), name) for color, name in panel.swatches[:_SWATCHES])
        more = len(panel.swatches) - _SWATCHES
        yield shown + (f"+{more}" if more > 0 else "")
    elif panel.text and values is None:
        yield panel.text


def _thumbnail(panel: Panel, channel: str, values: NDArray[Any] | None, width: int) -> str:
    size = canvas.fitted(panel.image.shape, (round(width * _TALLEST), width))
    image = canvas.resize(panel.image, *size)
    lines = list(_caption(panel, channel, values))
    return picture(png_bytes(np.ascontiguousarray(image)), panel.title, lines, size[1])


def _channel(title: str, sample: Sample) -> str:
    """The channel that a panel belongs to."""
    name = title.split("/")[0].split(" (")[0]
    return name if name in sample else ""


def sample_html(sample: Sample) -> str:
    """Thumbnails of all channels, the objects, and further data of the frame."""
    camera, meta = sample.camera, sample.meta
    sensor = f", sensor {camera.sensor}" if camera.sensor is not None else ""
    seed = f"seed {meta['seed']}" if "seed" in meta else ""
    size = f"{camera.width} x {camera.height}"
    dim = ", ".join(part for part in (str(meta.get("time_utc", "")), seed, size) if part)
    parts = [heading(f"Frame {meta.get('index', '?')}{sensor}", dim)]
    for panel in panels_of(sample, (_LARGE * 2, _LARGE)):
        channel = _channel(panel.title, sample)
        values = sample[channel] if channel else None
        is_first = panel.title in ("rgb", "visible boxes and axes", "sensor_rgb")
        parts.append(_thumbnail(panel, channel, values, _LARGE if is_first else _WIDTH))
    if "masks" in sample:
        masks = sample["masks"]
        shape = " x ".join(map(str, masks.shape))
        parts.append(heading("masks", f"{masks.dtype} {shape}, a silhouette an object"))
    if sample.has_objects:
        parts.append(
            folded(f"objects ({len(sample.objects)})", objects_table(sample.objects), True)
        )
    drawn = list(meta.get("drivers", {}).items())
    rest = {k: v for k, v in meta.items() if k not in ("drivers", "timings_s")}
    kept = sum(bool(row["on"]) for row in sample.plan)
    parts.append(folded(f"drivers ({len(drawn)})", table(("key", "value"), drawn)))
    parts.append(folded("meta", table(("key", "value"), flat(rest))))
    parts.append(folded(f"plan ({kept} on)", plan_table(sample.plan)))
    return whole(*parts)
