"""Names and ids of the labels: semantic classes at each level, instances, parts."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from fnmatch import fnmatchcase
from functools import cached_property, lru_cache

import numpy as np
from numpy.typing import NDArray

from perilune.bodies.areas import names_of
from perilune.config.areas import SURFACE
from perilune.config.body import Body
from perilune.config.errors import ConfigError, nearest
from perilune.config.labels import GROUND, LEVELS, MATERIAL, ClassPatterns
from perilune.config.schema import Config
from perilune.config.spacecraft import Spacecraft
from perilune.frame.html import taxonomy_html
from perilune.spacecraft.parts import PartEntry

BACKGROUND = "background"
OTHERS = "others"
"""Name of -1 in `coverage_instance`: all instances that have no layer of their own."""
HAZARDS = {0: "safe", 1: "slope", 2: "roughness", 4: "rocks", 128: "unknown"}
"""Bits of the channel `hazard`, which are summed."""
SHADOWS = {0: "sunlit or sky", 1: "shadow"}
"""Values of the channel `shadow`."""
SHADOW_CAUSES = {0: "sunlit or sky", 1: "itself", 2: "object", 3: "body", 4: "terrain"}
"""Values of the channel `shadow_cause`."""
_OCCLUSION = {0: "seen there", 1: "not seen there"}
VALUES: Mapping[str, Mapping[int, str]] = {
    "hazard": HAZARDS,
    "shadow": SHADOWS,
    "shadow_cause": SHADOW_CAUSES,
    "flow_occlusion": _OCCLUSION,
    "flow_occlusion_backward": _OCCLUSION,
}
"""Names of the values of channels that do not depend on the configuration."""
_PART = "part"
_IDS_MAX = 65535


@dataclass(frozen=True)
class Part:
    """One part of an instance, as numbered in the channel `part`."""

    id: int
    owner: str
    """Name of the spacecraft or body."""
    name: str
    """Name, unique among the owner's parts."""
    material: str
    classes: Mapping[str, str]
    """Level -> its class at each level that tells parts apart."""

    @property
    def class_name(self) -> str:
        """Class at the level `part`."""
        return self.classes[_PART]


@dataclass(frozen=True)
class Taxonomy:
    """Names and ids of all labels of a configuration. Id 0 is the background everywhere."""

    levels: tuple[str, ...]
    classes: Mapping[str, Mapping[str, int]]
    """Level -> class name -> id, for all levels, whether in `semantic` or not."""
    instances: Mapping[str, int]
    """Entry name -> id in the channel `instance`."""
    parts: tuple[Part, ...]

    def names(self, channel: str) -> dict[int, str]:
        """Id -> name, for `instance`, `part`, or a level of `semantic` (its name or number)."""
        if channel == "instance":
            return {0: BACKGROUND, **{id_: name for name, id_ in self.instances.items()}}
        if channel == "coverage_instance":
            return {-1: OTHERS, **self.names("instance")}
        if channel == "part":
            return {0: BACKGROUND, **{part.id: f"{part.owner}/{part.name}" for part in self.parts}}
        level = channel.removeprefix("semantic/")
        if level.isdecimal() and int(level) < len(self.levels):
            level = self.levels[int(level)]
        if level not in self.classes:
            allowed = ["instance", "part", *self.levels]
            raise ValueError(f"no labels called '{channel}'{nearest(level, allowed)}")
        return {0: BACKGROUND, **{id_: name for name, id_ in self.classes[level].items()}}

    def _repr_html_(self) -> str:
        return taxonomy_html(self)

    @property
    def channel_names(self) -> dict[str, dict[int, str]]:
        """`names` of instance, part, semantic/0, semantic/1 ..."""
        channels = [
            "instance",
            "coverage_instance",
            "part",
            *(f"semantic/{k}" for k in range(len(self.levels))),
        ]
        named = {channel: self.names(channel) for channel in channels}
        return named | {channel: dict(values) for channel, values in VALUES.items()}

    def parts_of(self, owner: str) -> list[Part]:
        """Parts of a body or spacecraft, in the order in which the core has them."""
        return self._parts_of.get(owner, [])

    @cached_property
    def _parts_of(self) -> dict[str, list[Part]]:
        found: dict[str, list[Part]] = {}
        for part in self.parts:
            found.setdefault(part.owner, []).append(part)
        return found

    def class_ids(self, *names: Mapping[str, str]) -> NDArray[np.uint16]:
        """(n, levels): class ids of objects given by their class name at each level; 0 without
        one."""
        rows = [
            [self.classes[level][name[level]] if level in name else 0 for level in self.levels]
            for name in names
        ]
        return np.array(rows, dtype=np.uint16).reshape(len(names), len(self.levels))


