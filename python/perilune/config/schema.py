"""The schema of a configuration: what may stand in the file, its units, ranges and defaults."""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Mapping
from typing import Annotated, Any, Literal

from pydantic import (
    AfterValidator,
    BeforeValidator,
    Discriminator,
    Field,
    Tag,
    field_validator,
    model_validator,
)

from perilune.base.timeline import Timeline
from perilune.config import utc
from perilune.config.articulation import Animation, Joint
from perilune.config.attitude import Attitude, Inertial
from perilune.config.bands import Spectrum
from perilune.config.body import Body
from perilune.config.camera import Camera
from perilune.config.ephemeris import Ephemeris
from perilune.config.errors import fail, nearest
from perilune.config.events import Events
from perilune.config.faces import DEFAULT, Faces
from perilune.config.keypoints import Keypoints
from perilune.config.labels import ClassPatterns, EntryClasses, Labels
from perilune.config.lidar import Lidar
from perilune.config.materials import DriverSection, Material, MaterialDrivers, MaterialUse
from perilune.config.motion import check_motion, check_steps
from perilune.config.orbit import Orbit
from perilune.config.parts import Parts
from perilune.config.sensors import Sensor
from perilune.config.sky import Sky
from perilune.config.time_of_flight import TimeOfFlight
from perilune.config.trajectory import check_trajectory
from perilune.config.types import (
    Direction,
    FileName,
    Finite,
    Integer,
    Latitudes,
    NonNegative,
    Positive,
    PositiveByAxis,
    StaticNonNegative,
    StaticVec3,
    Strict,
    of_structure,
    refuse_drawn,
)
from perilune.config.volumes import Volume
from perilune.drivers import Drawn, Group, factor

_NAME = re.compile(r"[A-Za-z_][A-Za-z0-9_-]*")
_EPOCH = re.compile(
    r"(\d{4})-(\d\d)-(\d\d)(?:[T ](\d\d):(\d\d)(?::(\d\d(?:\.\d{1,9})?))?)?(?:Z|\+00:00)?"
)
_YEARS = (1960, 2100)  # UTC exists since 1960; the ephemeris of the Earth holds until 2100


class Time(Strict):
    """Time of the steps.

    Step k is step_s * k seconds after the epoch. These are SI seconds, as of TT and TAI, so a leap
    second in between shifts the UTC date by one second. Each step is one frame, or with `sensors`
    one frame of each sensor that is triggered."""

    epoch: str
    """Time of step 0: UTC in ISO 8601, such as 2026-03-20T12:00:00Z."""
    step_s: Finite = 0.0
    """Time from one step to the next."""
    frames_per_scene: Annotated[Integer, Field(ge=1)] = 1
    """Steps per scene. Values drawn once a scene (orbits of the kinds database and hook, drivers
    without an interval) are drawn anew at its start; what is drawn at every step goes on."""

    @field_validator("epoch")
    @classmethod
    def _iso_utc(cls, value: str) -> str:
        match = _EPOCH.fullmatch(value)
        if not match:
            fail("", "must be an ISO 8601 date in UTC, such as 2026-03-20T12:00:00Z")
        if not _YEARS[0] <= int(match[1]) <= _YEARS[1]:
            fail("", f"years {_YEARS[0]} to {_YEARS[1]} are covered")
        if wrong := utc.complaint(_fields(match)):
            fail("", wrong)
        return value

    def utc_fields(self) -> tuple[int, int, int, int, int, float]:
        """Year, month, day, hour, minute, second of the epoch."""
        match = _EPOCH.fullmatch(self.epoch)
        assert match is not None  # the validator has matched it
        return _fields(match)


def _fields(match: re.Match[str]) -> tuple[int, int, int, int, int, float]:
    year, month, day, hour, minute = (int(match[k] or 0) for k in range(1, 6))
    return year, month, day, hour, minute, float(match[6] or 0.0)


