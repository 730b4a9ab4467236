"""The C core. Everything done per pixel, ray, vertex or time step happens here.

Frames and units: SI, radians. A *pose* is 7 doubles (x, y, z, qw, qx, qy, qz): the rotation and
translation that take child coordinates to root coordinates, metres. The root frame is inertial with
ICRF axes and its origin at the root body. Camera axes are OpenCV's: x right, y down, z forward.

Errors of the core are raised as `ValueError` (bad argument, range, format, unsupported),
`OSError` (files), `MemoryError`, `KeyboardInterrupt` (cancelled) or `RuntimeError` (device).
"""

from collections.abc import Callable, Mapping, Sequence
from typing import Any, Self, final

import numpy as np
from numpy.typing import NDArray

from perilune._core_files import (
    deflate as deflate,
    exr_decode as exr_decode,
    exr_encode as exr_encode,
    gltf_graphs as gltf_graphs,
    png_encode as png_encode,
    png_grey as png_grey,
    png_write as png_write,
    simplify as simplify,
)
from perilune._core_light import (
    band_gather as band_gather,
    cloud_cover as cloud_cover,
    sunlight as sunlight,
)
from perilune._core_orbit import (
    FORCES as FORCES,
    TURNS as TURNS,
    Propagator as Propagator,
    Tree as Tree,
)
from perilune._core_records import (
    AirSettings as AirSettings,
    BandLight as BandLight,
    Channel as Channel,
    CloudSettings as CloudSettings,
    Constant as Constant,
    Exposure as Exposure,
    FrameRequest as FrameRequest,
    FrameResult as FrameResult,
    Ground as Ground,
    GroundUse as GroundUse,
    LensModel as LensModel,
    NodeKind as NodeKind,
    PlanRow as PlanRow,
    Quality as Quality,
    SeenStars as SeenStars,
    Socket as Socket,
)
from perilune._core_scan import (
    EVENT as EVENT,
    LIDAR_RETURN as LIDAR_RETURN,
    RAY_SOURCES as RAY_SOURCES,
    TIME_OF_FLIGHT_PIXEL as TIME_OF_FLIGHT_PIXEL,
    source_extent as source_extent,
    source_rays as source_rays,
)
from perilune._core_terrain import (
    ClodSettings as ClodSettings,
    CraterField as CraterField,
    MottlingSettings as MottlingSettings,
    Raster as Raster,
    RockField as RockField,
    RockScan as RockScan,
    Terrain as Terrain,
    clods as clods,
    mottling as mottling,
)

F64 = NDArray[np.float64]

CHANNELS: tuple[Channel, ...]
"""Every per-pixel channel the core can compute, in a fixed order."""

EFFECTS: tuple[dict[str, str], ...]
"""Every row of the table of effects: {"name", "doc"}."""

COSTS: tuple[dict[str, Any], ...]
"""Every unit of work of the model of costs: {"name", "doc", "ns"}."""

REFLECTANCES: tuple[dict[str, str], ...]
"""Every reflectance model: {"name", "doc"}."""

CRATER_LAWS: tuple[dict[str, str], ...]
"""Every size-frequency law of craters: {"name", "doc"}."""

CRATER: Sequence[tuple[Any, ...]]
"""Description (name, type, shape) for numpy.dtype of one crater:

id (below 2^63, the same in any list); direction (3,) of the centre and major (3,) along the major
axis, unit, in body axes; diameter_m (mean of both axes), axis_ratio; age_ga; tau (degradation: time
of diffusion over R^2/diffusivity); depth_m and rim_m (degraded: rim to floor, and over the surface
before the impact); kept (fraction of the height at its centre that younger craters left)."""

RIM_IMAGE: Sequence[tuple[Any, ...]]
"""Description (name, type, shape) for numpy.dtype of the image of a rim:

kind (0: behind the near plane, nothing else is set; 1: partly behind it, only the box of the rest is
set; 2: an ellipse), centre (2,), semi_axes (2,) (major first) and box (4,) (least u and v, greatest
u and v; beyond the image, too) in pixels; angle_rad of the major axis from u towards v; facing
(cosine between the outward normal and the direction to the camera)."""

ROCK_LAWS: tuple[dict[str, str], ...]
"""Every size-frequency law of rocks: {"name", "doc"}."""

ROCK_FAMILIES: tuple[dict[str, str], ...]
"""Every family of shapes of rocks: {"name", "doc"}."""

