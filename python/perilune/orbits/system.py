"""The tree of a frame: central bodies, paths and rotations of all objects, and their states."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from perilune.base import rotations
from perilune.config.attitude import AttitudeTable, GroundPointing, Spin
from perilune.config.body import Body
from perilune.config.errors import ConfigError
from perilune.config.motion import sections
from perilune.config.orbit import ON_GROUND, Hook
from perilune.config.schema import Config
from perilune.config.spacecraft import Spacecraft
from perilune.orbits import hooked, paths
from perilune.orbits.almanac import almanac
from perilune.orbits.motion import Kept, States, evaluate, propagator
from perilune.orbits.place import Motion, Place
from perilune.orbits.riding import Ride
from perilune.orbits.setting import KM, Setting, ephemeris_name, parent_of, radii_m
from perilune.orbits.solar_system import Date
from perilune.orbits.sun import sun_position_m
from perilune.orbits.turns import SUN, body_turn, craft_turn, riding_turn

F64 = NDArray[np.float64]
Node = dict[str, Any]


def _ephemeris(setting: Setting, name: str) -> Motion:
    """Path of a body without an orbit, relative to the root."""
    config = setting.config
    if name == config.root:
        return {"kind": "fixed", "position_m": np.zeros(3)}
    own, origin = ephemeris_name(config, name), ephemeris_name(config, config.root)
    if own is None or origin is None:
        raise ValueError("its place is not known: give an orbit, or an ephemeris")
    if own == origin:
        raise ValueError(
            f"it stands where the root body is (the ephemeris of {own}); give an orbit"
        )
    epoch, places = setting.epoch, almanac(config)

    def path(t_s: F64) -> F64:
        return np.stack([places.relative_state(own, origin, epoch.after(t)) for t in t_s])

    return path


def _beside_site(config: Config, epoch: Date, t_s: F64) -> F64:
    """States (n, 6) of a Sun that keeps its place in the sky of a site; its velocity serves
    nothing, because no orbit is about it."""
    places = np.stack([sun_position_m(config, epoch, t) for t in t_s.tolist()])
    return np.hstack([places, np.zeros_like(places)])


def _sun(setting: Setting) -> Motion:
    config, epoch = setting.config, setting.epoch
    if config.sun.direction is not None:
        return {"kind": "fixed", "position_m": sun_position_m(config, epoch, 0.0)}
    if config.sun.at is not None:
        return lambda t_s: _beside_site(config, epoch, t_s)
    origin = ephemeris_name(config, config.root)
    assert origin is not None  # the root always has one
    places = almanac(config)

    def path(t_s: F64) -> F64:
        return np.stack([places.relative_state("sun", origin, epoch.after(t)) for t in t_s])

    return path


def _hooked(setting: Setting, name: str, orbit: Any) -> bool:
    return name in setting.hooks or isinstance(orbit, Hook)


def _path(setting: Setting, name: str, entry: Any, section: str) -> Motion:
    """Path of an object relative to its central body."""
    if entry.orbit is None:
        return _ephemeris(setting, name)
    key = f"{section}.{name}.orbit"
    if not _hooked(setting, name, entry.orbit) and entry.orbit.kind != "database":
        return paths.make(entry.orbit, Place(setting, name, key, entry.orbit.around))
    kept: Kept[Motion] = setting.drawn
    return kept.get((setting.scene, name), lambda: _drawn(setting.start, name, key))


def _drawn(start: Setting, name: str, key: str) -> Motion:
    """A path drawn once a scene, from the scene's first step, where it begins."""
    orbit = sections(start.config)[name][1].orbit
    assert orbit is not None  # drivers change numbers alone
    since = replace(start, epoch=start.epoch.after(start.start_s))
    place = Place(since, name, key, orbit.around)
    if _hooked(start, name, orbit):
        known = _known_before(start, name)
        motion = hooked.hook(orbit, place, lambda: _surroundings(start, known))
    else:
        motion = paths.make(orbit, place)
    return _later(motion, since.epoch, start.start_s)


def _later(motion: Motion, begin: Date, begin_s: float) -> Motion:
    """Converts a path whose time starts at `begin`, begin_s after the epoch, to one from the
    epoch."""
    if begin_s == 0.0 or (isinstance(motion, Mapping) and motion["kind"] == "fixed"):
        return motion
    if isinstance(motion, Mapping):
        spec = motion
        return lambda t_s: propagator(spec, begin).states(t_s - begin_s)
    path = motion
    return lambda t_s: path(t_s - begin_s)