class Angles(Strict):
    """A direction given by two angles, each of which takes a driver."""

    azimuth_deg: Finite
    """Angle about z, from x towards y."""
    elevation_deg: Annotated[float, Field(strict=True, ge=-90.0, le=90.0)]
    """Angle from the xy plane towards z."""


def _direction_tag(value: Any) -> str:
    return "angles" if isinstance(value, (Mapping, Angles)) else "vector"


def _vector(value: tuple[float, float, float] | Angles) -> tuple[float, float, float]:
    if not isinstance(value, Angles):
        return value
    azimuth, elevation = math.radians(value.azimuth_deg), math.radians(value.elevation_deg)
    flat = math.cos(elevation)
    return (flat * math.cos(azimuth), flat * math.sin(azimuth), math.sin(elevation))


_Micrometres = Annotated[float, Field(strict=True, ge=0.4226, le=1.1)]


SRGB_UM = (0.612, 0.549, 0.465)
"""Dominant wavelengths of the sRGB primaries red, green and blue, in micrometres."""


class SiteSun(Strict):
    """A place in the sky, seen from a site on the ellipsoid of the root body."""

    lon_deg: Finite
    """East longitude of the site."""
    lat_deg: Annotated[float, Field(strict=True, ge=-90.0, le=90.0)]
    """Latitude of the site."""
    latitudes: Latitudes | None = None
    """geodetic: latitude of the surface normal; geocentric: of the line from the body's centre.
    Default: the same as the body's maps."""
    azimuth_deg: Finite
    """Azimuth of the Sun's centre, from north towards east."""
    elevation_deg: Annotated[float, Field(strict=True, ge=-90.0, le=90.0)]
    """Elevation of the Sun's centre over the horizontal plane of the site."""


class Sun(Strict):
    """The Sun. Its position follows from the date, unless a direction is given."""

    radius_km: Positive = 695700.0
    """Radius of the disc."""
    irradiance_w_m2: NonNegative = 1361.0
    """Solar constant: irradiance at 1 au over all wavelengths."""
    spectrum: Spectrum | None = None
    """Spectrum of the Sun from a file. Default: a black body of 5850 K with 0.7 of its light below
    0.4 um, within 6 % of the Sun in every 50 nm from 0.3 to 1.1 um. Colours look the same with
    either."""
    band_wavelengths_um: tuple[_Micrometres, _Micrometres, _Micrometres] | None = None
    """Wavelengths of red, green and blue, at which limb darkening (Neckel 2005) and atmospheric
    scattering are computed. Default: 0.612, 0.549 and 0.465, those of sRGB. By default, limb
    darkening in images uses what the camera's `bands` see of each colour, and presets of
    atmospheres are means over each colour of sRGB."""
    direction: (
        Annotated[
            Annotated[Direction, Tag("vector")] | Annotated[Angles, Tag("angles")],
            Discriminator(_direction_tag),
            AfterValidator(_vector),
        ]
        | None
    ) = None
    """Direction from the root body to the Sun in ICRF axes, instead of that of the date: a vector,
    or {azimuth_deg, elevation_deg}."""
    at: SiteSun | None = None
    """Place of the Sun in the sky of a site on the root body, instead of that of the date; it stays
    there as the body rotates."""
    distance_au: Positive = 1.0
    """Distance of the Sun from the root body; used only with `direction` or `at`."""

    @property
    def wavelengths_um(self) -> tuple[float, float, float]:
        """Wavelengths of red, green and blue, in micrometres."""
        return self.band_wavelengths_um or SRGB_UM

    @property
    def by_date(self) -> bool:
        """Whether the date says where the Sun is."""
        return self.direction is None and self.at is None

    @model_validator(mode="after")
    def _given(self) -> Sun:
        self._exactly_one("direction", "at", optional=True)
        if self.by_date:
            self._only_with("direction or at: the date says where the Sun is", "distance_au")
        return self


