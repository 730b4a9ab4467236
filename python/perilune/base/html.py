"""HTML elements: tables, pictures, collapsible parts."""

from __future__ import annotations

import base64
import math
from collections.abc import Iterable, Mapping, Sequence
from html import escape
from typing import Any

import numpy as np

_LINE = "border-bottom:1px solid rgba(128,128,128,0.3)"
_CELL = "padding:2px 10px 2px 0;text-align:{align};vertical-align:top;background:none"
_TABLE = "border-collapse:collapse;border:none;margin:4px 0 8px 0;font-size:12px;line-height:1.4"
_TEXT = 80
MOST_ROWS = 40


def text_of(value: Any, digits: int = 5) -> str:
    """A short text for a value: numbers with this many digits, lists in brackets."""
    if isinstance(value, np.ndarray):
        value = value.tolist()
    if value is None:
        return "–"
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, float):
        return f"{value:.{digits}g}" if math.isfinite(value) else str(value)
    if isinstance(value, (list, tuple)):
        shown = ", ".join(text_of(item, digits) for item in value[:12])
        return f"[{shown}{', ...' if len(value) > 12 else ''}]"
    text = str(value)
    return text if len(text) <= _TEXT else f"{text[: _TEXT - 3]}..."


def table(
    columns: Sequence[str],
    rows: Iterable[Sequence[Any]],
    most: int = MOST_ROWS,
    tints: Sequence[str] = (),
) -> str:
    """A table with numbers aligned to the right; of many rows it shows the first and the number of
    others. tints: a CSS colour behind each row."""
    kept = [list(row) for row in rows]
    right = [
        bool(kept) and all(isinstance(row[k], (int, float, np.number)) for row in kept)
        for k in range(len(columns))
    ]

    def line(cells: Sequence[Any], tag: str, tint: str = "none") -> str:
        parts = []
        for k, cell in enumerate(cells):
            style = _CELL.format(align="right" if right[k] else "left")
            weight = ";font-weight:600" if tag == "th" else ""
            value = cell.item() if isinstance(cell, np.generic) else cell
            parts.append(f'<{tag} style="{style}{weight}">{escape(text_of(value))}</{tag}>')
        return f'<tr style="background:{tint};{_LINE}">{"".join(parts)}</tr>'

    behind = [*tints, *["none"] * (len(kept) - len(tints))]
    body = "".join(line(row, "td", tint) for row, tint in zip(kept[:most], behind, strict=False))
    rest = f"<div>and {len(kept) - most} more</div>" if len(kept) > most else ""
    head = line(columns, "th")
    return f'<table style="{_TABLE}"><thead>{head}</thead><tbody>{body}</tbody></table>{rest}'


def heading(text: str, dim: str = "") -> str:
    """A heading above a table."""
    beside = f' <span style="opacity:0.65">{escape(dim)}</span>' if dim else ""
    return f'<div style="margin:4px 0;font-size:13px"><b>{escape(text)}</b>{beside}</div>'


def folded(title: str, content: str, unfolded: bool = False) -> str:
    """A part that opens on a click."""
    state = " open" if unfolded else ""
    return (
        f'<details{state} style="margin:2px 0;font-size:12px"><summary>{escape(title)}</summary>'
        f"{content}</details>"
    )


def picture(png: bytes, title: str, lines: Sequence[str], width: int) -> str:
    """A picture with its title and further lines below."""
    data = base64.b64encode(png).decode("ascii")
    told = "".join(f'<div style="opacity:0.65">{line}</div>' for line in lines)
    return (
        f'<figure style="display:inline-block;vertical-align:top;margin:0 12px 12px 0;'
        f'width:{width}px;font-size:11px;line-height:1.35">'
        f'<img alt="{escape(title)}" style="width:100%;image-rendering:auto;margin:0" '
        f'src="data:image/png;base64,{data}"/>'
        f'<figcaption style="text-align:left"><b>{escape(title)}</b>{told}</figcaption></figure>'
    )


def swatch(color: Sequence[int], name: str) -> str:
    """A square of a colour with its label."""
    red, green, blue = (int(part) for part in color)
    square = (
        f'<span style="display:inline-block;width:9px;height:9px;margin-right:3px;'
        f'background:rgb({red},{green},{blue})"></span>'
    )
    return f'<span style="white-space:nowrap;margin-right:8px">{square}{escape(name)}</span>'


def whole(*parts: str) -> str:
    """A cell's complete text."""
    return f'<div class="perilune" style="max-width:1100px">{"".join(parts)}</div>'


def flat(values: Mapping[str, Any], prefix: str = "") -> list[tuple[str, Any]]:
    """(key path, value) of nested mappings and lists of mappings."""
    rows: list[tuple[str, Any]] = []
    for key, value in values.items():
        path = f"{prefix}.{key}" if prefix else str(key)
        if isinstance(value, Mapping) and value:
            rows += flat(value, path)
        elif isinstance(value, (list, tuple)) and any(isinstance(v, Mapping) for v in value):
            for k, item in enumerate(value):
                inner = item if isinstance(item, Mapping) else {"": item}
                rows += flat(inner, f"{path}[{k}]")
        else:
            rows.append((path, value))
    return rows
