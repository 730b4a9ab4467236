"""Mappings that the C core takes and gives: `perilune._core` has their names, for type checkers."""

from collections.abc import Mapping, Sequence
from typing import Any, NotRequired, TypedDict

import numpy as np
from numpy.typing import NDArray

from perilune._core import Map

F64 = NDArray[np.float64]

class Channel(TypedDict):
    name: str
    dtype: str  # NumPy type string, e.g. "float32"
    components: int  # 0: (H, W); n: (H, W, n); -1: (H, W, levels); -2: (H, W, bands)
    unit: str
    doc: str
    colour: bool  # light, rather than a label

class AirSettings(TypedDict):
    """Of three colour bands where there are three; heights above the surface."""
    rayleigh_scattering: Sequence[float]  # at the surface, 1/m
    rayleigh_height_m: float  # scale height
    rayleigh_upper_m: Sequence[float]  # above the first, the scale height is the second; 0, 0: none
    mie_scattering: Sequence[float]
    mie_extinction: Sequence[float]
    mie_height_m: float
    mie_upper_m: Sequence[float]
    mie_g: Sequence[float]
    ozone_absorption: Sequence[float]  # in the middle of the layer, 1/m
    ozone_center_m: float
    ozone_width_m: float
    top_m: float
    ground_albedo: Sequence[float]
    multiple: bool

class Socket(TypedDict):
    name: str
    type: str  # "scalar" | "vector" | "color"
    default: tuple[float, float, float]
    doc: str

class Constant(TypedDict):
    name: str
    type: str  # "number" | "choice" | "numbers" | "image"
    default: float  # of a choice its index
    low: float
    high: float
    choices: tuple[str, ...]
    columns: int  # of a row of "numbers"
    doc: str

class NodeKind(TypedDict):
    doc: str
    inputs: tuple[Socket, ...]
    outputs: tuple[Socket, ...]
    constants: tuple[Constant, ...]
    surface: bool  # its inputs are what a graph gives
    own: bool  # gives what the own material of the entity it is on does

class LensModel(TypedDict):
    doc: str
    coefficients: tuple[str, ...]  # their names, in OpenCV's order

class Ground(TypedDict, total=False):
    heights: Map | None  # black to white: body_ground's height
    normals: Map | None  # x east, y north, z up
    south: bool  # green of the normals grows southwards
    ocean: bool  # there is open water ...
    water: Map | None  # ... of this part; None: everywhere
    lights: Map | None  # of the night

class Quality(TypedDict):
    samples: int  # colour samples a pixel, 1..65536
    max_bounces: int  # 0..64
    texture_filter: int  # ceiling, 1..7, see the row of that name
    volume_steps: NotRequired[int]  # ceiling, 1..4096; with volumes
    target_dn: NotRequired[float]  # error of a pixel that samples are taken for; 0: none is stated
    target_sigmas: NotRequired[float]  # standard errors that it is to be
    tolerance_dn: float  # an effect whose bound is below this is left out; 0 keeps all that apply
    force_on: Sequence[str]  # effects kept whatever their bound
    force_off: Sequence[str]  # effects left out whatever their bound

class Exposure(TypedDict):
    mode: str  # "fixed" | "auto"
    white_radiance: float  # W m-2 sr-1 shown as 255 (fixed)
    percentile: float  # auto: this percentile of the lit pixels ...
    key: float  # auto: ... is shown at this fraction of white (linear)
    # auto: white is this at least, or a sunlit white surface; default 0, W m-2 sr-1
    min_white_radiance: NotRequired[float]

class CloudSettings(TypedDict):
    """See perilune.config.clouds."""

    altitude_m: float
    thickness_m: float
    turn_rad: float  # of the shell eastwards against the body
    opacity: float
    depth: float  # optical
    color: Sequence[float]  # three
    coverage: float  # 1: no noise
    softness: float
    octaves: float
    roughness: float
    size_m: float
    warp: float
    phase: float
    depth_spread: float
    relief_m: float
    seed: int

