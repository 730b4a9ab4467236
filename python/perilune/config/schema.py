"""The schema of a configuration: what may stand in the file, its units, ranges and defaults."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Annotated, Any, Literal

from pydantic import BeforeValidator, Field, model_validator

from perilune.base.timeline import Timeline
from perilune.config.body import Body
from perilune.config.camera import Camera
from perilune.config.drivers import Drivers
from perilune.config.ephemeris import Ephemeris
from perilune.config.errors import fail, nearest
from perilune.config.events import Events
from perilune.config.labels import Labels
from perilune.config.lidar import Lidar
from perilune.config.materials import Material, MaterialDrivers
from perilune.config.motion import check_motion, check_steps
from perilune.config.names import problem_of
from perilune.config.render import Render
from perilune.config.sensors import Sensor
from perilune.config.sky import Sky
from perilune.config.spacecraft import Spacecraft
from perilune.config.sun import Sun
from perilune.config.time import Time
from perilune.config.time_of_flight import TimeOfFlight
from perilune.config.trajectory import check_trajectory
from perilune.config.types import Integer, Strict, of_structure
from perilune.config.volumes import Volume
from perilune.drivers import Drawn


def _whole(value: Any) -> Any:
    """Refuses drivers and what is no whole number; a literal 1 alone would accept 1.0 and true."""
    if type(value) is not int:
        fail("", "takes no driver" if isinstance(value, Drawn) else "must be a whole number")
    return value


_KEPT_CAMERAS = 16
_cameras: dict[tuple[int, int], tuple[Any, Camera, dict[str | None, Camera]]] = {}
"""Identities of sensors and platform -> these, and the cameras of both: sections never change, and
a frame asks for them ten times."""


class Config(Strict):
    """A whole configuration."""

    version: Annotated[Literal[1], BeforeValidator(_whole)]
    """Version of the file format."""
    name: str = "perilune"
    """Name of the simulation. Default: the file's name."""
    description: str = ""
    """What the scene shows, for readers."""
    seed: Annotated[Integer, Field(ge=0, lt=2**63)] = 0
    """Seed of all random numbers; the same seed gives the same frames."""
    time: Time
    root: str
    """Name of the body whose centre is the origin of the root frame (ICRF axes)."""
    sun: Sun = Sun.of_defaults()
    sky: Sky | None = None
    """Stars and background; black by default."""
    ephemeris: Ephemeris = Ephemeris.of_defaults()
    bodies: Annotated[dict[str, Body], Field(min_length=1)]
    """Planets, moons and asteroids: name -> body."""
    spacecraft: dict[str, Spacecraft] = Field(default_factory=dict)
    """Models on orbits: name -> spacecraft."""
    volumes: Annotated[dict[str, Volume], Field(max_length=16)] = Field(default_factory=dict)
    """Dust, gas and glow within bounds: name -> volume."""
    materials: dict[str, Material] = Field(default_factory=dict)
    """Materials as graphs of nodes, which spacecraft, bodies and volumes use by name. An entry may
    also be a hook with an `ideal`, which draws graphs of any structure."""
    material_drivers: MaterialDrivers | None = None
    """Values for driver nodes of all graphs that neither the materials' nor the spacecraft's
    drivers set."""
    camera: Camera
    """The camera and its trajectory; with `sensors`, the platform that carries them."""
    sensors: dict[str, Sensor] = Field(default_factory=dict)
    """Several cameras in place of `camera`: name -> sensor. Keys that a sensor does not give are
    those of `camera`. In each step every triggered sensor takes a frame, in the order of this
    file."""
    lidars: dict[str, Lidar] = Field(default_factory=dict)
    """LiDARs on the platform: name -> LiDAR. `Simulation.lidar` scans from the step of a frame
    on."""
    time_of_flight: TimeOfFlight | None = None
    """What `Simulation.time_of_flight` takes pictures with."""
    events: Events | None = None
    """What `Simulation.events` records with."""
    render: Render = Render.of_defaults()
    labels: Labels = Labels.of_defaults()
    drivers: Drivers = Drivers.of_defaults()

    @property
    def objects(self) -> tuple[str, ...]:
        """Names of what has object labels: spacecraft, then the bodies with `annotate`."""
        return (*self.spacecraft, *(name for name, body in self.bodies.items() if body.annotate))

    @property
    def timeline(self) -> Timeline:
        """Step, scene and sensor of each frame; independent of what drivers draw."""
        intervals = {name: sensor.trigger_interval for name, sensor in self.sensors.items()}
        return Timeline(self.time.frames_per_scene, intervals)

    @property
    def cameras(self) -> dict[str | None, Camera]:
        """Camera of each sensor by its name; without sensors the platform's, under None."""
        if not self.sensors:
            return {None: self.camera}
        key = id(self.sensors), id(self.camera)
        kept = _cameras.get(key)
        if kept is None or kept[0] is not self.sensors or kept[1] is not self.camera:
            found: dict[str | None, Camera] = {}
            for name, sensor in self.sensors.items():
                found[name] = sensor.camera(self.camera)
            while len(_cameras) >= _KEPT_CAMERAS:
                _cameras.pop(next(iter(_cameras)), None)
            kept = _cameras[key] = self.sensors, self.camera, found
        return dict(kept[2])

    def place(self, name: str | None, key: str) -> str:
        """Key path of a camera's key: the sensor's own, or the platform's."""
        own = name is not None and getattr(self.sensors[name], key) is not None
        return f"sensors.{name}.{key}" if own else f"camera.{key}"

    @model_validator(mode="after")
    @of_structure
    def _names(self) -> Config:
        sections: dict[str, Iterable[str]] = {
            "bodies": self.bodies,
            "spacecraft": self.spacecraft,
            "materials": self.materials,
            "sensors": self.sensors,
            "lidars": self.lidars,
            "volumes": self.volumes,
        }
        for section, names in sections.items():
            for name in names:
                wrong = problem_of(name)
                if wrong is not None:
                    fail(f"{section}.{name}", wrong)
        for name in self.spacecraft:
            if name in self.bodies:
                fail(f"spacecraft.{name}", "a body has the same name")
        for name in self.volumes:
            if name in self.bodies or name in self.spacecraft:
                fail(f"volumes.{name}", "a body or spacecraft has the same name")
        return self

    @model_validator(mode="after")
    @of_structure
    def _levels(self) -> Config:
        stated: dict[str, Mapping[str, Any]] = {}
        stated |= {f"bodies.{name}.classes": row.classes for name, row in self.bodies.items()}
        stated |= {
            f"spacecraft.{name}.classes": row.classes for name, row in self.spacecraft.items()
        }
        stated |= {
            f"materials.{name}.labels": {level: row.classes for level, row in entry.labels.items()}
            for name, entry in self.materials.items()
        }
        self.labels.check(stated)
        return self

    @model_validator(mode="after")
    @of_structure
    def _references(self) -> Config:
        def known(path: str, name: str | None, allowed: list[str]) -> None:
            if name is not None and name not in allowed:
                fail(path, f"no entry named '{name}'{nearest(name, allowed)}")

        bodies = list(self.bodies)
        known("root", self.root, bodies)
        for place, volume in self.volumes.items():
            known(f"volumes.{place}.parent", volume.parent, [*bodies, *self.spacecraft])
        check_motion(self)
        for name, camera in self.cameras.items():
            camera.check_lens(self.place(name, "lens"), self.place(name, "fov_deg"))
        return self

    @model_validator(mode="after")
    def _times(self) -> Config:
        check_steps(self)
        check_trajectory(self)
        return self
