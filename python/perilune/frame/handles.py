"""The core's objects of one process for a configuration: models, maps, scene, renderer."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property, partial
from pathlib import Path
from threading import RLock
from typing import Any

import numpy as np
from numpy.typing import NDArray

from perilune import _core
from perilune.base.kept import make_room
from perilune.base.same import Same
from perilune.bodies import atmospheres, ground, maps, photometry, rings, shapes
from perilune.bodies.areas import Areas
from perilune.bodies.map_cache import MAPS
from perilune.config.body import Body
from perilune.config.errors import ConfigError, origin
from perilune.config.photometry import Photometry
from perilune.config.rings import Rings
from perilune.config.schema import Config
from perilune.config.shape import Shape
from perilune.config.spacecraft import Spacecraft
from perilune.config.symmetries import Symmetries
from perilune.document.document import Document
from perilune.document.fixed import fixed
from perilune.frame import scene_labels
from perilune.frame.hierarchy import Hierarchy
from perilune.frame.keypoints import KeypointSet
from perilune.frame.labels import Taxonomy, object_class, taxonomy, unmatched
from perilune.frame.material_assignments import MaterialAssignment, MaterialAssignments
from perilune.frame.pool import Pool
from perilune.frame.remarks import Remarks
from perilune.frame.stage_key import StageKey, air_key
from perilune.frame.terrains import Terrains
from perilune.frame.volumes import Volumes
from perilune.orbits.ground import Ground
from perilune.sky.skies import Skies
from perilune.spacecraft import articulation, faces
from perilune.spacecraft.model_files import shared_model
from perilune.spacecraft.parts import Partition, partition
from perilune.world import World

F64 = NDArray[np.float64]
Array = NDArray[Any]

_STAGES = 4
"""Number of scenes with renderers, and of atmospheres, to cache."""


_FILES = 16
"""Number of models, of shapes and of maps to keep besides those of the configuration that is
built."""
_MAPS = 6
"""Most maps that a body has at a time."""


@dataclass
class _Stage:
    """A scene, its renderer, and the material graphs on it."""

    scene: _core.Scene
    renderer: _core.Renderer
    assignment: MaterialAssignment = MaterialAssignment({}, {})  # noqa: RUF009 (immutable)


@dataclass(frozen=True)
class ObjectModel:
    """The model of a spacecraft: p_object = metres_per_unit * (p_model - offset)."""

    name: str
    """Name of the spacecraft's entry."""
    obj_id: int
    class_name: str
    model: _core.Model
    offset: F64
    """(3,) origin of the object in the model's frame, model units."""
    metres_per_unit: float
    """Scale at the configuration's ideal values; a driver on the size changes it per frame."""
    reach_units: float
    """Radius of the smallest sphere about the object's origin that contains the model, model
    units."""
    symmetries: Symmetries

    @property
    def radius_m(self) -> float:
        """The same radius in metres, at the ideal size."""
        return self.metres_per_unit * self.reach_units


def metres_per_unit(craft: Spacecraft, model: _core.Model) -> float:
    """Scale of a spacecraft's model, as given or from its size. For a stretched model: the scale of
    the mesh as read."""
    if isinstance(craft.metres_per_unit, tuple):
        return max(craft.metres_per_unit)
    if craft.metres_per_unit is not None:
        return craft.metres_per_unit
    assert craft.size_m is not None  # the schema asks for one of the two
    low, high = model.bounds
    return craft.size_m / float((high - low).max())


def _check_length(where: str, scale: float, bounds: F64) -> None:
    """ConfigError for a model longer or shorter than the core accepts; size_m is in range
    already."""
    length_m = scale * float((bounds[1] - bounds[0]).max())
    low, high = shapes.LENGTHS_M
    if not low * (1.0 - 1e-12) <= length_m <= high * (1.0 + 1e-12):
        text = f"{scale:g}: the model is then {length_m:.3g} m long; allowed: {low:g} to {high:g} m"
        raise ConfigError(f"{where}.metres_per_unit: {text}")


