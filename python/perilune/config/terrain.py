"""The section `terrain` of a body: its ground, from elevation models and fractal detail."""

from __future__ import annotations

import math
from typing import Annotated, Literal

from pydantic import BeforeValidator, Field, model_validator

from perilune.config.craters import Craters
from perilune.config.elevation import Elevation, Latitude, Longitude, SurfaceRaster
from perilune.config.errors import fail
from perilune.config.ground_textures import GroundTexture
from perilune.config.rocks import Rocks
from perilune.config.tracks import Track
from perilune.config.types import NonNegative, Positive, Strict, refuse_drawn

_Seed = Annotated[int, Field(strict=True, ge=0, lt=2**64)]
_Hurst = Annotated[float, Field(strict=True, ge=0.0, le=1.0)]
_Cells = Annotated[float, Field(strict=True, ge=1.0 / 16.0, le=16.0), BeforeValidator(refuse_drawn)]
_Cell = Annotated[float, Field(strict=True, ge=1e-4, le=1e6), BeforeValidator(refuse_drawn)]


class HurstRange(Strict):
    """Hurst exponent of a range of baselines."""

    from_m: NonNegative
    """Shortest baseline of the range; it goes up to the next range."""
    hurst: _Hurst
    """Exponent H: the RMS difference of heights grows as the baseline to this power."""


class Detail(Strict):
    """Fractal detail below the posts of elevation models, or everywhere without any.

    The RMS difference nu(L) of heights over a baseline L is a power L^H, whose exponent may change
    with scale. By default it is that of the highlands of the Moon: nu(17 m) = 1.9 m with H = 0.95
    between 0.1 m and 1 km (Rosenburg et al. 2011), 0.86, 0.6 and 0.22 from 1, 8 and 25 km on
    (LOLA's LDEM_4), and 0.85 below 0.1 m. Posts keep their heights."""

    method: Literal["noise", "diamond_square"] = "noise"
    """noise: a sum of noises on lattices that are turned at random. diamond_square: elevation
    models are refined on their own lattices by midpoint displacement, as the second paper does;
    where no model reaches, it is noise all the same."""
    seed: _Seed = 0
    """Number of the ground: another seed gives other detail of the same roughness."""
    baseline_m: Positive | None = None
    """Baseline of deviation_m. Default: 17 m."""
    deviation_m: NonNegative | None = None
    """RMS difference of heights over baseline_m. Default: 1.9 m."""
    hurst: _Hurst | None = None
    """Hurst exponent at all scales, instead of ranges."""
    ranges: Annotated[tuple[HurstRange, ...], Field(min_length=1, max_length=8)] | None = None
    """Hurst exponents by baseline, from 0 upwards."""
    from_elevation: bool = False
    """Take the law from the last elevation model: that of its heights over 1 to 8 posts, assumed to
    go on below them. Models that are smoothed or noisy break the assumption; a warning then says
    so."""
    strength: NonNegative = 1.0
    """Factor on all heights of the detail; 0: none."""
    longest_m: Positive | None = None
    """Longest wavelength, where there is no elevation model. Default: 0.4 radii."""
    finest_m: Positive | None = None
    """Shortest wavelength. Default: 1 cm."""

    @model_validator(mode="after")
    def _one_law(self) -> Detail:
        self._exactly_one("hurst", "ranges", optional=True)
        if (self.baseline_m is None) != (self.deviation_m is None):
            key = "deviation_m" if self.deviation_m is None else "baseline_m"
            fail(key, "baseline_m and deviation_m go together")
        for key in ("hurst", "ranges", "deviation_m"):
            if self.from_elevation and getattr(self, key) is not None:
                fail("from_elevation", f"true: takes the law from the model; leave out {key}")
        rows = self.ranges or ()
        if rows and rows[0].from_m != 0.0:
            fail("ranges[0].from_m", "must be 0")
        for k in range(1, len(rows)):
            if rows[k].from_m <= rows[k - 1].from_m:
                fail(f"ranges[{k}].from_m", f"must be above that before it, {rows[k - 1].from_m:g}")
        longest = math.inf if self.longest_m is None else self.longest_m
        if self.finest_m is not None and self.finest_m > longest:
            fail("finest_m", f"must not be above longest_m, {longest:g}")
        return self


