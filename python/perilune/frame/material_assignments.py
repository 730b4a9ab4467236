"""Material assignment: which graphs are on which objects in a frame.

Drivers may choose among graphs, per scene or per step. Graphs are compiled, and patterns matched
with models, once for each choice."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from perilune import _core, materials
from perilune.base.same import Latest, Same
from perilune.config.errors import ConfigError, named, nearest
from perilune.config.materials import MaterialUse
from perilune.config.schema import Config
from perilune.document.document import Document
from perilune.frame.labels import graph_levels
from perilune.materials import Graph, ImageFiles, Placed
from perilune.materials.drivers import given_by_drivers
from perilune.materials.graph import has_drawn
from perilune.spacecraft.parts import Partition

_T = TypeVar("_T")
_PATTERNS = 16
"""Number of sets of patterns to cache, for all spacecraft together."""


@dataclass(frozen=True)
class MaterialAssignment:
    """The material graphs of a frame."""

    crafts: Mapping[str, Placed]
    """Spacecraft -> their graphs, for those that have any."""
    bodies: Mapping[str, Placed]
    """Bodies -> their graph, for those that have one."""

    @property
    def graphs(self) -> list[tuple[str, Placed]]:
        """The objects and their graphs, in the order of the core's parameters."""
        return [*self.crafts.items(), *self.bodies.items()]


