"""Types of the C core for the ground of bodies: `perilune._core` has their names."""

from collections.abc import Mapping, Sequence
from typing import Any, Self, TypedDict, final

import numpy as np
from numpy.typing import NDArray

F64 = NDArray[np.float64]

@final
class Raster:
    """Georeferenced numbers on a body: scale * sample + offset. Posts stay to the bit. Directions are
    from the body's centre, in body axes."""
    def __new__(
        cls, samples: NDArray[Any], projection: str, x0: float, y0: float, dx: float, dy: float,
        scale: float = 1.0, offset: float = 0.0, lon0_rad: float = 0.0, lat0_rad: float = 0.0,
        radius_m: float = 0.0, map_scale: float = 1.0, axis_ratio: float = 1.0
    ) -> Self:
        """samples: (height, width) of uint8, int16, uint16 or float32, finite; borrowed, so they must
        not change. The post of column c and row r is at (x0 + c dx, y0 + r dy). projection:
        "cylindrical" (longitude and latitude, rad; axis_ratio: polar over equatorial radius, where
        latitudes are geodetic), "stereographic" or "orthographic" (m, about the centre lon0_rad,
        lat0_rad, of a sphere of radius_m; map_scale: scale at the centre, stereographic)."""
    def values(
        self, directions: F64, interpolation: str = "bilinear", level: int = 0
    ) -> F64:
        """(n,) values in directions (n, 3), NaN outside; of level `level` of the pyramid, whose cells
        are 2^level posts wide. interpolation: "bilinear" | "cubic"."""
    def weights(self, directions: F64, border_posts: float) -> F64:
        """(n,) 1 inside, 0 outside, smooth over the border."""
    def posts(self, directions: F64, /) -> F64:
        """(n, 2) column and row of directions (n, 3), NaN outside."""
    def directions(self, posts: F64, /) -> F64:
        """(n, 3) unit directions of columns and rows (n, 2)."""
    def spacing_m(self, radius_m: float, /) -> float:
        """Distance of posts on a body of this radius."""
    def bounds(self, interpolation: str = "bilinear", /) -> tuple[float, float]:
        """Bounds of all values."""
    @property
    def levels(self) -> int:
        """Number of levels of its pyramid."""
    @property
    def whole(self) -> bool:
        """Whether it covers the whole body."""

@final
class CraterField:
    """Craters of a body as a function of place: their relief, and lists of them."""
    def __new__(cls, settings: Mapping[str, object]) -> Self:
        """settings: radius_m (of the body), and, all optional, law (a name of CRATER_LAWS),
        surface_age_ga, density (factor), coefficient and exponent (of law "power"), table (of law
        "table": (n, 2) diameters, m, and densities of craters of these or more, 1/m^2), seed (0 to
        2^64 - 1), min_diameter_m, max_diameter_m, diffusivity_m2_per_myr (of craters of 1 km),
        diffusivity_exponent, ellipticity (greatest 1 - minor/major axis), irregularity (1: as real
        rims), terraces (likewise, 0 to 1), model_posts (posts of an elevation model over a crater that it shows), ray_brightness
        (of fresh ejecta over old ground, less 1; 0: no rays), ray_fade_ga, ray_reach (radii). The
        defaults are the Moon's, without rays."""
    def heights(self, directions: F64, footprint_m: float = 0.0) -> F64:
        """(n,) relief of craters, m, in directions (n, 3); those of less than 2 to 4 footprints of
        diameter are left out."""
    def list(
        self, direction: F64, radius_m: float, min_diameter_m: float = 0.0,
        max_diameter_m: float = 1e300
    ) -> NDArray[np.void]:
        """(n,) of CRATER, with centres within radius_m of a direction (3,)."""

@final
class RockScan:
    """The shape of a measured rock: distances of its surface from the mean of its area, in all
    directions, along its principal axes (z the shortest). The greatest is 1."""
    def __new__(cls, positions: F64, triangles: NDArray[np.uint32]) -> Self:
        """positions (V, 3), triangles (T, 3): a closed mesh, in any units and axes. ValueError if it
        does not surround the mean of its area."""
    @property
    def folded(self) -> float:
        """Fraction of directions in which overhangs were filled."""
    def radii(self, directions: F64, /) -> F64:
        """(n,) distances of the surface in directions (n, 3)."""

@final
class RockField:
    """Rocks of a body as a function of place."""
    def __new__(cls, settings: Mapping[str, object]) -> Self:
        """settings: radius_m (geometric mean of the body's radii), and, all optional, law (a name of
        ROCK_LAWS), density (factor), abundance and decay_per_m (of law "golombek"), coefficient and
        exponent (of law "power"), cutoff_m (densities times exp(-D / cutoff_m); 0: none), table (of
        law "table": (n, 2) diameters, m, and densities of rocks of these or more, 1/m^2), seed (0 to
        2^64 - 1), min_diameter_m, max_diameter_m, least_burial and most_burial (parts of the height
        below the ground), repose_rad (no rocks on steeper slopes), fillet (height of the soil at
        their feet over theirs, 0 to 0.3), families (weights by names of
        ROCK_FAMILIES; those not named have none), models (up to 32
        RockScans, of the family "model"), ejecta_at_rim (density of blocks at rims of new
        craters over that of the law), ejecta_life_ga, ejecta_least_crater_m."""
    def list(
        self, terrain: Terrain, direction: F64, radius_m: float, min_diameter_m: float = 0.0,
        max_diameter_m: float = 1e300
    ) -> NDArray[np.void]:
        """(n,) of ROCK: rocks on a terrain, with centres within radius_m of a direction (3,)."""