ROCK: Sequence[tuple[Any, ...]]
"""Description of the records of RockField.list: id, family (index in ROCK_FAMILIES), diameter_m
(seen from above), height_m (over the ground), burial (part of the height below the ground),
slope_rad (of the ground), direction (3,) (of the place), center (3,) (of the shape, body axes, m),
up (3,) (normal of the ground), rotation (3, 3) (axes of the shape to those of the body)."""

OBJECT_LABEL: Sequence[tuple[Any, ...]]
KEYPOINT_LABEL: Sequence[tuple[Any, ...]]
"""Description (name, type, shape) for numpy.dtype of one row of the object labels:

R_m2c (3, 3), t_m2c (3,) m, instance_id, obj_id, in_view; and as in BOP's scene_gt_info:
bbox_visib, bbox_obj (x, y, w, h with w = x_max - x_min; -1s when px_count_visib is 0),
px_count_visib, px_count_all (silhouette on the canvas with one image size of margin on each
side), px_count_valid (silhouette inside the image), visib_fract. With the request's "amodal" false:
bbox_obj -1s, px_count_all and px_count_valid -1, visib_fract nan."""

@final
class Model:
    """A model read from .gltf or .glb; immutable, turned to z-up. Model units are the file's times
    the stretch."""
    def __new__(
        cls, path: str, crease_angle_rad: float = ..., stretch: F64 | None = None,
        sides: Callable[[str, bool], bool] | None = None
    ) -> Self:
        """crease_angle_rad (default: pi, none): normals that the file has for faces that meet over
        edges of more than that are split, each side gets its own; a line of `warnings` tells.
        stretch: (3,) positive factors along the model's axes, as if all root nodes were below a
        node of that scale. sides: asked of each material by its name, and whether the file has it
        double-sided: whether rays meet the backs of its faces; those of solids that light goes
        through they do."""
    @property
    def path(self) -> str: ...
    @property
    def triangle_count(self) -> int: ...
    @property
    def vertex_count(self) -> int: ...
    @property
    def nbytes(self) -> int:
        """Memory of meshes and textures."""
    @property
    def bounds(self) -> F64:
        """(2, 3): smallest and largest coordinates, model units, z-up."""
    @property
    def stretch(self) -> F64:
        """(3,): factors along its axes by which it was stretched; 1, 1, 1: as in the file."""
    @property
    def parts(self) -> tuple[dict[str, Any], ...]:
        """{"name", "material", "node": index} of each part: a primitive of a node of the file."""
    @property
    def nodes(self) -> tuple[dict[str, Any], ...]:
        """{"name", "parent": index or -1, "origin": (3) at rest, model axes and units, nan for a
        flattened node} of each node of the file, by its index there."""
    @property
    def animations(self) -> tuple[dict[str, Any], ...]:
        """{"name", "duration_s", "nodes": indices} of those that move nodes of the scene."""
    @property
    def materials(self) -> tuple[str, ...]: ...
    @property
    def warnings(self) -> tuple[str, ...]: ...
    def mesh(self) -> dict[str, NDArray[Any]]:
        """Copies: positions (V,3) f64, model units, normals (V,3) f32, uv (V,2) f32 or absent,
        indices (T,3) u32, triangle_part (T,) u32, triangle_color (T,3) u8 (mean sRGB)."""
    def surfaces(self) -> dict[str, NDArray[Any]]:
        """What rays meet of the triangles: double_sided (T,) bool, whether their backs are met, and
        presence (T,) u8: 0 where alpha leaves nothing of a triangle, 1 a part, 2 all of it."""
    @classmethod
    def of_mesh(
        cls,
        name: str,
        positions: NDArray[np.float32],
        indices: NDArray[np.uint32],
        one_sided: bool = False,
        source: Model | None = None,
        corners: NDArray[np.uint32] | None = None,
        faces: NDArray[np.uint32] | None = None,
        /,
    ) -> Self:
        """The shape of a body: positions (V, 3), indices (T, 3), counter-clockwise seen from
        outside; its path is the name. one_sided: rays from behind pass its triangles. source: the
        model whose materials and texture coordinates it gets, but for opacity and emission; corners
        (T, 3) are its vertices there, faces (T,) its triangles. ValueError: no such corners."""
    def winding(self, points: F64, /) -> F64:
        """How often the surface goes around points (n, 3): of a closed mesh 1 inside, 0 outside."""
    def components(self) -> NDArray[np.uint32]:
        """(T,): connected component of each triangle, vertices welded by position; numbered from
        0 by falling number of triangles, then by first triangle."""

