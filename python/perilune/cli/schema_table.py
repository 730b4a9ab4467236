"""Sections of a configuration as tables: key, value, unit, limits, default, meaning."""

from __future__ import annotations

import re
import shutil
import textwrap
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from perilune.cli.schema_walk import ANY_NAME, Found, Schema, Value, default_text

_COLUMNS = ("key", "value", "unit", "limits", "default", "meaning")
_LEAST_MEANING = 40
_HUGE = 1e30

UNITS: dict[str, str] = {
    "w_m2_sr": "W m-2 sr-1",
    "w_m3_sr": "W m-3 sr-1",
    "w_m2": "W m-2",
    "km3_s2": "km3 s-2",
    "m_s2": "m s-2",
    "m2_kg": "m2 kg-1",
    "m2_per_myr": "m2 Myr-1",
    "kg_m2": "kg m2",
    "deg_step_v": "deg a step",
    "deg_s": "deg s-1",
    "deg_h": "deg h-1",
    "km_s": "km s-1",
    "m_s": "m s-1",
    "e_dn": "e-/DN",
    "e_s": "e- s-1",
    "cm2_s": "cm-2 s-1",
    "mag_arcsec2": "mag arcsec-2",
    "per_km": "km-1",
    "per_m": "m-1",
    "deg": "deg",
    "km": "km",
    "mm": "mm",
    "um": "um",
    "nm": "nm",
    "ms": "ms",
    "us": "us",
    "px": "px",
    "au": "au",
    "dn": "DN",
    "m": "m",
    "s": "s",
    "h": "h",
    "e": "e-",
    "k": "K",
    "c": "deg C",
    "year": "year",
    "ga": "Ga",
    "magnitude": "mag",
}
"""Suffix of a key's name -> its unit, longer ones first."""
_NO_UNIT = ("h_c", "h_s", "b_c0", "b_s0")
"""Parameters of photometry whose names end like a unit."""


def unit_of(key: str) -> str:
    """The unit of a key, such as `km` for `altitude_km`; empty for a number without a unit."""
    if key in _NO_UNIT:
        return ""
    ends = (unit for end, unit in UNITS.items() if key.endswith(f"_{end}"))
    return next(ends, "")


def _limits(leaves: Sequence[Mapping[str, Any]]) -> str:
    """Limits of the numbers among the alternatives."""
    found = []
    for leaf in leaves:
        for key, sign in (
            ("exclusiveMinimum", ">"),
            ("minimum", ">="),
            ("exclusiveMaximum", "<"),
            ("maximum", "<="),
        ):
            if key in leaf and abs(leaf[key]) < _HUGE:
                found.append(f"{sign} {leaf[key]:.6g}")
    return ", ".join(dict.fromkeys(found))


