"""A loaded configuration: its tree, the folder of its paths, its drivers and values."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property
from operator import is_
from pathlib import Path
from typing import Any, NamedTuple, TypeVar

from pydantic import ValidationError

from perilune.base.hooks import HookError
from perilune.config.errors import (
    ConfigError,
    from_validation,
    named,
    nearest,
    origin,
    shown,
    unread,
    warn,
)
from perilune.config.schema import Config
from perilune.document import intrinsics, shipped
from perilune.document.fixed import fixed
from perilune.document.instances import spread
from perilune.document.limits import Limits, contains
from perilune.document.loader import is_oaisys, plain_tree, read_tree
from perilune.document.material_files import include
from perilune.document.model_graphs import include_models
from perilune.document.overrides import apply_overrides, joined, without_unread
from perilune.document.patch import Patch
from perilune.document.paths import resolve
from perilune.document.references import check_references
from perilune.drivers import (
    Defaults,
    DriverError,
    Found,
    KeyPath,
    Named,
    Plan,
    find,
    names,
    substitute,
    without,
)
from perilune.drivers.choice import KIND as CHOICE
from perilune.drivers.hook import KIND as HOOK

_KEPT_STEPS = 4
"""Number of steps whose configurations are cached: this one, its scene's first, a metered one."""
_KEPT_PATCHES = 16
"""Number of combinations of choices that are cached."""


_T = TypeVar("_T")


def _keep(kept: dict[Any, Any], most: int, key: Any, value: _T) -> _T:
    """Adds a value to a cache of limited size."""
    while len(kept) >= most:
        kept.pop(next(iter(kept)), None)
    kept[key] = value
    return value


def _is_numbers(value: Any) -> bool:
    """Whether a driver's value is a number or a list of numbers."""
    if isinstance(value, (list, tuple)):
        return all(map(_is_numbers, value))
    return isinstance(value, (int, float)) and not isinstance(value, bool)


@dataclass(frozen=True)
class Given:
    """Source of a document, which documents with other changes start from."""

    tree: Mapping[str, Any]
    """The tree as written, or translated from an OAISYS file; without overrides and included
    files."""
    base: Path
    source: str
    origins: Mapping[str, str]
    overrides: Mapping[str, Any]
    """Overrides of perilune.open."""
    replay: Mapping[str, Any] | None


class _Ideal(NamedTuple):
    """Where a limit of a driver is tried: all drivers have their ideals there."""

    tree: Mapping[str, Any]
    config: Config
    fixed: Mapping[str, Any]
    """What no driver may change there."""
    patch: Patch