@final
class Articulation:
    """Moving nodes of a model. Axes are the model's (z-up): an axis (x, y, z) of a node in the file
    is (x, -z, y) here; lengths are model units, angles radians.

    joints: {"node": index, "kind": "turn" (about the axis by the value) | "slide" (along it by the
    value) | "towards" (about it until the normal comes nearest to the target, plus the value),
    "axis": (3,), "pivot": (3,) a point of the axis, "normal": (3,), "in_node_axes": bool}. In the
    node's axes at rest, whatever its scale, the pivot is counted from the node's origin; otherwise
    all is in the model's axes. All joints are given at rest and travel with what is above them.
    animations: (n,) indices into Model.animations, played together. ValueError names the node that
    cannot move, or that two animations move in the same way."""
    def __new__(
        cls, model: Model, joints: Sequence[Mapping[str, Any]], animations: NDArray[np.int32]
    ) -> Self: ...
    @property
    def nodes(self) -> tuple[int, ...]:
        """Indices of the moving nodes that something hangs on, parents before children."""
    @property
    def axes(self) -> F64:
        """(joints, 2, 3): unit axis and pivot of each joint at rest, in the model's axes."""
    def pose(
        self, values: F64, targets: F64, play_s: float = 0.0, loop: str = "repeat"
    ) -> tuple[F64, F64]:
        """The joints' angles or ways (joints,), and motions (nodes, 3, 4): [m | t] takes a point of
        the model at rest to where it is now, p' = m p + t.

        values: (joints,). targets: (joints, 3) points in the model's axes and units, at this
        instant; read for "towards" alone, where a target on the axis leaves the angle at the value.
        play_s: seconds since the animations began; loop: "repeat", "clamp" or "pingpong", of each."""

@final
class Stars:
    """A catalogue of stars: unit directions (n, 3) in root axes for an observer at rest, irradiance
    of the bands (n, 3), W m-2, magnitudes and numbers (n,) for labels."""
    def __new__(
        cls, directions: F64, light: F64, magnitudes: F64, numbers: NDArray[np.int64]) -> Self: ...
    @property
    def count(self) -> int:
        """Number of stars."""

@final
class Map:
    """A filtered texture: a PNG, JPEG or WebP file, uint8 (H, W, channels) or float32 (H, W). Wrap:
    "repeat" | "clamp" | "mirror". black: linear, becomes 0; None: what all but a twentieth of
    the body's area is at most, by channel, up to 0.02. water: a mask of where it is blue."""

    def __new__(
        cls, source: str | NDArray[np.uint8] | NDArray[np.float32], srgb: bool = True, wrap_u:
        str = "repeat", wrap_v: str = "clamp", black: float | None = 0.0, water: bool = False
    ) -> Self: ...
    @property
    def size(self) -> tuple[int, int]:
        """(width, height), texels."""
    @property
    def mean(self) -> F64:
        """(4,) mean linear RGBA."""
    @property
    def nbytes(self) -> int:
        """Memory of its texels at all levels."""
    def columns(self) -> F64:
        """(width, 4) mean linear RGBA of each column, of up to 64 of its texels."""

@final
class Grid:
    """Numbers over a whole body, filtered by the footprint of a ray."""
    def __new__(
        cls, values: NDArray[np.float32], west_rad: float, north_rad: float, south_rad: float
    ) -> Self:
        """values: (height, width, channels), finite, at most 32 channels; rows from north to south,
        columns all around eastwards from west_rad. Beyond the edges the edge's."""
    @property
    def mean(self) -> F64:
        """(channels,) mean of all cells."""

@final
class Air:
    """An atmosphere about a round body at the origin; points lie outside it, directions are unit."""
    def __new__(cls, settings: AirSettings, radius_m: float) -> Self:
        """radius_m: of the body, the geometric mean of its semi-axes."""
    def transmittance(self, points: F64, directions: F64) -> F64:
        """(n, 3) part of the light of each band that comes from infinity in directions (n, 3) to
        points (n, 3), m; directions that meet the ground count as tangent to it."""
    def scatter(
        self, points: F64, directions: F64, sun: tuple[float, float, float], sun_radius_rad: float,
        end_m: float, steps: int, multiple: bool
    ) -> tuple[F64, F64]:
        """(n, 3) radiance, 1/sr, of light scattered to points along directions up to end_m or the
        ground, under a sun of irradiance 1 towards `sun`; (n, 3) part of the light from the end that
        arrives. steps: 1..64."""
    def skylight(self, sun_sine: float, multiple: bool) -> tuple[float, float, float]:
        """Irradiance of the sky on flat ground, of a sun of irradiance 1 with its height's sine."""

