"""What a simulation measures besides pictures: points, LiDARs, time of flight, single rays."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from perilune import _core
from perilune.base import arguments, rotations
from perilune.base.processors import default_threads
from perilune.camera import trajectories
from perilune.camera.imaging import intrinsics
from perilune.config import Config
from perilune.config.errors import nearest
from perilune.config.sensors import Transformation
from perilune.document import Document
from perilune.frame import scans
from perilune.frame.handles import Handles
from perilune.frame.placing import placed
from perilune.frame.remarks import Remarks
from perilune.frame.request import channel_layout
from perilune.world import World

Array = NDArray[Any]
F64 = NDArray[np.float64]

EXACT_PX = 1e5
"""Focal length for poses during a scan: these are then right to a millionth of the distance."""


class Simulated(Protocol):
    """A simulation, of which this module needs little."""

    _document: Document
    _trajectory: Callable[[World], Any] | None
    _remarks: Remarks

    @property
    def config(self) -> Config: ...
    def config_at(self, index: int) -> tuple[Config, dict[str, Any]]: ...
    def world(self, index: int) -> World: ...
    def frame(self, index: int, channels: Sequence[str] | None, threads: int | None) -> Any: ...
    def _mine(self) -> Handles: ...
    def _request(self, scene: World) -> _core.FrameRequest: ...
    def _camera_poses(self, scene: World) -> F64: ...
    def _tell_of_jump(self, world: World, step: int) -> None: ...


def _threads(given: int | None) -> int:
    return arguments.whole("threads", default_threads() if given is None else given, 1)


def _scanned(
    sim: Simulated, index: int, window_s: float, place: Transformation | None
) -> tuple[World, _core.FrameRequest]:
    """The world from the opening of the shutter on, and the core's input, with the pose of a sensor
    on the platform in place of the camera's."""
    world = scans.during(sim.world(index), sim.config_at(index)[0].camera, window_s)

    def poses(then: World) -> F64:
        platform = trajectories.platform_poses(then, sim._trajectory)
        return platform if place is None else trajectories.mounted(platform, place)

    hooked = sim._trajectory is not None
    return world, placed(world, sim._mine(), poses, hooked, focal_px=EXACT_PX)