class ContinuousSymmetry(Strict):
    """Full rotational symmetry about a line in the model's frame."""

    axis: StaticVec3
    """Direction of the line."""
    offset_m: StaticVec3 = (0.0, 0.0, 0.0)
    """A point on the line."""


class DiscreteSymmetry(Strict):
    """A rotation about a point that maps the model onto itself."""

    rotation_deg: StaticVec3
    """Roll, pitch, yaw of the rotation."""
    offset_m: StaticVec3 = (0.0, 0.0, 0.0)
    """A point on the axis of rotation, in the model's frame."""


class Symmetries(Strict):
    """Symmetries of a model in its frame, for BOP.

    They are never guessed. Each is checked: the rotated model must lie within a tenth of its
    diameter, or 15 mm, of itself, as BOP asks."""

    discrete_deg: tuple[StaticVec3, ...] = ()
    """Rotations (roll, pitch, yaw) about the frame's origin that map the model onto itself. List
    all of them, with those of `discrete`, except the identity."""
    discrete: tuple[DiscreteSymmetry, ...] = ()
    """Rotations about other points."""
    continuous: tuple[ContinuousSymmetry, ...] = ()
    """Rotational symmetries about lines."""


class Spacecraft(Strict):
    """A model on an orbit."""

    model: FileName
    """Model file, .glb or .gltf; relative to this file, or data:... under PERILUNE_DATA."""
    size_m: Annotated[Positive, Field(ge=1e-9, le=1e18)] | None = None
    """Longest side of the model's bounding box; scales the model."""
    metres_per_unit: PositiveByAxis | None = None
    """Scale of the model: a number, or one for each of its axes x, y, z (z up). It acts like a
    parent node of that scale. Boxes of `parts` and `materials` are given in the file's units, all
    other lengths at the model's final size."""
    centre: Literal["bounds", "origin"] = "bounds"
    """Point of the model that follows the orbit: the centre of its bounding box, or the file's
    origin."""
    crease_angle_deg: Annotated[StaticNonNegative, Field(le=180)] = 65.0
    """Crease angle: an edge is shaded sharp if its faces meet at more than this angle although the
    file has one normal for both, and if that normal is more than half of this angle from one of
    them. 180 keeps the file's normals."""
    faces: Faces = DEFAULT
    """Which sides of faces exist, for visibility, light, labels and written models alike.
    double_sided: both. as_stated: as the file says; single-sided materials have no backs (glTF).
    single_sided: fronts only. A mapping from shell patterns on material names (case-insensitive) to
    one of these: the first match counts, double_sided without any. Of two sheets back to back,
    closer than a ten-thousandth of the model's size, the one facing the viewer is always visible.
    Solids that transmit light keep both sides."""
    orbit: Orbit
    gm_km3_s2: Positive | None = None
    """Gravitational parameter, for a model that others orbit: an asteroid or a moonlet."""
    attitude: Attitude = Inertial.of_defaults()
    obj_id: Annotated[Integer, Field(ge=0)] | None = None
    """BOP object id. Default: 1, 2, ... in the order of this section."""
    class_: str | None = Field(default=None, alias="class")
    """Class at the label level `object`. Default: the entry's name."""
    classes: EntryClasses = Field(default_factory=dict)
    """Classes at your own label levels: level of `labels.levels` -> class, or class -> shell
    patterns on part and material names, in place of those of `labels.classes`."""
    parts: Parts = Parts.of_defaults()
    part_classes: ClassPatterns = Field(default_factory=dict)
    """Class of part -> shell patterns on part and material names; tried before those of
    `labels`."""
    materials: tuple[MaterialUse, ...] = ()
    """Material graphs that replace or wrap the model's materials. For each triangle the first entry
    that matches counts."""
    model_graphs: bool = True
    """Whether to use material graphs stored in the model's file (`perilune_graph` in a material's
    extras, with the keys of an entry of `materials`) where `materials` assigns none. Such a graph
    is the entry `FILE-MATERIAL` of the top section `materials`; keys given there override the
    file's."""
    material_drivers: DriverSection | None = None
    """Values for driver nodes of these graphs that the materials' own drivers do not set."""
    articulation: tuple[Joint, ...] = ()
    """Joints: nodes of the model that move."""
    animation: Animation | None = None
    """The model's own animations. Joints act on top of them."""
    symmetries: Symmetries = Symmetries.of_defaults()
    keypoints: Keypoints = Keypoints.of_defaults()
    """Named points of it whose images are labels."""

    @model_validator(mode="after")
    def _one_scale(self) -> Spacecraft:
        self._exactly_one("size_m", "metres_per_unit")
        return self

    @property
    def stretch(self) -> tuple[float, float, float]:
        """Scale factors along the model's axes, relative to the largest, which is 1."""
        given = self.metres_per_unit
        if not isinstance(given, tuple):
            return (1.0, 1.0, 1.0)
        x, y, z = given
        return (x / max(given), y / max(given), z / max(given))


