"""A simulation: frames as a pure function of (configuration, seed, index)."""

from __future__ import annotations

import math
import os
from collections.abc import Callable, Iterable, Mapping, Sequence
from functools import lru_cache
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from perilune import _core
from perilune.base import arguments
from perilune.base.hooks import Hook
from perilune.base.processors import default_threads
from perilune.base.same import Latest, Same
from perilune.base.timeline import Moment, Timeline
from perilune.bodies.shapes import BodyShape
from perilune.camera import bands, trajectories
from perilune.config import Config, ConfigError
from perilune.config.errors import named
from perilune.config.render import Render
from perilune.cost import calibration
from perilune.cost.budget import Budgeted, at_tolerance, within
from perilune.cost.costed import Costed
from perilune.document import Document
from perilune.document.references import (
    HIERARCHY,
    KEYPOINTS,
    OBJECTS,
    OF_MOTION,
    OF_SENSOR,
    TABLES,
    check_channels,
    check_references,
)
from perilune.frame import craters, labels, motion, passes, shutter
from perilune.frame.ground_tables import GroundTables, body_with_terrain
from perilune.frame.handles import Assets, Handles, ObjectModel
from perilune.frame.metadata import Metadata
from perilune.frame.placing import placed
from perilune.frame.range_sensors import RangeSensors
from perilune.frame.remarks import Remarks
from perilune.frame.request import arrays_of, object_dtype
from perilune.frame.rows import row_poses
from perilune.frame.unseen import Unseen
from perilune.orbits import Setting, System, solar_system
from perilune.orbits.hooked import hooks_of
from perilune.orbits.motion import Kept
from perilune.orbits.sunlight import LightCurve, light_curve
from perilune.sample import Sample
from perilune.sky.skies import seen
from perilune.spacecraft import articulation
from perilune.spacecraft.parts import Partition
from perilune.world import World, build as build_world

if TYPE_CHECKING:
    from perilune.show.graphs import GraphPicture

F64 = NDArray[np.float64]
Array = NDArray[Any]

_orphans: list[Handles | Assets] = []
"""Objects of a parent process. A fork must neither use nor destroy them, because the ray tracer's
threads do not exist in the child; so they stay referenced until the child ends."""


class _Store:
    """The assets that a simulation shares with those derived from it, one set per process."""

    def __init__(self) -> None:
        self._assets: Assets | None = None
        self._pid = 0

    def __reduce__(self) -> tuple[Any, ...]:
        return _Store, ()

    def of(self, document: Document) -> Assets:
        """The set of this process."""
        pid = os.getpid()
        if self._assets is None or self._pid != pid:
            if self._assets is not None:
                _orphans.append(self._assets)
            self._assets, self._pid = Assets(document), pid
        return self._assets


