"""Checks what moves against what: names, cycles, masses and steps that orbits need."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING, Any

from perilune.config.attitude import GroundPointing, Spin, TargetPointing
from perilune.config.errors import fail, nearest
from perilune.config.orbit import ON_GROUND, Circular, Database, Hook, Kepler, Table, Tle
from perilune.config.standing import check_datum

if TYPE_CHECKING:
    from perilune.config.body import Body
    from perilune.config.schema import Config
    from perilune.config.spacecraft import Spacecraft


def sections(config: Config) -> Mapping[str, tuple[str, Body | Spacecraft]]:
    """Name -> (section, entry) of every body, then every spacecraft, in the order of the file."""
    bodies = {name: ("bodies", entry) for name, entry in config.bodies.items()}
    crafts = {name: ("spacecraft", entry) for name, entry in config.spacecraft.items()}
    return {**bodies, **crafts}


def _check_cycles(entities: Mapping[str, tuple[str, Any]]) -> None:
    for start, (section, _) in entities.items():
        chain, at = [start], start
        while (orbit := entities[at][1].orbit) is not None:
            at = orbit.around
            if at == start:
                text = " -> ".join([*chain, start])
                fail(f"{section}.{start}.orbit.around", f"a cycle: each is around the next: {text}")
            if at in chain:
                break  # a later cycle, reported where it begins
            chain.append(at)


def _needs_gm(orbit: Any) -> bool:
    if isinstance(orbit, Kepler):
        return orbit.position_km is None
    if isinstance(orbit, Database):
        return orbit.propagator != "circular"
    if isinstance(orbit, Hook):  # without a propagator, what the function returns decides
        return orbit.propagator in ("kepler", "j2")
    return not isinstance(orbit, (Circular, Table, Tle, *ON_GROUND))


def _steps(entry: Any) -> list[tuple[str, bool]]:
    """Keys below an entry that count by steps, and whether they do."""
    orbit, found = entry.orbit, []
    if isinstance(orbit, (Circular, Database, Hook)):
        found.append(("orbit.v_step", bool(orbit.v_step)))
    for key in ("rotation", "attitude"):
        turn = getattr(entry, key, None)
        if isinstance(turn, Spin):
            found.append((f"{key}.rotation_deg_step_v", turn.turns_by_step))
    return found


def _check_ground(config: Config, path: str, entry: Any) -> None:
    """Orbits on the ground are of spacecraft, about bodies."""
    orbit, attitude = entry.orbit, getattr(entry, "attitude", None)
    if isinstance(attitude, GroundPointing) and not isinstance(orbit, ON_GROUND):
        text = "ground: only with orbit.kind surface, traverse or powered_descent"
        fail(f"{path}.attitude.pointing", text)
    if not isinstance(orbit, ON_GROUND):
        return
    if attitude is None:
        fail(f"{path}.orbit.kind", f"{orbit.kind}: only for a spacecraft")
    if orbit.around not in config.bodies:
        fail(f"{path}.orbit.around", f"kind {orbit.kind} needs a body; {orbit.around} is none")
    check_datum(config, f"{path}.orbit", orbit, orbit.around)


def _but(names: Iterable[str], name: str) -> list[str]:
    return [other for other in names if other != name]


def check_steps(config: Config) -> None:
    """Inside a validator: what counts by steps needs their length."""
    if config.time.step_s != 0.0:
        return
    for name, (section, entry) in sections(config).items():
        for key, given in _steps(entry):
            if given:
                fail(f"{section}.{name}.{key}", "counts by steps: it needs time.step_s")


def check_motion(config: Config) -> None:
    """Inside a validator: checks all names, and what orbits need of other entries. It reads no
    numbers."""
    entities = sections(config)
    for name, (section, entry) in entities.items():
        path = f"{section}.{name}"
        if entry.orbit is not None:
            around = entry.orbit.around
            if around == name:
                fail(f"{path}.orbit.around", f"a cycle: {name} is around itself: {name} -> {name}")
            if around not in entities:
                text = f"no entry named '{around}'{nearest(around, _but(entities, name))}"
                fail(f"{path}.orbit.around", text)
            parent = config.spacecraft.get(around)
            if parent is not None and parent.gm_km3_s2 is None and _needs_gm(entry.orbit):
                text = f"an orbit about a spacecraft needs spacecraft.{around}.gm_km3_s2"
                fail(f"{path}.orbit.around", text)
        _check_ground(config, path, entry)
        attitude = getattr(entry, "attitude", None)
        if isinstance(attitude, TargetPointing):
            target = attitude.target
            if target == name:
                fail(f"{path}.attitude.target", "it cannot point at itself")
            if target not in entities:
                text = f"no entry named '{target}'{nearest(target, _but(entities, name))}"
                fail(f"{path}.attitude.target", text)
    if config.bodies[config.root].orbit is not None:
        fail(f"bodies.{config.root}.orbit", "the root body is the origin and has no orbit")
    _check_cycles(entities)