def _known_before(setting: Setting, name: str) -> list[str]:
    """Objects that a hook's orbit may see: all that move without a hook that comes at or after
    it."""
    entities = sections(setting.config)
    order = list(entities)
    later = {
        other
        for other in order[order.index(name) :]
        if entities[other][1].orbit is not None
        and _hooked(setting, other, entities[other][1].orbit)
    }
    known = []
    for other in order:
        at: str | None = other
        while at is not None and at not in later:
            orbit = entities[at][1].orbit
            at = None if orbit is None else orbit.around
        if at is None:
            known.append(other)
    return known


def _radii_m(setting: Setting, name: str) -> F64:
    return parent_of(setting, name).radii_m


def _surroundings(setting: Setting, known: list[str]) -> hooked.Surroundings:
    """Poses and radii of some objects at the scene's first step."""
    found = System(setting, known).states(np.array([setting.start_s]))
    entries: dict[str, hooked.Entity] = {}
    for name in known:
        radii = partial(_radii_m, setting, name)
        entries[name] = hooked.Entity(found.poses[name][0], radii)
    return hooked.Surroundings(entries)


def _nodes(setting: Setting, names: list[str]) -> list[Node]:
    """The tree's nodes for some objects, followed by the Sun's if one of them points at it."""
    index = {name: k for k, name in enumerate(names)}
    index[SUN] = len(names)
    return _with_sun(setting, [_node(setting, name, index) for name in names], index)


def _node(setting: Setting, name: str, index: Mapping[str, int]) -> Node:
    """index: name -> node."""
    config = setting.config
    section, entry = sections(config)[name]
    try:
        motion = _path(setting, name, entry, section)
        if isinstance(entry, Body):
            turn = body_turn(entry, setting)
        else:
            # A target that is not known yet cannot be pointed at yet.
            target = getattr(entry.attitude, "target", name)
            turn = {"frame": "inertial"}
            stands = _stands(entry)
            if isinstance(motion, Ride) and stands is not None:
                turn = riding_turn(stands, motion.axes, setting)
            elif target in index:
                turn = craft_turn(name, entry.attitude, setting, index)
    except (ValueError, OSError) as error:
        raise _named(error, f"{section}.{name}") from None
    parent = -1 if name == config.root else index[_around(config, entry)]
    return {"name": name, "parent": parent, "motion": motion, "rotation": turn}


def _around(config: Config, entry: Body | Spacecraft) -> str:
    """Central body of an object; the root without an orbit."""
    return config.root if entry.orbit is None else entry.orbit.around


def _with_sun(setting: Setting, nodes: list[Node], index: Mapping[str, int]) -> list[Node]:
    config = setting.config
    if any(node["rotation"].get("frame") == "sun" for node in nodes):
        sun = {"motion": _sun(setting), "rotation": {"frame": "inertial"}}
        nodes.append({"name": SUN, "parent": index[config.root], **sun})
    return nodes


def _stands(craft: Spacecraft) -> Spin | None:
    """The attitude of a spacecraft, if relative to the axes of its place on the ground when it is
    there."""
    given = craft.attitude
    stated = "attitude" in craft.model_fields_set
    return given if isinstance(given, GroundPointing if stated else Spin) else None


_OF_NUMBERS = ("kepler", "circular", "j2")
"""Kinds of orbits that need neither files nor what is drawn once a scene."""


def _lasting(setting: Setting, names: list[str]) -> list[Node]:
    """The nodes of all entities, kept while nothing that they are made from changes."""
    config = setting.config
    orbits = all(
        entry.orbit is None or entry.orbit.kind in _OF_NUMBERS
        for _, entry in sections(config).values()
    )
    files = config.ephemeris.kernels or any(
        isinstance(craft.attitude, AttitudeTable) for craft in config.spacecraft.values()
    )
    if setting.hooks or files or not orbits:
        return _nodes(setting, names)
    read = (config.bodies, config.spacecraft, config.time, config.sun, config.root)

    def make() -> list[Node]:
        index = {name: k for k, name in enumerate((*names, SUN))}
        return _with_sun(setting, [_lasting_node(setting, name, index) for name in names], index)

    return setting.nodes.of((*read, setting.epoch), make)