TextureFilter = Literal[
    "nearest",
    "bilinear",
    "trilinear",
    "anisotropic_2",
    "anisotropic_4",
    "anisotropic_8",
    "anisotropic_16",
]


class Render(Strict):
    """Image quality and outputs of a frame."""

    quality: Literal["adaptive", "reference"] = "adaptive"
    """adaptive: saves effects and samples within `tolerance_dn`. reference: `tolerance_dn` is 0
    and `force_off` empty. Nothing is left out, shared between pixels or smoothed, every pixel gets
    all samples, and the image converges to the light of the scene as samples grow. See
    docs/convergence.md."""
    samples: Annotated[Integer, Field(ge=1, le=65536)] = 16
    """Colour samples per pixel. With adaptive sampling, pixels whose noise is within three
    tolerances get fewer and outlines up to twice as many, for about the error of this number
    everywhere. At a tolerance of 0 every pixel gets this number."""
    max_bounces: Annotated[Integer, Field(ge=0, le=64)] = 4
    """Largest number of bounces of a light path; 0: direct light only."""
    texture_filter: TextureFilter = "anisotropic_16"
    """Best texture filter that may be used. nearest and bilinear take one texel or four of one mip
    level, trilinear four of each of two levels, anisotropic_N up to N such lookups along the longer
    axis of the pixel's footprint."""
    volume_steps: Annotated[Integer, Field(ge=1, le=1024)] = 32
    """Largest number of steps along a ray through a volume. For a volume with a material it is also
    the resolution, from 8 to 64 cells a side, of the precomputed light inside it; rays from
    surfaces take a quarter of the steps."""
    tolerance_dn: NonNegative = 1.0
    """Largest change of any pixel by an effect that may be left out. 0 keeps every effect that
    applies. Default: 1, or 0 with `quality: reference`."""
    force_on: tuple[str, ...] = ()
    """Effects that are kept whatever their bound. `perilune plan` lists the names."""
    force_off: tuple[str, ...] = ()
    """Effects that are left out whatever their bound."""
    channels: tuple[str, ...] = ("rgb", "depth", "semantic", "part", "instance", "objects")
    """Channels that a sample holds unless it is asked for others."""
    scans: tuple[Literal["points", "lidar", "time_of_flight", "events"], ...] = ()
    """Measurements that datasets hold beside channels: `points` of the pixels, returns of all
    `lidars`, pixels of `time_of_flight`, and `events` until the next frame. docs/lidar.md."""
    amodal: Annotated[bool, Field(strict=True)] = True
    """Whether object labels cover whole silhouettes, including hidden and cut-off parts. Costs
    extra rays."""

    @model_validator(mode="before")
    @classmethod
    def _tolerance_of_reference(cls, data: Any) -> Any:
        if isinstance(data, Mapping) and data.get("quality") == "reference":
            return {"tolerance_dn": 0.0, **data}
        return data

    @model_validator(mode="after")
    def _whole_reference(self) -> Render:
        if self.quality == "reference" and self.tolerance_dn != 0.0:
            fail(
                "tolerance_dn",
                f"is {self.tolerance_dn:g}, but quality: reference is a tolerance of 0: leave one "
                "of them out",
            )
        if self.quality == "reference" and self.force_off:
            fail(
                "force_off",
                f"leaves out {self.force_off[0]}, but quality: reference leaves out nothing",
            )
        return self

    @model_validator(mode="after")
    def _not_both(self) -> Render:
        both = sorted(set(self.force_on) & set(self.force_off))
        if both:
            fail("force_off", f"{both[0]} is in force_on too")
        return self


