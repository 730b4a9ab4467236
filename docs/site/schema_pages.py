"""The reference of all keys of a configuration, as Markdown, made of the schema itself."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from perilune import _core
from perilune.cli.json_schema import config_schema
from perilune.cli.schema_table import Tables
from perilune.cli.schema_walk import ANY_NAME, Schema

_HEAD = "| key | value | unit | limits | default | meaning |\n| --- | --- | --- | --- | --- | --- |"
_LONG = " | ".join(row["name"] for row in _core.EFFECTS)
Node = Mapping[str, Any]


def _cell(text: str) -> str:
    """Markdown of a cell: no column ends inside, and nothing is read as HTML."""
    text = text.replace(_LONG, "names of [effects](effects.md)")
    return text.replace("<", "&lt;").replace("*", "\\*").replace("|", "\\|")


def _anchor(path: str) -> str:
    return path.replace(".", "-").lower()


class Reference:
    """Goes through all sections, each once."""

    def __init__(self) -> None:
        self._schema = Schema(config_schema())
        self._tables = Tables(self._schema)
        self._seen: dict[str, str] = {}
        """Keys and description of a section -> the path where its table stands."""

    def text(self) -> str:
        """All of it."""
        return "\n".join(self._section("", "top level", self._schema.root))

    def _section(self, path: str, title: str, section: Node) -> Iterator[str]:
        needed = section.get("required", ())
        name = f"`{title}`" if path else "Top level"
        yield f"\n## {name} {{ #{_anchor(path) or 'top-level'} }}\n"
        about = section.get("description", "")
        if path and about:
            yield f"{_cell(' '.join(about.split()))}\n"
        yield _HEAD
        below: list[tuple[str, Node]] = []
        for key, node in section["properties"].items():
            cells = [_cell(cell) for cell in self._tables.row(key, node, key in needed)]
            where = f"{path}.{key}" if path else key
            found = list(self._below(where, node))
            links = [self._link(at, leaf) for at, leaf in found]
            if links:
                cells[1] = f"{cells[1]}: {', '.join(dict.fromkeys(links))}"
            below += found
            yield f"| `{cells[0]}` | {' | '.join(cells[1:])} |"
        for where, leaf in below:
            if self._seen.get(self._identity(leaf)) == where:
                yield from self._once(where, leaf)

    def _once(self, where: str, leaf: Node) -> Iterator[str]:
        written = f"written {where}"
        if written not in self._seen:
            self._seen[written] = where
            yield from self._section(where, where, leaf)

    def _below(self, where: str, node: Node) -> Iterator[tuple[str, Node]]:
        """(path, section) of the sections that a key leads to."""
        value = self._schema.value(node)
        sections = self._schema.sections(value)
        entry = None if sections else self._schema.entries(value)
        if entry is not None:
            where = f"{where}.{ANY_NAME}"
            sections = self._schema.sections(self._schema.value(entry))
        for kind, section in sections:
            yield (f"{where}.{kind}" if kind else where), section

    def _identity(self, section: Node) -> str:
        return repr((section.get("description"), section["properties"]))

    def _link(self, where: str, section: Node) -> str:
        first = self._seen.setdefault(self._identity(section), where)
        return f"[{where.rsplit('.', 1)[-1]}](#{_anchor(first)})"


def reference() -> str:
    """The page's tables: each section has one, under its path."""
    return Reference().text()
