"""Layout of the sheet: the picture first and large, then every other channel in a grid."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from perilune import _core
from perilune.base import colors
from perilune.document.references import MASKS
from perilune.show.preview import canvas
from perilune.show.preview.canvas import Canvas, shortened, text_width
from perilune.show.preview.overlay import with_objects
from perilune.show.preview.panels import Context, Names, Panel, channel_panels

if TYPE_CHECKING:
    from perilune.sample import Sample

U8 = NDArray[np.uint8]

COLUMNS = 4
PANEL_WIDTH = 310
GAP = 20
_TEXT, _HEADING = 17, 28
"""Heights of letters, pixels."""
_LINE = 20
_BASE = 13
"""Rows from the top of a line to its base line."""
_HEADER, _HEADER_BASE = 70, 42
_TITLE = _LINE + 4
_LEGEND = 2 * _LINE + 4
_BAR = 8
_TALLEST = 1.4
_FLATTEST = 0.1
_LONGEST_PX = 1280
"""Labels of larger images are thinned to this size before they are coloured and their values
read."""
_BRIGHT = (236, 238, 243)
_DIM = (158, 164, 178)


def _draw_swatches(sheet: Canvas, top: int, left: int, width: int, panel: Panel) -> None:
    x, line = left, 0
    square = 14
    for index, (color, name) in enumerate(panel.swatches):
        label = shortened(name, width - square - 8, _TEXT)
        advance = square + 6 + text_width(label, _TEXT) + 14
        if x + advance - 14 > left + width and x > left:
            x, line = left, line + 1
        rest = f"+{len(panel.swatches) - index}"
        # The last line keeps room for "+n" unless this is the last name.
        reserve = 0 if rest == "+1" else text_width(rest, _TEXT) + 14
        if line > 1 or (line == 1 and x > left and x + advance - 14 + reserve > left + width):
            at = x if line == 1 else left + width - text_width(rest, _TEXT)
            sheet.text(top + _LINE + _BASE, at, rest, _DIM, _TEXT)
            return
        row = top + line * _LINE
        sheet.fill(row, x, square, square, color)
        sheet.text(row + _BASE, x + square + 6, label, _DIM, _TEXT)
        x += advance


def _draw_legend(sheet: Canvas, top: int, left: int, width: int, panel: Panel) -> None:
    if panel.bar is not None:
        steps = np.linspace(0, len(colors.ramp()) - 1, width).astype(np.int64)
        sheet.place(top, left, np.tile(colors.ramp()[steps][None], (_BAR, 1, 1)))
        low, high = panel.bar
        sheet.text(top + _BAR + 6 + _BASE, left, low, _DIM, _TEXT)
        right = left + width - text_width(high, _TEXT)
        sheet.text(top + _BAR + 6 + _BASE, right, high, _DIM, _TEXT)
    elif panel.swatches:
        _draw_swatches(sheet, top, left, width, panel)
    elif panel.text:
        sheet.text(top + _BASE, left, shortened(panel.text, width, _TEXT), _DIM, _TEXT)


def _draw_panel(sheet: Canvas, top: int, left: int, width: int, height: int, panel: Panel) -> None:
    title = shortened(panel.title, width, _TEXT)
    sheet.text(top + _BASE, left, title, _BRIGHT, _TEXT)
    top += _TITLE
    rows, columns = canvas.fitted(panel.image.shape, (height, width))
    picture = canvas.resize(panel.image, rows, columns)
    at_top, at_left = top + (height - rows) // 2, left + (width - columns) // 2
    sheet.place(at_top, at_left, picture)
    _draw_legend(sheet, top + height + 8, left, width, panel)


def _hit_mask(sample: Mapping[str, NDArray[Any]]) -> NDArray[np.bool_] | None:
    for name in ("depth", "range"):
        if name in sample:
            values = sample[name]
            return np.asarray(np.isfinite(values) & (values > 0))
    return None


def _overlay_panel(sample: Sample, box: tuple[int, int]) -> Panel:
    """rgb at its size on the sheet, so that lines keep their thickness."""
    rgb = sample["rgb"]
    picture = canvas.resize(rgb, *canvas.fitted(rgb.shape, box))
    picture = with_objects(picture, sample.objects, sample.camera, rgb.shape[1])
    visible = int((sample.objects["px_count_visib"] > 0).sum())
    text = f"{visible} of {len(sample.objects)} objects visible"
    return Panel("visible boxes and axes", picture, text=text)


def _panels(sample: Sample, names: Names, units: Mapping[str, str]) -> list[Panel]:
    step = -(-max(sample.camera.height, sample.camera.width) // _LONGEST_PX)
    # Masks are an image per object; the panel of instances shows what is seen of them.
    thinned = {name: sample[name][::step, ::step] for name in sample if name != MASKS}
    of_bands = {i: str(row["name"]) for i, row in enumerate(sample.meta.get("bands", ()))}
    names = {**names, "bands": {i: name for i, name in of_bands.items() if name}}
    context = Context(_hit_mask(thinned), thinned.get("instance"), names, units)
    found: list[Panel] = []
    for name, values in thinned.items():
        if name == "rgb" or values.ndim not in (2, 3):
            continue
        found += channel_panels(name, values, context)
    return found


def panels_of(sample: Sample, box: tuple[int, int], names: Names | None = None) -> list[Panel]:
    """All panels of a sample, the picture first. box: height and width of the picture with boxes
    and axes on the sheet."""
    units = {channel["name"]: channel["unit"] for channel in _core.CHANNELS}
    found: list[Panel] = []
    if "rgb" in sample:
        found = channel_panels("rgb", sample["rgb"], Context(None, None, names or {}, units))
        if sample.has_objects:
            found.append(_overlay_panel(sample, box))
    return found + _panels(sample, names or {}, units)


def draw_sheet(sample: Sample, title: str, names: Names, units: Mapping[str, str]) -> U8:
    """The whole sheet as (H, W, 3); `title` is its heading, with parts divided by " | "."""
    if len(sample) == 0:
        raise ValueError("preview: the sample holds no pixel channel to draw")
    height, width = sample.camera.height, sample.camera.width
    shape = min(max(height / width, _FLATTEST), _TALLEST)
    small = (round(PANEL_WIDTH * shape), PANEL_WIDTH)
    large_width = 2 * PANEL_WIDTH + GAP
    large = (round(large_width * shape), large_width)
    leading: list[Panel] = []
    if "rgb" in sample:
        leading = channel_panels("rgb", sample["rgb"], Context(None, None, names, units))
        if sample.has_objects:
            leading.append(_overlay_panel(sample, large))
    others = _panels(sample, names, units)
    frame = _TITLE + _LEGEND + 8 + GAP
    rows = -(-len(others) // COLUMNS)
    total = _HEADER + (large[0] + frame if leading else 0) + rows * (small[0] + frame)
    sheet = Canvas.blank(COLUMNS * (PANEL_WIDTH + GAP) + GAP, total, colors.BACKGROUND)
    _draw_header(sheet, title.split(" | "))
    top = _HEADER
    for index, panel in enumerate(leading):
        left = GAP + index * (large_width + GAP)
        _draw_panel(sheet, top, left, large[1], large[0], panel)
    top += large[0] + frame if leading else 0
    _draw_grid(sheet, top, small, frame, others)
    return sheet.pixels()


def _draw_grid(
    sheet: Canvas, top: int, size: tuple[int, int], frame: int, panels: Sequence[Panel]
) -> None:
    for index, panel in enumerate(panels):
        row, column = divmod(index, COLUMNS)
        left = GAP + column * (PANEL_WIDTH + GAP)
        _draw_panel(sheet, top + row * (size[0] + frame), left, size[1], size[0], panel)


def _draw_header(sheet: Canvas, parts: Sequence[str]) -> None:
    """Draws the first part large, the others dimmed after it."""
    width = sheet.image.width - 2 * GAP
    heading = shortened(parts[0], width // 2, _HEADING)
    sheet.text(_HEADER_BASE, GAP, heading, _BRIGHT, _HEADING)
    left = GAP + text_width(heading, _HEADING) + 2 * GAP
    rest = shortened("     ".join(parts[1:]), GAP + width - left, _TEXT)
    sheet.text(_HEADER_BASE, left, rest, _DIM, _TEXT)
