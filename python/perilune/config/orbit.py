"""The section `orbit`: kinds of orbits, and elements at the epoch.

To add a kind: its section here and its line in `Orbit`; its file in orbits/kinds and its line in
orbits/paths.py."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Any, Literal

from pydantic import ConfigDict, Discriminator, Field, Tag, model_validator

from perilune.config.errors import fail, fail_unread
from perilune.config.standing import Descent, Footprint, Standing, Way
from perilune.config.types import (
    AngleRange,
    FileName,
    Finite,
    FiniteRange,
    FunctionName,
    Inclination,
    Integer,
    NonNegative,
    Positive,
    PositiveRange,
    PositiveVec3,
    Strict,
    Vec3,
    hook_or_function,
)

_SIZES = ("altitude_km", "semi_major_axis_km", "periapsis_km")


class Around(Strict):
    """What every orbit has: the central body."""

    around: str
    """Name of the central body or spacecraft. Around a spacecraft (a small moon or asteroid given
    as a mesh), all orbits but circular ones, tables and fixed positions need its gm_km3_s2."""


class State(Strict):
    """Position and velocity at the epoch, relative to the centre of the central body."""

    position_km: Vec3
    """Position in the axes of `frame`."""
    velocity_km_s: Vec3
    """Velocity in the axes of `frame`."""


class Elements(Around):
    """Osculating elements at the epoch, or a state vector."""

    altitude_km: Positive | None = None
    """Altitude of the periapsis above the mean equatorial radius."""
    semi_major_axis_km: Finite | None = None
    """Semi-major axis; negative for a hyperbola."""
    periapsis_km: Positive | None = None
    """Distance of the periapsis from the centre of the central body."""
    eccentricity: NonNegative = 0.0
    inclination_deg: Inclination = 0.0
    """Inclination to the xy plane of `frame`."""
    raan_deg: Finite = 0.0
    """Right ascension of the ascending node."""
    arg_periapsis_deg: Finite = 0.0
    """Argument of the periapsis."""
    mean_anomaly_deg: Finite | None = None
    """Mean anomaly at the epoch."""
    true_anomaly_deg: Finite | None = None
    """True anomaly at the epoch, instead of the mean anomaly."""
    state: State | None = None
    """Position and velocity, instead of elements."""
    frame: Literal["equator", "icrf"] | None = None
    """Axes of the elements or the state. equator: equator of date of the central body, x along its
    ascending node on the ICRF equator; icrf: Earth's equator and equinox of J2000. Default: icrf
    for a state, and around the Earth and bodies without a known equator; equator around all
    others."""

    @model_validator(mode="after")
    def _one_description(self) -> Elements:
        if self._fixed():
            return self
        if self.state is not None:
            others = self.model_fields_set & _REPLACED_BY_STATE
            if others:
                fail(sorted(others)[0], "does not go with state, which replaces the elements")
            return self
        self._exactly_one(*self._places())
        self._exactly_one("mean_anomaly_deg", "true_anomaly_deg")
        self._check_conic()
        return self

    def _places(self) -> tuple[str, ...]:
        return (*_SIZES, "state")

    def _fixed(self) -> bool:
        return False

    def _check_conic(self) -> None:
        e, a = self.eccentricity, self.semi_major_axis_km
        if a is not None and (e == 1.0 or a == 0.0 or (a > 0.0) != (e < 1.0)):
            fail(
                "semi_major_axis_km",
                f"{a:g} does not go with eccentricity {e:g}: positive for e < 1, negative for "
                "e > 1, undefined for e = 1 (give periapsis_km)",
            )
        if e == 1.0 and self.mean_anomaly_deg is not None:
            fail("mean_anomaly_deg", "undefined on a parabola (e = 1); give true_anomaly_deg")


_REPLACED_BY_STATE = frozenset(Elements.model_fields) - {"around", "state", "frame"}


class Kepler(Elements):
    """Two-body motion on any conic, or a fixed position."""

    kind: Literal["kepler"] = "kepler"
    position_km: Vec3 | None = None
    """Fixed position from the centre of the central body in ICRF axes, instead of elements."""

    def _places(self) -> tuple[str, ...]:
        return (*_SIZES, "state", "position_km")

    def _fixed(self) -> bool:
        if self.position_km is None:
            return False
        others = self.model_fields_set - {"kind", "around", "position_km"}
        if others:
            fail(sorted(others)[0], "does not go with position_km, which replaces an orbit")
        return True


class _OnPath(Around):
    """Motion along a closed path at a constant rate."""

    v_step: Finite
    """Revolutions per step, which needs time.step_s; 0: a fixed position."""
    orbit_start: Finite = 0.0
    """Position on the path at the epoch, in revolutions from its x axis."""


class Circular(_OnPath):
    """A scaled and rotated circle, traversed at a constant rate; gravity plays no part."""

    kind: Literal["circular"]
    scale: PositiveVec3
    """Semi-axes of the path along its x and y (z is not used), in radii of the central body: 1.0640
    around the Earth is 408 km of altitude."""
    rotation_deg: Vec3 = (0.0, 0.0, 0.0)
    """Roll, pitch, yaw of the path, relative to ICRF axes."""


class J2(Elements):
    """A Kepler orbit with the secular drift of node, periapsis and mean anomaly by the oblateness
    of the central body."""

    kind: Literal["j2"]
    osculating: Annotated[bool, Field(strict=True)] = False
    """Whether the elements are osculating at the epoch; their semi-major axis is then converted to
    a mean one. false: mean elements."""
    j2: Positive | None = None
    """Oblateness coefficient J2, for the mean equatorial radius. Default: the table's value for the
    central body."""


class Harmonics(Strict):
    """Gravity of the central body beyond the point mass."""

    degree: Annotated[Integer, Field(ge=2)]
    """Highest degree. Without a file, 2 to 6: the zonal harmonics of the table."""
    order: Annotated[Integer, Field(ge=0)] | None = None
    """Highest order, only with a file: 0 to the degree. Default: the degree."""
    file: FileName | None = None
    """File of spherical-harmonic coefficients; relative to this file, or data:... under
    PERILUNE_DATA."""

    @model_validator(mode="after")
    def _ranges(self) -> Harmonics:
        if self.file is None and self.degree > 6:
            fail("degree", f"{self.degree}: the table goes to 6; higher ones need a file")
        if self.file is None and self.order is not None:
            fail("order", "only with a file; the table's harmonics are zonal")
        if self.order is not None and self.order > self.degree:
            fail("order", f"{self.order} is larger than the degree {self.degree}")
        return self


class Drag(Strict):
    """Drag by the atmosphere of the central body."""

    area_to_mass_m2_kg: NonNegative
    """Cross-section divided by mass."""
    cd: NonNegative = 2.2
    """Drag coefficient."""


class RadiationPressure(Strict):
    """Solar radiation pressure on a sphere, with the shadow of the central body."""

    area_to_mass_m2_kg: NonNegative
    """Cross-section divided by mass."""
    cr: NonNegative = 1.3
    """Radiation pressure coefficient: 1 absorbs all light."""


class Forces(Strict):
    """Forces besides the central body's point mass."""

    harmonics: Harmonics | None = None
    third_bodies: tuple[str, ...] = ()
    """Names in the table of bodies whose gravity perturbs the orbit: sun, moon ..."""
    drag: Drag | None = None
    radiation_pressure: RadiationPressure | None = None


