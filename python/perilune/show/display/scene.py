"""A simulation, its configuration and its labels in a notebook."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from perilune.base.html import flat, folded, heading, table, whole

if TYPE_CHECKING:
    from perilune.config.types import Strict
    from perilune.frame.labels import Taxonomy
    from perilune.simulation import Simulation


def _things(sim: Simulation) -> list[tuple[Any, ...]]:
    rows: list[tuple[Any, ...]] = []
    config = sim.config
    for section, entries in (("body", config.bodies), ("spacecraft", config.spacecraft)):
        for name, entry in entries.items():
            what = getattr(entry, "kind", None) or getattr(entry, "model", "")
            orbit = entry.orbit
            around = "at the root" if orbit is None else f"{orbit.kind} around {orbit.around}"
            rows.append((name, section, what, around))
    return rows


def _cameras(sim: Simulation) -> list[tuple[Any, ...]]:
    rows = []
    for name, camera in sim.config.cameras.items():
        view = f"{camera.fov_deg:g} deg" if camera.fov_deg is not None else "by focal_px or K"
        sensor = "with a sensor model" if camera.sensor is not None else ""
        size = f"{camera.width} x {camera.height}"
        rows.append((name or "camera", size, view, camera.trajectory.kind, sensor))
    return rows


def simulation_html(sim: Simulation) -> str:
    """What is in it, what takes its frames, and what varies."""
    config, document = sim.config, sim.document
    dim = f"{document.source}, seed {config.seed}, from {config.time.epoch}"
    drivers = [(row.name, row.kind.name, row.ideal, row.group) for row in document.drivers]
    columns = ("key", "distribution", "ideal", "group")
    return whole(
        heading(f"Simulation {config.name}", dim),
        heading("", config.description) if config.description else "",
        table(("name", "", "kind or model", "orbit"), _things(sim)),
        table(("camera", "size", "field of view", "trajectory", ""), _cameras(sim)),
        folded(f"drivers ({len(drivers)})", table(columns, drivers)),
        folded("configuration", table(("key", "value"), flat(document.tree), most=400)),
    )


def configuration_html(section: Strict) -> str:
    """All keys of a section, those that are given in it before those that are left out."""
    given = flat(section.model_dump(by_alias=True, exclude_unset=True, mode="json"))
    names = {path for path, _ in given}
    every = flat(section.model_dump(by_alias=True, exclude_none=True, mode="json"))
    others = [(path, value) for path, value in every if path not in names]
    defaults = table(("key", "value"), others, most=400)
    return whole(
        heading(type(section).__name__, (section.__doc__ or "").split("\n")[0]),
        table(("key", "value"), given, most=400),
        folded(f"defaults ({len(others)})", defaults),
    )


def taxonomy_html(labels: Taxonomy) -> str:
    """Names and ids, channel by channel; 0 is the background everywhere."""
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
