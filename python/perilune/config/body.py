"""The section `bodies`: ellipsoids or meshes with a surface, an orbit and a rotation."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import BeforeValidator, Field, model_validator

from perilune.config.areas import AREAS_MAX, AreaRaster
from perilune.config.atmosphere import Atmosphere
from perilune.config.attitude import BodyRotation
from perilune.config.clouds import Clouds
from perilune.config.errors import fail
from perilune.config.ground import NightLights, Ocean, Relief
from perilune.config.keypoints import Landmark, PointName
from perilune.config.labels import EntryClasses
from perilune.config.materials import DriverSection
from perilune.config.orbit import Orbit
from perilune.config.photometry import Photometry
from perilune.config.rings import Rings
from perilune.config.shape import Shape, named
from perilune.config.terrain import Terrain
from perilune.config.types import (
    FileName,
    Integer,
    Latitudes,
    Positive,
    Rgb,
    StaticFinite,
    Strict,
    triple,
)

# In kilometres what the core's floats hold, 1e-9 to 1e18 m.
_Radius = Annotated[float, Field(strict=True, ge=1e-12, le=1e15)]
_Radii = Annotated[tuple[_Radius, _Radius, _Radius], BeforeValidator(triple)]
_Share = Annotated[float, Field(strict=True, ge=0.0, le=10.0)]
_Albedo = Annotated[tuple[_Share, _Share, _Share], BeforeValidator(triple)]


_LATITUDES = {"earth": "geodetic"}
"""kind -> latitude of published maps. Maps of the Earth use that of WGS 84. For the other bodies
the IAU's working group recommends planetocentric latitudes (Archinal et al. 2018), which maps of
the USGS use; some bodies, such as the Moon, are spheres in maps. Maps of giant planets exist in
both sorts."""


class Body(Strict):
    """A planet, a moon or an asteroid, as an ellipsoid or a mesh."""

    kind: str
    """Name in the table of bodies, which gives size, mass, rotation and ephemeris; or `ellipsoid`,
    which needs radii_km and gm_km3_s2."""
    radii_km: _Radii | None = None
    """Semi-axes along body-fixed x, y, z. Default: the table's."""
    gm_km3_s2: Positive | None = None
    """Gravitational parameter. Default: the table's."""
    ephemeris: str | None = None
    """Only for `ellipsoid`: body of the table whose position it takes. Default for the root:
    earth."""
    shape: Annotated[Shape, BeforeValidator(named)] | None = None
    """Mesh that replaces the ellipsoid: a file, or a mapping with one."""
    terrain: Terrain | None = None
    """True ground in place of the smooth ellipsoid: elevation models and fractal detail."""
    color_map: FileName | None = None
    """Colour map: equirectangular PNG, JPEG, WebP or TIFF; relative to this file, or data:... under
    PERILUNE_DATA."""
    map_center_lon_deg: StaticFinite = 0.0
    """East longitude of the centre column of the maps."""
    latitudes: Latitudes | None = None
    """Latitude of all maps of the body, and of `lon_lat_deg` in its material. geodetic
    (planetographic): angle of the surface normal; geocentric: angle of the line from the centre.
    They differ by up to 21 km on the Earth. Default: geodetic for kind earth, geocentric for all
    others."""
    albedo: _Albedo | None = None
    """Linear factor on the colour map (default 1). Without a map: the colour itself (default: the
    table's Bond albedo)."""
    albedo_contrast: Annotated[float, Field(strict=True, ge=0.0, le=10.0)] = 1.0
    """Contrast of its maps of albedo about their mean over the body: 1 as in the maps, 0 none, 2
    twice. Of the color_map, of photometry.maps without one, and of terrain.albedo."""
    emission_w_m2_sr: Rgb = (0.0, 0.0, 0.0)
    """Radiance that the whole surface emits: a number for all bands, or [r, g, b]."""
    reflectance: str = "lambert"
    """Name in the table of reflectance models. It decides what the albedo means: the Lambert albedo
    of lambert, the normal albedo of lunar_lambert and minnaert, the single-scattering albedo w of
    lommel_seeliger and hapke."""
    photometry: Photometry | None = None
    """Other parameters of a photometric reflectance model."""
    relief: Relief | None = None
    """Terrain slopes as normals; smooth by default."""
    ocean: Ocean | None = None
    """Open water that reflects the Sun; only with reflectance: lambert."""
    night_lights: NightLights | None = None
    """City lights on the night side."""
    atmosphere: Atmosphere | None = None
    """Atmosphere; none by default."""
    clouds: Clouds | None = None
    """Cloud layer; none by default."""
    rings: Rings | None = None
    """Rings in the equatorial plane; none by default."""
    material: str | None = None
    """Name of an entry of `materials`, whose graph replaces or wraps the surface defined above."""
    material_drivers: DriverSection | None = None
    """Values for driver nodes of this graph that the material's own drivers do not set."""
    material_mode: Literal["replace", "wrap"] = "replace"
    """replace: the graph is the whole surface. wrap: inputs of the surface that the graph does not
    set come from the keys above."""
    orbit: Orbit | None = None
    """Orbit around another body or a spacecraft. Default: the ephemeris of its kind."""
    rotation: BodyRotation | None = None
    """`body`: the table's rotation (default where there is one); or a fixed rotation and a spin,
    relative to ICRF axes."""
    class_: str | None = Field(default=None, alias="class")
    """Class at the label level `object`. Default: kind, or the entry's name for an ellipsoid."""
    classes: EntryClasses = Field(default_factory=dict)
    """Classes at your own label levels: level of `labels.levels` -> class, or class -> shell
    patterns on the names of `areas` (`surface`: where there is none)."""
    areas: Annotated[tuple[AreaRaster, ...], Field(max_length=8)] = ()
    """Rasters that name areas of the surface, for labels: sea, ice, a mare; from coarse to fine."""
    landmarks: dict[PointName, Landmark] = Field(default_factory=dict)
    """Name -> place on its ground; its image is a keypoint."""
    annotate: Annotated[bool, Field(strict=True)] = False
    """Whether it is an object as spacecraft are: with pose, boxes, masks and visible fraction in
    `objects` and `masks`, a model in BOP, and its place in all formats of objects."""
    obj_id: Annotated[Integer, Field(ge=1)] | None = None
    """Object id in BOP; only with annotate. Default: the smallest free one after those of
    spacecraft."""

    @property
    def is_geodetic(self) -> bool:
        """Whether its maps use geodetic latitude."""
        return (self.latitudes or _LATITUDES.get(self.kind, "geocentric")) == "geodetic"

    @property
    def has_geodetic_clouds(self) -> bool:
        """Whether the map of its clouds uses geodetic latitude."""
        own = None if self.clouds is None else self.clouds.latitudes
        return self.is_geodetic if own is None else own == "geodetic"

    @property
    def may_be_dressed(self) -> bool:
        """Whether the materials of its shape's file, if any, are its surface."""
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
        """Whether the albedo comes from the photometry's maps."""
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
        """Whether a material graph is its whole surface."""
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
    def _one_ground(self) -> Body:
        for key in ("shape", "relief"):
            if self.terrain is not None and getattr(self, key) is not None:
                fail("terrain", f"not with {key}: it is the ground, and has its slopes")
        return self

    @model_validator(mode="after")
    def _surface_of_terrain(self) -> Body:
        given = self.terrain
        rasters = given is not None and (given.albedo or given.roughness)
        if rasters and self.material is not None:
            key = "albedo" if given is not None and given.albedo else "roughness"
            fail(f"terrain.{key}", f"not for a body with a material; give it to '{self.material}'")
        mapped = self.color_map is not None or self.has_parameter_maps
        if not mapped and not (given is not None and given.albedo) and not self.is_replaced:
            self._only_with("a color_map, photometry.maps or terrain.albedo", "albedo_contrast")
        if self.material is not None:
            self._only_with("a surface of its own, not a material", "albedo_contrast")
        return self

    @model_validator(mode="after")
    def _textures_of_terrain(self) -> Body:
        given, why = self.terrain, f"not for a body with a material; give it to '{self.material}'"
        for k, row in enumerate(() if given is None else given.textures):
            for key in ("albedo", "mottling", "roughness"):
                if self.material is not None and getattr(row, key) is not None:
                    fail(f"terrain.textures[{k}].{key}", why)
            if row.roughness is not None and self.reflectance != "hapke":
                fail(f"terrain.textures[{k}].roughness", "does nothing without reflectance: hapke")
        for k, track in enumerate(() if given is None else given.tracks):
            if self.material is not None and track.albedo != 1.0:
                fail(f"terrain.tracks[{k}].albedo", f"{why}: must be 1.0")
        return self

    @model_validator(mode="after")
    def _centre_of_map(self) -> Body:
        users = ("color_map", "relief", "ocean", "night_lights", "material")
        if all(getattr(self, key) is None for key in users):
            self._only_with(f"a map, or one of {', '.join(users)}", "map_center_lon_deg")
        return self

    @model_validator(mode="after")
    def _few_areas(self) -> Body:
        names = {name for raster in self.areas for name in raster.classes}
        if len(names) > AREAS_MAX:
            fail("areas", f"{len(names)} names of areas; at most {AREAS_MAX}")
        return self

    @model_validator(mode="after")
    def _id_of_object(self) -> Body:
        if self.obj_id is not None and not self.annotate:
            fail("obj_id", "only with annotate: true")
        return self

    @model_validator(mode="after")
    def _mode_of_material(self) -> Body:
        if self.material is None and self.material_mode != "replace":
            fail("material_mode", "only for a body with a material")
        return self