class Numerical(Elements):
    """Numerical integration with the given forces."""

    kind: Literal["numerical"]
    rtol: Annotated[Positive, Field(le=1e-3)] = 1e-12
    """Relative error tolerance of an integration step."""
    forces: Forces = Forces.of_defaults()


class Tle(Around):
    """A two-line element set, propagated by SGP4 (extra `tle`) and rotated from TEME to ICRF."""

    kind: Literal["tle"]
    lines: tuple[str, str] | None = None
    """The two lines of the set."""
    file: FileName | None = None
    """File of element sets, with or without name lines; relative to this file, or data:..."""
    name: str | None = None
    """Name line of the set to take from the file."""
    number: Annotated[Integer, Field(ge=0, le=339999)] | None = None
    """Catalogue number of the set to take from the file."""

    @model_validator(mode="after")
    def _one_source(self) -> Tle:
        self._exactly_one("lines", "file")
        if self.file is None:
            for key in ("name", "number"):
                if getattr(self, key) is not None:
                    fail(key, "only with file")
        else:
            self._exactly_one("name", "number", optional=True)
        return self


class Table(Around):
    """Interpolated states from a file."""

    kind: Literal["table"]
    file: FileName
    """A CCSDS OEM (.oem or .txt, KVN), or a CSV table. The first line of a CSV names its columns:
    t_s (seconds after the epoch) or time_utc; x_km, y_km, z_km (or x_m ...) from the centre of the
    central body in ICRF axes; optionally vx_km_s ... (or vx_m_s ...). Relative to this file, or
    data:..."""
    object: str | None = None
    """Object to take from a file with several: the column `object` of a CSV, as `perilune orbit`
    writes it, or OBJECT_NAME or OBJECT_ID of an OEM."""
    degree: Annotated[Integer, Field(ge=1, le=25)] | None = None
    """Degree of the interpolating polynomials; odd if velocities are used. Default: the OEM's, else
    7. With INTERPOLATION = LAGRANGE an OEM's velocities are not used."""


class Spice(Around):
    """States from SPICE kernels (extra `spice`): geometric, J2000 axes."""

    kind: Literal["spice"]
    kernels: Annotated[tuple[FileName, ...], Field(min_length=1)]
    """Kernel files, loaded in this order; relative to this file, or data:..."""
    target: str
    """NAIF name or number of the moving object."""
    observer: str | None = None
    """NAIF name or number of the central body. Default: from the table of bodies."""


class Surface(Around, Standing):
    """At rest on the ground of a body: the lowest point of the spacecraft's box is on the plane
    that fits the ground under it best."""

    kind: Literal["surface"]
    height_m: Finite = 0.0
    """Height of the lowest point over the ground, along the spacecraft's axis z; negative: it has
    sunk in."""
    footprint_m: Footprint | None = None
    """Length and width of the ground that it stands on, one number for both. Default: those of the
    model's box."""


