"""Objects, plans and labels of frames as HTML tables for notebooks."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

from numpy.typing import NDArray

from perilune.base.html import folded, heading, table, whole
from perilune.frame.plan_rows import applies, cells, columns, state

if TYPE_CHECKING:
    from perilune.frame.labels import Taxonomy

_OBJECT_COLUMNS = ("instance", "obj_id", "visible", "pixels", "box x y w h", "t_m2c, m")


def objects_table(rows: NDArray[Any]) -> str:
    """Labels of spacecraft, a row each."""
    cells = [
        (
            int(row["instance_id"]),
            int(row["obj_id"]),
            f"{100.0 * float(row['visib_fract']):.1f} %",
            int(row["px_count_visib"]),
            row["bbox_visib"].tolist() if row["px_count_visib"] > 0 else None,
            [round(float(value), 3) for value in row["t_m2c"]],
        )
        for row in rows
    ]
    return table(_OBJECT_COLUMNS, cells)


def objects_html(rows: NDArray[Any]) -> str:
    """HTML table of the spacecraft's labels in a frame."""
    return whole(
        heading("Objects", "poses: t_m2c in the camera's axes, OpenCV"), objects_table(rows)
    )


_TINTS = {"on": "rgba(46,160,67,0.18)", "off": "none"}
_REDUCED = "rgba(210,153,34,0.22)"
"""Behind the rows of a plan: green on, amber reduced, none off."""


def plan_table(rows: Sequence[Mapping[str, Any]]) -> str:
    """Effects of a plan, those that are on first, then those that were left out, then those that
    the scene does not have; a colour for each state."""
    ordered = sorted(rows, key=lambda row: (not row["on"], not applies(row)))
    names = columns(rows)
    tints = [_TINTS.get(state(row), _REDUCED) for row in ordered]
    return table(names, [cells(row, names) for row in ordered], most=100, tints=tints)


def plan_html(rows: Sequence[Mapping[str, Any]], told: str) -> str:
    """HTML table of a frame's effects, those that are on first, below what is told of all."""
    return whole(heading("Plan", told), plan_table(rows))


def taxonomy_html(labels: Taxonomy) -> str:
    """HTML table of names and ids by channel; 0 is the background everywhere."""
    parts = [heading("Taxonomy", "id 0 is the background everywhere")]
    instances = [(id_, name) for name, id_ in labels.instances.items()]
    parts += [heading("instance"), table(("id", "name"), instances)]
    for level, classes in labels.classes.items():
        shown = labels.levels.index(level) if level in labels.levels else None
        where = "not shown" if shown is None else f"semantic[..., {shown}]"
        rows = [(id_, name) for name, id_ in classes.items()]
        parts += [heading(level, where), table(("id", "class"), rows)]
    owned = [(p.id, p.owner, p.name, p.material, p.class_name) for p in labels.parts]
    columns = ("id", "of", "part", "material", "class")
    parts.append(folded(f"part ({len(owned)})", table(columns, owned, most=200)))
    return whole(*parts)
