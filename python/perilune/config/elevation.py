"""The schema's section for one elevation model of a body: its file and where it lies."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Any, Literal

from pydantic import BeforeValidator, Discriminator, Field, Tag, model_validator

from perilune.config.errors import fail
from perilune.config.types import (
    FileName,
    Finite,
    Latitudes,
    NonNegative,
    Positive,
    StaticFinite,
    Strict,
    refuse_drawn,
)

_Positive = Annotated[Positive, BeforeValidator(refuse_drawn)]
Longitude = Annotated[float, Field(strict=True, ge=-720.0, le=720.0), BeforeValidator(refuse_drawn)]
Latitude = Annotated[float, Field(strict=True, ge=-90.0, le=90.0), BeforeValidator(refuse_drawn)]
_Posts = Annotated[float, Field(strict=True, ge=0.0, le=1e6), BeforeValidator(refuse_drawn)]
_Offset = Annotated[tuple[Finite, Finite], BeforeValidator(refuse_drawn)]


class CylindricalPlace(Strict):
    """Columns of equal longitude and rows of equal latitude, in equal steps; rows from north to
    south (simple cylindrical, equirectangular). A raster of all longitudes wraps around."""

    kind: Literal["cylindrical"]
    west_deg: Longitude
    """East longitude of the western edge: 0 for the grids of LOLA and MOLA."""
    east_deg: Longitude | None = None
    """East longitude of the eastern edge, greater than west_deg. Default: a full turn on."""
    south_deg: Latitude = -90.0
    north_deg: Latitude = 90.0
    edges: Literal["cells", "posts"] = "cells"
    """What the edges are: the borders of the outermost cells, whose numbers belong to the middle of
    a cell; or the outermost posts themselves."""
    latitudes: Latitudes | None = None
    """geodetic (planetographic): angle of the surface normal; geocentric: angle of the line from
    the centre. Default: the body's."""

    @model_validator(mode="after")
    def _some_extent(self) -> CylindricalPlace:
        east = self.west_deg + 360.0 if self.east_deg is None else self.east_deg
        if not 0.0 < east - self.west_deg <= 360.0:
            fail("east_deg", "must be east of west_deg, by at most 360 degrees")
        if not self.south_deg < self.north_deg:
            fail("south_deg", "must be south of north_deg")
        return self


class PolarPlace(Strict):
    """A polar stereographic map of a sphere of the datum's radius, with square cells. Longitude
    center_lon_deg points down from the north pole, and up from the south pole."""

    kind: Literal["polar_stereographic"]
    pole: Literal["north", "south"]
    post_m: _Positive
    """Distance of posts at the pole."""
    center_lon_deg: Longitude = 0.0
    """East longitude of the vertical meridian."""
    center_m: _Offset = (0.0, 0.0)
    """Right and up from the pole to the middle of the raster."""


class LocalPlace(Strict):
    """An orthographic map about a point, with square cells, north up."""

    kind: Literal["orthographic"]
    center_lon_lat_deg: Annotated[tuple[Longitude, Latitude], BeforeValidator(refuse_drawn)]
    """East longitude and latitude (geocentric) of the point to which the map is tangent."""
    post_m: _Positive
    """Distance of posts."""
    center_m: _Offset = (0.0, 0.0)
    """East and north from that point to the middle of the raster."""


def _kind(value: Any) -> str | None:
    found = value.get("kind") if isinstance(value, Mapping) else getattr(value, "kind", None)
    return found if isinstance(found, str) else None


Place = Annotated[
    Annotated[CylindricalPlace, Tag("cylindrical")]
    | Annotated[PolarPlace, Tag("polar_stereographic")]
    | Annotated[LocalPlace, Tag("orthographic")],
    Discriminator(_kind),
]
"""Where a raster lies; `kind` selects the projection."""


class RawSamples(Strict):
    """Layout of a file of numbers without a label."""

    type: Literal["uint8", "int16", "uint16", "int32", "float32", "float64"] = "int16"
    byte_order: Literal["little", "big"] = "little"
    width: Annotated[int, Field(strict=True, ge=1)] | None = None
    """Numbers in a row. Default: twice the number of rows."""