def reach_units(model: _core.Model, offset: F64) -> float:
    """Distance from the offset to the farthest vertex, model units. (The farthest corner of the
    bounding box would be 1.73 times as far for a ball.)"""
    from_offset = model.mesh()["positions"].astype(np.float64) - offset
    return math.sqrt(float(np.einsum("ij,ij->i", from_offset, from_offset).max()))


def _obj_ids(config: Config) -> dict[str, int]:
    """Given ids; the others get the smallest free numbers from 1 on, bodies after spacecraft."""
    stated = {n: c.obj_id for n, c in config.spacecraft.items() if c.obj_id is not None}
    first: dict[int, str] = {}
    for name, number in stated.items():
        other = first.setdefault(number, name)
        a, b = config.spacecraft[name], config.spacecraft[other]
        same = ("model", "size_m", "metres_per_unit", "centre", "crease_angle_deg", "faces")
        if any(getattr(a, key) != getattr(b, key) for key in same):
            raise ConfigError(
                f"spacecraft.{name}.obj_id = {number}: {other} has it too, but another model or "
                "size; one id stands for one model"
            )
    for name, body in config.bodies.items():
        if body.annotate and body.obj_id is not None:
            other = first.setdefault(body.obj_id, name)
            if other != name:
                raise ConfigError(
                    f"bodies.{name}.obj_id = {body.obj_id}: {other} has it too; one id stands for "
                    "one model"
                )
            stated[name] = body.obj_id
    used = set(stated.values())
    free = (number for number in range(1, len(used) + len(config.objects) + 1))
    unused = (number for number in free if number not in used)
    return {name: stated[name] if name in stated else next(unused) for name in config.objects}


class FrameLock:
    """Admits one frame at a time. Other threads wait; code that interrupts a frame in its own
    thread (a signal handler, a finalizer) would wait forever and is refused."""

    def __init__(self) -> None:
        self._lock = RLock()
        self._busy = False

    def __enter__(self) -> None:
        self._lock.acquire()
        if self._busy:
            self._lock.release()
            raise RuntimeError("a frame of this simulation is being rendered around this call")
        self._busy = True

    def __exit__(self, *_: object) -> None:
        self._busy = False
        self._lock.release()


class Assets:
    """Files read and objects built in a process, for a configuration and all that `with_overrides`
    derives from it. `lock` guards the renderers, which render one frame at a time."""

    def __init__(self, document: Document) -> None:
        self.lock = FrameLock()
        self.pool = Pool()
        self.models: dict[tuple[Any, ...], _core.Model] = {}
        self.files: dict[tuple[Any, ...], _core.Map] = {}
        self.areas: dict[object, Areas] = {}
        self.regolith_maps: dict[tuple[Path, ...], _core.Grid] = {}
        self.skies = Skies(document.path)
        self.shapes: dict[tuple[str, Shape], shapes.BodyShape] = {}
        self.terrains = Terrains()
        self.airs: dict[tuple[Any, ...], _core.Air | None] = {}
        self.ring_systems: dict[Rings, _core.Rings] = {}
        self.stages: dict[StageKey, _Stage] = {}


_NOT_BUILT = ("version", "name", "description", "seed", "time.", "render.channels", "drivers")
"""Fixed keys that do not affect scenes."""


def _built_from(config: Config) -> str:
    """All inputs of a scene that no driver may change, as a text; equal texts give equal scenes."""
    rows = fixed(config)
    return repr({key: row for key, row in rows.items() if not key.startswith(_NOT_BUILT)})


