"""The world of one frame without the camera's pose: positions while the shutter is open."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from perilune import orbits
from perilune.base import rotations
from perilune.base.random import brief_generator, generator
from perilune.base.timeline import Moment
from perilune.bodies.shapes import BodyShape
from perilune.config.camera import Camera
from perilune.config.orbit import Circular
from perilune.config.schema import Config
from perilune.orbits.ground import Ground
from perilune.orbits.solar_system import Date

F64 = NDArray[np.float64]


@dataclass(frozen=True)
class World:
    """What a trajectory sees: the root frame (ICRF axes), in metres.

    Poses are those when the shutter opens on the first row and when it closes on the last. For
    poses in between, a trajectory is asked with worlds that close earlier."""

    config: Config
    """Configuration of the frame; its section `camera` is that of the sensor that takes the
    frame."""
    moment: Moment
    epoch: Date
    t_s: float
    """Time at which the shutter opens, in seconds after the epoch."""
    poses: Mapping[str, F64]
    """Name of a body or spacecraft -> poses (2, 7), at opening and closing."""
    velocities_m_s: Mapping[str, F64]
    """Name of a body or spacecraft -> velocities (2, 3), at opening and closing."""
    body_radii_m: Mapping[str, F64]
    """Name of a body -> semi-axes (3,); also for a body with a shape."""
    craft_radius_m: Mapping[str, float]
    """Name of a spacecraft -> radius of its bounding sphere about its origin."""
    sun_position_m: F64
    system: orbits.System
    """Motion of bodies and spacecraft: their states at any other time."""
    drivers: Mapping[str, Any]
    """Values that the drivers drew, by key path."""
    window_s: float = 0.0
    """Time from the opening of the first row to the closing of the last, in seconds."""
    shapes: Mapping[str, BodyShape] = field(default_factory=dict)
    """Name of a body -> its shape, for bodies that have one."""
    longest: World | None = None
    """The same step with the longest exposure of its sensors; None if this is the longest."""

    @property
    def index(self) -> int:
        """Index of the frame."""
        return self.moment.index

    @property
    def step(self) -> int:
        """Step of the timeline; t_s is step_s * step."""
        return self.moment.step

    @property
    def scene(self) -> int:
        """Scene of the frame: a run of time.frames_per_scene steps."""
        return self.moment.scene

    @property
    def sensor(self) -> str | None:
        """Name of the sensor that takes the frame; None without `sensors`."""
        return self.moment.sensor

    @property
    def shared(self) -> World:
        """The world common to all sensors of the step, by which the platform is placed.

        Its poses at closing are those of the longest exposure."""
        return self.longest or self

    @property
    def camera(self) -> Camera:
        """The section of the camera that takes the frame."""
        return self.config.camera

    @property
    def date(self) -> Date:
        """Date at which the shutter opens."""
        return self.epoch.after(self.t_s)

    def position_m(self, name: str) -> F64:
        """Position (3,) of the centre of a body or spacecraft at shutter opening."""
        return self.poses[name][0, :3]

    def _orbited(self, name: str) -> str:
        """Central body of a body or spacecraft: the root if an ephemeris places it."""
        entry = self.config.bodies.get(name) or self.config.spacecraft[name]
        return entry.orbit.around if entry.orbit is not None else self.config.root

    def orbital_state(self, name: str, when: int = 0) -> tuple[F64, F64]:
        """Position (3,), m, and velocity (3,), m/s, relative to the central body, in ICRF axes."""
        around = self._orbited(name)
        position = self.poses[name][when, :3] - self.poses[around][when, :3]
        velocity = self.velocities_m_s[name][when] - self.velocities_m_s[around][when]
        return np.asarray(position), np.asarray(velocity)

    def mean_motion_rad_s(self, name: str) -> float:
        """Mean motion of an orbit from its energy. If the orbit is no ellipse, or the central
        body's mass is unknown: the present angular rate."""
        position, velocity = self.orbital_state(name)
        distance = float(np.linalg.norm(position))
        body = self.config.bodies.get(self._orbited(name))
        entry = self.config.bodies.get(name) or self.config.spacecraft[name]
        if body is not None and not isinstance(entry.orbit, Circular):
            gm = orbits.gm_m3_s2(body)
            inverse = 2.0 / distance - float(velocity @ velocity) / gm  # of the semi-major axis
            if inverse > 0.0:
                return float(np.sqrt(gm * inverse**3))
        return float(np.linalg.norm(rotations.cross(position, velocity))) / distance**2

    def radius_m(self, name: str) -> float:
        """Radius of a bounding sphere about the centre of a body or spacecraft."""
        if name in self.craft_radius_m:
            return self.craft_radius_m[name]
        if name in self.shapes:
            return self.shapes[name].radius_m
        high = 0.0
        if self.config.bodies[name].terrain is not None:
            high = (self.ground(name).bounds_m or (0.0, 0.0))[1]
        return float(max(self.body_radii_m[name].tolist())) + max(high, 0.0)

    def random(self, what: str, interval: int = 1) -> np.random.Generator:
        """The step's random numbers for `what`, independent of all other draws.

        All sensors of a step get the same ones, and so do all of `interval` steps."""
        return generator(self.config.seed, what, self.step // interval)

    def brief_random(self, what: str, interval: int = 1) -> np.random.Generator:
        """The numbers of `random` for trajectories, which draw them at once: see
        perilune.base.random.brief_generator."""
        return brief_generator(self.config.seed, what, self.step // interval)

    def scene_random(self, what: str) -> np.random.Generator:
        """The scene's random numbers for `what`: the same for all its steps."""
        return generator(self.config.seed, f"scene:{what}", self.scene)

    def body_axes(self, name: str, vector: F64, when: int = 0) -> F64:
        """A vector of the root frame in the axes of a body or spacecraft."""
        return rotations.rotate_back(self.poses[name][when, 3:], vector)

    def inside(self, point_m: F64, clearance_m: float = 0.0, when: int = 0) -> str | None:
        """Name of a body that contains a point or is nearer to it than about the clearance; else
        None."""
        for name, radii in self.body_radii_m.items():
            own = self.body_axes(name, point_m - self.poses[name][when, :3], when)
            if self._under(name, own, clearance_m):
                return name
            if self.config.bodies[name].terrain is not None:
                continue
            if name in self.shapes:
                if _near_shape(self.shapes[name], own, clearance_m):
                    return name
                continue
            p = own / (radii + clearance_m)
            if float(p @ p) <= 1.0:
                return name
        return None

    def ground(self, name: str) -> Ground:
        """The ground of a body, in its axes."""
        return self.system.setting.ground(name)

    def _under(self, name: str, point: F64, clearance_m: float) -> bool:
        """Whether a point in body axes is in the terrain of a body, or less than about the
        clearance over it."""
        if self.config.bodies[name].terrain is None:
            return False
        ground = self.ground(name)
        assert ground.bounds_m is not None  # it is of a terrain
        high = float(ground.radii_m.max()) + ground.bounds_m[1] + clearance_m
        return float(np.linalg.norm(point)) <= high and ground.height_m(point) <= clearance_m

    def depth_m(self, name: str, point_m: F64, when: int = 0) -> float | None:
        """How far a point of the root frame is below the terrain of a body; None for a body
        without one."""
        if self.config.bodies[name].terrain is None:
            return None
        own = self.body_axes(name, point_m - self.poses[name][when, :3], when)
        return -self.ground(name).height_m(own)

    def surface_m(self, name: str, direction: F64) -> float:
        """Distance from a body's centre to its surface, or its terrain's, along a unit direction in
        body axes. For a shape, the outermost surface, or that of its ellipsoid if there is none in
        this direction."""
        if self.config.bodies[name].terrain is not None:
            return float(self.ground(name).ground_m(direction[np.newaxis])[0])
        shape = self.shapes.get(name)
        found = shape.surface_m(direction) if shape is not None else None
        if found is not None:
            return found
        return float(1.0 / np.linalg.norm(direction / self.body_radii_m[name]))

    def hit_m(self, name: str, origin_m: F64, direction: F64) -> float | None:
        """Distance to the first intersection with a body along a ray of unit direction; None
        without one.

        From inside a body the distance is 0."""
        radii = self.body_radii_m[name]
        own = self.body_axes(name, origin_m - self.position_m(name))
        if self.config.bodies[name].terrain is not None:
            return self.ground(name).hit_m(own, self.body_axes(name, direction))
        if name in self.shapes:
            shape = self.shapes[name]
            return 0.0 if shape.holds(own) else shape.hit_m(own, self.body_axes(name, direction))
        towards = self.body_axes(name, direction) / radii
        return _hit_sphere((own / radii).tolist(), towards.tolist())


def _hit_sphere(p: list[float], d: list[float]) -> float | None:
    """Distance along a ray to the unit sphere, in lengths of its direction d; 0 from inside, None
    if it passes."""

    def dot(x: list[float], y: list[float]) -> float:
        return x[0] * y[0] + x[1] * y[1] + x[2] * y[2]

    if dot(p, p) <= 1.0:
        return 0.0
    a, b = dot(d, d), dot(p, d)
    nearest = [x - y * (b / a) for x, y in zip(p, d, strict=True)]  # of the line to the centre
    inside = 1.0 - dot(nearest, nearest)
    if b >= 0.0 or inside < 0.0:
        return None
    return -b / a - math.sqrt(inside / a)


def _near_shape(shape: BodyShape, point: F64, clearance_m: float) -> bool:
    """Whether a point in body axes is inside the shape, or nearer to its surface than the
    clearance."""
    if float(np.linalg.norm(point)) > shape.radius_m + clearance_m:
        return False
    return shape.holds(point) or (clearance_m > 0.0 and shape.distance_m(point) <= clearance_m)


def _system(
    config: Config, epoch: Date, scene: int, craft_radius_m: Mapping[str, float]
) -> orbits.System:
    """The system of a configuration alone."""
    return orbits.System(
        orbits.Setting(config, epoch, scene, lambda text, _: Path(text), craft_radius_m.__getitem__)
    )


def build(
    config: Config,
    drivers: Mapping[str, Any],
    index: int,
    epoch: Date,
    craft_radius_m: Mapping[str, float],
    system: orbits.System | None = None,
    shapes: Mapping[str, BodyShape] | None = None,
) -> World:
    """The world of frame `index`; the sizes of the spacecraft come from their models.

    system: motion that depends on files, hooks or scenes; default: that of the configuration
    alone."""
    moment = config.timeline.at(index)
    moving = system or _system(config, epoch, moment.scene, craft_radius_m)
    cameras = config.cameras
    t_s = config.time.step_s * moment.step
    radii_m = {name: orbits.radii_m(body) for name, body in config.bodies.items()}

    def world(camera: Camera, longest: World | None) -> World:
        window_s = camera.window_s
        states = moving.states(np.array([t_s, t_s + window_s]))
        return World(
            config=config
            if camera is config.camera
            else config.model_copy(update={"camera": camera}),
            moment=moment,
            epoch=epoch,
            t_s=t_s,
            poses=states.poses,
            velocities_m_s=states.velocities_m_s,
            body_radii_m=radii_m,
            craft_radius_m=craft_radius_m,
            sun_position_m=orbits.sun_position_m(config, epoch, t_s + 0.5 * window_s),
            system=moving,
            drivers=drivers,
            window_s=window_s,
            shapes=shapes or {},
            longest=longest,
        )

    own = cameras[moment.sensor]
    slowest = max(cameras.values(), key=lambda camera: camera.window_s)
    shared = slowest.window_s > own.window_s
    return world(own, world(slowest, None) if shared else None)
