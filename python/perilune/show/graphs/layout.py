"""Places boxes in columns from left to right, the surface last, with few crossings of links.

After Sugiyama, Tagawa, Toda (1981), "Methods for visual understanding of hierarchical system
structures": columns follow the longest path to the right, links across several columns are cut into
pieces, and the order in columns follows barycentres. Then heights move towards those of the
neighbours; least squares with a fixed order is an isotonic regression."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

from perilune.show.graphs.boxes import Box, Link

HEADER, LINE, FOOT = 38.0, 18.0, 8.0
"""Heights in a box, px: header with names, a row, and the space below the rows."""
SIZE, SMALL = 11.0, 9.5
"""Font sizes, px: of names and rows, and of the kinds of nodes."""
PAD = 12.0
"""Between a box's side and its text, px."""
_GAP_X, _GAP_Y = 70.0, 22.0
_SWEEPS = 12
_STRAIGHT = 4.0
"""Weight of a piece of a long link relative to that of a box."""

_NARROW, _WIDE = set(" .,:;'|!iIjlt[]()"), set("mwMW@%")


def width(text: str, size: float = SIZE) -> float:
    """Approximate width of a text in a sans-serif font, px, rather too large."""
    units = sum(0.36 if c in _NARROW else 0.98 if c in _WIDE else 0.66 for c in text)
    return size * units


@dataclass
class Placed:
    """A box, or a piece of a link that crosses a column (box None)."""

    box: Box | None
    column: int
    width: float = 0.0
    height: float = 0.0
    x: float = 0.0
    y: float = 0.0

    def port(self, row: int) -> float:
        """Height of a row's middle below the top, px."""
        return 0.5 * self.height if self.box is None else HEADER + LINE * (row + 0.5)


@dataclass
class Picture:
    """Boxes and links with coordinates, px."""

    boxes: list[Placed]
    links: list[tuple[Link, list[tuple[float, float]]]]
    """Links with the points that they pass through."""
    width: float
    height: float


@dataclass
class _Edge:
    left: int
    left_row: int
    right: int
    right_row: int


@dataclass
class _Layers:
    items: list[Placed] = field(default_factory=list)
    columns: list[list[int]] = field(default_factory=list)
    edges: list[_Edge] = field(default_factory=list)

    def neighbours(self, to_left: bool) -> dict[int, list[tuple[int, int, int]]]:
        """Item -> (row of its own, neighbour, neighbour's row)."""
        found: dict[int, list[tuple[int, int, int]]] = {k: [] for k in range(len(self.items))}
        for e in self.edges:
            if to_left:
                found[e.right].append((e.right_row, e.left, e.left_row))
            else:
                found[e.left].append((e.left_row, e.right, e.right_row))
        return found


def _columns(boxes: Sequence[Box], links: Sequence[Link]) -> dict[str, int]:
    """Length in links of the longest path to the right end; the graph has no cycle."""
    targets: dict[str, list[str]] = {box.name: [] for box in boxes}
    for link in links:
        targets[link.source].append(link.target)
    found: dict[str, int] = {}

    def column(name: str) -> int:
        if name not in found:
            found[name] = max((column(target) + 1 for target in targets[name]), default=0)
        return found[name]

    for box in boxes:
        column(box.name)
    return found


def size_of(box: Box) -> tuple[float, float]:
    """Width and height of a box, px."""
    texts = [width(box.name) * 1.08, width(box.kind, SMALL)]
    for row in box.rows:
        swatch = 18.0 if row.color is not None else 0.0
        texts.append(width(row.text) + (width(row.value) + 10.0 if row.value else 0.0) + swatch)
    return max(90.0, max(texts) + 2.0 * PAD), HEADER + LINE * len(box.rows) + FOOT


def _layers(boxes: Sequence[Box], links: Sequence[Link]) -> tuple[_Layers, list[list[int]]]:
    """Items, edges between adjacent columns, and the items that each link passes through."""
    column = _columns(boxes, links)
    layers = _Layers(columns=[[] for _ in range(max(column.values()) + 1)])

    def add(item: Placed) -> int:
        layers.items.append(item)
        layers.columns[item.column].append(len(layers.items) - 1)
        return len(layers.items) - 1

    index = {box.name: add(Placed(box, column[box.name], *size_of(box))) for box in boxes}
    ways = []
    for link in links:
        way = [index[link.source]]
        for c in range(column[link.source] - 1, column[link.target], -1):
            way.append(add(Placed(None, c)))
        way.append(index[link.target])
        rows = [link.source_row, *([0] * (len(way) - 2)), link.target_row]
        for k in range(len(way) - 1):
            layers.edges.append(_Edge(way[k], rows[k], way[k + 1], rows[k + 1]))
        ways.append(way)
    return layers, ways