class Handles:
    """The core's objects, built on demand, once per process and configuration."""

    def __init__(self, document: Document, remarks: Remarks, assets: Assets) -> None:
        """remarks: receives messages of model readers. assets: shared with configurations derived
        from the same one."""
        self.document = document
        self._remarks = remarks
        self.assets = assets
        self.lock, self.pool, self.skies = self.assets.lock, self.assets.pool, self.assets.skies
        self.volumes = Volumes(document)
        self._built_from = _built_from(document.config)
        self._stage_keys: Same[StageKey] = Same()

    @cached_property
    def obj_ids(self) -> Mapping[str, int]:
        """Spacecraft or annotated body -> id of its model in BOP, in the order of the objects."""
        return _obj_ids(self.document.config)

    @cached_property
    def models(self) -> Mapping[str, ObjectModel]:
        """Spacecraft entry -> its model, in the order of the configuration."""
        config, ids = self.document.config, self.obj_ids
        files = self.assets.models
        result: dict[str, ObjectModel] = {}
        reaches: dict[tuple[int, bytes], float] = {}
        for name, craft in config.spacecraft.items():
            path = str(self.document.path(craft.model, f"spacecraft.{name}.model"))
            key = (path, craft.crease_angle_deg, craft.stretch, repr(craft.faces))
            if key not in files:
                make_room(files, _FILES + len(config.spacecraft))
                try:
                    angle_rad = math.radians(craft.crease_angle_deg)
                    files[key] = shared_model(path, angle_rad, craft.stretch, craft.faces)
                except ValueError as error:
                    where = f"{self.document.source}:\n  spacecraft.{name}.model"
                    raise ConfigError(f"{where}: {error}") from error
            model = files[key]
            self.tell(f"spacecraft.{name}.model", path, model.warnings)
            for pattern, text in faces.unmatched(craft.faces, model.materials):
                self.tell_of_key(f"spacecraft.{name}.faces.{pattern}", text)
            bounds = model.bounds
            offset = bounds.mean(axis=0) if craft.centre == "bounds" else np.zeros(3)
            if not float((bounds[1] - bounds[0]).max()) > 0.0:
                where = f"{self.document.source}:\n  spacecraft.{name}.model"
                raise ConfigError(f"{where}: {path}: has no extent")
            same = (id(model), offset.tobytes())
            if same not in reaches:
                reaches[same] = reach_units(model, offset)
            scale = metres_per_unit(craft, model)
            _check_length(f"{self.document.source}:\n  spacecraft.{name}", scale, bounds)
            result[name] = ObjectModel(
                name=name,
                obj_id=ids[name],
                class_name=object_class(name, craft),
                model=model,
                offset=offset,
                metres_per_unit=scale,
                reach_units=reaches[same],
                symmetries=craft.symmetries,
            )
        return result

    def tell(self, key: str, path: str, lines: tuple[str, ...]) -> None:
        where = origin(key, self.document.origins)
        self._remarks.tell(f"{self.document.source}: {where}", path, lines)

    def tell_of_key(self, key: str, text: str) -> None:
        where = origin(key, self.document.origins)
        self._remarks.tell_of_key(f"{self.document.source}: {where}", text)

    @cached_property
    def partitions(self) -> Mapping[str, Partition]:
        """Spacecraft entry -> division of its model into parts; one object for equal ones."""
        crafts, source = self.document.config.spacecraft, self.document.source
        made: dict[tuple[int, str], Partition] = {}
        found = {}
        for name, row in self.models.items():
            parts, key = crafts[name].parts, f"{source}:\n  spacecraft.{name}.parts"
            same = (id(row.model), repr(parts))
            if same not in made:
                made[same] = partition(row.model, parts, key)
            found[name] = made[same]
        return found

    @cached_property
    def rigs(self) -> Mapping[str, articulation.Rig]:
        """Spacecraft entry -> moving parts, for those that have any."""
        crafts, source = self.document.config.spacecraft, self.document.source
        rigs = {
            name: articulation.rig(
                row.model,
                crafts[name],
                row.offset,
                row.metres_per_unit,
                f"{source}:\n  spacecraft.{name}",
            )
            for name, row in self.models.items()
        }
        return {name: rig for name, rig in rigs.items() if rig is not None}

    @cached_property
    def keypoints(self) -> KeypointSet:
        """The keypoints of the configuration."""
        return KeypointSet(self.document, self.models, self.rigs, self.taxonomy.instances)

    @cached_property
    def hierarchy(self) -> Hierarchy:
        """Spacecraft, their nodes and parts."""
        taxonomy = self.taxonomy
        parts = {name: taxonomy.parts_of(name) for name in self.models}
        return Hierarchy(self.models, self.partitions, self.rigs, taxonomy.instances, parts)

    def hierarchy_of(self, config: Config, groups: Array, moved: Mapping[str, Any]) -> Array:
        """The rows of Sample.hierarchy; see Hierarchy.table."""
        return self.hierarchy.table(groups, self.scales(config), moved)

    @cached_property
    def assignments(self) -> MaterialAssignments:
        """The material graphs of the configuration."""
        models = {name: row.model for name, row in self.models.items()}
        return MaterialAssignments(self.document, models, self.partitions)

    @cached_property
    def taxonomy(self) -> Taxonomy:
        """Names and ids of all labels."""
        parts = {name: cut.entries for name, cut in self.partitions.items()}
        found = taxonomy(self.document.config, parts)
        for key, text in self.unmatched():
            self.tell_of_key(key, text)
        return found

    def unmatched(self) -> list[tuple[str, str]]:
        """(key path, message) of patterns of `part_classes` that match no part."""
        parts = {name: cut.entries for name, cut in self.partitions.items()}
        return list(unmatched(self.document.config, parts))

    def scales(self, config: Config) -> dict[str, float]:
        """Metres per model unit of each spacecraft in a frame."""
        crafts = config.spacecraft
        return {name: metres_per_unit(crafts[name], row.model) for name, row in self.models.items()}

    def radii_m(self, config: Config) -> dict[str, float]:
        """Bounding radius about the origin of each spacecraft, for any position of its parts."""
        radii_m = {}
        for name, scale in self.scales(config).items():
            row, rig = self.models[name], self.rigs.get(name)
            reach = row.reach_units if rig is None else rig.reach_units
            radii_m[name] = scale * reach + articulation.slides_m(config.spacecraft[name])
        return radii_m

    def bounds_m(self, config: Config, name: str) -> F64:
        """(2, 3): the box of a spacecraft's model as stored, in its axes about its origin."""
        row = self.models[name]
        bounds = np.asarray(row.model.bounds, dtype=np.float64)
        return np.asarray(self.scales(config)[name] * (bounds - row.offset))

    def ground_of(self, config: Config, name: str) -> Ground | None:
        """The ground of a body with a shape; None for a smooth ellipsoid."""
        body = config.bodies[name]
        if body.terrain is not None:
            return self.terrain_of(config, name)[1]
        if body.shape is None:
            return None
        return self.assets.terrains.of_shape(name, body, lambda: self.shapes_of(config)[name])

    def terrain_of(self, config: Config, name: str) -> tuple[_core.Terrain, Ground]:
        """The terrain of a body that has one; the same objects as long as no driver changes it."""
        return self.assets.terrains.of_terrain(self.document, name, config.bodies[name], self)

    def posed(self, scene: World) -> dict[str, articulation.Posed]:
        """Spacecraft entry -> poses of its moving parts in a frame, for those that have any."""
        scales = self.scales(scene.config)
        return {
            name: articulation.posed(rig, scene, name, scales[name])
            for name, rig in self.rigs.items()
        }

    def _map(
        self,
        name: str,
        center_lon_deg: float | None,
        text: str | None,
        key: str,
        heights: maps.HeightKey | None = None,
        **options: Any,
    ) -> _core.Map | None:
        """A map of a body. Each file is read once for each set of options of _core.Map.
        center_lon_deg: None for a map that does not cover the whole body."""
        if text is None:
            return None
        path = self.document.path(text, f"bodies.{name}.{key}")
        options_key = center_lon_deg, heights, *sorted(options.items())
        if (path, *options_key) not in self.assets.files:

            def read() -> tuple[_core.Map, tuple[str, ...]]:
                if heights is None:
                    file = maps.picture(path, center_lon_deg)
                else:
                    file = maps.heights(path, heights, center_lon_deg)
                return _core.Map(file.source, **options), file.remarks

            try:
                made, remarks = MAPS.of(path, options_key, read)
            except ValueError as error:
                where = f"{self.document.source}: bodies.{name}.{key}"
                raise ConfigError(f"{where}: {error}") from error
            make_room(self.assets.files, _FILES + _MAPS * len(self.document.config.bodies))
            self.assets.files[path, *options_key] = made
            self.tell(f"bodies.{name}.{key}", str(path), remarks)
        return self.assets.files[path, *options_key]

    def _cloud_map(self, name: str, body: Body) -> _core.Map | None:
        if body.clouds is None:
            return None
        given = body.clouds
        return self._map(name, given.map_center_lon_deg, given.map, "clouds.map", srgb=False)

    def shapes_of(self, config: Config) -> dict[str, shapes.BodyShape]:
        """Body entry -> its shape, for bodies that have one; each file is read once."""
        found: dict[str, shapes.BodyShape] = {}
        for name, body in config.bodies.items():
            if body.shape is None:
                continue
            if (name, body.shape) not in self.assets.shapes:
                key = f"bodies.{name}.shape"
                path = self.document.path(body.shape.file, f"{key}.file")
                make_room(self.assets.shapes, _FILES + len(config.bodies))
                try:
                    self.assets.shapes[name, body.shape] = shapes.load(name, body.shape, path)
                except ValueError as error:
                    raise ConfigError(f"{self.document.source}:\n  {key}.{error}") from error
                shape = self.assets.shapes[name, body.shape]
                self.tell(f"bodies.{name}.shape.file", str(path), shape.warnings)
            found[name] = self.assets.shapes[name, body.shape]
            if body.kind == "ellipsoid" and body.may_be_dressed and found[name].color is None:
                where = f"{self.document.source}:\n  bodies.{name}.albedo"
                raise ConfigError(
                    f"{where}: required for kind: ellipsoid without a color_map: the shape's file "
                    "has no materials"
                )
        return found

    def _air(self, name: str, config: Config) -> _core.Air | None:
        """The atmosphere of a body; tables are computed once for each atmosphere and radii."""
        body = config.bodies[name]
        key = air_key(body)
        if key not in self.assets.airs:
            make_room(self.assets.airs, _STAGES)
            try:
                self.assets.airs[key] = atmospheres.air_of(config, body)
            except ValueError as error:
                raise ConfigError(
                    f"{self.document.source}:\n  bodies.{name}.atmosphere: {error}"
                ) from error
        return self.assets.airs[key]

    def _rings(self, name: str, config: Config) -> _core.Rings | None:
        """The rings of a body; tables are computed once for each choice."""
        given = config.bodies[name].rings
        if given is None:
            return None
        if given not in self.assets.ring_systems:
            columns = None
            if given.color_map is not None:
                read = self._map(name, None, given.color_map, "rings.color_map")
                columns = read.columns() if read is not None else None
            try:
                self.assets.ring_systems[given] = rings.rings_of(given, columns)
            except ValueError as error:
                raise ConfigError(
                    f"{self.document.source}:\n  bodies.{name}.rings: {error}"
                ) from error
        return self.assets.ring_systems[given]

    def _regolith_map(self, name: str, given: Photometry | None) -> _core.Grid | None:
        """The parameter map of a body; each set of files is read once."""
        if given is None or not given.maps:
            return None
        key = f"bodies.{name}.photometry.maps"
        paths = tuple(self.document.path(text, key) for text in given.maps)
        if paths not in self.assets.regolith_maps:
            try:
                self.assets.regolith_maps[paths] = photometry.load_map(paths)
            except ValueError as error:
                raise ConfigError(f"{self.document.source}:\n  {key}: {error}") from error
        return self.assets.regolith_maps[paths]

    @property
    def renderer(self) -> _core.Renderer:
        """The core's renderer of the ideal configuration's scene."""
        return self.renderer_of(self.document.config)

    def renderer_of(self, config: Config) -> _core.Renderer:
        """The core's renderer, with a frame's material graphs on its scene.

        There is a scene for each combination of maps, shapes, reflectances, atmosphere and rings
        that choices give the bodies. Graphs are exchanged on the scene, which keeps its
        acceleration structures."""
        key = self._stage_keys.of((config.bodies,), lambda: StageKey(self._built_from, config))
        if key not in self.assets.stages:
            make_room(self.assets.stages, _STAGES)
            self.assets.stages[key] = self._stage(config)
        stage = self.assets.stages[key]
        try:
            self._assign_materials(stage, self.assignments.of(config))
        except Exception:
            del self.assets.stages[key]  # its state is unknown
            raise
        return stage.renderer

    def _assign_materials(self, stage: _Stage, assignment: MaterialAssignment) -> None:
        """Puts the material graphs of a frame on a scene, unless they are there already."""
        for index, name in enumerate(self.models):
            placed, there = assignment.crafts.get(name), stage.assignment.crafts.get(name)
            if placed is not None and (there is None or not placed.is_like(there)):
                cores = tuple(graph.core for graph in placed.graphs)
                stage.scene.set_materials(index, cores, placed.triangle_graph)
            elif placed is None and there is not None:
                stage.scene.set_materials(index, (), self.assignments.bare(name))
        for index, name in enumerate(self.document.config.bodies):
            placed, there = assignment.bodies.get(name), stage.assignment.bodies.get(name)
            if placed is not None and (there is None or not placed.is_like(there)):
                stage.scene.set_body_graph(index, placed.graphs[0].core)
            elif placed is None and there is not None:
                stage.scene.set_body_graph(index, None)
        stage.assignment = assignment

    def _stage(self, config: Config) -> _Stage:
        """A scene without material graphs."""
        scene = _core.Scene(len(self.taxonomy.levels))
        self._add_bodies(scene, config)
        self._add_crafts(scene)
        return _Stage(scene, _core.Renderer(scene))

    def _add_bodies(self, scene: _core.Scene, config: Config) -> None:
        labels, meshes = self.taxonomy, self.shapes_of(config)
        for name, body in config.bodies.items():
            scene.add_body(
                name=name,
                map=self._map(name, body.map_center_lon_deg, body.color_map, "color_map"),
                map_center_lon_rad=math.radians(body.map_center_lon_deg),
                reflectance=body.reflectance,
                regolith_map=self._regolith_map(name, body.photometry),
                air=self._air(name, config),
                shape=meshes[name].model if name in meshes else None,
                rings=self._rings(name, config),
                cloud_map=self._cloud_map(name, body),
                terrain=None if body.terrain is None else self.terrain_of(config, name)[0],
                cells_per_pixel=1.0 if body.terrain is None else body.terrain.cells_per_pixel,
                finest_cell_m=0.01 if body.terrain is None else body.terrain.finest_cell_m,
                ground=ground.of_body(body, partial(self._map, name, body.map_center_lon_deg)),
                geodetic=body.is_geodetic,
                geodetic_clouds=body.has_geodetic_clouds,
                dressed=body.may_be_dressed and name in meshes and meshes[name].color is not None,
                instance_id=labels.instances[name],
                part_id=int(scene_labels.part_ids(labels, name)[0]),
                class_ids=scene_labels.class_ids(labels, name, body)[0],
                ground_labels=scene_labels.ground_labels(labels, body),
                crater_criteria=scene_labels.crater_criteria(self.document.config.labels.craters),
                areas=scene_labels.areas(self.document, name, labels, self.assets.areas, self.tell),
                obj_id=self.obj_ids.get(name, 0),
            )

    def _add_crafts(self, scene: _core.Scene) -> None:
        labels = self.taxonomy
        for name, row in self.models.items():
            index = scene.add_object(
                name=name,
                model=row.model,
                offset=row.offset,
                obj_id=row.obj_id,
                instance_id=labels.instances[name],
                part_ids=scene_labels.part_ids(labels, name),
                class_ids=scene_labels.class_ids(
                    labels, name, self.document.config.spacecraft[name]
                ),
                triangle_part=self.partitions[name].triangle_part,
            )
            if name in self.rigs:
                nodes = np.array(self.rigs[name].core.nodes, dtype=np.int32)
                scene.articulate(index, nodes)