TERRAIN, CRATER, ROCK, SPACECRAFT, BODY = "terrain", "crater", "rock", "spacecraft", "body"
"""Classes of the level `ground`, with ids from 1 on in this order; `body` is one without terrain.
"""


def ground_class(entry: Body | Spacecraft) -> str:
    """Class of an entry at the level `ground`, but for the craters and rocks of a body."""
    if isinstance(entry, Spacecraft):
        return SPACECRAFT
    return BODY if entry.terrain is None else TERRAIN


def object_class(name: str, entry: Body | Spacecraft) -> str:
    """Class of an entry at the level `object`: the given one, else the body's kind or the entry's
    name."""
    if entry.class_ is not None:
        return entry.class_
    return entry.kind if isinstance(entry, Body) and entry.kind != "ellipsoid" else name


def _texts(part: PartEntry) -> list[str]:
    """Texts that patterns of classes are matched with."""
    names = (part.name, part.base, part.material, f"{part.base}/{part.material}")
    return [name.lower() for name in names]


@lru_cache(maxsize=65536)  # spacecraft that are alike have equal parts
def _fits(pattern: str, part: PartEntry) -> bool:
    return any(fnmatchcase(text, pattern.lower()) for text in _texts(part))


def _first_match(part: PartEntry, *tables: ClassPatterns) -> str | None:
    """First class with a pattern that matches one of the part's names (case-insensitive).

    The names are the part's with and without its number, its material's, and name/material."""
    for table in tables:
        for class_name, patterns in table.items():
            if any(_fits(pattern, part) for pattern in patterns):
                return class_name
    return None


def part_class(config: Config, craft: Spacecraft, part: PartEntry) -> str:
    """Class of a part at the level `part`."""
    found = _first_match(part, craft.part_classes, config.labels.part_classes)
    return config.labels.other_part if found is None else found


def _own_classes(
    entry: Body | Spacecraft, part: PartEntry, shared: Mapping[str, ClassPatterns]
) -> dict[str, str]:
    """Class of a part at each level of one's own at which it has one."""
    found = {}
    for level, given in {**shared, **entry.classes}.items():
        name = given if isinstance(given, str) else _first_match(part, given)
        if name is not None:
            found[level] = name
    return found


def _part_classes(config: Config, craft: Spacecraft, part: PartEntry) -> dict[str, str]:
    """Level -> class of a part, at all levels that tell parts apart; none where it has id 0."""
    found = _own_classes(craft, part, config.labels.classes)
    found[_PART] = part_class(config, craft, part)
    if part.material:
        found[MATERIAL] = part.material
    return found


def _areas(body: Body) -> list[PartEntry]:
    """Parts of a body: its surface, and the areas on it."""
    return [PartEntry(name, name, "") for name in (SURFACE, *names_of(body.areas))]


def _stated(config: Config) -> Iterator[tuple[str, str, ClassPatterns]]:
    """Entry, key path and table of all patterns that an entry states itself."""
    for name, craft in config.spacecraft.items():
        yield name, f"spacecraft.{name}.part_classes", craft.part_classes
    classes = {("bodies", name): body.classes for name, body in config.bodies.items()}
    classes |= {("spacecraft", name): craft.classes for name, craft in config.spacecraft.items()}
    for (section, name), levels in classes.items():
        for level, given in levels.items():
            if not isinstance(given, str):
                yield name, f"{section}.{name}.classes.{level}", given