class Patch(Strict):
    """A square on the ground about a site, with sides to the east and the north."""

    center_lon_lat_deg: Annotated[tuple[Longitude, Latitude], BeforeValidator(refuse_drawn)]
    """East longitude and latitude (geocentric) of the site."""
    side_m: Annotated[Positive, BeforeValidator(refuse_drawn)]
    """Length of a side."""


class Terrain(Strict):
    """The true ground of a body, in place of its smooth ellipsoid: heights over `radii_km`, along
    lines from the centre.

    It is built as a mesh, as fine as the pixels of the frame ask, from the limb to the feet of the
    camera. Heights at a place do not depend on the camera. See docs/terrain.md."""

    elevation: Annotated[tuple[Elevation, ...], Field(max_length=256)] = ()
    """Elevation models, from coarse to fine: each lies over those before it."""
    detail: Detail | None = Detail.of_defaults()
    """Fractal detail below the posts, or everywhere without elevation. null: none."""
    albedo: Annotated[tuple[SurfaceRaster, ...], Field(max_length=256)] = ()
    """Rasters of albedo, from coarse to fine: each lies over those before it, the first over the
    body's colour map or photometric maps. Their numbers, 0 to 10, mean what those maps' do: they
    are multiplied by the body's `albedo`, and the product is at most 1."""
    roughness: Annotated[tuple[SurfaceRaster, ...], Field(max_length=256)] = ()
    """Rasters of Hapke's macroscopic roughness, 0 to 60 degrees, from coarse to fine: each lies
    over those before it, the first over the body's photometry.roughness_deg; only for reflectance
    with a roughness."""
    mask: Annotated[tuple[SurfaceRaster, ...], Field(max_length=256)] = ()
    """Rasters of whole numbers, 0 to 65535, as ids of mapped craters or units: each lies over those
    before it, and gaps are 0. The channel `ground_mask` has the
    number nearest to the point that is seen."""
    patch: Patch | None = None
    """The mesh is fine in this square alone. Ground beside it stays coarse, but for what throws
    shadows into it. Default: all ground in view."""
    roughness_baseline_m: NonNegative = 100.0
    """Baseline below which photometry.roughness_deg is that of all slopes. Those of detail and
    craters, which the ground has itself, are taken from it. Default: 100 m, the pixels of the maps
    that the Moon's is from. 0: it is that of slopes finer than all detail."""
    craters: Craters | None = None
    """Craters where elevation models do not show them; none by default."""
    crater_catalogue: str | None = None
    """File of real craters, that of Robbins (2018) for one: CSV with columns of latitude, longitude
    (degrees, planetocentric) and diameter. They are labelled with those that are drawn, but not
    drawn: elevation models show them. `craters` are smaller than the smallest of them."""
    rocks: Rocks | None = None
    """Rocks on the ground; none by default."""
    textures: Annotated[tuple[GroundTexture, ...], Field(max_length=4)] = ()
    """Textures of the ground: displacement, roughness and albedo by images of a small sample, below
    the posts and the detail."""
    tracks: Annotated[tuple[Track, ...], Field(max_length=64)] = ()
    """Tracks of wheels on the ground. They are no part of labels. Rocks do not lie in them."""
    cells_per_pixel: _Cells = 1.0
    """Accuracy: cells of the mesh along a pixel. Half as many build four times faster."""
    finest_cell_m: _Cell = 0.01
    """Smallest cell of the mesh."""

    @model_validator(mode="after")
    def _some_ground(self) -> Terrain:
        if not self.elevation and self.detail is None and self.craters is None:
            text = "null: without elevation or craters there is then no ground; leave terrain out"
            fail("detail", text)
        if self.rocks is not None and self.rocks.ejecta is not None and self.craters is None:
            fail("rocks.ejecta", "does nothing without craters")
        if not self.elevation and self.detail is not None and self.detail.from_elevation:
            fail("detail.from_elevation", "true: there is no elevation")
        if not self.elevation and self.detail is not None and self.detail.method != "noise":
            text = f"{self.detail.method}: refines elevation models, and there is no elevation"
            fail("detail.method", text)
        return self
