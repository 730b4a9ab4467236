"""How bodies and spacecraft move: the kinds of orbits, elements at the epoch.

To add a kind: its section here and its line in `Orbit`; its file in orbits/kinds and its line in
orbits/paths.py.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Any, Literal

from pydantic import ConfigDict, Discriminator, Field, Tag, model_validator

from perilune.config.errors import fail, fail_unread
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
    """What every orbit states."""

    around: str
    """Name of a body or spacecraft. About a spacecraft (a small moon or an asteroid given as a
    mesh) all but circular orbits, tables and fixed positions need its gm_km3_s2."""


class State(Strict):
    """Position and velocity at the epoch, relative to the centre of what is orbited."""

    position_km: Vec3
    velocity_km_s: Vec3


class Elements(Around):
    """Osculating elements at the epoch, or a state."""

    altitude_km: Positive | None = None
    """Altitude of the periapsis over the mean equatorial radius."""
    semi_major_axis_km: Finite | None = None
    """Negative for a hyperbola."""
    periapsis_km: Positive | None = None
    """Distance of the periapsis from the body's centre."""
    eccentricity: NonNegative = 0.0
    inclination_deg: Inclination = 0.0
    raan_deg: Finite = 0.0
    arg_periapsis_deg: Finite = 0.0
    mean_anomaly_deg: Finite | None = None
    true_anomaly_deg: Finite | None = None
    state: State | None = None
    """Instead of elements."""
    frame: Literal["equator", "icrf"] | None = None
    """Axes of the elements or of the state. equator: the body's, of date, x along its ascending
    node on ICRF's; icrf: the Earth's equator and equinox of J2000. Default: for a state, and around
    the Earth and bodies without a known equator icrf, equator around the others."""

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
    """Two-body motion on any conic; or a fixed position."""

    kind: Literal["kepler"] = "kepler"
    position_km: Vec3 | None = None
    """Instead of elements: a fixed position from the body's centre, ICRF axes."""

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
    """Revolutions from one step to the next, which needs time.step_s; 0: it stands still."""
    orbit_start: Finite = 0.0
    """Revolutions from the path's x axis at the epoch."""


class Circular(_OnPath):
    """A circle scaled and turned, run through at a constant rate: no gravity in it."""

    kind: Literal["circular"]
    scale: PositiveVec3
    """Semi-axes of the path along its x and y (and z, which it does not use), in radii of what is
    orbited: 1.0640 around the Earth is 408 km."""
    rotation_deg: Vec3 = (0.0, 0.0, 0.0)
    """Roll, pitch, yaw of the path, from ICRF axes."""


class J2(Elements):
    """A Kepler orbit whose node, periapsis and mean anomaly drift by the parent's oblateness."""

    kind: Literal["j2"]
    osculating: Annotated[bool, Field(strict=True)] = False
    """Whether the elements are those of the state at the epoch (their semi-major axis is then
    corrected to the mean one); else they are mean elements."""
    j2: Positive | None = None
    """Instead of the table's value of the parent; with its mean equatorial radius."""


class Harmonics(Strict):
    """The parent's gravity beyond the point mass."""

    degree: Annotated[Integer, Field(ge=2)]
    """Without a file, 2 to 6: the zonal harmonics of the table."""
    order: Annotated[Integer, Field(ge=0)] | None = None
    """With a file: 0 to the degree (default)."""
    file: FileName | None = None
    """Spherical-harmonic coefficients; relative to this file, or data:... under PERILUNE_DATA."""

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
    """Drag of the parent's atmosphere."""

    area_to_mass_m2_kg: NonNegative
    cd: NonNegative = 2.2


class RadiationPressure(Strict):
    """Pressure of sunlight on a sphere, with the parent's shadow."""

    area_to_mass_m2_kg: NonNegative
    cr: NonNegative = 1.3


class Forces(Strict):
    """What acts beside the parent's point mass."""

    harmonics: Harmonics | None = None
    third_bodies: tuple[str, ...] = ()
    """Names of the table of bodies: sun, moon ..."""
    drag: Drag | None = None
    radiation_pressure: RadiationPressure | None = None


class Numerical(Elements):
    """Integrated motion under the stated forces."""

    kind: Literal["numerical"]
    rtol: Annotated[Positive, Field(le=1e-3)] = 1e-12
    """Relative tolerance of a step of the integrator."""
    forces: Forces = Forces()