class Tables:
    """Writes the section or key that a path names."""

    def __init__(self, schema: Schema) -> None:
        self._schema = schema

    def _type(self, value: Value) -> str:
        words = list(dict.fromkeys(self._word(leaf) for leaf in value.leaves))
        if words and set(words) <= {"section"} and len(value.leaves) > 1:
            kinds = [kind for kind, _ in self._schema.sections(value)]
            words = [f"section: {' | '.join(kinds)}"]
        text = " or ".join(words) or "anything"
        text += " or null" if value.nullable else ""
        return f"{text}, or a driver" if value.varies and _takes_numbers(words) else text

    def _word(self, leaf: Mapping[str, Any]) -> str:
        if "const" in leaf:
            return str(leaf["const"])
        if "enum" in leaf:
            return " | ".join(map(str, leaf["enum"]))
        if "properties" in leaf:
            return "section"
        kind = leaf.get("type")
        if kind == "array":
            if "prefixItems" in leaf:
                words = self._type(self._schema.value(leaf["prefixItems"][0])).split(",")[0]
                plural = "numbers" if words == "number" else words
                return f"{len(leaf['prefixItems'])} {plural}"
            return f"list of {self._type(self._schema.value(leaf.get('items', {})))}"
        if kind == "object":
            entry = self._schema.entries(Value((leaf,)))
            below = self._type(self._schema.value(entry)) if entry else "anything"
            return f"name -> {below}"
        names = {"number": "number", "integer": "whole number", "string": "text"}
        return {**names, "boolean": "true | false"}.get(str(kind), "anything")

    def _number_leaves(self, value: Value) -> list[Mapping[str, Any]]:
        found = [leaf for leaf in value.leaves if "properties" not in leaf]
        for leaf in value.leaves:
            items = leaf.get("prefixItems") or [leaf.get("items") or {}]
            if leaf.get("type") == "array" and items[0]:
                found += self._schema.value(items[0]).leaves
        return found

    def row(self, key: str, node: Mapping[str, Any], required: bool) -> tuple[str, ...]:
        """Cells of a key."""
        value = self._schema.value(node)
        meaning = node.get("description", "")
        if not meaning and len(value.leaves) == 1:
            meaning = value.leaves[0].get("description", "")
        cells = (key, self._type(value), unit_of(key), _limits(self._number_leaves(value)))
        return (*cells, default_text(node, required), re.sub(r"\s+", " ", meaning))

    def section(self, section: Mapping[str, Any], width: int) -> str:
        """Table of a section's keys, required ones first."""
        needed = section.get("required", ())
        rows = [self.row(key, node, key in needed) for key, node in section["properties"].items()]
        rows.sort(key=lambda row: row[4] != "required")
        return table(rows, width)

    def overview(self) -> str:
        """All sections, one line each."""
        rows = self._schema.root["properties"].items()
        needed = self._schema.root.get("required", ())
        lines = ["Sections of a configuration, and its keys at the top (* required):", ""]
        longest = max(len(key) for key, _ in rows)
        width = shutil.get_terminal_size((100, 24)).columns
        for key, node in rows:
            meaning = self.row(key, node, False)[5]
            mark = "*" if key in needed else " "
            lines.append(_hanging(f"{mark} {key.ljust(longest)}  ", meaning, width))
        return "\n".join(lines)

    def describe(self, found: Found, width: int | None = None) -> str:
        """Text for a section, its kinds, or one key."""
        width = width or shutil.get_terminal_size((100, 24)).columns
        return "\n".join(self._lines(found, width))

    def _lines(self, found: Found, width: int) -> Iterator[str]:
        sections = found.sections
        path = found.path
        entry = self._schema.entries(found.value) if not sections else None
        if entry is not None and (below := self._schema.sections(self._schema.value(entry))):
            sections, path = below, f"{path}.{ANY_NAME}"
        told = re.sub(r"\s+", " ", found.node.get("description", ""))
        if not sections:
            yield table([self.row(path.rsplit(".", 1)[-1], found.node, False)], width)
        elif len(sections) == 1:
            about = re.sub(r"\s+", " ", sections[0][1].get("description", told))
            yield from textwrap.wrap(f"{path}: {about}", width)
            yield ""
            yield self.section(sections[0][1], width)
        else:
            yield from textwrap.wrap(f"{path}: {told or 'one of these kinds'}", width)
            yield ""
            longest = max(len(kind) for kind, _ in sections)
            for kind, section in sections:
                about = re.sub(r"\s+", " ", section.get("description", ""))
                yield _hanging(f"  {kind.ljust(longest)}  ", about, width)
            yield ""
            yield f"perilune schema {found.path}.{sections[0][0]}    shows the keys of one"


def _takes_numbers(words: Sequence[str]) -> bool:
    return any("number" in word for word in words)


def _hanging(head: str, text: str, width: int) -> str:
    indent = " " * len(head)
    body = textwrap.wrap(text, max(width - len(head), _LEAST_MEANING))
    return head + f"\n{indent}".join(body or [""])


def table(rows: Sequence[tuple[str, ...]], width: int) -> str:
    """Lays out rows in wrapped columns and omits empty columns. In a narrow terminal the meaning is
    below its key."""
    most = (28, 30, 12, 18, 16)
    names = list(_COLUMNS)
    used = [k for k in range(len(names)) if any(row[k] for row in rows)]
    widths = {}
    for k in used:
        longest = max(len(row[k]) for row in rows)
        cap = most[k] if k < len(most) else longest
        widths[k] = max(len(names[k]), min(longest, cap))
    fixed = sum(widths[k] + 2 for k in used if k != len(names) - 1)
    last = len(names) - 1
    beside = width - fixed >= _LEAST_MEANING
    if last in widths:
        widths[last] = min(widths[last], width - fixed) if beside else 0
    columns = [k for k in used if k != last or beside]
    lines = ["  ".join(names[k].ljust(widths[k]) for k in columns).rstrip()]
    lines.append("  ".join("-" * widths[k] for k in columns))
    for row in rows:
        cells = [textwrap.wrap(row[k], widths[k], break_on_hyphens=False) or [""] for k in columns]
        for line in range(max(map(len, cells))):
            texts = [cell[line] if line < len(cell) else "" for cell in cells]
            pairs = zip(texts, columns, strict=True)
            lines.append("  ".join(text.ljust(widths[k]) for text, k in pairs).rstrip())
        if not beside and row[last]:
            lines += textwrap.indent(textwrap.fill(row[last], width - 4), "    ").split("\n")
    return "\n".join(lines)
