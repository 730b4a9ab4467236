"""The picture of a frame with labels drawn over it, where lens and shutter put them."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from perilune import _core
from perilune.base import colors, rotations
from perilune.config.errors import nearest
from perilune.show.preview import canvas
from perilune.show.preview.canvas import Line
from perilune.show.preview.overlay import axes_px, box_line

if TYPE_CHECKING:
    from perilune.sample import Sample
    from perilune.simulation import Simulation

U8 = NDArray[np.uint8]
F64 = NDArray[np.float64]
Placed = Callable[[Any], F64]
"""Pixels of the frame -> pixels of the picture."""

_AXIS_COLORS = ((255, 92, 82), (110, 220, 90), (90, 150, 255))
_SEEN, _HIDDEN, _RIM, _FLOW = (120, 235, 120), (255, 150, 60), (255, 210, 70), (90, 220, 255)
_ARROWS = 24
"""Arrows of the flow across the picture."""
_ELLIPSE = np.linspace(0.0, 2.0 * np.pi, 49)
_TINT = 0.45
"""Fraction of an instance's colour in the picture."""
_ROW_STEPS = 8


def _axes_at(sample: Sample, name: str, row: Any) -> F64:
    """(3, steps, 2): axes of an object; under a rolling shutter at the time of the rows that see
    them."""
    camera, rows = sample.camera, sample.meta.get("rows", [])
    axes = axes_px(row["R_m2c"], row["t_m2c"], row["bbox_visib"], camera)
    if not rows or not np.isfinite(axes).all():
        return axes
    numbers = [entry["row"] for entry in rows]
    for index in np.ndindex(axes.shape[:2]):
        for _ in range(_ROW_STEPS):
            line = float(np.clip(axes[index][1], numbers[0], numbers[-1]))
            k = min(int(np.searchsorted(numbers, line, side="right")) - 1, len(rows) - 2)
            share = (line - numbers[k]) / max(numbers[k + 1] - numbers[k], 1)
            a, b = (rows[i]["objects"][name] for i in (k, k + 1))
            turn = rotations.to_axis_angle(rotations.from_matrix(a["R_m2c"].T @ b["R_m2c"]))
            part = rotations.to_matrix(rotations.axis_angle(turn[0], share * turn[1]))
            t = a["t_m2c"] + share * (b["t_m2c"] - a["t_m2c"])
            axes[index] = axes_px(a["R_m2c"] @ part, t, row["bbox_visib"], camera)[index]
    return axes


def _axes(sim: Simulation, sample: Sample, placed: Placed) -> list[Line]:
    found: list[Line] = []
    for name, row in zip(sim.config.objects, sample.objects, strict=True):
        if row["px_count_visib"] == 0:
            continue
        for axis, color in zip(_axes_at(sample, name, row), _AXIS_COLORS, strict=True):
            found += [Line(placed(axis), colors.BACKGROUND, 4.0), Line(placed(axis), color, 2.0)]
    return found


def _boxes(sim: Simulation, sample: Sample, placed: Placed) -> list[Line]:
    edges = placed(np.array([sample.camera.width, sample.camera.height]) - 0.5) + 0.5
    rows = sample.objects[sample.objects["px_count_visib"] > 0]
    return [box_line(row, placed, edges) for row in rows]


def _craters(sim: Simulation, sample: Sample, placed: Placed) -> list[Line]:
    camera, found = sample.camera, []
    for table, rows in sim.ground_tables(sample).items():
        for row in rows if table == "craters" else ():
            cosine, sine = np.cos(row["angle_rad"]), np.sin(row["angle_rad"])
            along, across = row["semi_axes"][:, None] * [np.cos(_ELLIPSE), np.sin(_ELLIPSE)]
            pinhole = row["center"] + np.stack(
                [cosine * along - sine * across, sine * along + cosine * across], axis=-1
            )
            rays = np.concatenate([pinhole, np.ones((len(_ELLIPSE), 1))], axis=1)
            rays = np.ascontiguousarray(rays @ np.linalg.inv(camera.K).T)
            found.append(Line(placed(_core.project(camera.K, camera.lens, rays)), _RIM, 1.2))
    return found