class Document:
    """The configuration of a simulation; pickles as its tree and validates again when loaded."""

    given: Given | None = None
    changes: Mapping[str, Any]
    """Key path -> value: changes since the configuration was opened."""

    def __init__(
        self,
        tree: Mapping[str, Any],
        base: Path,
        source: str,
        origins: Mapping[str, str] | None = None,
        replay: Mapping[str, Any] | None = None,
        *,
        limits_known: bool = False,
    ) -> None:
        """origins: key path -> key path in the file, for a translated or included one; for errors.
        replay: metadata of a frame whose drivers' values are used instead of new ones.
        limits_known: the drivers' limits were validated before, in the same tree."""
        self.changes = {}
        self.tree = plain_tree(tree, source)
        self.base = base
        self.source = source
        self.origins = dict(origins or {})
        try:
            self._plan = Plan(tuple(find(self.tree)))
            for driver in self.drivers:
                if driver.path[0] == "drivers":
                    raise DriverError(driver.name, "takes no driver: it sets those of others")
            self.config = self._validate(self._plan.ideals, self._plan.ideal_keys)
            self._plan = self._grouped()
        except (DriverError, HookError) as error:
            raise ConfigError(f"{source}: {named(str(error), self.origins)}") from None
        if not limits_known:
            self._check_clips()
        self._configs: dict[int, Config] = {}
        self._drawn: dict[int, Mapping[KeyPath, Any]] = {}
        self._patches: dict[str, Patch] = {}
        self._replay = dict(replay) if replay is not None else None
        self._recorded = self._records(self._replay) if self._replay is not None else {}

    def __reduce__(self) -> tuple[Any, ...]:
        arguments = (self.tree, self.base, self.source, self.origins, self._replay)
        return _unpickled, (arguments, self.given, self.changes)

    def changed(self, changes: Mapping[str, Any], known: bool = False) -> Document:
        """The same configuration with other values at some key paths, in the form of overrides.

        known: they were checked before, so the drivers' limits are not validated again."""
        given = self.given
        if given is None:  # not from `load`; its tree has all that was changed before
            given = Given(self.tree, self.base, self.source, self.origins, {}, self._replay)
        together = joined(self.changes, plain_tree(changes, "overrides"))
        # Strengths and intervals do not move the limits, which were tried when it was opened.
        settings = all(key.startswith("drivers.") for key in changes)
        made = _made(given, together, known or settings)
        if not known:
            told = set(self.doubts())
            for line in made.doubts():
                if line not in told:
                    warn(line)
        return made

    @property
    def replay(self) -> Mapping[str, Any] | None:
        """Metadata of the frame whose drivers' values are used instead of new ones."""
        return self._replay

    @property
    def drivers(self) -> tuple[Found, ...]:
        """All drivers, in the order of the tree."""
        return self._plan.drivers

    def at(self, frame: int) -> tuple[Config, Mapping[str, Any]]:
        """The configuration of a frame, and the values of its drivers, by key path.

        All frames of a step have the same."""
        if not self.drivers:
            return self.config, {}
        step = self.config.timeline.at(frame).step
        values = self._values(step)
        config = self._configs.get(step)
        if config is None:
            made = self._like(step, values) or self._patched(values)
            config = _keep(self._configs, _KEPT_STEPS, step, made)
        return config, Named(self.drivers, values)

    def _like(self, step: int, values: Mapping[KeyPath, Any]) -> Config | None:
        """The configuration of another step for which drivers drew the very same values: those of a
        run of steps, as drivers keep a value for their interval."""
        for other, config in list(self._configs.items()):
            theirs = self._drawn.get(other)
            if theirs is not None and all(map(is_, values.values(), theirs.values())):
                return config
        return None

    def _patched(self, values: Mapping[KeyPath, Any]) -> Config:
        """The configuration with the given numbers as values of the drivers."""
        chosen = {path: values[path] for path in self._choosing if not _is_numbers(values[path])}
        key = repr(chosen)
        patch = self._patches.get(key)
        if patch is not None:
            config = patch.tried(values)
            if config is not None:
                return config
        config = self._validate(values)
        if patch is None:
            fixed = {} if self._recorded else self._plan.fixed
            driven = [path for path in values if path not in chosen and path not in fixed]
            tree = substitute(self.tree, {**fixed, **chosen})
            patch = Patch(config, tree, driven, self.path)
            _keep(self._patches, _KEPT_PATCHES, key, patch)
        return config

    @cached_property
    def _choosing(self) -> list[KeyPath]:
        """Paths of the drivers that may draw other values than numbers."""
        return [row.path for row in self.drivers if row.kind in (CHOICE, HOOK)]

    def scene_values(self, frame: int) -> dict[str, Any]:
        """Values of the drivers at the first step of a frame's scene, where they differ from the
        frame's.

        Orbits that are drawn once a scene depend on them."""
        step = self.config.timeline.at(frame).step
        first = self._first_step(step)
        if not self.drivers or first == step:
            return {}
        now, then = (Named(self.drivers, self._values(at)) for at in (step, first))
        return {name: value for name, value in then.items() if value != now[name]}

    def _first_step(self, step: int) -> int:
        """Step of the first frame of a step's scene."""
        per_scene = self.config.time.frames_per_scene
        timeline = self.config.timeline
        return timeline.at(timeline.frames_before(step // per_scene * per_scene)).step

    def _values(self, step: int) -> Mapping[KeyPath, Any]:
        found = self._drawn.get(step)
        if found is not None:
            return found
        try:
            values = self._plan.values(self.config.seed, step)
        except (DriverError, HookError) as error:
            raise ConfigError(f"{self.source}: {error}") from None
        return _keep(self._drawn, _KEPT_STEPS, step, {**values, **self._recorded.get(step, {})})

    def _records(self, meta: Mapping[str, Any]) -> dict[int, dict[KeyPath, Any]]:
        """Step -> values recorded in the metadata of a frame."""
        paths = {driver.name: driver.path for driver in self.drivers}
        for key in ("index", "drivers"):
            if key not in meta:
                raise ConfigError(f"replay: the metadata of a sample have a key '{key}'")
            if key == "drivers" and not isinstance(meta[key], Mapping):
                raise ConfigError(f"replay: drivers: must be a mapping, not {shown(meta[key])}")
        index, now = meta["index"], meta["drivers"]
        if type(index) is not int or not 0 <= index < 2**31:
            raise ConfigError(f"replay: index: must be that of a frame, not {index!r}")
        then = {**now, **meta.get("scene_drivers", {})}
        for name in then:
            if name not in paths:
                raise ConfigError(f"replay: no driver '{name}'{nearest(name, paths)}")
        for name in paths:
            if name not in now:
                raise ConfigError(f"replay: no value of the driver {name}")
        step = self.config.timeline.at(index).step
        first = self._first_step(step)
        rows = {
            at: {paths[name]: value for name, value in row.items()}
            for at, row in ((first, then), (step, now))
        }
        for values in rows.values():
            self._validate(values)
        return rows

    def _grouped(self) -> Plan:
        """The drivers with their groups, defaults and functions."""
        section = self.config.drivers
        members = [
            (member, f"drivers.groups.{name}.members[{k}]")
            for name, group in section.groups.items()
            for k, member in enumerate(group.members or ())
        ]
        keys = set(names(self.tree)) if members else set()
        for member, key in members:
            if member not in keys:  # one with a plain value is no error: it may be an override
                known = [driver.name for driver in self.drivers]
                raise DriverError(key, f"no key '{member}'{nearest(member, known)}")
        interval = section.interval or self.config.time.frames_per_scene
        plan = Plan(
            self.drivers,
            {name: group.resolved(name) for name, group in section.groups.items()},
            Defaults(section.strength, interval),
        )
        plan.check()
        return plan.loaded(self.path)

    def path(self, text: str, key: str) -> Path:
        """Resolves a path of the configuration; `key` names it in errors."""
        return resolve(text, self.base, f"{self.source}: {origin(key, self.origins)}")

    def _validate(
        self,
        values: Mapping[KeyPath, Any],
        parts: Mapping[str, str] | None = None,
        given: Mapping[str, Any] | None = None,
    ) -> Config:
        """parts: key path of each driver -> the driver's key that the value comes from; default:
        drawn. given: the tree with fewer spacecraft; default: the whole one."""
        if given is None:
            given = self.tree
        else:
            values = {path: value for path, value in values.items() if contains(given, path)}
        tree = substitute(given, values)
        while True:
            try:
                return Config.model_validate(tree, context={"path": self.path})
            except ValidationError as error:
                idle = unread(error, tree)
                if not idle or not all(self._beside_choice(path) for path in idle):
                    driven = parts or {driver.name: "" for driver in self.drivers}
                    raise from_validation(error, tree, self.source, driven, self.origins) from None
                for path in idle:
                    tree = without(tree, path)

    def doubts(self) -> Iterator[str]:
        """Things that are allowed but probably not intended, one line each."""
        for driver, limit, share in self._plan.piled():
            key = origin(driver.name, self.origins)
            yield (
                f"{self.source}: {key}: {share:.0%} of its draws are clipped to {limit}; "
                "`truncated: true` draws them between the limits"
            )
        before = self.tree if self.given is None else self.given.tree
        yield from intrinsics.doubts(self.tree, before, self.source)

    def _beside_choice(self, path: KeyPath) -> bool:
        """Whether another value of a choice in the same section may read a key."""
        return any(
            driver.kind is CHOICE and driver.path[:-1] == path[:-1] and driver.path != path
            for driver in self.drivers
        )

    def choices(self, chosen: Callable[[KeyPath], bool]) -> Iterator[Config]:
        """The configuration with each limit of the drivers at some key paths, one at a time.

        For a choice these are all its values."""
        for driver in self.drivers:
            if chosen(driver.path):
                for limit in driver.distribution.limits.values():
                    yield self._validate({**self._plan.ideals, driver.path: limit})

    def _check_clips(self) -> None:
        """Checks that each driver's limits are valid values, so that no later frame fails on
        them."""
        limits = Limits(self.tree)
        place = _Ideal(self.tree, self.config, fixed(self.config), self._patch_of(self.tree))
        owner = None
        for driver in self.drivers:
            untried = limits.untried(driver)
            if untried and limits.owner(driver.path) != owner:
                owner = limits.owner(driver.path)
                tree = limits.tree_for(owner)
                ideal = self._validate(self._plan.ideals, self._plan.ideal_keys, tree)
                place = _Ideal(tree, ideal, fixed(ideal), self._patch_of(tree, ideal))
            for part, limit in untried:
                self._check_limit(driver, part, limit, place)

    def _patch_of(self, tree: Mapping[str, Any], ideal: Config | None = None) -> Patch:
        """For the numbers of all drivers in a tree. ideal: what is configured there with all
        drivers at their ideals."""
        chosen = {path: self._plan.ideals[path] for path in self._choosing if contains(tree, path)}
        numbers = [row.path for row in self.drivers if row.path not in self._choosing]
        driven = [path for path in numbers if contains(tree, path)]
        return Patch(ideal or self.config, substitute(tree, chosen), driven, self.path)

    def _check_limit(self, driver: Found, part: str, limit: Any, place: _Ideal) -> None:
        """Checks one limit."""
        ideals, ideal_keys = self._plan.ideals, self._plan.ideal_keys
        values = {**ideals, driver.path: limit}
        config = None
        if driver.path not in self._choosing:
            config = place.patch.tried(values)
        if config is None:
            config = self._validate(values, {**ideal_keys, driver.name: part}, place.tree)
        check_references(config, self.source, self.drivers, self.origins, place.config)
        for key, value in fixed(config).items():
            if place.fixed.get(key) != value:
                raise ConfigError(
                    f"{self.source}: {driver.name}: takes no driver: it changes {key}, "
                    "which is fixed when the scene is built"
                )


def _unpickled(
    arguments: tuple[Any, ...], given: Given | None, changes: Mapping[str, Any]
) -> Document:
    document = Document(*arguments, limits_known=True)
    document.given, document.changes = given, changes
    return document


def _made(given: Given, changes: Mapping[str, Any], limits_known: bool = False) -> Document:
    """A document with the overrides of perilune.open, followed by later changes."""
    tree, base, source = plain_tree(given.tree, given.source), given.base, given.source
    for overrides in (given.overrides, changes):
        apply_overrides(tree, plain_tree(overrides, "overrides"))
    origins = {**given.origins, **include(tree, base, source)}
    origins |= include_models(tree, base, source)
    spread(tree)
    while True:
        try:
            document = Document(
                tree, base, source, origins, given.replay, limits_known=limits_known
            )
        except ConfigError as error:
            fewer = without_unread(tree, error.unread, [*given.overrides, *changes])
            if not error.unread or fewer is None:
                raise
            tree = fewer
        else:
            document.given, document.changes = given, dict(changes)
            return document


def load(
    config: str | os.PathLike[str] | Mapping[str, Any],
    overrides: Mapping[str, Any] | None = None,
    base: Path | None = None,
    replay: Mapping[str, Any] | None = None,
) -> Document:
    """Loads a YAML or JSON file, or takes a mapping (paths relative to `base`, default: here).

    A file with the sections of OAISYS is translated first; overrides use Perilune's keys. If an
    override changes a mode, keys that only the former mode reads are removed. replay: see
    perilune.open; it repeats the changes with which that frame was made."""
    if isinstance(config, Mapping):
        source = "configuration"
        tree = plain_tree(config, source)
        base = base or Path.cwd()
    else:
        path = shipped.configuration(Path(config))
        source = str(config)
        tree = read_tree(path)
        base = base or path.resolve().parent
        tree.setdefault("name", path.stem)
    origins: dict[str, str] = {}
    if is_oaisys(tree):
        from perilune.document import oaisys  # its dozen modules are for such files alone

        translation = oaisys.translate(tree, base, source)
        tree, origins = translation.tree, dict(translation.origins)
    given = Given(tree, base, source, origins, plain_tree(overrides or {}, "overrides"), replay)
    changes = (replay or {}).get("overrides") or {}
    document = _made(given, plain_tree(changes, "replay: overrides"))
    for line in document.doubts():
        warn(line)
    return document
