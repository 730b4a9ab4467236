"""SVG of a placed graph. It uses presentation attributes only, because styles would affect the page
around it."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any
from xml.sax.saxutils import escape, quoteattr

from perilune.show.graphs.boxes import Link, Row
from perilune.show.graphs.layout import HEADER, LINE, PAD, SIZE, SMALL, Picture, Placed

_MARGIN, _TITLE = 24.0, 34.0
_FONT = "DejaVu Sans, Helvetica, Arial, sans-serif"
_TYPES = {"scalar": "#8c8c8c", "vector": "#5b5bd0", "color": "#c2a500", "surface": "#2f8f4e"}
_DRIVER, _DRIVER_FILL, _DRIVER_TEXT = "#e0660b", "#fff1e3", "#a8480a"
_INK, _FAINT, _EDGE, _FILL = "#222222", "#6b6b6b", "#b5b5b5", "#fbfbfb"


def _element(tag: str, text: str | None = None, **attributes: object) -> str:
    parts = []
    for key, value in attributes.items():
        shown = f"{value:.2f}".rstrip("0").rstrip(".") if isinstance(value, float) else str(value)
        parts.append(f" {key.replace('_', '-')}={quoteattr(shown)}")
    inner = "".join(parts)
    return f"<{tag}{inner}/>" if text is None else f"<{tag}{inner}>{escape(text)}</{tag}>"


def _text(x: float, y: float, text: str, fill: str, size: float = SIZE, **more: object) -> str:
    return _element("text", text, x=x, y=y, fill=fill, font_size=size, font_family=_FONT, **more)


def _srgb(color: tuple[float, float, float]) -> str:
    """Hexadecimal sRGB of linear RGB, clipped (IEC 61966-2-1)."""

    def byte(x: float) -> int:
        x = min(max(x, 0.0), 1.0)
        encoded = 12.92 * x if x <= 0.0031308 else 1.055 * x ** (1.0 / 2.4) - 0.055
        return round(255.0 * encoded)

    return "#" + "".join(f"{byte(value):02x}" for value in color)


def _link(link: Link, points: list[tuple[float, float]]) -> str:
    """Curves between the columns, straight lines through them."""
    (x, y), *others = points
    way = [f"M {x:.1f} {y:.1f}"]
    for k, (to_x, to_y) in enumerate(others):
        if k % 2 == 0:
            bend = max(24.0, 0.5 * (to_x - x))
            way.append(f"C {x + bend:.1f} {y:.1f} {to_x - bend:.1f} {to_y:.1f}")
            way.append(f"{to_x:.1f} {to_y:.1f}")
        else:
            way.append(f"L {to_x:.1f} {to_y:.1f}")
        x, y = to_x, to_y
    color = _TYPES[link.type]
    return _element("path", d=" ".join(way), fill="none", stroke=color, stroke_width=2.0)


def _row(item: Placed, index: int, row: Row) -> Iterator[str]:
    top = item.y + HEADER + LINE * index
    middle = top + 0.5 * LINE
    base = middle + 0.36 * SIZE
    right = item.x + item.width
    ink = _DRIVER_TEXT if row.driver else _INK
    if row.driver and item.box is not None and not item.box.driver:
        left, wide = item.x + 1.0, item.width - 2.0
        yield _element("rect", x=left, y=top, width=wide, height=LINE, fill=_DRIVER_FILL)
    if row.output:
        yield _text(right - PAD, base, row.text, _FAINT, text_anchor="end")
    else:
        indent = 12.0 if row.text.startswith("  ") else 0.0
        yield _text(item.x + PAD + indent, base, row.text.strip(), ink)
        end = right - PAD
        if row.color is not None:
            end -= 18.0
            square = {"x": end + 6.0, "y": middle - 6.0, "width": 12.0, "height": 12.0, "rx": 2.0}
            yield _element("rect", None, **square, fill=_srgb(row.color), stroke=_EDGE)
        if row.value:
            yield _text(end, base, row.value, ink, text_anchor="end")
    if row.socket is not None:
        x = right if row.output else item.x
        fill = _TYPES[row.socket]
        yield _element("circle", cx=x, cy=middle, r=4.5, fill=fill, stroke="#ffffff")


def _box(item: Placed) -> Iterator[str]:
    box = item.box
    assert box is not None  # pieces of links are no boxes
    x, y, w, h = item.x, item.y, item.width, item.height
    head = _DRIVER if box.driver else _TYPES[box.type]
    fill = _DRIVER_FILL if box.driver else _FILL
    edge: dict[str, Any] = {"stroke_dasharray": "5 4"} if not box.reached else {}
    edge |= {"stroke": _DRIVER, "stroke_width": 2.5} if box.driver else {"stroke": _EDGE}
    yield _element("rect", x=x, y=y, width=w, height=h, rx=7.0, fill=fill, **edge)
    top = f"M {x:.1f} {y + HEADER - 4:.1f} v {11 - HEADER:.1f} a 7 7 0 0 1 7 -7 "
    top += f"h {w - 14:.1f} a 7 7 0 0 1 7 7 v {HEADER - 11:.1f} z"
    yield _element("path", d=top, fill=head)
    yield _text(x + PAD, y + 15.0, box.name, "#ffffff", font_weight="bold")
    kind = box.kind if box.reached else f"{box.kind}, not used by the surface"
    yield _text(x + PAD, y + 28.0, kind, "#ffffff", SMALL)
    for index, row in enumerate(box.rows):
        yield from _row(item, index, row)


def write(title: str, picture: Picture) -> str:
    """The whole SVG document."""
    width = picture.width + 2.0 * _MARGIN
    height = picture.height + 2.0 * _MARGIN + _TITLE
    rows = [
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{width:.0f}" height="{height:.0f}" '
        f'viewBox="0 0 {width:.0f} {height:.0f}">',
        _element("title", title),
        _element("rect", width="100%", height="100%", fill="#ffffff"),
        _text(_MARGIN, _MARGIN + 10.0, title, _INK, 16.0, font_weight="bold"),
        f'<g transform="translate({_MARGIN:.0f} {_MARGIN + _TITLE:.0f})">',
        *(_link(link, points) for link, points in picture.links),
        *(part for item in picture.boxes for part in _box(item)),
        "</g>",
        "</svg>",
    ]
    return "\n".join(rows) + "\n"