def _keypoints(sim: Simulation, sample: Sample, placed: Placed) -> list[Line]:
    found = []
    for row in sample.keypoints[sample.keypoints["visible"] > 0]:
        if row["object"] in sim.config.bodies and row["occluded_by"] == row["instance_id"]:
            continue  # on the far side
        color = _SEEN if row["visible"] == 2 else _HIDDEN
        center = placed(row["xy"])
        ring = center + 4.0 * np.stack([np.cos(_ELLIPSE), np.sin(_ELLIPSE)], axis=1)
        found += [Line(ring, colors.BACKGROUND, 3.0), Line(ring, color, 1.5)]
    return found


def _flow(sim: Simulation, sample: Sample, placed: Placed) -> list[Line]:
    step = max(1, sample.camera.width // _ARROWS)
    found = []
    for y in range(step // 2, sample.camera.height, step):
        for x in range(step // 2, sample.camera.width, step):
            start = np.array([x, y], dtype=np.float64)
            ends = placed(np.stack([start, start + sample["flow"][y, x]]))
            way = ends[1] - ends[0]
            length = float(np.hypot(*way))
            if not length > 0.5:  # also nan
                continue
            head = min(5.0, 0.4 * length) * way / length
            side = np.array([-head[1], head[0]])
            tip = np.stack([ends[1] - head + 0.6 * side, ends[1], ends[1] - head - 0.6 * side])
            found += [Line(ends, _FLOW, 1.2), Line(tip, _FLOW, 1.2)]
    return found


_CHANNELS: dict[str, tuple[str, ...]] = {
    "axes": ("objects",),
    "boxes": ("objects",),
    "masks": ("instance",),
    "craters": ("crater_id", "instance", "position"),
    "keypoints": ("keypoints",),
    "flow": ("flow",),
}
_LINES: dict[str, Callable[[Simulation, Sample, Placed], list[Line]]] = {
    "axes": _axes,
    "boxes": _boxes,
    "craters": _craters,
    "keypoints": _keypoints,
    "flow": _flow,
}
OVERLAYS = tuple(_CHANNELS)
"""Names of what can be drawn over a picture."""


def _tinted(picture: U8, instance: NDArray[np.integer[Any]]) -> U8:
    """Silhouettes of what is seen, in the colours of their instances."""
    shown = instance > 0
    palette = colors.colored_ids(instance).astype(np.float64)
    mixed = picture.astype(np.float64)
    mixed[shown] += _TINT * (palette[shown] - mixed[shown])
    return np.rint(mixed).astype(np.uint8)


def render_overlay(
    sim: Simulation, index: int, names: Sequence[str], threads: int | None = None, scale: int = 1
) -> U8:
    """The picture (H, W, 3) of a frame with labels over it, `scale` times as large.

    names: of OVERLAYS, drawn in that order. ValueError for another; ConfigError where a label is
    not there, as keypoints of a configuration without any."""
    for name in names:
        if name not in OVERLAYS:
            raise ValueError(f"overlay: no '{name}'{nearest(name, OVERLAYS)}")
    asked = [channel for name in names for channel in _CHANNELS[name]]
    sample = sim.frame(index, list(dict.fromkeys(["rgb", *asked])), threads=threads)
    picture = sample["rgb"]
    if "masks" in names:
        picture = _tinted(picture, sample["instance"])
    height, width = picture.shape[:2]
    picture = canvas.resize(picture, scale * height, scale * width)

    def placed(pixels: Any) -> F64:
        return np.asarray((np.asarray(pixels, dtype=np.float64) + 0.5) * scale - 0.5)

    lines = [line for name in OVERLAYS if name in names and name in _LINES
             for line in _LINES[name](sim, sample, placed)]  # fmt: skip
    return canvas.draw_lines(picture, lines)
