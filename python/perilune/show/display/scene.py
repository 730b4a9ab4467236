"""A simulation in a notebook."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from perilune.base.html import flat, folded, heading, table, whole

if TYPE_CHECKING:
    from perilune.simulation import Simulation


def _entities(sim: Simulation) -> list[tuple[Any, ...]]:
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
    """Objects of a simulation, its cameras, and what varies."""
    config, document = sim.config, sim.document
    dim = f"{document.source}, seed {config.seed}, from {config.time.epoch}"
    drivers = [(row.name, row.kind.name, row.ideal, row.group) for row in document.drivers]
    columns = ("key", "distribution", "ideal", "group")
    return whole(
        heading(f"Simulation {config.name}", dim),
        heading("", config.description) if config.description else "",
        table(("name", "", "kind or model", "orbit"), _entities(sim)),
        table(("camera", "size", "field of view", "trajectory", ""), _cameras(sim)),
        folded(f"drivers ({len(drivers)})", table(columns, drivers)),
        folded("configuration", table(("key", "value"), flat(document.tree), most=400)),
    )