class Traverse(Around, Way):
    """A drive over the ground at a constant speed, from the epoch to the end of the way."""

    kind: Literal["traverse"]
    speed_m_s: Positive
    """Speed along the way."""
    height_m: Finite = 0.0
    """Height of the lowest point over the ground, along the spacecraft's axis z."""
    footprint_m: Footprint | None = None
    """Length and width of the ground that it stands on, one number for both. Default: those of the
    model's box."""


class PoweredDescent(Around, Descent):
    """A powered descent to the ground, on which the spacecraft then stands (see `Descent`)."""

    kind: Literal["powered_descent"]
    footprint_m: Footprint | None = None
    """Length and width of the ground that it stands on after the touch-down, one number for both.
    Default: those of the model's box."""


class Drawn(Around):
    """Common keys of orbits that are drawn once a scene.

    Their epoch is the first step of the scene."""

    propagator: Literal["kepler", "j2", "circular"] | None = None
    """Motion on the drawn orbit: kepler (default), j2, or circular (from orbit_start at v_step;
    default for a hook that returns {scale_xyz, rotation_rpy})."""
    v_step: Finite | None = None
    """Revolutions per step; required for circular, and needs time.step_s."""
    orbit_start: FiniteRange | None = None
    """For circular: revolutions at the start, a number or [smallest, largest]. Default: 0 to 1."""

    def _circular_keys(self, *propagators: str | None) -> None:
        if self.propagator in propagators:
            for key in ("v_step", "orbit_start"):
                if getattr(self, key) is not None:
                    fail_unread(key, "only for propagator: circular")
        if self.propagator == "circular" and self.v_step is None:
            fail("v_step", "required for propagator: circular (0: it stands still)")


class Database(Drawn):
    """An orbit drawn once a scene from a class of orbits.

    Each key replaces a default of the class."""

    kind: Literal["database"]
    class_: Literal["LEO", "MEO", "GEO", "PO", "SSO", "MOLNIYA", "GTO", "LLO", "NRHO"] = Field(
        alias="class"
    )
    altitude_km: PositiveRange | None = None
    """Altitude of the periapsis above the mean equatorial radius. Like every range, drawn
    uniformly."""
    semi_major_axis_km: PositiveRange | None = None
    eccentricity: FiniteRange | None = None
    inclination_deg: AngleRange | None = None
    """Inclination, drawn uniformly over the sphere (in its cosine)."""
    raan_deg: FiniteRange | None = None
    arg_periapsis_deg: FiniteRange | None = None
    mean_anomaly_deg: FiniteRange | None = None
    ltan_h: FiniteRange | None = None
    """SSO: local mean solar time of the ascending node."""
    longitude_deg: FiniteRange | None = None
    """GEO: east longitude of the satellite."""

    @model_validator(mode="after")
    def _circular_only(self) -> Database:
        self._circular_keys("kepler", "j2", None)
        return self


class Hook(Drawn):
    """An orbit that your function draws once a scene."""

    model_config = ConfigDict(json_schema_extra=hook_or_function)

    kind: Literal["hook"]
    hook: FunctionName
    """module:function (the key `function` works too). Its arguments may be body_radius_xyz (km),
    rng, world and params. It returns {position_km, velocity_km_s}, elements by the keys of a Kepler
    orbit, or {scale_xyz, rotation_rpy} (radians): a scaled circle, which needs v_step."""
    params: dict[str, Any] = Field(default_factory=dict)
    """Parameters for the function, passed as `params` or each by its name."""

    @model_validator(mode="before")
    @classmethod
    def _older_name(cls, data: Any) -> Any:
        return cls._renamed(data, "function", "hook")

    @model_validator(mode="after")
    def _circular_only(self) -> Hook:
        self._circular_keys("kepler", "j2")
        return self


ON_GROUND = (Surface, Traverse, PoweredDescent)
"""Kinds of orbits that have axes of their own, those of `attitude.pointing: ground`."""


def _kind(value: Any) -> str:
    mapping = isinstance(value, Mapping)
    found = value.get("kind") if mapping else getattr(value, "kind", None)
    return "kepler" if found is None else str(found)


Orbit = Annotated[
    Annotated[Kepler, Tag("kepler")]
    | Annotated[Circular, Tag("circular")]
    | Annotated[J2, Tag("j2")]
    | Annotated[Numerical, Tag("numerical")]
    | Annotated[Tle, Tag("tle")]
    | Annotated[Table, Tag("table")]
    | Annotated[Spice, Tag("spice")]
    | Annotated[Database, Tag("database")]
    | Annotated[Surface, Tag("surface")]
    | Annotated[Traverse, Tag("traverse")]
    | Annotated[PoweredDescent, Tag("powered_descent")]
    | Annotated[Hook, Tag("hook")],
    Discriminator(_kind),
]
"""An orbit; `kind` selects its model. Default: kepler."""