def _lasting_node(setting: Setting, name: str, index: Mapping[str, int]) -> Node:
    """A node, kept while its entry and that of its central body stay the same."""
    config = setting.config
    entries = sections(config)
    _, entry = entries[name]
    _, around = entries[_around(config, entry)]
    read = (entry, around, entries[config.root][1], config.time, setting.epoch)
    return setting.each_node.of(name, read, lambda: _node(setting, name, index))


def _named(error: Exception, key: str) -> Exception:
    """Keeps errors that name their key themselves: of missing files, and of grounds."""
    return error if isinstance(error, (OSError, ConfigError)) else ValueError(f"{key}: {error}")


def _check_over_ground(setting: Setting, found: States, t_s: F64, name: str, around: str) -> None:
    """The same for a central body with terrain."""
    section, _ = sections(setting.config)[name]
    ground = setting.ground(around)
    assert ground.bounds_m is not None  # it is of a terrain
    high = float(ground.radii_m.max()) + ground.bounds_m[1]
    for k, (pose, parent) in enumerate(zip(found.poses[name], found.poses[around], strict=True)):
        own = rotations.rotate_back(parent[3:], pose[:3] - parent[:3])
        distance = float(np.linalg.norm(own))
        depth = -ground.height_m(own) if 0.0 < distance <= high else 0.0
        if depth > 0.0 or distance == 0.0:
            when = setting.epoch.after(float(t_s[k])).utc()
            raise ValueError(
                f"{section}.{name}.orbit: at {when} it is {max(depth, 0.0):.6g} m below the ground "
                f"of {around}"
            )


def _check_above(setting: Setting, found: States, t_s: F64, names: list[str]) -> None:
    """ValueError that names the orbit of an object whose centre is inside its central body."""
    entities = sections(setting.config)
    for name in names:
        section, entry = entities[name]
        if entry.orbit is None or entry.orbit.around not in setting.config.bodies:
            continue
        if isinstance(entry.orbit, ON_GROUND):
            continue
        around = entry.orbit.around
        if setting.config.bodies[around].terrain is not None:
            _check_over_ground(setting, found, t_s, name, around)
            continue
        radii = radii_m(setting.config.bodies[around])
        for k, pose in enumerate(found.poses[name]):
            parent = found.poses[around][k]
            from_center = pose[:3] - parent[:3]
            size = rotations.norm(rotations.rotate_back(parent[3:], from_center) / radii)
            if size < 1.0 - 1e-9:
                distance = rotations.norm(from_center)
                deep = distance * (1.0 / size - 1.0) / KM if size > 0.0 else radii.min() / KM
                when = setting.epoch.after(float(t_s[k])).utc()
                raise ValueError(
                    f"{section}.{name}.orbit: at {when} it is {deep:.6g} km below the surface of "
                    f"{around}"
                )


def _with_section(error: ValueError, setting: Setting) -> ValueError:
    """Adds the entry to errors that name only the node, such as "node 'iss'" from the core."""
    if isinstance(error, ConfigError):
        return error
    name, _, text = str(error).removeprefix("node ").partition(": ")
    name = name.strip("'")
    found = sections(setting.config).get(name)
    return error if found is None else ValueError(f"{found[0]}.{name}: {text}")


class System:
    """Everything that moves in a frame. Orbits are drawn, read and requested from hooks once, here.

    ValueError names the entry that cannot be placed."""

    def __init__(self, setting: Setting, names: list[str] | None = None) -> None:
        """names: only these objects, which must include all their central bodies."""
        self.setting = setting
        self._names = list(sections(setting.config)) if names is None else names
        self._nodes = _lasting(setting, self._names) if names is None else _nodes(setting, names)

    def states(self, t_s: F64) -> States:
        """States of every body and spacecraft in the root frame, t_s (n,) seconds after the epoch.

        ValueError for a path without a state, or below the surface of its central body."""
        t_s = np.asarray(t_s, dtype=np.float64)
        try:
            found = evaluate(self._nodes, self.setting.epoch, t_s)
        except ValueError as error:
            raise _with_section(error, self.setting) from None
        _check_above(self.setting, found, t_s, self._names)
        poses = {name: found.poses[name] for name in self._names}
        return States(poses, {name: found.velocities_m_s[name] for name in self._names})