@final
class Rings:
    """Flat rings about a body, in its axes: z is their normal, the origin its centre."""
    def __new__(
        cls, edges_m: F64, depth: F64, albedo: F64, exponent: float, dust_share: float,
        dust_g: float
    ) -> Self:
        """edges_m: (n + 1,) rising radii; between them depth (n,) along the normal and albedo
        (n, 3), n up to 16384. exponent: of the particles' phase function; dust_share: of the light
        that is scattered as by dust, with a mean cosine of dust_g."""
    def scatter(
        self, points: F64, directions: F64, sun: tuple[float, float, float], sun_radius_rad: float,
        width_m: float, spread: float
    ) -> tuple[F64, F64]:
        """(n, 3) radiance, 1/sr, that the rings send to points (n, 3), m, of a sun of irradiance 1
        in the unit direction `sun`, and (n,) part of the light from behind that passes: means over
        cones about unit directions (n, 3), width_m wide at the points and wider by `spread` a metre;
        the body's shadow is left out."""

NODES: dict[str, NodeKind]

LENSES: dict[str, LensModel]
"""The kinds of nodes of material graphs by name."""

@final
class Graph:
    """A compiled material graph; immutable once it is placed.

    nodes: (name, kind, inputs, constants) each, inputs and constants in the order of NODES. An
    input is (source, index, output, x, y, z) with source "unset", "constant" (x, y, z; a scalar
    thrice), "link" (to output `output` of node `index`) or "parameter" (`index` of those that each
    frame gives). A constant is (number or index of the choice, numbers float32 or None, Map or
    None). surface: index of the node that is the surface. wrap: inputs of it that are unset stay
    the model's material's. ValueError starts with `node.key`."""
    def __new__(
        cls, nodes: tuple[tuple[Any, ...], ...], surface: int, parameters: int, wrap: bool
    ) -> Self: ...
    @property
    def instructions(self) -> int:
        """Nodes evaluated at each hit: constant and unused ones are not among them."""
    @property
    def parameters(self) -> int: ...
    @property
    def presence(self) -> int:
        """What its alpha leaves of a surface, in any frame: 0 nothing, 1 perhaps a part, 2 all."""
    def add_level(
        self, level: int, value: Graph, ranges: F64, ids: NDArray[np.uint16]
    ) -> None:
        """Gives points of the surface classes at a level of `semantic`, by the emission strength of
        `value`, a graph with the same parameters. ranges: (n, 2), least and greatest, both included;
        ids: (n,). The first range that has the value counts; 0 where none has it. Before the graph
        is placed."""
    def evaluate(self, points: F64, radius: float, parameters: NDArray[np.float32]) -> F64:
        """(n, 8): colour (3), metalness, GGX alpha, emission (3) of the surface at points (n, 3) in
        object axes, m, with footprints of this radius, m. parameters: (count, 4)."""
    def albedo(self, towards: F64, draws: int, parameters: NDArray[np.float32]) -> F64:
        """(n, 3): what the surface at the object's origin sends towards unit directions (n, 3), of
        its axes with z the normal, of an even sky's light: the directional albedo, by as many draws
        of its model; 0 from below."""

