"""A material's graph as a picture: nodes with their sockets and values, links, drivers.

`boxes` reads the graph, `layout` places it from left to right, `write` makes SVG of it.
"""

from __future__ import annotations

import os
from pathlib import Path

from perilune import materials
from perilune.config.errors import nearest
from perilune.document.document import Document
from perilune.show.graphs.boxes import read
from perilune.show.graphs.layout import place
from perilune.show.graphs.write import write


class GraphPicture:
    """The picture of a graph, which a notebook displays as the value of a cell."""

    def __init__(self, name: str, svg: str) -> None:
        self.name = name
        self.svg = svg
        """The whole document, as text."""

    def _repr_svg_(self) -> str:
        return self.svg

    def __repr__(self) -> str:
        return f"<GraphPicture {self.name}, {len(self.svg)} characters of SVG>"

    def save(self, path: str | os.PathLike[str]) -> Path:
        """Writes the picture to a file, whose name must end in .svg; ValueError if not."""
        target = Path(path)
        if target.suffix.lower() != ".svg":
            raise ValueError(f"{target}: the name of the picture must end in .svg")
        target.write_text(self.svg, encoding="utf-8")
        return target


def draw(document: Document, name: str, entity: str | None = None) -> GraphPicture:
    """The picture of an entry of `materials`, with the drivers that it has on an object.

    entity: spacecraft or body (default: the first that it is, or may be, on). ValueError for
    unknown names."""
    config = document.config
    if name not in config.materials:
        raise ValueError(f"materials: no entry named '{name}'{nearest(name, config.materials)}")
    on = materials.users(config, document.drivers)
    users = [owner for owner, uses in on.items() if name in uses]
    if entity is not None and entity not in users:
        raise ValueError(f"'{name}' is not on '{entity}'{nearest(entity, users)}")
    if entity is None and users:
        entity = users[0]
    boxes, links = read(document, name, entity)
    title = name if entity is None else f"{name} on {entity}"
    return GraphPicture(name, write(title, place(boxes, links)))