class RangeSensors:
    """Methods of a simulation."""

    def points(
        self: Simulated, index: int, colour: bool = False, threads: int | None = None
    ) -> Array:
        """The surface points that the pixels of a frame show: a structured array, row by row.

        Fields: u, v (pixel), camera_m and position_m (3; camera axes, root frame), normal (3, unit,
        root axes), range_m, instance, part, semantic (one per level), and with `colour` rgb. With a
        rolling shutter, all is of the time of the pixel's own row."""
        names = [*scans.POINT_CHANNELS, *(["rgb"] if colour else [])]
        sample = self.frame(index, names, threads)
        levels = len(self.config.labels.levels)
        return scans.points_of(sample, sample.camera, levels, sample.meta.get("rows", ()))

    def trace(
        self: Simulated,
        index: int,
        rays: Any,
        channels: Sequence[str] = ("instance", "part", "semantic"),
        reflectance: bool = False,
        threads: int | None = None,
    ) -> dict[str, Array]:
        """What rays of one's own hit at the step of a frame: channels of labels by name, (n, ...),
        and range_m (n,), nan where nothing is hit, origin_m, point_m (n, 3; root frame), and
        surface_normal (n, 3; root axes).

        rays: (n, 6), origin and direction in the axes of the platform (x right, y down, z forward),
        m; or (n, 7) with a time in seconds after the shutter opens. channels: those that need no
        more than a pixel of its own. reflectance: adds `reflectance` (n,), pi times the BRDF for
        light that comes back to its source, times the cosine of incidence, of the red band."""
        source = scans.given(rays)
        count, last_s = _core.source_extent(source)
        world, request = _scanned(self, index, last_s, None)
        out = {}
        for name in arguments.names("channels", channels):
            row = next((row for row in _core.CHANNELS if row["name"] == name), None)
            if row is None:
                known = [row["name"] for row in _core.CHANNELS]
                raise ValueError(f"channels: no channel is named '{name}'{nearest(name, known)}")
            (_, _, *tail), dtype = channel_layout(self.config, name)
            out[name] = np.empty((1, count, *tail), dtype)
        handles = self._mine()
        with handles.lock:
            renderer = handles.renderer_of(world.config)
            found = renderer.trace(
                request, source, out, _threads(threads), instants=16, shade=reflectance
            )
        names = {"position_m": "point_m", "normal": "surface_normal"}
        traced = {names.get(name, name): array for name, array in found.items()}
        return {**{name: array[0] for name, array in out.items()}, **traced}

    def lidar(
        self: Simulated, index: int, name: str | None = None, threads: int | None = None
    ) -> Array:
        """A LiDAR's scan that begins as the shutter of a frame opens: a structured array, a row per
        return in the order of beams, nearest first.

        name: entry of `lidars`; default: the only one. Fields: time_s after the start, range_m as
        measured, true_range_m without noise, origin_m and direction of the beam and position_m
        (origin_m + range_m direction) in the root frame at that time, sensor_direction (axes of the
        LiDAR), intensity, reflectance, incidence_rad, beam, line, instance, part, semantic (one per
        level), return_number (from 1) and return_count of the beam, path (0: direct, 1: through a
        clear wall, 2: by a mirror, 3: both)."""
        config, _ = self.config_at(index)
        name, lidar = scans.chosen(config, name)
        source = scans.source_of(lidar)
        _, last_s = _core.source_extent(source)
        world, request = _scanned(self, index, last_s, lidar.transformation)
        handles = self._mine()
        with handles.lock:
            returns = handles.renderer_of(world.config).lidar(
                request,
                source,
                scans.receiver_of(lidar, list(config.lidars).index(name)),
                _threads(threads),
                lidar.instants,
                scans.band_of(lidar.band),
            )
        return returns.view(scans.lidar_dtype(len(config.labels.levels)))

    def measure_scan(
        self: Simulated, index: int, repeats: int, name: str | None = None
    ) -> tuple[int, float, float]:
        """For benchmarks: times the rays of a LiDAR against raw Embree; see _core.Renderer."""
        _, lidar = scans.chosen(self.config_at(index)[0], name)
        source = scans.source_of(lidar)
        world, request = _scanned(self, index, 0.0, lidar.transformation)
        handles = self._mine()
        with handles.lock:
            return handles.renderer_of(world.config).measure_scan(request, source, repeats)

    def time_of_flight(self: Simulated, index: int, threads: int | None = None) -> Array:
        """The picture of a time-of-flight camera with the pixels of a frame's camera: a structured
        array (height, width).

        Fields: range_m along the ray, nan where there is none; true_range_m, the mean over what the
        pixel sees, weighted by its light; amplitude_e, the least of the modulations; offset_e, the
        mean of the taps; echoes (0: nothing, 1: one surface, 2: several); full."""
        world = self.world(index)
        camera = world.config.time_of_flight
        if camera is None:
            raise ValueError("time_of_flight: the configuration has no such section")
        request, handles = self._request(world), self._mine()
        with handles.lock:
            pixels = handles.renderer_of(world.config).time_of_flight(
                request,
                scans.pixels(camera.samples),
                scans.flight_of(camera),
                _threads(threads),
                1,
                scans.band_of(camera.band),
            )
        size = world.camera.height, world.camera.width
        return pixels.view(scans.flight_dtype()).reshape(size)

    def events(self: Simulated, index: int, threads: int | None = None) -> Array:
        """What an event camera records from a frame on until the next one of the same camera: a
        structured array in the order of time.

        Fields: t_us after the frame's shutter opens, x, y, polarity (1: brighter, -1: darker). At
        the start all pixels are at rest. What moves goes on as in frame `index`; a warning tells
        where the next frame does not go on from there."""
        world = self.world(index)
        camera = world.config.events
        if camera is None:
            raise ValueError("events: the configuration has no such section")
        interval = (
            1 if world.sensor is None else world.config.sensors[world.sensor].trigger_interval
        )
        window_s = interval * world.config.time.step_s
        later = scans.during(world, world.camera, window_s)
        request, handles = self._request(later), self._mine()
        self._tell_of_jump(later, world.step + interval)
        with handles.lock:
            renderer = handles.renderer_of(later.config)
            found, _ = renderer.events(request, scans.events_of(camera), _threads(threads))
        return found.view(scans.event_dtype())

    def _tell_of_jump(self: Simulated, world: World, step: int) -> None:
        """Warns where the camera of the next frame is not where this one's goes."""
        if step // world.config.time.frames_per_scene != world.scene:
            return
        timeline = self.config.timeline
        there = self._camera_poses(self.world(timeline.index_of(step, world.sensor)))[0]
        here = self._camera_poses(world)[1]
        _, angle = rotations.to_axis_angle(
            rotations.multiply(rotations.conjugate(here[3:]), there[3:])
        )
        pixels = float(intrinsics(world.camera)[0, 0]) * angle
        if pixels > 1.0:
            self._remarks.tell_of_key(
                f"{self._document.source}: camera.trajectory",
                f"frame {world.index + 1} does not go on where frame {world.index} goes: it turns"
                f" by {pixels:.3g} pixels at once, of which no events tell",
            )