@final
class Scene:
    """What does not change from frame to frame: models, maps, label ids."""
    def __new__(cls, levels: int) -> Self:
        """levels: number of semantic levels, 1..32."""
    def add_body(
        self, *, name: str, map: Map | None, map_center_lon_rad: float, reflectance: str,
        instance_id: int, part_id: int, class_ids: NDArray[np.uint16], regolith_map: Grid | None,
        air: Air | None, shape: Model | None = None, rings: Rings | None = None, cloud_map: Map |
        None = None, ground: Ground | None = None, geodetic: bool = False,
        geodetic_clouds: bool = False, dressed: bool = False, terrain: Terrain | None = None,
        cells_per_pixel: float = 1.0, finest_cell_m: float = 0.01,
        ground_labels: tuple[int, int, int] | None = None,
        crater_criteria: tuple[float, float, float] = ...,
        areas: tuple[tuple[Raster, ...], NDArray[np.int32], NDArray[np.uint16]] | None = None,
        obj_id: int = 0
    ) -> int:
        """An ellipsoid, or a shape in metres and body axes instead; returns its index. class_ids:
        (levels,). regolith_map: 27 channels, w, b, c, B_C0, h_C, B_S0, h_S, roughness in radians
        and filling factor of each band, for the photometric reflectances; its w counts where there
        is no map. cloud_map: cover of the clouds that requests give it, about longitude 0; red.
        ground: not of a body with a graph; water only with reflectance lambert. geodetic: maps
        count by geodetic latitude, not planetocentric; geodetic_clouds: so does cloud_map.
        dressed: the shape's own materials instead of map, albedo and reflectance. terrain: replaces
        the ellipsoid, whose radii must be those of the body in every frame; its mesh has
        cells_per_pixel cells along a pixel, but none smaller than finest_cell_m. ground_labels:
        level at which its rocks and craters have classes of their own, and these; None: those of
        the body. crater_criteria: pixels along a diameter, depth over that of a fresh crater and
        share that younger ones left, from which on craters are labelled. areas: of the surface,
        with parts of their own: rasters of bytes, from the lowest to the uppermost, which number
        them from 1 on (0: none, or what the raster below says); part ids (areas,); class ids
        (areas, levels). obj_id: of its object label; 0: it has none."""
    def add_object(
        self, *, name: str, model: Model, offset: F64, obj_id: int, instance_id: int, part_ids:
        NDArray[np.int32], class_ids: NDArray[np.uint16], triangle_part: NDArray[np.uint32] | None =
        None
    ) -> int:
        """A model instance; a model point p is at scale * (p - offset) in the object's frame.
        offset: (3,) model units; part_ids: (parts,); class_ids: (parts, levels); triangle_part:
        (T,) index into them, instead of the model's own parts."""
    def set_materials(
        self, object: int, graphs: tuple[Graph, ...], triangle_graph: NDArray[np.int32]) -> None:
        """Puts graphs on an object's triangles (T,), -1: the model's material, in the place of
        those that are there. Also when a Renderer uses the scene, whose accelerators stay, but not
        while it renders (ValueError)."""
    def set_body_graph(self, body: int, graph: Graph | None) -> None:
        """Puts a graph on a body, instead of, or around, the surface that map and reflectance make,
        in the place of the one that is there; when, see set_materials."""
    def articulate(self, object: int, nodes: NDArray[np.int32]) -> None:
        """Lets nodes of an object's model move; each frame then gives each a motion, in the order
        of the objects and of these nodes. Once an object."""