class SurfaceRaster(Strict):
    """Numbers of a surface from one file: a whole body, or a patch that is laid over what comes
    before it. Missing numbers are filled from those around them, with a warning."""

    file: FileName
    """As of elevation: PDS image, TIFF, NumPy array, grey PNG, or what rasterio reads. Relative to
    this file, or data:... under PERILUNE_DATA."""
    projection: Place | None = None
    """Where the raster lies. Default: what the file's label or georeference says."""
    raw: RawSamples | None = None
    """Layout of an .img file without a label."""
    band: Annotated[int, Field(strict=True, ge=1)] | None = None
    """Band of a TIFF, or of what rasterio reads, with several; from 1 on."""
    scale: StaticFinite | None = None
    """Factor on the file's numbers. Default: the file's own, else 1; a PNG needs it (8 bits from 0
    to 1: 0.00392157). They are linear, without the curve of sRGB."""
    offset: StaticFinite | None = None
    """What is added then. Default: the file's own, else 0."""
    missing: StaticFinite | None = None
    """Number of the file that marks missing ones, besides those that the file declares, numbers
    that are not finite or beyond 1e30, and -32768 unless bytes or unsigned."""
    border_posts: _Posts = 8.0
    """Width of the border in which a patch fades into what lies below it; at most half of the
    patch."""

    @model_validator(mode="after")
    def _some_scale(self) -> SurfaceRaster:
        if self.scale == 0.0:
            fail("scale", "must not be 0")
        return self


class Elevation(Strict):
    """Heights from one file: a whole body, or a patch that is laid over what comes before it.

    Posts keep their values to the bit, unless `destep` is on. Missing heights are filled from those
    around them, with a warning. At a pole the columns of a cylindrical raster meet; there it is
    smoothed over about a post, in full within 5.7 degrees of the pole (less for fine rasters) and
    not at all beyond 10, so that it has one height at the pole and no spokes about it."""

    file: FileName
    """PDS image (.img, beside it its label .lbl if there is one), TIFF with or without
    georeference, NumPy array (.npy), or grey PNG with 8 or 16 bits; other files are read with
    rasterio (the extra `geo`). Relative to this file, or data:... under PERILUNE_DATA."""
    projection: Place | None = None
    """Where the raster lies. Default: what the file's label or georeference says."""
    raw: RawSamples | None = None
    """Layout of an .img file without a label."""
    scale_m: StaticFinite | None = None
    """Metres of one unit of the file's numbers. Default: the file's own, else 1; a PNG needs it."""
    offset_m: StaticFinite | None = None
    """Height where the file's number is 0. Default: the file's own, else 0."""
    datum_radius_km: _Positive | None = None
    """Radius of the sphere over which heights count. Default: the file's label; else heights are
    over the body's ellipsoid."""
    missing: StaticFinite | None = None
    """Number of the file that marks missing heights, besides those that the file declares, numbers
    that are not finite or beyond 1e30, and -32768 unless bytes or unsigned."""
    interpolation: Literal["bilinear", "cubic"] = "bilinear"
    """Between posts: bilinear has slope creases along lines of posts; cubic (Catmull-Rom) has
    none."""
    border_posts: _Posts = 8.0
    """Width of the border in which a patch fades into what lies below it; at most half of the
    patch."""
    apron_m: Annotated[NonNegative, BeforeValidator(refuse_drawn)] = 0.0
    """Width of the ground around a patch that is raised or lowered to meet its edges, where it does
    not agree with what lies below it; posts there of what lies below move. 0: none, and a
    disagreement shows as a wall in the border."""
    destep: Annotated[bool, Field(strict=True)] = False
    """Smooths the terraces of heights in whole numbers. No post moves by more than half a unit of
    the file's numbers."""

    @model_validator(mode="after")
    def _some_scale(self) -> Elevation:
        if self.scale_m == 0.0:
            fail("scale_m", "must not be 0")
        return self