def _crossings(layers: _Layers) -> int:
    rank = {item: k for column in layers.columns for k, item in enumerate(column)}
    ends: dict[int, list[tuple[tuple[int, int], tuple[int, int]]]] = {}
    for e in layers.edges:
        pair = ((rank[e.left], e.left_row), (rank[e.right], e.right_row))
        ends.setdefault(layers.items[e.left].column, []).append(pair)
    count = 0
    for pairs in ends.values():
        for k, (a, b) in enumerate(pairs):
            count += sum((a < c) != (b < d) for c, d in pairs[:k] if a != c and b != d)
    return count


def _centre(layers: _Layers, near: Sequence[tuple[int, int, int]], own: float) -> float:
    """Mean position of an item's neighbours in the order of their columns."""
    places = []
    for _, other, row in near:
        item = layers.items[other]
        place = layers.columns[item.column].index(other)
        places.append(place + row / (1.0 + (len(item.box.rows) if item.box is not None else 0)))
    return sum(places) / len(places) if places else own


def _order(layers: _Layers) -> None:
    """Sorts the columns by barycentres, back and forth, and keeps the order with the fewest
    crossings."""
    best, fewest = [list(column) for column in layers.columns], _crossings(layers)
    for sweep in range(_SWEEPS):
        to_left = sweep % 2 == 1
        near = layers.neighbours(to_left)
        todo = range(len(layers.columns))
        for c in reversed(todo) if to_left else todo:
            column = layers.columns[c]
            keys = {item: _centre(layers, near[item], float(k)) for k, item in enumerate(column)}
            layers.columns[c] = sorted(column, key=keys.__getitem__)
        crossings = _crossings(layers)
        if crossings < fewest:
            best, fewest = [list(column) for column in layers.columns], crossings
    layers.columns = best


def _stack(
    wanted: Sequence[float], weights: Sequence[float], sizes: Sequence[float]
) -> list[float]:
    """Tops nearest to those wanted, in this order and without overlap (pool adjacent violators)."""
    offsets = [sum(sizes[:k]) for k in range(len(sizes))]
    pools: list[tuple[float, float, int]] = []  # weighted sum, weight, count
    for top, weight, offset in zip(wanted, weights, offsets, strict=True):
        pools.append((weight * (top - offset), weight, 1))
        while len(pools) > 1 and pools[-2][0] / pools[-2][1] > pools[-1][0] / pools[-1][1]:
            last, before = pools.pop(), pools.pop()
            pools.append((last[0] + before[0], last[1] + before[1], last[2] + before[2]))
    levels = [total / weight for total, weight, count in pools for _ in range(count)]
    return [level + offset for level, offset in zip(levels, offsets, strict=True)]


def _heights(layers: _Layers) -> None:
    items = layers.items
    for column in layers.columns:
        sizes = [items[k].height + _GAP_Y for k in column]
        tops = _stack([0.0] * len(column), [1.0] * len(column), sizes)
        for k, top in zip(column, tops, strict=True):
            items[k].y = top
    left, right = layers.neighbours(True), layers.neighbours(False)
    for sweep in range(4 * _SWEEPS):
        columns = layers.columns if sweep % 2 == 0 else layers.columns[::-1]
        for column in columns:
            wanted, weights = [], []
            for k in column:
                item, near = items[k], (left[k] + right[k])
                ideal = [items[o].y + items[o].port(row) - item.port(own) for own, o, row in near]
                wanted.append(sum(ideal) / len(ideal) if ideal else item.y)
                weights.append(_STRAIGHT if item.box is None else 1.0)
            sizes = [items[k].height + _GAP_Y for k in column]
            for k, top in zip(column, _stack(wanted, weights, sizes), strict=True):
                items[k].y = top
    lowest = min(item.y for item in items)
    for item in items:
        item.y -= lowest


def place(boxes: Sequence[Box], links: Sequence[Link]) -> Picture:
    """The layout of a graph; column 0 is the rightmost."""
    layers, ways = _layers(boxes, links)
    items = layers.items
    _order(layers)
    _heights(layers)
    x = 0.0
    for column in reversed(layers.columns):
        wide = max(items[k].width for k in column)
        for k in column:
            items[k].x = x
            items[k].width = items[k].width if items[k].box is not None else wide
        x += wide + _GAP_X
    drawn = []
    for link, way in zip(links, ways, strict=True):
        first, last = items[way[0]], items[way[-1]]
        points = [(first.x + first.width, first.y + first.port(link.source_row))]
        for k in way[1:-1]:
            points += [(items[k].x, items[k].y), (items[k].x + items[k].width, items[k].y)]
        points.append((last.x, last.y + last.port(link.target_row)))
        drawn.append((link, points))
    height = max(item.y + item.height for item in items)
    return Picture([item for item in items if item.box is not None], drawn, x - _GAP_X, height)