class Simulation(RangeSensors, Costed):
    """Random access to frames: `sim[i]` is the same whatever was rendered before, in any process.

    perilune.open makes one. It pickles as its configuration; every process, forked ones too,
    creates the core's objects when it first needs them."""

    def __init__(
        self,
        document: Document,
        trajectory: Callable[[World], Any] | None = None,
        orbits: Mapping[str, Hook] | None = None,
        store: _Store | None = None,
    ) -> None:
        """trajectory: a callable that replaces the configured trajectory.

        orbits: name of a body or spacecraft -> a hook that replaces its orbit.

        store: assets of the simulation that this one is derived from."""
        check_references(document.config, document.source, document.drivers, document.origins)
        self._document = document
        self._trajectory = trajectory
        self._orbits = hooks_of(orbits, document.config)
        if trajectory is not None:
            arguments.function("trajectory", trajectory, "of a perilune.world.World")
        self._epoch = solar_system.date_from_utc(document.config.time.utc_fields())
        self._drawn: Kept[Any] = Kept(64)
        self._nodes: Same[list[dict[str, Any]]] = Same()
        self._each_node: Latest[dict[str, Any]] = Latest()
        self._remarks = Remarks()
        self._unseen = Unseen()
        self._store = store or _Store()
        self._handles: Handles | None = None
        self._noise = 0
        self._pid = 0
        try:
            self.system(0).states(np.zeros(1))
        except ConfigError:
            raise
        except ValueError as error:
            text = named(str(error), document.origins)
            raise ConfigError(f"{document.source}:\n  {text}") from error

    def __reduce__(self) -> tuple[Any, ...]:
        arguments = (self._document, self._trajectory, self._orbits, self._store)
        return Simulation, arguments, {"_remarks": self._remarks}

    def with_overrides(
        self, overrides: Mapping[str, Any] | None = None, **dotted: Any
    ) -> Simulation:
        """Returns the same simulation with other values at some keys; this one stays unchanged.

        overrides, dotted: as for perilune.open, applied after all earlier changes; drivers are
        mappings or perilune.Driver. Models, maps, scenes and their acceleration structures are
        shared, so the call takes only as long as checking the configuration. Samples record the
        changes in `meta["overrides"]`; `perilune.open(config, replay=meta)` applies them again.
        Raises ConfigError as perilune.open does."""
        return self._with({**(overrides or {}), **dotted})

    def with_noise(self, noise: int) -> Simulation:
        """The same simulation with other random numbers of samples and sensors; drivers and grounds
        stay as they are. 0: the frames' own. For estimates of noise, as of perilune.cost."""
        made = self._with({})
        made._noise = noise
        return made

    def _with(self, changes: Mapping[str, Any], known: bool = False) -> Simulation:
        """known: these changes were checked before."""
        document = self._document.changed(changes, known)
        made = Simulation(document, self._trajectory, self._orbits, self._store)
        made._remarks = self._remarks  # models are read and reported once
        return made

    def _repr_html_(self) -> str:
        from perilune.show.display import simulation_html

        return simulation_html(self)

    def __repr__(self) -> str:
        cameras = self.config.cameras.items()
        sizes = [f"{name or ''} {c.width}x{c.height}".lstrip() for name, c in cameras]
        return f"<Simulation {self.config.name}, seed {self.config.seed}, {', '.join(sizes)}>"

    @property
    def config(self) -> Config:
        """The configuration with every driver at its ideal value."""
        return self._document.config

    @property
    def document(self) -> Document:
        """The loaded configuration: its file, tree and drivers."""
        return self._document

    @property
    def timeline(self) -> Timeline:
        """Step, scene and sensor of each frame."""
        return self.config.timeline

    @property
    def taxonomy(self) -> labels.Taxonomy:
        """Names and ids of the labels; loads the models."""
        return self._mine().taxonomy

    @property
    def models(self) -> Mapping[str, ObjectModel]:
        """Spacecraft entry -> its model, id and scale; loads the models."""
        return self._mine().models

    @property
    def obj_ids(self) -> Mapping[str, int]:
        """Name -> id of its model in BOP, in the order of `Sample.objects`."""
        return self._mine().obj_ids

    @property
    def keypoint_names(self) -> Mapping[str, tuple[str, ...]]:
        """Spacecraft or body -> names of its keypoints or landmarks, in the order of
        `Sample.keypoints`; without those that have none."""
        return self._mine().keypoints.names

    @property
    def shapes(self) -> Mapping[str, BodyShape]:
        """Body entry -> the mesh of its surface, for bodies with a shape; loads them."""
        return self._mine().shapes_of(self.config)

    @property
    def partitions(self) -> Mapping[str, Partition]:
        """Spacecraft entry -> the division of its model into parts; loads the models."""
        return self._mine().partitions

    def presence(self, name: str) -> NDArray[np.uint8]:
        """(T,): how much alpha leaves of each triangle of a spacecraft's model, over all frames.

        0: nothing, 1: perhaps a part, 2: all of it."""
        return self._mine().assignments.presence(name)

    def moving_nodes(self, names: Sequence[str]) -> list[tuple[str, ...]]:
        """For each part of a model, the nodes above it that move on any of the given spacecraft,
        nearest first, by their names in `Sample.meta["articulation"]`."""
        handles = self._mine()
        rigs = [handles.rigs[name] for name in names if name in handles.rigs]
        return articulation.moving_above(handles.models[names[0]].model, rigs)

    def unmatched_part_classes(self) -> list[tuple[str, str]]:
        """(key path, message) of patterns in `part_classes` that match no part."""
        return self._mine().unmatched()

    def _mine(self) -> Handles:
        """The handles of this process."""
        pid = os.getpid()
        if self._handles is None or self._pid != pid:
            if self._handles is not None:
                _orphans.append(self._handles)
            assets = self._store.of(self._document)
            self._handles, self._pid = Handles(self._document, self._remarks, assets), pid
        return self._handles

    def config_at(self, index: int) -> tuple[Config, dict[str, Any]]:
        """The configuration of a frame, and the values that its drivers drew, by key path.

        Its section `camera` is the platform's; `world(index).camera` is the camera that takes the
        frame."""
        config, drawn = self._document.at(index)
        return config, dict(drawn)

    def _setting(self, config: Config, index: int) -> Setting:
        moment = config.timeline.at(index)
        return Setting(
            config=config,
            epoch=self._epoch,
            scene=moment.scene,
            file=self._document.path,
            craft_radius_m=lambda name: self._mine().radii_m(config)[name],
            grounds=lambda name: self._mine().ground_of(config, name),
            craft_bounds_m=lambda name: self._mine().bounds_m(config, name),
            hooks=self._orbits,
            drawn=self._drawn,
            nodes=self._nodes,
            each_node=self._each_node,
            first_of_scene=self._first_of_scene(config, moment),
        )

    def _first_of_scene(self, config: Config, moment: Moment) -> Callable[[], Setting] | None:
        """See Setting.first_of_scene."""
        if config.time.frames_per_scene == 1:
            return None
        first = config.timeline.frames_before(moment.scene * config.time.frames_per_scene)

        @lru_cache(maxsize=1)
        def setting() -> Setting:
            return self._setting(self._document.at(first)[0], first)

        return None if moment.step == self.timeline.at(first).step else setting

    @property
    def has_orbit_hooks(self) -> bool:
        """Whether functions given in code draw any orbits."""
        return bool(self._orbits)

    @property
    def functions(self) -> list[str]:
        """Arguments of perilune.open that are functions, which no configuration file can hold."""
        given = ["trajectory"] if self._trajectory is not None else []
        return given + [f"orbits.{name}" for name in self._orbits]

    def system(self, index: int) -> System:
        """Motion of bodies and spacecraft in a frame, at any time."""
        index = arguments.frame_index(index)
        return System(self._setting(self._document.at(index)[0], index))

    def world(self, index: int) -> World:
        """Everything in a frame except the camera's pose: a perilune.world.World."""
        index = arguments.frame_index(index)
        config, drawn = self._document.at(index)
        mine = self._mine()
        radii_m, shapes = mine.radii_m(config), mine.shapes_of(config)
        system = System(self._setting(config, index))
        return build_world(config, drawn, index, self._epoch, radii_m, system, shapes)

    def _camera_poses(self, scene: World) -> F64:
        return trajectories.camera_poses(scene, self._trajectory)

    def camera_poses(self, index: int) -> F64:
        """Poses (2, 7) of a frame's camera as the shutter opens and closes: x, y, z in metres, qw,
        qx, qy, qz, from camera axes (OpenCV) to the root frame."""
        return self._camera_poses(self.world(index))

    def light_curve(self, name: str, frames: Iterable[int], **options: Any) -> LightCurve:
        """Eclipses and sunlight at a body, a spacecraft or the camera, frame by frame.

        See perilune.orbits.sunlight.light_curve."""
        return light_curve(self, name, frames, **options)

    def request(self, index: int) -> _core.FrameRequest:
        """The core's input for a frame."""
        return self._request(self.world(index))

    def _request(
        self, scene: World, posed: Mapping[str, articulation.Posed] | None = None
    ) -> _core.FrameRequest:
        """posed: poses of the moving parts in the middle of the exposure, if already known."""
        handles = self._mine()
        request = self._placed(scene, posed)
        request["seed"] ^= self._noise
        request["sky"] = handles.skies.request(scene)
        if scene.config.volumes:
            request["volumes"] = handles.volumes.request(scene.config)
        return request

    def _placed(
        self, scene: World, posed: Mapping[str, articulation.Posed] | None = None
    ) -> _core.FrameRequest:
        """The request without sky and volumes."""
        hooked = self._trajectory is not None
        return placed(scene, self._mine(), self._camera_poses, hooked, posed)

    def _add_neighbours(
        self, request: _core.FrameRequest, scene: World, names: Sequence[str]
    ) -> None:
        if self.timeline.frames_per_scene == 1:
            where = f"{self._document.source}: time.frames_per_scene"
            self._remarks.tell_of_key(where, motion.ALONE)
        motion.add_neighbours(request, scene, names, self.timeline, self.world, self._placed)

    def _metered(self, scene: World) -> tuple[Config, _core.FrameRequest] | None:
        """The frame that sets the exposure of a sensor with a lag; None if it meters itself."""
        sensor = scene.config.camera.sensor
        if sensor is None or sensor.exposure.mode == "fixed":
            return None
        earlier = self.timeline.earlier(scene.index, sensor.exposure.lag_frames)
        if earlier == scene.index:
            return None
        before = self.world(earlier)
        return before.config, self._request(before)

    def measure_rays(self, index: int, repeats: int) -> dict[str, tuple[int, float, float]]:
        """For benchmarks: times a frame's rays against raw Embree; see _core.Renderer."""
        scene, handles = self.world(index), self._mine()
        request = self._request(scene)
        with handles.lock:
            renderer = handles.renderer_of(scene.config)
            return renderer.measure_rays(request, repeats)

    def measure_frame(self, index: int, repeats: int) -> dict[str, tuple[int, float, float]]:
        """For benchmarks: all rays of a frame's colour against raw Embree; see _core.Renderer."""
        scene, handles = self.world(index), self._mine()
        request = self._request(scene)
        with handles.lock:
            renderer = handles.renderer_of(scene.config)
            arrays = arrays_of(scene.config, ["rgb"], {}, handles.pool)
            return renderer.measure_frame(request, arrays, repeats)

    def _kept_within(self, scene: World, arrays: Mapping[str, Array]) -> Budgeted | None:
        """What render.time_budget_ms keeps of the colours of a frame; None without one. It follows
        the table of costs that ships, so that frames are the same on every machine."""
        render = scene.config.render
        if render.time_budget_ms is None or not passes.COLOURS & set(arrays):
            return None
        table = calibration.of_table()
        return within(self, scene.index, render.time_budget_ms, render.tolerance_dn, table)

    def _told_of_target(
        self, render: Render, arrays: Mapping[str, Array], result: _core.FrameResult
    ) -> dict[str, float]:
        """What meta says of render.target_error_dn in a frame with colour."""
        pictures = [array for name, array in arrays.items() if name in passes.COLOURS]
        if render.target_error_dn is None or not pictures:
            return {}
        height, width = pictures[0].shape[:2]
        missed = result["missed"] / (height * width) if result["aimed"] else math.nan
        self._remarks.tell_of_target(self._document.source, render, missed)
        return {"target_missed": missed}

    def __getitem__(self, index: int) -> Sample:
        return self.frame(index)

    def frame(
        self,
        index: int,
        channels: Sequence[str] | None = None,
        threads: int | None = None,
        out: Mapping[str, Array] | None = None,
    ) -> Sample:
        """Renders a frame and returns its Sample.

        channels: names of the channels to compute (default: render.channels). threads: number of
        threads, which does not change the result (default: all processors of the process). out:
        arrays to write into, by channel name, such as those of an earlier sample; for other
        channels arrays are new, or reused from samples that nobody references any more."""
        asked = self.config.render.channels if channels is None else channels
        names = arguments.names("channels", asked)
        check_channels(names, self.config, "channels")
        count = arguments.whole("threads", default_threads() if threads is None else threads, 1)
        scene = self.world(index)
        handles = self._mine()
        posed = handles.posed(shutter.middle(scene))
        request = self._request(scene, posed)
        if set(OF_MOTION) & set(names):
            self._add_neighbours(request, scene, names)
        metered = self._metered(scene) if set(names) & set(OF_SENSOR) else None
        undistorted = scene.config.camera.label_lens == "undistorted"
        pixels = [name for name in names if name not in TABLES]
        arrays = arrays_of(scene.config, pixels, out or {}, handles.pool)
        if KEYPOINTS in names:
            request["keypoints"] = handles.keypoints.rows(scene, handles.scales(scene.config))
            arrays[KEYPOINTS] = handles.keypoints.empty()
        if HIERARCHY in names:
            request["part_groups"] = handles.hierarchy.request()
            arrays["part_groups"] = handles.hierarchy.empty(object_dtype())
        kept = self._kept_within(scene, arrays)
        colours = None if kept is None else at_tolerance(request, kept.tolerance_dn)
        try:
            with handles.lock:
                if metered is not None:
                    passes.expose(request, handles.renderer_of(metered[0]).plan(metered[1]))
                renderer = handles.renderer_of(scene.config)
                result = passes.render(renderer, request, arrays, count, undistorted, colours)
        except Exception as error:
            error.add_note(f"{self._document.source}: frame {scene.index}")
            raise
        more: dict[str, Any] = {}
        if scene.camera.line_time_us > 0.0:
            more["rows"] = row_poses(
                scene.config, request, result["plan"], handles.rigs, handles.scales(scene.config)
            )
        if "bands" in arrays or ("raw" in arrays and bands.has_planes(scene.config.camera)):
            more["bands"] = bands.described(scene.config.camera, scene.config.sun)
        objects, found = arrays.pop(OBJECTS, None), arrays.pop(KEYPOINTS, None)
        groups = arrays.pop("part_groups", None)
        unseen = self._unseen.look(scene.config, objects)
        if unseen is not None:
            where = f"{self._document.source}: camera.trajectory.target"
            self._remarks.tell_of_key(where, unseen)
        self._remarks.tell_of_ground(self._document.source, result["ground"])
        more |= self._told_of_target(scene.config.render, arrays, result)
        if kept is not None:
            self._remarks.tell_of_budget(self._document.source, kept)
            more |= {"budget_tolerance_dn": kept.tolerance_dn, "expected_ms": kept.expected.ms}
        tables = {}
        if found is not None:
            tables[KEYPOINTS] = handles.keypoints.table(found)
        if groups is not None:
            articulated = {name: row.meta for name, row in posed.items()}
            tables[HIERARCHY] = handles.hierarchy_of(scene.config, groups, articulated)
        told = Metadata(
            scene, self._document, request, posed, result, more, undistorted=undistorted
        )
        return Sample(arrays, objects, told, result["plan"], seen(result["stars"]), tables)

    def terrain(self, index: int, body: str | None = None) -> _core.Terrain:
        """The ground of a body in a frame: heights, slopes and craters at any place.

        body: default the only one with `terrain`. The same object as long as no driver of the
        terrain changes. Raises ValueError for a body without terrain."""
        config, _ = self.config_at(index)
        return self._mine().terrain_of(config, body_with_terrain(config, body))[0]

    def craters(
        self,
        index: int,
        body: str | None = None,
        least_px: float = 10.0,
        most: int = 20_000,
        threads: int | None = None,
    ) -> Array:
        """Craters in view of a frame, largest first: rows of frame.craters.CRATER_LABEL.

        body: default the only one with craters or a catalogue of them. least_px: least length of a
        rim's image, pixels. most: ValueError if more craters lie about the ground in view. Renders
        labels of the frame, to tell what is hidden. docs/craters.md explains the fields."""
        if not least_px > 0.0:
            raise ValueError(f"least_px: must be above 0, not {least_px}")
        arguments.whole("most", most, 1)
        scene = self.world(index)
        name = craters.body_of(scene.config, body, "craters")
        labelled = [] if scene.config.labels.craters is None else ["crater_id"]
        sample = self.frame(index, ["position", "instance", *labelled], threads)
        return self._tables(scene, sample).craters(name, least_px, most)

    def rocks(self, index: int, body: str | None = None, threads: int | None = None) -> Array:
        """Rocks that a frame shows, most pixels first: rows of frame.rocks.ROCK_LABEL.

        body: default the only one with `terrain.rocks`. docs/labels.md explains the fields."""
        scene = self.world(index)
        name = craters.body_of(scene.config, body, "rocks")
        sample = self.frame(index, ["rock_id", "instance"], threads)
        return self._tables(scene, sample).rocks(name)

    def ground_tables(self, sample: Sample) -> dict[str, Array]:
        """The tables of a frame that `craters` and `rocks` give, of all bodies, largest first.

        `craters` if the sample has crater_id, instance and position, `rocks` if it has rock_id and
        instance. Craters are those of labels.craters.least_px or more."""
        return self._tables(self.world(sample.meta["index"]), sample).all()

    def _tables(self, scene: World, sample: Sample) -> GroundTables:
        return GroundTables(scene, sample, sample.camera, self._mine(), self.taxonomy)

    def plot_orbits(self, frames: Iterable[int] = (0,), **options: Any) -> Any:
        """A matplotlib Figure of the orbits in some frames; see show/plots/orbits.py."""
        from perilune.show.plots import plot_orbits

        return plot_orbits(self, frames, **options)

    def plot_trajectory(self, frames: Iterable[int], **options: Any) -> Any:
        """A matplotlib Figure of the camera's path about its target; see
        show/plots/trajectory.py."""
        from perilune.show.plots import plot_trajectory

        return plot_trajectory(self, frames, **options)

    def plot_light_curve(self, names: Iterable[str], frames: Iterable[int], **options: Any) -> Any:
        """A matplotlib Figure of the sunlight over time; see show/plots/light.py."""
        from perilune.show.plots import plot_light_curve

        return plot_light_curve(self, names, frames, **options)

    def ground_track(self, frames: Iterable[int], **options: Any) -> Any:
        """A matplotlib Figure of the spacecraft's ground tracks on a body; see
        show/plots/ground.py."""
        from perilune.show.plots import plot_ground_track

        return plot_ground_track(self, frames, **options)

    def graph(self, name: str, on: str | None = None) -> GraphPicture:
        """Draws the graph of an entry of `materials` (SVG) and highlights its drivers.

        on: spacecraft or body whose drivers are shown (default: the first that uses the material).
        A notebook shows the result; `.svg` is its text, `.save(path)` writes it. Raises ValueError
        for unknown names."""
        from perilune.show.graphs import draw

        return draw(self._document, name, on)