class FrameRequest(TypedDict):
    seed: int
    index: int
    width: int
    height: int
    K: F64  # (3, 3), pixels, integer pixel centres
    lens: NotRequired[tuple[str, F64] | None]  # model and coefficients, see LENSES
    # Diameter of the lens and depth in focus (inf: infinity), m; None: a pinhole.
    focus: NotRequired[tuple[float, float] | None]
    camera_pose: F64  # (2, 7): camera to root at shutter opening and closing
    # What moves while the shutter is open; None: nothing. "times": exposure in s, time from row to
    # row in s, whether keys hold to halfway to the next. Keys, an odd number K evenly from the
    # first row's opening to the last row's closing, replace all poses: "camera" (K, 7), "objects"
    # (objects, K, 7), "bodies" (bodies, K, 7), "sun" (K, 3), "movers" (K, nodes, 3, 4). Without
    # "camera" entities move straight from their first pose to their second.
    motion: NotRequired[Mapping[str, Any] | None]
    object_poses: F64  # (objects, 2, 7)
    object_scale: F64  # (objects,), metres per model unit
    object_movers: NotRequired[F64]  # (all moving nodes, 3, 4): see Articulation.pose
    graph_parameters: NotRequired[F64]  # (all of all graphs, 3): by object, then by body
    body_poses: F64  # (bodies, 2, 7)
    body_radii: F64  # (bodies, 3), m
    body_albedo: F64  # (bodies, 3), linear factor on the map (or the colour itself without one)
    body_contrast: NotRequired[F64]  # (bodies,), of the maps of albedo about their mean; 1: theirs
    body_emission: F64  # (bodies, 3), W m-2 sr-1
    # (bodies, 27) for photometric reflectances: b, c, B_C0, h_C, B_S0, h_S, roughness in radians,
    # filling factor of each band (nan: the map's, or 0), Minnaert's k, 1 for the H function of 1981
    # instead of 2002, 1 for the coherent surge's shape of 2012 instead of 2002.
    body_regolith: NotRequired[F64]
    body_clouds: NotRequired[Sequence[CloudSettings | None]]  # one a body; None: no clouds
    # (bodies, 10), of the ground: height of white over black in m, factor on the slopes of normals,
    # wind over the water in m/s, albedo of water (3; nan: the map's), radiance of the lights where
    # their map is white (3) in W m-2 sr-1, cells in m that break that map up (0: it is as it is; nan:
    # a texel of it).
    body_ground: NotRequired[F64]
    sun_position: F64  # (3,), m, root frame
    sun_radius: float  # m
    sun_irradiance: float  # W m-2 at 1 AU, in every colour band
    sun_wavelengths: NotRequired[F64]  # (3,), um, of the bands: limb darkening
    quality: Quality
    exposure: Exposure
    sky: NotRequired[Mapping[str, Any] | None]  # see perilune.sky.skies.Skies.request
    volumes: NotRequired[Sequence[Mapping[str, Any]] | None]  # see perilune.frame.volumes.Volumes
    sensor: NotRequired[Mapping[str, Any] | None]  # see perilune.camera.imaging.sensor_of
    # (bands, 3): part of the sun's irradiance that each gathers of red, green and blue reflectances
    bands: NotRequired[F64]
    # Of channels of the ground: {"baselines_m": (n,), at most 8; "points" of a disc, 8 to 256;
    # "hazard": footprint in m, and the greatest slope in rad, RMS height in m and rock in m}
    ground_labels: NotRequired[Mapping[str, Any] | None]
    # Of the channels of coverage: {"samples": rays a pixel, 1 to 1024; "layers": 1 to 16}
    coverage_labels: NotRequired[Mapping[str, int] | None]
    # Of channels of motion: the requests of other frames, of which only what is placed counts; None:
    # there is no such frame.
    next: NotRequired[FrameRequest | None]
    previous: NotRequired[FrameRequest | None]
    # (bodies,), in another frame: whether a body's shape or terrain differs from this one's
    changed_bodies: NotRequired[NDArray[np.bool_]]
    # (keypoints, 6): object, or number of objects + body; 1 + moving node of the object, or 0; place
    # at rest in the owner's axes, m; how far its own surface may lie before it, m
    keypoints: NotRequired[F64 | None]
    # Groups of parts with a label: the object (groups,) of each, and a flag for each of its parts,
    # one group after the other
    part_groups: NotRequired[tuple[NDArray[np.int32], NDArray[np.uint8]] | None]
    amodal: NotRequired[bool]  # whether objects get the labels of their full silhouettes (True)

class PlanRow(TypedDict):
    name: str
    on: bool
    reason: str
    bound_dn: float  # of leaving it out
    residual_dn: float  # of keeping it at `value` rather than at the limit of all
    spent_dn: float  # what `value` takes of the tolerance
    cost_ms: float
    value: int  # 0: off; 1: on; more where it has a count (samples, bounces)
    ceiling: int  # the largest useful value; 0: the effect cannot matter in the frame
    # By Simulation.plan(index, measure=True): CPU time that the effect takes as planned, or would
    # take; RMS and 99.9th percentile of what it changes, over pixels and bands
    measured_ms: NotRequired[float]
    measured_dn: NotRequired[float]
    measured_p999_dn: NotRequired[float]

class SeenStars(TypedDict):
    number: NDArray[np.int64]  # (n,), the brightest first
    pixel: F64  # (n, 2)
    magnitude: NDArray[np.float32]  # (n,)

class GroundUse(TypedDict):
    tiles: int  # of terrain, in the middle of the frame
    kept_bytes: int  # of tiles that are kept between frames
    widened: float  # factor by which cells are wider than asked, for the limit of tiles; 1: none
    widened_body: str | None  # the body whose cells are
    missed_body: str | None  # a body that states a patch of which the camera sees none

class FrameResult(TypedDict):
    white_radiance: float  # nan: automatic, and no colour was asked for
    exposure_s: float  # of the sensor; nan: none of its channels was asked for
    gain_e_dn: float  # likewise
    plan: list[PlanRow]
    timings_s: dict[str, float]
    stars: SeenStars  # that the colours show
    work: dict[str, int]  # what was done, by names of COSTS; zeros for plans
    missed: int  # pixels that all samples did not bring to the target
    aimed: bool  # whether pixels got samples by their error: a target, and neither motion nor lens
    ground: GroundUse  # zeros without terrain, and for plans

class BandLight(TypedDict):
    part: tuple[float, float, float]  # of the sun's irradiance, by red, green and blue
    moment_um: tuple[float, float, float]  # integrals of the same times the wavelength
    mean_um: float  # wavelength of what is gathered of white, by energy; 0: nothing is
