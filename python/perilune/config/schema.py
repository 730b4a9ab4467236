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
from perilune.config.faces import DEFAULT, Faces
from perilune.config.labels import Classes, Labels
from perilune.config.materials import DriverSection, Material, MaterialDrivers, MaterialUse
from perilune.config.motion import check_motion
from perilune.config.orbit import Orbit
from perilune.config.parts import Parts
from perilune.config.sensors import Sensor
from perilune.config.sky import Sky
from perilune.config.trajectory import check_trajectory
from perilune.config.types import (
    Direction,
    FileName,
    Finite,
    Integer,
    NonNegative,
    Positive,
    PositiveByAxis,
    StaticNonNegative,
    StaticVec3,
    Strict,
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
    """Step k lies step_s * k seconds after the epoch: of TT, as long as those of UTC, TAI and every
    clock, so that a leap second between makes the dates of UTC one less. Each step is a frame, or
    with `sensors` one frame of each sensor that is triggered."""

    epoch: str
    """UTC, ISO 8601: 2026-03-20T12:00:00Z."""
    step_s: Finite = 0.0
    """Seconds from one step to the next."""
    frames_per_scene: Annotated[Integer, Field(ge=1)] = 1
    """Steps of a scene. What is drawn once a scene (orbits from samplers, drivers without an
    interval) is drawn anew every so many steps; what is drawn at every step goes on."""

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
    """A direction by two angles; either may be driven."""

    azimuth_deg: Finite
    """About z, from x towards y."""
    elevation_deg: Annotated[float, Field(strict=True, ge=-90.0, le=90.0)]
    """From the xy plane towards z."""


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
"""Dominant wavelengths of the primaries of sRGB."""


class Sun(Strict):
    """The Sun; its position follows from the date unless a direction is given."""

    radius_km: Positive = 695700.0
    irradiance_w_m2: NonNegative = 1361.0
    """At one astronomical unit: of all wavelengths together."""
    spectrum: Spectrum | None = None
    """How it is spread over the wavelengths; default: a black body of 5850 K with 0.7 of its light
    below 0.4 um, within 6 % of the Sun in every 50 nm from 0.3 to 1.1 um. Colours look the same in
    the light of either."""
    band_wavelengths_um: tuple[_Micrometres, _Micrometres, _Micrometres] | None = None
    """Of the colours red, green, blue: by these the disc darkens towards its edge (Neckel 2005) and
    atmospheres scatter. Default: 0.612, 0.549, 0.465, those of sRGB; but in images the disc darkens
    by what the camera's `bands` see of each colour, and presets of atmospheres are means over all
    that adds to each colour of sRGB."""
    direction: (
        Annotated[
            Annotated[Direction, Tag("vector")] | Annotated[Angles, Tag("angles")],
            Discriminator(_direction_tag),
            AfterValidator(_vector),
        ]
        | None
    ) = None
    """Towards the Sun from the root body, ICRF axes, instead of the date's: a vector, or
    {azimuth_deg, elevation_deg}."""
    distance_au: Positive = 1.0
    """From the root body; used with `direction` only."""

    @property
    def wavelengths_um(self) -> tuple[float, float, float]:
        """Of the colours red, green and blue."""
        return self.band_wavelengths_um or SRGB_UM

    @model_validator(mode="after")
    def _given(self) -> Sun:
        if self.direction is None:
            self._only_with("a direction: the date says where the Sun is", "distance_au")
        return self


class ContinuousSymmetry(Strict):
    """Full rotational symmetry about a line of the model frame."""

    axis: StaticVec3
    offset_m: StaticVec3 = (0.0, 0.0, 0.0)


class DiscreteSymmetry(Strict):
    """A rotation about a point that leaves the model as it is."""

    rotation_deg: StaticVec3
    """Roll, pitch, yaw."""
    offset_m: StaticVec3 = (0.0, 0.0, 0.0)
    """The point, in the model's frame: any of the axis."""


class Symmetries(Strict):
    """Symmetries of a model in its frame; written to BOP as stated, never guessed, once the model
    turned by them is near itself: within a tenth of its diameter, or 15 mm, as BOP has it."""

    discrete_deg: tuple[StaticVec3, ...] = ()
    """Rotations (roll, pitch, yaw) about the frame's origin that leave the model as it is; with
    those of `discrete` every one but the identity."""
    discrete: tuple[DiscreteSymmetry, ...] = ()
    """The same about other points."""
    continuous: tuple[ContinuousSymmetry, ...] = ()


class Spacecraft(Strict):
    """A model on an orbit."""

    model: FileName
    """.glb or .gltf; relative to this file, or data:... under PERILUNE_DATA."""
    size_m: Annotated[Positive, Field(ge=1e-9, le=1e18)] | None = None
    """Longest side of the bounding box."""
    metres_per_unit: PositiveByAxis | None = None
    """A number, or one for each of the model's axes x, y, z (z up), which stretches it: as if the
    file's root nodes were below a node of that scale. Boxes of `parts` and `materials` stay in the
    file's units; all other lengths are of the stretched model."""
    centre: Literal["bounds", "origin"] = "bounds"
    """What flies on the orbit: the bounding box's centre, or the file's origin."""
    crease_angle_deg: Annotated[StaticNonNegative, Field(le=180)] = 65.0
    """Edges that are shaded sharp: where the file has one normal for faces that meet at more than
    this angle, and it leans from one of them by more than half of it, each side gets its own. 180:
    the file's normals as they are."""
    faces: Faces = DEFAULT
    """From which sides faces are there, for sight, light, labels and written models alike.
    double_sided: from both, as things are. as_stated: the backs of what the file has single-sided
    are not, as glTF has it. single_sided: no backs are. A mapping: shell pattern on the names of
    materials, in any case -> one of these; the first that fits, double_sided where none does. Of
    sheets back to back, within a ten-thousandth of the model, the one that looks at the viewer is
    seen in any case; solids that light goes through keep both sides."""
    orbit: Orbit
    gm_km3_s2: Positive | None = None
    """Gravitational parameter, for a model that is orbited: an asteroid, a moonlet."""
    attitude: Attitude = Inertial()
    obj_id: Annotated[Integer, Field(ge=0)] | None = None
    """BOP object id (default: 1, 2, ... in the order of this section)."""
    class_: str | None = Field(default=None, alias="class")
    """Class of object for the labels (default: the entry's name)."""
    classes: Classes = Field(default_factory=dict)
    """Level of `labels.levels` -> class there, of levels of your own."""
    parts: Parts = Parts()
    part_classes: dict[str, tuple[str, ...]] = Field(default_factory=dict)
    """Class of part -> patterns on part and material names; before those of `labels`."""
    materials: tuple[MaterialUse, ...] = ()
    """Graphs instead of, or around, the model's materials; the first that fits a triangle."""
    model_graphs: bool = True
    """Whether graphs in the model's file (`perilune_graph` in a material's extras, a mapping as in
    `materials`) are used where `materials` puts none. Each is the entry `FILE-MATERIAL` of
    `materials`, in whose place keys stand beside the file's."""
    material_drivers: DriverSection | None = None
    """Values of nodes of these graphs that the materials' own drivers do not give."""
    articulation: tuple[Joint, ...] = ()
    """Nodes of the model that move."""
    animation: Animation | None = None
    """The model's own animations; joints act on what they move."""
    symmetries: Symmetries = Symmetries()

    @model_validator(mode="after")
    def _one_scale(self) -> Spacecraft:
        self._exactly_one("size_m", "metres_per_unit")
        return self

    @property
    def stretch(self) -> tuple[float, float, float]:
        """Factors along the model's axes by which it is read; the largest is 1."""
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
    """Quality and outputs of a frame."""

    quality: Literal["adaptive", "reference"] = "adaptive"
    """`reference`: a `tolerance_dn` of 0 and nothing in `force_off`. Nothing is left out, nothing
    is shared between pixels or smoothed, every pixel gets all samples, and the image converges to
    the light of the scene as they grow. See docs/convergence.md."""
    samples: Annotated[Integer, Field(ge=1, le=65536)] = 16
    """Colour samples a pixel. Pixels that are quiet to within three tolerances get fewer, outlines
    up to twice as many: about the error of so many in all, which they get at a tolerance of 0."""
    max_bounces: Annotated[Integer, Field(ge=0, le=64)] = 4
    texture_filter: TextureFilter = "anisotropic_16"
    """The best filter of pictures that may be used: of a mip level the nearest texel or four, of
    two levels four each, or up to so many of these along the longer axis of a footprint."""
    volume_steps: Annotated[Integer, Field(ge=1, le=1024)] = 32
    """Most steps along a ray through a volume. Where that has a material they are also the cells, 8
    to 64, of the table of the light that reaches its parts, and rays from surfaces take a quarter
    of them."""
    tolerance_dn: NonNegative = 1.0
    """An effect that can change no pixel by more is left out; 0 keeps all that apply. 1 by default,
    0 with `quality: reference`."""
    force_on: tuple[str, ...] = ()
    """Effects kept whatever their bound."""
    force_off: tuple[str, ...] = ()
    """Effects left out whatever their bound."""
    channels: tuple[str, ...] = ("rgb", "depth", "semantic", "part", "instance", "objects")
    """What a sample holds unless asked otherwise."""
    amodal: Annotated[bool, Field(strict=True)] = True
    """Whether object labels cover full silhouettes, with what is hidden or cut; costs rays."""

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
    """A literal 1 would take 1.0, true and a driver's value too."""
    if type(value) is not int:
        fail("", "takes no driver" if isinstance(value, Drawn) else "must be a whole number")
    return value


Correlation = Annotated[float, Field(strict=True, ge=-1.0, le=1.0), BeforeValidator(refuse_drawn)]


class DriverGroup(Strict):
    """Settings of the drivers that say `group: NAME`, and how their draws go together.

    Drivers are correlated through standard normals: of normal drivers the correlations are those
    given, the others are monotonic functions of theirs (a Gaussian copula)."""

    jitter_strength: StaticNonNegative | None = None
    """Factor on every variance; 0 gives exactly the ideal values (default: drivers.strength)."""
    step_interval: Annotated[Integer, Field(ge=1)] | None = None
    """Steps between draws (default: drivers.interval)."""
    shared: Annotated[bool, Field(strict=True)] = False
    """All drivers of the group vary by one and the same draw."""
    members: Annotated[tuple[str, ...], Field(min_length=1)] | None = None
    """Key paths of the drivers, in the order of the matrix's rows."""
    correlation: tuple[tuple[Correlation, ...], ...] | None = None
    """Symmetric and positive definite, with ones on the diagonal."""

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
        """As the drivers use it."""
        return Group(
            name,
            self.jitter_strength,
            self.step_interval,
            self.shared,
            self.members or (),
            None if self.correlation is None else factor(self.correlation),
        )


class Drivers(Strict):
    """Defaults of the drivers, and their groups. A driver is a mapping in the place of a value:
    {ideal, jitter_variance, clip_min, clip_max}, {uniform: [low, high]}, {median, log_variance,
    clip_min, clip_max}, {choice: [...], weights: [...]} or {hook: module:function, ideal, ...}."""

    strength: StaticNonNegative = 1.0
    """Factor on every variance; 0 gives exactly the ideal values."""
    interval: Annotated[Integer, Field(ge=1)] | None = None
    """A value is drawn anew every so many steps (default: time.frames_per_scene)."""
    groups: dict[str, DriverGroup] = Field(default_factory=dict)
    """Drivers with settings of their own, or correlated."""


_KEPT_CAMERAS = 16
_cameras: dict[tuple[int, int], tuple[Any, Camera, dict[str | None, Camera]]] = {}
"""Identities of sensors and platform -> these, and the cameras of both: sections never change, and
a frame asks for them ten times."""


class Config(Strict):
    """A whole configuration."""

    version: Annotated[Literal[1], BeforeValidator(_whole)]
    """Of the format of this file."""
    name: str = "perilune"
    """Of the simulation (default: the file's name)."""
    description: str = ""
    """What it shows, for readers."""
    seed: Annotated[Integer, Field(ge=0, lt=2**63)] = 0
    """Of all randomness: the same seed gives the same frames."""
    time: Time
    root: str
    """Name of the body entry whose centre is the origin of the root frame (ICRF axes)."""
    sun: Sun = Sun()
    sky: Sky | None = None
    """Black without it."""
    ephemeris: Ephemeris = Ephemeris()
    bodies: Annotated[dict[str, Body], Field(min_length=1)]
    """Name -> a planet, moon or other body."""
    spacecraft: dict[str, Spacecraft] = Field(default_factory=dict)
    """Name -> a model on an orbit."""
    volumes: Annotated[dict[str, Volume], Field(max_length=16)] = Field(default_factory=dict)
    """Dust, gas and light within bounds."""
    materials: dict[str, Material] = Field(default_factory=dict)
    """Graphs of nodes that the spacecraft's `materials` put on their models. A hook with its
    `ideal` may stand for a whole entry, and draws graphs of any structure."""
    material_drivers: MaterialDrivers | None = None
    """Values of nodes of all graphs that neither the materials' nor the spacecraft's drivers
    give."""
    camera: Camera
    """The platform's way, and its camera."""
    sensors: dict[str, Sensor] = Field(default_factory=dict)
    """Cameras that take the frames instead of `camera`, whose keys they have unless they say
    otherwise. In a step each sensor that is triggered takes a frame, in the order of this file."""
    render: Render = Render()
    labels: Labels = Labels()
    drivers: Drivers = Drivers()

    @property
    def timeline(self) -> Timeline:
        """Which step, scene and sensor each frame is; the same whatever drivers draw."""
        intervals = {name: sensor.trigger_interval for name, sensor in self.sensors.items()}
        return Timeline(self.time.frames_per_scene, intervals)

    @property
    def cameras(self) -> dict[str | None, Camera]:
        """What takes frames: each sensor's camera; without sensors the platform's, named None."""
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
        """Key path of a key that a camera has: its sensor's own, or the platform's."""
        own = name is not None and getattr(self.sensors[name], key) is not None
        return f"sensors.{name}.{key}" if own else f"camera.{key}"

    @model_validator(mode="after")
    def _names(self) -> Config:
        sections: dict[str, Iterable[str]] = {
            "bodies": self.bodies,
            "spacecraft": self.spacecraft,
            "materials": self.materials,
            "sensors": self.sensors,
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
    def _levels(self) -> Config:
        stated = [(f"bodies.{name}.classes", row.classes) for name, row in self.bodies.items()]
        crafts = self.spacecraft.items()
        stated += [(f"spacecraft.{name}.classes", row.classes) for name, row in crafts]
        self.labels.check(stated)
        return self

    @model_validator(mode="after")
    def _references(self) -> Config:
        def known(path: str, name: str | None, allowed: list[str]) -> None:
            if name is not None and name not in allowed:
                fail(path, f"no entry named '{name}'{nearest(name, allowed)}")

        bodies = list(self.bodies)
        known("root", self.root, bodies)
        for place, volume in self.volumes.items():
            known(f"volumes.{place}.parent", volume.parent, [*bodies, *self.spacecraft])
        check_motion(self)
        check_trajectory(self)
        for name, camera in self.cameras.items():
            camera.check_focus(self.place(name, "lens"))
        return self