def unmatched(
    config: Config, parts: Mapping[str, Sequence[PartEntry]]
) -> Iterator[tuple[str, str]]:
    """(key path, message) of patterns of classes that match no part.

    In the tables of `labels`, which configurations may share, only classes are reported none of
    whose patterns matches a part of any spacecraft. parts: those of each spacecraft's model."""
    owned = {name: _areas(body) for name, body in config.bodies.items()} | dict(parts)
    for name, key, table in _stated(config):
        known = list(dict.fromkeys(text for part in owned[name] for text in (part.base, part.name)))
        for class_name, patterns in table.items():
            for pattern in patterns:
                if not any(_fits(pattern, part) for part in owned[name]):
                    text = f"'{pattern}' fits no part{nearest(pattern, known)}"
                    yield f"{key}.{class_name}", text
    every = [part for name in config.spacecraft for part in parts[name]]
    shared = {"labels.part_classes": config.labels.part_classes}
    for level, table in config.labels.classes.items():
        shared[f"labels.classes.{level}"] = table
    for key, table in shared.items():
        for class_name, patterns in table.items():
            if not any(_fits(pattern, part) for part in every for pattern in patterns):
                told = ", ".join(f"'{pattern}'" for pattern in patterns)
                yield f"{key}.{class_name}", f"no part of any spacecraft fits {told}"


def _numbered(level: str, names: Iterable[str], fixed: Mapping[str, int]) -> dict[str, int]:
    """Ids of class names: the fixed ones, and the smallest free numbers in order."""
    known = list(dict.fromkeys(names))
    for name in fixed:
        if name not in known:
            raise ConfigError(f"labels.ids.{level}: no class named '{name}'{nearest(name, known)}")
    ids: dict[str, int] = {}
    free = (number for number in range(1, _IDS_MAX + 1) if number not in set(fixed.values()))
    for name in known:
        ids[name] = fixed[name] if name in fixed else next(free)
    return ids


def _class_names(config: Config, parts: Mapping[str, Sequence[PartEntry]]) -> dict[str, list[str]]:
    """Names of classes at each level, in the order in which they are numbered."""
    labels, crafts = config.labels, config.spacecraft
    areas = [name for body in config.bodies.values() for name in names_of(body.areas)]
    tables = [labels.part_classes, *(craft.part_classes for craft in crafts.values())]
    names = {
        "kind": ["body", "spacecraft"],
        "object": [
            *(object_class(name, body) for name, body in config.bodies.items()),
            *(object_class(name, craft) for name, craft in crafts.items()),
        ],
        _PART: [SURFACE, *areas, *(name for table in tables for name in table), labels.other_part],
        GROUND: [TERRAIN, CRATER, ROCK, SPACECRAFT, BODY],
        MATERIAL: [part.material for rows in parts.values() for part in rows if part.material],
    }
    for level in labels.levels:
        if level in names:
            continue
        names[level] = list(labels.classes.get(level, ()))
        own: list[str | Iterable[str]] = [
            body.classes.get(level, ()) for body in config.bodies.values()
        ]
        own += [craft.classes.get(level, ()) for craft in crafts.values()]
        own += [
            row.labels[level].classes for row in config.materials.values() if level in row.labels
        ]
        for given in own:
            names[level] += [given] if isinstance(given, str) else list(given)
    return {level: names[level] for level in dict.fromkeys((*LEVELS, *labels.levels))}


def graph_levels(config: Config) -> dict[str, tuple[int, dict[str, int]]]:
    """Levels at which material graphs say classes: level -> its place in `semantic`, and ids."""
    used = {level for row in config.materials.values() for level in row.labels}
    names = _class_names(config, {})
    return {
        level: (k, _numbered(level, names[level], config.labels.ids.get(level, {})))
        for k, level in enumerate(config.labels.levels)
        if level in used
    }


def taxonomy(config: Config, parts: Mapping[str, Sequence[PartEntry]]) -> Taxonomy:
    """Numbers all labels; `parts` are those of each spacecraft's model.

    Class ids follow from the configuration alone, but for those of the level `material`, which
    follow from the models, as part ids do."""
    classes = {
        level: _numbered(level, names, config.labels.ids.get(level, {}))
        for level, names in _class_names(config, parts).items()
    }
    instances = {name: k for k, name in enumerate([*config.bodies, *config.spacecraft], start=1)}
    rows: list[Part] = []
    for name, body in config.bodies.items():
        for area in _areas(body):
            own = {**_own_classes(body, area, {}), _PART: area.name}
            rows.append(Part(len(rows) + 1, name, area.name, "", own))
    for name, craft in config.spacecraft.items():
        for part in parts[name]:
            own = _part_classes(config, craft, part)
            rows.append(Part(len(rows) + 1, name, part.name, part.material, own))
    return Taxonomy(config.labels.levels, classes, instances, tuple(rows))