class MaterialAssignments:
    """Makes the material assignments of a configuration. All options of choices are made and
    checked at the start."""

    def __init__(
        self,
        document: Document,
        models: Mapping[str, _core.Model],
        partitions: Mapping[str, Partition],
    ) -> None:
        """models, partitions: those of each spacecraft. ConfigError for graphs that match
        nothing."""
        self._document = document
        self._models = models
        self._partitions = partitions
        self._images = ImageFiles(document.path)
        self._levels = graph_levels(document.config)
        self._graphs: dict[tuple[Any, ...], Graph] = {}
        self._hooked = {row.path[1] for row in document.drivers if materials.is_drawn(row)}
        self._drawn: dict[tuple[Any, ...], Graph] = {}
        self._triangles: dict[tuple[Any, ...], NDArray[np.int32]] = {}
        self._last: Same[MaterialAssignment] = Same(2)
        self._parameters: Same[NDArray[np.float64]] = Same(2)
        self._triples: Latest[materials.Triples] = Latest()
        self._ideal: MaterialAssignment | None = None
        self._ideal = self.of(document.config)
        for config in document.choices(materials.is_choice):
            self.of(config)

    def of(self, config: Config) -> MaterialAssignment:
        """The graphs of a frame; ConfigError for one that is missing or does not fit."""
        first = self._document.config
        same = config.spacecraft is first.spacecraft and config.bodies is first.bodies
        if same and self._ideal is not None:
            return self._ideal
        return self._last.of(self._assigned(config), lambda: self._made(config))

    def _assigned(self, config: Config) -> tuple[object, ...]:
        """What decides which graphs are where."""
        bodies = config.bodies.values()
        return (
            *(config.spacecraft[name].materials for name in self._models),
            *(body.material for body in bodies),
            *(body.material_mode for body in bodies),
            config.materials if self._hooked else None,
        )

    def parameters(self, config: Config) -> NDArray[np.float64]:
        """(n, 3): those of a frame's graphs, as the core's request takes them, read-only."""
        assignment = self.of(config)

        def make() -> NDArray[np.float64]:
            found = materials.parameters(assignment.graphs, config, self._triples)
            found.flags.writeable = False
            return found

        return self._parameters.of((assignment, *_read(config)), make)

    def _made(self, config: Config) -> MaterialAssignment:
        try:
            crafts = {
                name: self._on_craft(name, config)
                for name in self._models
                if config.spacecraft[name].materials
            }
            bodies = {
                name: self._on_body(name, body.material, body.material_mode, config)
                for name, body in config.bodies.items()
                if body.material is not None
            }
        except ValueError as error:
            text = named(str(error), self._document.origins)
            raise ConfigError(f"{self._document.source}:\n  {text}") from None
        return MaterialAssignment(crafts, bodies)

    def bare(self, craft: str) -> NDArray[np.int32]:
        """(T,) of -1: triangles without graphs."""
        return self._of_patterns(craft, ())

    def presence(self, craft: str) -> NDArray[np.uint8]:
        """(T,): how much alpha leaves of each triangle for all choices and draws. 0: nothing, 1:
        perhaps a part, 2: all of it."""
        own: NDArray[np.uint8] = self._models[craft].surfaces()["presence"]
        configs = [self._document.config, *self._document.choices(materials.is_choice)]
        rows = [_with_graphs(own, self.of(config).crafts.get(craft)) for config in configs]
        low, high = np.minimum.reduce(rows), np.maximum.reduce(rows)
        return np.where(low == high, low, np.uint8(1))

    def _on_craft(self, name: str, config: Config) -> Placed:
        uses = config.spacecraft[name].materials
        names = tuple(use.use for use in uses)
        graphs = tuple(
            self._graph(name, use.use, use.mode, f"spacecraft.{name}.materials[{k}].use", config)
            for k, use in enumerate(uses)
        )
        return Placed(names, graphs, self._of_patterns(name, uses))

    def _on_body(self, name: str, use: str, mode: str, config: Config) -> Placed:
        graph = self._graph(name, use, mode, f"bodies.{name}.material", config)
        return Placed((use,), (graph,), np.empty(0, dtype=np.int32))

    def _graph(self, owner: str, name: str, mode: str, key: str, now: Config) -> Graph:
        """Compiles a graph with all values that drivers of the ideal configuration may vary; a
        hook's graph is as drawn now."""
        hooked = name in self._hooked
        config = now if hooked else self._document.config
        if name not in config.materials:
            raise ValueError(f"{key}: no entry named '{name}'{nearest(name, config.materials)}")
        wrap = mode == "wrap"

        def make() -> Graph:
            material = materials.applied(config, name, owner)
            return materials.build(name, material, wrap, self._images, self._levels)

        # The program is that of all owners whose drivers give the same nodes the same values.
        given = given_by_drivers(config, name, owner)
        same = (name, wrap, tuple((*at, has_drawn(v), repr(v)) for at, v in given.items()))
        if not hooked:
            return _kept(self._graphs, same, make)
        found = _kept(self._drawn, (*same, repr(config.materials[name])), make)
        if len(self._drawn) > _PATTERNS * max(len(self._models), 1):
            del self._drawn[next(iter(self._drawn))]
        return found

    def _of_patterns(self, craft: str, uses: tuple[MaterialUse, ...]) -> NDArray[np.int32]:
        patterns = tuple(
            (use.material, use.part, use.component, use.box, use.required) for use in uses
        )
        key = f"spacecraft.{craft}.materials"
        model, cut = self._models[craft], self._partitions[craft]  # shared by spacecraft alike

        def make() -> NDArray[np.int32]:
            return materials.triangles(uses, model, cut, key)

        found = _kept(self._triangles, (id(model), id(cut), patterns), make)
        if len(self._triangles) > _PATTERNS * len(self._models):
            del self._triangles[next(iter(self._triangles))]  # the one looked up first
        return found


def _read(config: Config) -> tuple[object, ...]:
    """The sections that decide the parameters of graphs."""
    entities = (config.spacecraft, config.bodies, config.volumes)
    return (*entities, config.materials, config.material_drivers)


def _with_graphs(own: NDArray[np.uint8], placed: Placed | None) -> NDArray[np.uint8]:
    """A surface must be there by the model's material and by the graph on it."""
    if placed is None:
        return own
    of_graphs = np.array([*(g.core.presence for g in placed.graphs), 2], dtype=np.uint8)
    return np.minimum(own, of_graphs[placed.triangle_graph])  # -1, no graph, is the last


def _kept(store: dict[Any, _T], key: Any, make: Callable[[], _T]) -> _T:
    found = store.get(key)
    if found is None:
        found = store[key] = make()
    return found