class Tle(Around):
    """A two-line element set through SGP4 (extra `tle`); TEME turned to ICRF."""

    kind: Literal["tle"]
    lines: tuple[str, str] | None = None
    """The two lines."""
    file: FileName | None = None
    """A file of sets, with or without name lines; relative to this file, or data:..."""
    name: str | None = None
    """Which set of the file, by its name line."""
    number: Annotated[Integer, Field(ge=0, le=339999)] | None = None
    """Which set of the file, by catalogue number."""

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
    """Interpolated states of a file."""

    kind: Literal["table"]
    file: FileName
    """A CCSDS OEM (.oem, .txt: KVN), or a CSV table: its first line names the columns t_s (seconds
    after the epoch) or time_utc; x_km, y_km, z_km (or x_m ...) from the centre of what is orbited,
    ICRF axes; optionally vx_km_s ... (or vx_m_s ...). Relative to this file, or data:..."""
    object: str | None = None
    """Which object's lines to take in a CSV table with a column `object`, as `perilune orbit`
    writes; or the OBJECT_NAME or OBJECT_ID of an OEM with several."""
    degree: Annotated[Integer, Field(ge=1, le=25)] | None = None
    """Degree of the interpolating polynomials (default: the OEM's, else 7). With velocities it is
    odd; an OEM that asks for INTERPOLATION = LAGRANGE is interpolated without them."""


class Spice(Around):
    """States of SPICE kernels (extra `spice`), geometric, J2000 axes."""

    kind: Literal["spice"]
    kernels: Annotated[tuple[FileName, ...], Field(min_length=1)]
    """Files, loaded in this order; relative to this file, or data:..."""
    target: str
    """Name or number of what moves."""
    observer: str | None = None
    """Name or number of what is orbited (default: that of the table of bodies)."""


class Drawn(Around):
    """What orbits that are drawn once a scene share; what they say of the epoch holds at the first
    step of the scene."""

    propagator: Literal["kepler", "j2", "circular"] | None = None
    """How the drawn orbit is run through: kepler (default), j2, or circular (at v_step, from
    orbit_start; default for a hook's form {scale_xyz, rotation_rpy})."""
    v_step: Finite | None = None
    """For circular, which needs it: revolutions from one step to the next; needs time.step_s."""
    orbit_start: FiniteRange | None = None
    """For circular: revolutions at the start; a number, or [smallest, largest] (default 0 to 1)."""

    def _circular_keys(self, *propagators: str | None) -> None:
        if self.propagator in propagators:
            for key in ("v_step", "orbit_start"):
                if getattr(self, key) is not None:
                    fail_unread(key, "only for propagator: circular")
        if self.propagator == "circular" and self.v_step is None:
            fail("v_step", "required for propagator: circular (0: it stands still)")


class Database(Drawn):
    """An orbit drawn once a scene from a class of orbits; every key replaces a default of it."""

    kind: Literal["database"]
    class_: Literal["LEO", "MEO", "GEO", "PO", "SSO", "MOLNIYA", "GTO", "LLO", "NRHO"] = Field(
        alias="class"
    )
    altitude_km: PositiveRange | None = None
    """Of the periapsis, over the mean equatorial radius; each range is drawn uniformly."""
    semi_major_axis_km: PositiveRange | None = None
    eccentricity: FiniteRange | None = None
    inclination_deg: AngleRange | None = None
    """Drawn uniformly over the sphere (in its cosine)."""
    raan_deg: FiniteRange | None = None
    arg_periapsis_deg: FiniteRange | None = None
    mean_anomaly_deg: FiniteRange | None = None
    ltan_h: FiniteRange | None = None
    """SSO: local mean solar time of the ascending node, hours."""
    longitude_deg: FiniteRange | None = None
    """GEO: east longitude of the station."""

    @model_validator(mode="after")
    def _circular_only(self) -> Database:
        self._circular_keys("kepler", "j2", None)
        return self


class Hook(Drawn):
    """An orbit that a function of the user's draws, once a scene."""

    model_config = ConfigDict(json_schema_extra=hook_or_function)

    kind: Literal["hook"]
    hook: FunctionName
    """module:function (`function` is understood too). It gets those of its arguments that are named
    body_radius_xyz (km), rng, world or params, and returns {scale_xyz, rotation_rpy} (radians: a
    scaled circle, run through at v_step, which it then needs), {position_km, velocity_km_s}, or
    elements by the names of a Kepler orbit's keys."""
    params: dict[str, Any] = Field(default_factory=dict)
    """Handed to the function as `params`, or each by its name."""

    @model_validator(mode="before")
    @classmethod
    def _older_name(cls, data: Any) -> Any:
        return cls._renamed(data, "function", "hook")

    @model_validator(mode="after")
    def _circular_only(self) -> Hook:
        self._circular_keys("kepler", "j2")
        return self


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
    | Annotated[Hook, Tag("hook")],
    Discriminator(_kind),
]
"""An orbit; `kind` says which (default: kepler)."""