@final
class Terrain:
    """Heights of a body's ground over its ellipsoid, along directions from its centre: rasters, from
    coarse to fine, and fractal detail of wavelengths below their posts, which stay to the bit."""
    def __new__(
        cls, radii_m: F64, layers: Sequence[tuple[object, ...]] = ...,
        detail: Mapping[str, object] | None = None, craters: CraterField | None = None,
        rocks: RockField | None = None, albedo: Sequence[tuple[Raster, float]] | None = None,
        roughness: Sequence[tuple[Raster, float]] | None = None,
        roughness_baseline_m: float = 0.0, known_craters: F64 | None = None,
        mask: Sequence[tuple[Raster, float]] | None = None,
        patch: tuple[tuple[float, float, float], float] | None = None,
        tracks: Sequence[tuple[F64, float, float, float, float, float, float, float]] | None = None,
        textures: Sequence[tuple[Raster | None, Raster | None, Raster | None, float, int]] | None = None,
    ) -> Self:
        """radii_m: (3,) of the ellipsoid. layers: (Raster, interpolation,
        border_posts, datum_m), and apron_m or none, each over those before it: interpolation "bilinear" | "cubic"; the border is the width of blending
        into the layers below; datum_m: radius of the sphere that heights are over, 0 for the
        ellipsoid; apron_m: width of the ground beside it that is raised or lowered to meet its edges. detail: None for none; keys, all optional: method ("noise" |
        "diamond_square"), seed (0 to 2^64 - 1), ranges [(from_m,
        hurst), ...] (the first from 0), baseline_m and deviation_m (RMS difference of heights over
        that baseline), strength (factor of heights), longest_m and finest_m (widest and narrowest
        cells of noise). The defaults are the highlands of the Moon, without a seed: 0. craters: of a
        body of the geometric mean of the radii; added where the uppermost raster cannot show them.
        rocks: of such a body, too; they are no part of the heights. albedo, roughness (rad):
        (raster, border_posts) of the surface, each over those before it. roughness_baseline_m: the
        roughness of laws of reflectance is that of slopes below it; 0: finer than all detail. known_craters: (n, 4)
        unit directions and diameters (m) of craters that are labelled, but not drawn. mask: whole numbers,
        as albedo. patch: unit direction and side (m) of a square; meshes are fine only in it.
        tracks: of wheels: points (n, 3) of the ellipsoid (m), gauge, width, depth, spacing and depth of
        the imprints of grousers (m), angle of their bars (rad), factor on the albedo. textures: images of
        heights (m), factors on roughness and albedo, their width on the ground (m) and a seed."""
    def heights(self, directions: F64, cell_m: float = 0.0) -> F64:
        """(n,) heights, m, in directions (n, 3) in body axes, as a lattice with cells of at most
        cell_m resolves them; 0: of the finest level."""
    def block(
        self, face: int, level: int, i0: int, j0: int, width: int, height: int
    ) -> F64:
        """(height, width) heights, m, of nodes (i0 + column, j0 + row) of a face of the cube."""
    def slopes(self, directions: F64, baseline_m: float) -> F64:
        """(n, 3) slopes, rise over distance, between points baseline_m apart, as vectors along the
        ground in body axes."""
    def planes(self, directions: F64, baseline_m: float, points: int = 32) -> F64:
        """(n, 2) slope in rad and RMS height in m of the plane of least squares through `points`
        heights (8 to 256) in a disc about each direction, with a diameter of baseline_m, as cells of
        at most 1/8 of it resolve them."""
    def craters(
        self, direction: F64, radius_m: float, min_diameter_m: float = 0.0,
        max_diameter_m: float = 1e300
    ) -> NDArray[np.void]:
        """(n,) of CRATER that are drawn, with centres within radius_m of a direction (3,)."""
    def rocks(self, ids: NDArray[np.uint64], /) -> NDArray[np.void]:
        """(n,) of ROCK: the rocks of ids (n,). ValueError for an id of none."""
    def rock_surfaces(
        self, ids: NDArray[np.uint64], eye: F64, pixel_rad: float, /
    ) -> tuple[NDArray[np.void], F64, NDArray[np.int64]]:
        """(m,) of ROCK, as `rocks`; points (n, 3) of the rocks over the ground, body axes, m, of
        which their silhouettes are the hulls, as meshes have them that are seen from eye (3,) in
        pixels of this angle; (m + 1,) where those of each rock begin, and the end."""
    def level(self, cell_m: float, /) -> int:
        """Coarsest level of the lattice with cells of at most cell_m; 0: the finest level."""
    def cell_m(self, level: int, /) -> float:
        """Width of the cells of a level."""
    def relief_m(self, cell_m: float, /) -> float:
        """Standard deviation, m, of the detail that levels finer than cell_m add."""
    @property
    def bounds(self) -> tuple[float, float]:
        """Bounds of all heights, m."""
    @property
    def finest_level(self) -> int:
        """Level beyond which nothing is added."""

class ClodSettings(TypedDict):
    seed: int
    pixels: int  # along a side
    size_m: float
    min_diameter_m: float
    max_diameter_m: float
    density_per_m2: float  # of 1 cm or more
    exponent: float

class MottlingSettings(TypedDict):
    seed: int
    pixels: int
    cover: float
    border: float
    hurst: float

def clods(settings: ClodSettings, /) -> NDArray[np.float32]:
    """Heights over the soil, m, (pixels, pixels), of clods on a square of size_m. ValueError names the
    key."""

def mottling(settings: MottlingSettings, /) -> NDArray[np.float32]:
    """Fractions of bright ground less their mean, (pixels, pixels)."""
