"""Bodies: ellipsoids with a surface, a place and a rotation."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import BeforeValidator, Field, model_validator

from perilune.config.atmosphere import Atmosphere
from perilune.config.attitude import BodyRotation
from perilune.config.clouds import Clouds
from perilune.config.errors import fail
from perilune.config.ground import NightLights, Ocean, Relief
from perilune.config.labels import Classes
from perilune.config.materials import DriverSection
from perilune.config.orbit import Orbit
from perilune.config.photometry import Photometry
from perilune.config.rings import Rings
from perilune.config.shape import Shape, named
from perilune.config.types import FileName, Latitudes, Positive, Rgb, StaticFinite, Strict, triple

# In kilometres what the core's floats hold, 1e-9 to 1e18 m.
_Radius = Annotated[float, Field(strict=True, ge=1e-12, le=1e15)]
_Radii = Annotated[tuple[_Radius, _Radius, _Radius], BeforeValidator(triple)]
_Share = Annotated[float, Field(strict=True, ge=0.0, le=10.0)]
_Albedo = Annotated[tuple[_Share, _Share, _Share], BeforeValidator(triple)]


_LATITUDES = {"earth": "geodetic"}
"""kind -> what published maps count by. Those of the Earth are of WGS 84; of the other bodies the
IAU's working group recommends planetocentric latitudes, as the maps of the USGS have them (Archinal
et al. 2018), and some, as the Moon, are spheres in maps. Of giant planets maps of either sort are
published."""


class Body(Strict):
    """An ellipsoid or a mesh: a planet, a moon, an asteroid."""

    kind: str
    """A name in the table of bodies, or `ellipsoid` (then radii_km and gm_km3_s2 are needed)."""
    radii_km: _Radii | None = None
    """Semi-axes along body-fixed x, y, z; replaces the table's."""
    gm_km3_s2: Positive | None = None
    """Gravitational parameter; replaces the table's."""
    ephemeris: str | None = None
    """For `ellipsoid`: the body of the table in whose place it stands (root: earth)."""
    shape: Annotated[Shape, BeforeValidator(named)] | None = None
    """A mesh instead of the ellipsoid: a file, or a mapping with one."""
    color_map: FileName | None = None
    """Equirectangular PNG, JPEG, WebP or TIFF; relative to this file, or data:... under
    PERILUNE_DATA."""
    map_center_lon_deg: StaticFinite = 0.0
    """East longitude of the map's centre column."""
    latitudes: Latitudes | None = None
    """What latitude all maps of the body count by, `lon_lat_deg` of its material too. geodetic (or
    planetographic): of the surface's normal; geocentric: of the line to the centre. On the Earth
    they differ by up to 21 km. Default: geodetic of kind earth, geocentric of all others."""
    albedo: _Albedo | None = None
    """Linear factor on the map (default 1); without a map, the colour (table's Bond albedo)."""
    emission_w_m2_sr: Rgb = (0.0, 0.0, 0.0)
    reflectance: str = "lambert"
    """A name in the table of reflectance models. The albedo is then Lambert's, the normal albedo of
    lunar_lambert and minnaert, or the single-scattering albedo w of lommel_seeliger and hapke."""
    photometry: Photometry | None = None
    """Other parameters of a photometric reflectance."""
    relief: Relief | None = None
    """Mountains as normals; smooth without."""
    ocean: Ocean | None = None
    """Open water that mirrors the sun; only with reflectance: lambert."""
    night_lights: NightLights | None = None
    """Seen where the sun is down."""
    atmosphere: Atmosphere | None = None
    """Air about it; none without."""
    clouds: Clouds | None = None
    """A shell of clouds about it; none without."""
    rings: Rings | None = None
    """Rings in the plane of its equator; none without."""
    material: str | None = None
    """Name of an entry of `materials`: a graph instead of the surface that the keys above make."""
    material_drivers: DriverSection | None = None
    """Values of nodes of this graph that the material's own drivers do not give."""
    material_mode: Literal["replace", "wrap"] = "replace"
    """wrap: inputs of the surface that the graph does not give stay those of the keys above."""
    orbit: Orbit | None = None
    """Around another thing; without it the ephemeris of its kind places it."""
    rotation: BodyRotation | None = None
    """`body`: the table's rotation (default where it has one); or a fixed one and a spin, from ICRF
    axes."""
    class_: str | None = Field(default=None, alias="class")
    """Class of object for the labels (default: kind, or the entry's name for an ellipsoid)."""
    classes: Classes = Field(default_factory=dict)
    """Level of `labels.levels` -> class there, of levels of your own."""

    @property
    def is_geodetic(self) -> bool:
        """Whether its maps count by geodetic latitude."""
        return (self.latitudes or _LATITUDES.get(self.kind, "geocentric")) == "geodetic"

    @property
    def has_geodetic_clouds(self) -> bool:
        """Whether the map of its clouds does."""
        own = None if self.clouds is None else self.clouds.latitudes
        return self.is_geodetic if own is None else own == "geodetic"

    @property
    def may_be_dressed(self) -> bool:
        """Whether the materials of its shape's file, if it has any, are its surface."""
        return (
            self.shape is not None
            and self.shape.file.lower().endswith((".gltf", ".glb"))
            and self.albedo is None
            and self.color_map is None
            and self.photometry is None
            and self.reflectance == "lambert"
            and not self.is_replaced
        )

    @property
    def has_parameter_maps(self) -> bool:
        """Whether the albedo is that of the photometry's maps."""
        return self.photometry is not None and bool(self.photometry.maps)

    @model_validator(mode="after")
    def _ellipsoid(self) -> Body:
        if self.kind == "ellipsoid":
            for key in ("radii_km", "gm_km3_s2"):
                if getattr(self, key) is None:
                    fail(key, "required for kind: ellipsoid")
            bare = self.albedo is None and self.color_map is None and not self.is_replaced
            if bare and not self.may_be_dressed:
                fail("albedo", "required for kind: ellipsoid without a color_map")
        elif self.ephemeris is not None:
            fail("ephemeris", f"only for kind: ellipsoid; {self.kind} has its own")
        if self.kind == "sun":
            fail("kind", "the Sun is always there (section `sun`); list the other bodies")
        if self.orbit is not None and self.ephemeris is not None:
            fail("ephemeris", "give an orbit or an ephemeris, not both")
        for key in ("atmosphere", "clouds"):
            if self.shape is not None and getattr(self, key, None) is not None:
                fail(key, "only about an ellipsoid: a body with a shape has none")
        return self

    @property
    def is_replaced(self) -> bool:
        """Whether a graph is all of its surface."""
        return self.material is not None and self.material_mode == "replace"

    @model_validator(mode="after")
    def _ground(self) -> Body:
        for key in ("relief", "ocean", "night_lights"):
            if getattr(self, key) is not None and self.material is not None:
                fail(key, f"not for a body with a material; give it to '{self.material}'")
        if self.ocean is not None and self.reflectance != "lambert":
            fail("ocean", f"only with reflectance: lambert, not {self.reflectance}")
        if self.ocean is not None and self.ocean.map is None and self.color_map is None:
            fail("ocean.map", "required without a color_map, whose blue would be the water")
        return self

    @model_validator(mode="after")
    def _centre_of_map(self) -> Body:
        users = ("color_map", "relief", "ocean", "night_lights", "material")
        if all(getattr(self, key) is None for key in users):
            self._only_with(f"a map, or one of {', '.join(users)}", "map_center_lon_deg")
        return self

    @model_validator(mode="after")
    def _mode_of_material(self) -> Body:
        if self.material is None and self.material_mode != "replace":
            fail("material_mode", "only for a body with a material")
        return self
