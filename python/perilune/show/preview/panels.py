"""Panels of the sheet: one function per kind of channel."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from perilune.base import colors

U8 = NDArray[np.uint8]
Array = NDArray[Any]
Names = Mapping[str, Mapping[int, str]]
"""Names of ids: channel ("part", "semantic/0") -> id -> name."""


@dataclass(frozen=True)
class Panel:
    """A titled picture with its legend."""

    title: str
    image: U8  # (H, W, 3)
    text: str = ""
    bar: tuple[str, str] | None = None  # what the two ends of the ramp stand for
    swatches: Sequence[tuple[U8, str]] = field(default_factory=tuple)  # colour, name


@dataclass(frozen=True)
class Context:
    """Inputs of the panels besides their own channel."""

    hit: NDArray[np.bool_] | None  # (H, W), pixels where something is hit; None: not known
    instance: NDArray[np.integer] | None  # (H, W)
    names: Names
    units: Mapping[str, str]


def format_value(value: float, unit: str) -> str:
    """Four digits and the unit; long distances in kilometres."""
    if unit == "1":
        unit = ""
    if unit == "m" and abs(value) >= 1e4:
        value, unit = value / 1e3, "km"
    return f"{value:.4g} {unit}".rstrip()


def _valid(values: Array, context: Context) -> NDArray[np.bool_]:
    """Pixels with a value: finite, and hit if that is known."""
    finite = np.asarray(np.isfinite(values))
    if values.ndim == 3:
        finite = np.asarray(finite.all(axis=2))
    return finite if context.hit is None else np.asarray(finite & context.hit)


def scalar_panel(name: str, values: Array, context: Context) -> list[Panel]:
    """A quantity (H, W) on the ramp, with its smallest and largest value."""
    valid = _valid(values, context)
    unit = context.units.get(name, "")
    scaled = colors.scale_values(values, valid, spread=unit != "rad")
    image = colors.colored_values(scaled, valid)
    if scaled is None:
        return [Panel(name, image, text="no value in view")]
    title = f"{name} (log)" if scaled.rule == "log" else name
    ends = (format_value(scaled.low, unit), format_value(scaled.high, unit))
    return [Panel(title, image, bar=ends)]


def layers_panel(name: str, values: Array, context: Context) -> list[Panel]:
    """Quantities (H, W, n): a panel per layer."""
    titles = [f"{name}/{layer}" for layer in range(values.shape[2])]
    named = replace(context, units=dict.fromkeys(titles, context.units.get(name, "")))
    return [
        scalar_panel(title, values[:, :, layer], named)[0] for layer, title in enumerate(titles)
    ]


def parts_panel(name: str, values: Array, context: Context) -> list[Panel]:
    """Parts of a whole (H, W), or a panel per layer of (H, W, n): black is none, white all."""
    if values.ndim == 3:
        titles = [f"{name}/{layer}" for layer in range(values.shape[2])]
        return [
            parts_panel(title, values[:, :, layer], context)[0]
            for layer, title in enumerate(titles)
        ]
    grey = np.rint(255.0 * values.clip(0.0, 1.0)).astype(np.uint8)
    text = f"black 0, white 1; up to {values.max():.3g}"
    return [Panel(name, np.repeat(grey[:, :, None], 3, axis=2), text=text)]


def image_panel(name: str, values: Array, context: Context) -> list[Panel]:
    """Display-encoded pixels as they are."""
    return [
        Panel(name, np.ascontiguousarray(values), text=f"{values.shape[1]} x {values.shape[0]}")
    ]


def digital_panel(name: str, values: Array, context: Context) -> list[Panel]:
    """Digital numbers, stretched from 0 to the largest."""
    largest = max(1, int(values.max()))
    image = np.rint(values * (255.0 / largest)).astype(np.uint8)
    if image.ndim == 2:
        image = np.repeat(image[:, :, None], 3, axis=2)
    return [Panel(name, image, text=f"0 .. {largest} DN")]


def _titles(name: str, values: Array, context: Context) -> list[str]:
    """Titles of the bands of a channel."""
    known = context.names.get("bands", {})
    return [f"{name}/{known.get(band, band)}" for band in range(values.shape[2])]


def raw_panel(name: str, values: Array, context: Context) -> list[Panel]:
    """Digital numbers (H, W), or a panel for each plane of (H, W, B)."""
    if values.ndim == 2:
        return digital_panel(name, values, context)
    return [
        digital_panel(title, values[:, :, plane], context)[0]
        for plane, title in enumerate(_titles(name, values, context))
    ]


def radiance_panel(name: str, values: Array, context: Context) -> list[Panel]:
    """Linear light: white is the 99.5th percentile of the lit pixels, gamma 2.2."""
    finite = np.nan_to_num(values.astype(np.float64), nan=0.0, posinf=0.0, neginf=0.0)
    lit = finite[finite > 0.0]
    white = float(np.percentile(lit, 99.5)) if lit.size else 1.0
    image = np.rint(255.0 * (finite / white).clip(0.0, 1.0) ** (1 / 2.2)).astype(np.uint8)
    if image.ndim == 2:
        image = np.repeat(image[:, :, None], 3, axis=2)
    top = format_value(float(finite.max()), context.units.get(name, ""))
    return [Panel(name, image, text=f"0 .. {top}")]


def normal_panel(name: str, values: Array, context: Context) -> list[Panel]:
    """Unit vectors of the camera frame: right red, up green, towards the camera blue."""
    valid = _valid(values, context) & (np.abs(values) > 0).any(axis=2)
    image = np.empty(values.shape, dtype=np.uint8)
    image[:] = colors.EMPTY
    turned = values[valid] * np.array([1.0, -1.0, -1.0])
    image[valid] = np.rint(127.5 + 127.5 * turned.clip(-1.0, 1.0)).astype(np.uint8)
    return [Panel(name, image, text="right, up, to camera")]


def vector_panel(name: str, values: Array, context: Context) -> list[Panel]:
    """Coordinates as colours, stretched within each instance."""
    valid = _valid(values, context) & (np.abs(np.nan_to_num(values)) > 0).any(axis=2)
    image = colors.stretch_by_group(values, valid, context.instance)
    return [Panel(name, image, text="x y z as r g b" if valid.any() else "no value in view")]


def flow_panel(name: str, values: Array, context: Context) -> list[Panel]:
    """Motion: the direction is the hue, the length the strength."""
    valid = np.isfinite(values).all(axis=2)
    image = np.empty((*valid.shape, 3), dtype=np.uint8)
    image[:] = colors.EMPTY
    vectors = values[valid].astype(np.float64)
    length = np.hypot(vectors[:, 0], vectors[:, 1])
    longest = float(length.max()) if length.size else 0.0
    strength = length / longest if longest > 0.0 else length
    angle = np.arctan2(vectors[:, 1], vectors[:, 0])
    lab = np.stack(
        [0.35 + 0.4 * strength, 0.15 * strength * np.cos(angle), 0.15 * strength * np.sin(angle)],
        axis=-1,
    )
    image[valid] = colors.oklab_to_srgb(lab)
    return [Panel(name, image, text=f"up to {format_value(longest, 'pixels')}")]


def id_panel(name: str, values: Array, context: Context) -> list[Panel]:
    """Ids (H, W) in stable colours, the most frequent ones named."""
    ids, counts = np.unique(values, return_counts=True)
    order = np.argsort(-counts, kind="stable")
    shown = [int(ids[index]) for index in order if ids[index] != 0]
    names = context.names.get(name, {})
    palette = colors.id_colors(np.array(shown, dtype=np.int64))
    swatches = [
        (color, names.get(number, str(number)))
        for color, number in zip(palette, shown, strict=True)
    ]
    text = "" if shown else "nothing in view"
    return [Panel(name, colors.colored_ids(values), text=text, swatches=swatches)]


def levels_panel(name: str, values: Array, context: Context) -> list[Panel]:
    """Ids (H, W, L): a panel per level, whose names are its own or those of all."""
    titles = [f"{name}/{level}" for level in range(values.shape[2])]
    shared = dict.fromkeys(titles, context.names[name]) if name in context.names else {}
    named = replace(context, names={**shared, **context.names})
    return [id_panel(title, values[:, :, level], named)[0] for level, title in enumerate(titles)]


def bands_panel(name: str, values: Array, context: Context) -> list[Panel]:
    """Radiances in bands (H, W, B): a panel per band."""
    titles = _titles(name, values, context)
    named = replace(context, units=dict.fromkeys(titles, context.units.get(name, "")))
    return [
        radiance_panel(title, values[:, :, band], named)[0] for band, title in enumerate(titles)
    ]


_HAZARD_COLORS = {1: (224, 152, 62), 2: (96, 134, 214), 4: (204, 70, 70)}
_SAFE = (70, 146, 92)


def hazard_panel(name: str, values: Array, context: Context) -> list[Panel]:
    """Safe ground green; of several hazards the mean of their colours."""
    image = np.empty((*values.shape, 3), dtype=np.uint8)
    image[:] = colors.EMPTY
    names = context.names.get(name, {})
    swatches = []
    for number in np.unique(values[values < 8]).tolist():
        bits = [bit for bit in _HAZARD_COLORS if number & bit]
        mixed = np.mean([_HAZARD_COLORS[bit] for bit in bits] if bits else [_SAFE], axis=0)
        color = np.rint(mixed).astype(np.uint8)
        image[values == number] = color
        told = " + ".join(names.get(bit, str(bit)) for bit in bits or [0])
        swatches.append((color, told))
    return [Panel(name, image, text="" if swatches else "no ground in view", swatches=swatches)]


_SUNLIT, _SHADED = (214, 205, 180), (62, 68, 92)


def shadow_panel(name: str, values: Array, context: Context) -> list[Panel]:
    """Sunlit surfaces light, those in shadow dark."""
    image = np.empty((*values.shape, 3), dtype=np.uint8)
    image[:] = colors.EMPTY
    image[_valid(values, context) & (values == 0)] = _SUNLIT
    image[values == 1] = _SHADED
    swatches = [(np.array(_SHADED, dtype=np.uint8), f"shadow: {(values == 1).sum()} px")]
    return [Panel(name, image, swatches=swatches)]


Kind = Callable[[str, Array, Context], list[Panel]]

KINDS: dict[str, Kind] = {
    "rgb": image_panel,
    "raw": raw_panel,
    "radiance": radiance_panel,
    "bands": bands_panel,
    "sensor_rgb": image_panel,
    "normal": normal_panel,
    "geometric_normal": normal_panel,
    "albedo": radiance_panel,
    "flow": flow_panel,
    "semantic": levels_panel,
    "coverage": parts_panel,
    "cloud_opacity": parts_panel,
    "slope_baseline": layers_panel,
    "rms_height": layers_panel,
    "hazard": hazard_panel,
    "shadow": shadow_panel,
}
"""Channels with a panel of their own; others are shown by their shape and type."""


def kind_of(name: str, values: Array) -> Kind:
    """Kind of panel for a channel."""
    if name in KINDS:
        return KINDS[name]
    is_real = np.issubdtype(values.dtype, np.floating)
    if values.ndim == 2:
        return scalar_panel if is_real else id_panel
    if is_real and values.shape[2] == 3:
        return vector_panel
    if is_real and values.shape[2] == 2:
        return flow_panel
    if not is_real:
        return levels_panel
    raise ValueError(
        f"preview: channel {name!r} of shape {values.shape} and type {values.dtype} "
        "cannot be shown; known are (H, W), (H, W, 2) and (H, W, 3)"
    )


def channel_panels(name: str, values: Array, context: Context) -> list[Panel]:
    """The panels of one channel."""
    return kind_of(name, values)(name, values, context)