@final
class Renderer:
    """Renders frames of one scene; keeps its accelerators and buffers between frames."""
    def __new__(cls, scene: Scene) -> Self: ...
    def render(
        self,
        request: FrameRequest,
        out: Mapping[str, NDArray[Any]],
        threads: int = 1,
        pilot: bool = False,
    ) -> FrameResult:
        """Fills the arrays of `out`: any of CHANNELS by name, C-contiguous, exact shape and type,
        "objects": (objects,) of OBJECT_LABEL, "keypoints": (keypoints,) of KEYPOINT_LABEL,
        "part_groups": (groups,) of OBJECT_LABEL, whose pose is that of the object, and "masks":
        (objects, height, width) uint8, 1 on the full silhouette of each object inside the image, hidden parts too (the visible part is
        where "instance" is the object's). pilot: the work of the colour is counted on a part of the
        picture, for all of it; `out` may hold rgb alone, which is of no use then. Releases the GIL;
        ctrl-C cancels."""
    def trace(
        self,
        request: FrameRequest,
        source: Mapping[str, Any],
        out: Mapping[str, NDArray[Any]],
        threads: int = 1,
        instants: int = 1,
        shade: bool = False,
        band: int = 0,
    ) -> dict[str, NDArray[Any]]:
        """Traces the n rays of a source (see RAY_SOURCES), which leave within the request's
        exposure, and fills the channels of `out`, shape (1, n) or (1, n, components): those that
        need no neighbours. Returns "range_m" (n,), nan where nothing is hit, "origin_m",
        "position_m" (n, 3) in the root frame and "normal" (n, 3) at the time of each ray, and with
        `shade` "reflectance" (n,) of colour `band`. instants: at which it is decided what hides
        what."""
    def lidar(
        self,
        request: FrameRequest,
        source: Mapping[str, Any],
        lidar: Mapping[str, Any],
        threads: int = 1,
        instants: int = 1,
        band: int = 0,
    ) -> NDArray[Any]:
        """Returns of a LiDAR: an array of LIDAR_RETURN. lidar: {"keep": "all" | "first" |
        "strongest" | "last", "most": 1..8, "stream": its number, "resolution_m", "min_range_m",
        "max_range_m", "reference_m", "least_intensity", "dropout", "noise_m", "shot_noise_m",
        "gain_noise", "ambiguity_m": 0 for none}."""
    def time_of_flight(
        self,
        request: FrameRequest,
        source: Mapping[str, Any],
        camera: Mapping[str, Any],
        threads: int = 1,
        instants: int = 1,
        band: int = 0,
    ) -> NDArray[Any]:
        """Pixels of a time-of-flight camera, row by row: an array of TIME_OF_FLIGHT_PIXEL. source:
        of kind "pixels". camera: {"modulation_hz": (1..4,) whole numbers, "signal_e", "ambient_e",
        "read_e", "contrast", "full_well_e", "least_e"}."""
    def events(
        self, request: FrameRequest, camera: Mapping[str, float], threads: int = 1
    ) -> tuple[NDArray[Any], int]:
        """Events (n,) of EVENT in the request's exposure, and how many pictures were made. camera:
        {"on", "off", "mismatch", "dark", "refractory_s", "leak_hz", "noise_hz", "tolerance",
        "tolerated_pixels", "instants", "halvings"}."""
    def measure_rays(
        self, request: FrameRequest, repeats: int, /) -> dict[str, tuple[int, float, float]]:
        """For benchmarks: "primary" and "shadow" rays of a frame -> (rays, seconds in the tracer,
        seconds of Embree's packet call alone on the same rays), medians of `repeats`, 1..64."""
    def measure_frame(
        self, request: FrameRequest, out: Mapping[str, NDArray[Any]], repeats: int, /
    ) -> dict[str, tuple[int, float, float]]:
        """For benchmarks: renders a frame on one thread and casts all of its rays at meshes and
        terrain again: "closest" and "shadow" -> as of measure_rays, in packets of eight."""
    def measure_scan(
        self, request: FrameRequest, source: Mapping[str, Any], repeats: int, /
    ) -> tuple[int, float, float]:
        """The same of all rays of a source, where entities are at the middle of the exposure."""
    def plan(self, request: FrameRequest) -> FrameResult:
        """The plan of a frame without rendering it (automatic exposure is metered)."""

BODIES: dict[str, dict[str, Any]]
"""The table of constants: name -> {"gm_m3_s2", "radii_m": (a, b, c), "orientation": bool,
"geometric_albedo", "bond_albedo", "parent": str | None}. Lower-case names."""

def body_orientation(name: str, tdb_day: float, tdb_fraction: F64) -> F64:
    """Body-fixed to ICRF quaternions (n, 4) at JD(TDB) = tdb_day + tdb_fraction (n,)."""

PROPAGATORS: tuple[dict[str, str], ...]
"""The kinds of propagators: {"name", "doc"}; doc states what is modelled and its error."""

def philox(key: tuple[int, int], counter: tuple[int, int, int, int], count: int) -> NDArray[np.uint64]:
    """`count` words of Philox4x64-10, as numpy.random.Philox gives them (for tests)."""

def rim_images(
    rims: F64, camera: tuple[float, float, float, float, float], near_m: float, /
) -> NDArray[np.void]:
    """(n,) of RIM_IMAGE of rims (n, 3, 3), m: centre, major and minor semi-axis in camera axes, with
    major x minor outwards. camera: fx, fy, cx, cy, skew; near_m: distance of the plane at which rims
    are cut."""
def project(K: F64, lens: tuple[str, F64] | None, points: F64) -> F64:
    """(N, 2): pixels of (N, 3) points in camera axes; nan where there is no image."""

def unproject(K: F64, lens: tuple[str, F64] | None, pixels: F64) -> F64:
    """(N, 3): unit directions, camera axes, of (N, 2) pixels; nan where the lens has none."""

def draws(
    seed: int, keys: NDArray[np.uint64], frames: NDArray[np.uint64], normal: NDArray[np.bool_],
    counts: NDArray[np.int64], /
) -> F64:
    """counts[i] numbers of each row i, one after the other: standard normals, or uniform in [0, 1),
    as numpy.random.Generator(Philox(key=(seed, keys[i]), counter=(0, 0, 0, frames[i]))) gives."""

def allocations() -> int:
    """Allocations the core has made in this process so far; Embree's and NumPy's not counted."""

def version() -> dict[str, str]:
    """What the core was built with: embree, compiler, instruction_set (of this machine)."""