def _whole(value: Any) -> Any:
    """Refuses drivers and what is no whole number; a literal 1 alone would accept 1.0 and true."""
    if type(value) is not int:
        fail("", "takes no driver" if isinstance(value, Drawn) else "must be a whole number")
    return value


Correlation = Annotated[float, Field(strict=True, ge=-1.0, le=1.0), BeforeValidator(refuse_drawn)]


class DriverGroup(Strict):
    """Settings and correlation of the drivers with `group: NAME`.

    Correlated draws use a Gaussian copula: normal drivers have the given correlations, other kinds
    are monotonic functions of correlated normal numbers."""

    jitter_strength: StaticNonNegative | None = None
    """Factor on every variance; 0 gives exactly the ideal values. Default: drivers.strength."""
    step_interval: Annotated[Integer, Field(ge=1)] | None = None
    """Steps between draws. Default: drivers.interval."""
    shared: Annotated[bool, Field(strict=True)] = False
    """Whether all drivers of the group use the same random draw."""
    members: Annotated[tuple[str, ...], Field(min_length=1)] | None = None
    """Key paths of the drivers, in the order of the rows of `correlation`."""
    correlation: tuple[tuple[Correlation, ...], ...] | None = None
    """Correlation matrix of `members`: symmetric, positive definite, ones on the diagonal."""

    @model_validator(mode="after")
    def _matrix(self) -> DriverGroup:
        if self.correlation is None:
            if self.members is not None:
                fail("members", "are the rows of `correlation`, which is missing")
            return self
        if self.shared:
            fail("shared", "give shared or correlation, not both")
        if self.members is None:
            fail("members", "required with correlation: the key paths of its rows")
        count = len(self.members)
        if len(set(self.members)) != count:
            fail("members", "a key path occurs twice")
        if len(self.correlation) != count or any(len(row) != count for row in self.correlation):
            fail("correlation", f"must be {count} x {count} for {count} members")
        try:
            factor(self.correlation)
        except ValueError as error:
            fail("correlation", str(error))
        return self

    def resolved(self, name: str) -> Group:
        """The group in the form that the drivers use."""
        return Group(
            name,
            self.jitter_strength,
            self.step_interval,
            self.shared,
            self.members or (),
            None if self.correlation is None else factor(self.correlation),
        )


class Drivers(Strict):
    """Defaults and groups of the drivers.

    A driver is a mapping in place of a value: {ideal, jitter_variance, clip_min, clip_max},
    {uniform: [low, high]}, {median, log_variance, clip_min, clip_max}, {choice: [...], weights:
    [...]} or {hook: module:function, ideal, ...}."""

    strength: StaticNonNegative = 1.0
    """Factor on every variance; 0 gives exactly the ideal values."""
    interval: Annotated[Integer, Field(ge=1)] | None = None
    """Steps between draws of a value. Default: time.frames_per_scene."""
    groups: dict[str, DriverGroup] = Field(default_factory=dict)
    """Groups of drivers with settings of their own, or correlated."""


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
                if not _NAME.fullmatch(name):
                    fail(f"{section}.{name}", "a name is letters, digits, _ and -, no digit first")
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
            camera.check_focus(self.place(name, "lens"))
        return self

    @model_validator(mode="after")
    def _times(self) -> Config:
        check_steps(self)
        check_trajectory(self)
        return self
