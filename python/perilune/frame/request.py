"""From the world of a frame to the core's input, and the arrays that it fills."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import lru_cache
from pathlib import Path
from statistics import NormalDist
from typing import Any, NamedTuple, get_args

import numpy as np
from numpy.typing import NDArray

from perilune import _core
from perilune.base import rotations
from perilune.base.same import Same
from perilune.bodies import clouds, ground, photometry
from perilune.camera import bands
from perilune.camera.imaging import intrinsics, sensor_of
from perilune.camera.label import CameraLabel
from perilune.camera.optics import focus_of, lens_of
from perilune.config import Config
from perilune.config.camera import Exposure
from perilune.config.errors import nearest
from perilune.config.labels import GroundLabels
from perilune.config.render import Render, TextureFilter
from perilune.document.references import MASKS, OBJECTS
from perilune.frame.pool import Pool
from perilune.frame.shutter import Keys
from perilune.world import World

F64 = NDArray[np.float64]
Array = NDArray[Any]


class _Surfaces(NamedTuple):
    """What the request says of bodies, and no time changes."""

    radii: F64
    albedo: F64
    contrast: F64
    emission: F64
    regolith: F64
    ground: F64


_surfaces: Same[_Surfaces] = Same(8)


class _Lasting(NamedTuple):
    """Parts of the request that depend on a few sections alone, which seldom change."""

    quality: _core.Quality
    exposure: _core.Exposure
    wavelengths: F64
    bands: F64
    ground_labels: dict[str, Any]
    coverage: dict[str, int]


_lasting: Same[_Lasting] = Same(8)


def _lasting_of(config: Config) -> _Lasting:
    def make() -> _Lasting:
        coverage = config.labels.coverage
        wavelengths = np.array(bands.wavelengths_um(config.camera, config.sun))
        parts = bands.matrix(config.camera, config.sun)
        wavelengths.flags.writeable = parts.flags.writeable = False
        return _Lasting(
            _quality(config.render),
            _exposure(config.camera.exposure),
            wavelengths,
            parts,
            _ground_labels(config.labels.ground),
            {"samples": coverage.samples, "layers": coverage.layers},
        )

    read = (config.render, config.camera.exposure, config.camera.bands, config.camera.sensor)
    return _lasting.of((*read, config.sun, config.labels), make)


def _surfaces_of(scene: World) -> _Surfaces:
    """Arrays that nobody may change: frames share them as long as no driver changes a body."""

    def make() -> _Surfaces:
        config = scene.config
        found = _Surfaces(
            _stacked([scene.body_radii_m[name] for name in config.bodies], (3,)),
            _albedos(scene),
            np.array([body.albedo_contrast for body in config.bodies.values()]),
            np.array([body.emission_w_m2_sr for body in config.bodies.values()]),
            photometry.regolith(config),
            ground.numbers(config),
        )
        for array in found:
            array.flags.writeable = False
        return found

    return _surfaces.of((scene.config.bodies, *scene.shapes.values()), make)


def _albedos(scene: World) -> F64:
    rows = []
    for name, body in scene.config.bodies.items():
        shape = scene.shapes.get(name)
        if body.albedo is not None:
            rows.append(body.albedo)
        elif body.may_be_dressed and shape is not None and shape.color is not None:
            rows.append(shape.color)  # to what is lit by it; its own surface is the file's
        elif body.color_map is not None or body.is_replaced or body.has_parameter_maps:
            rows.append((1.0, 1.0, 1.0))
        else:
            rows.append((float(_core.BODIES[body.kind]["bond_albedo"]),) * 3)
    return np.array(rows, dtype=np.float64)


def request_of(
    scene: World,
    camera_poses: F64,
    scales: Mapping[str, float],
    movers: F64,
    keys: Keys | None,
    path: Callable[[str, str], Path],
) -> _core.FrameRequest:
    """The core's input for a frame.

    camera_poses: (2, 7), camera to root, at opening and closing. scales: metres per model unit of
    each spacecraft. movers: (nodes, 3, 4), motions of all moving nodes in the middle of the
    exposure. keys: poses within the exposure. path: resolves a path of the configuration; takes the
    key for errors."""
    config = scene.config
    K = intrinsics(config.camera)
    surfaces, lasting = _surfaces_of(scene), _lasting_of(config)
    where = config.place(scene.sensor, "sensor")
    sensor = sensor_of(config.camera, path, config.sun.spectrum, where)
    return {
        "seed": config.seed,
        "index": scene.index,
        "width": config.camera.width,
        "height": config.camera.height,
        "K": K,
        "lens": lens_of(config.camera),
        "focus": focus_of(config.camera, K, sensor),
        "camera_pose": camera_poses,
        "object_poses": _stacked([scene.poses[name] for name in config.spacecraft], (2, 7)),
        "object_movers": movers,
        "object_scale": np.array([scales[name] for name in config.spacecraft], dtype=np.float64),
        "body_poses": _stacked([scene.poses[name] for name in config.bodies], (2, 7)),
        "motion": _motion(config, keys),
        "body_radii": surfaces.radii,
        "body_albedo": surfaces.albedo,
        "body_contrast": surfaces.contrast,
        "body_emission": surfaces.emission,
        "body_regolith": surfaces.regolith,
        "body_clouds": clouds.rows(config, scene.t_s + 0.5 * scene.window_s),
        "body_ground": surfaces.ground,
        "sun_position": scene.sun_position_m,
        "sun_radius": config.sun.radius_km * 1e3,
        "sun_irradiance": config.sun.irradiance_w_m2,
        "sun_wavelengths": lasting.wavelengths,
        "quality": lasting.quality.copy(),
        "exposure": lasting.exposure.copy(),
        "sensor": sensor,
        "bands": lasting.bands,
        "ground_labels": lasting.ground_labels,
        "coverage_labels": lasting.coverage,
        "amodal": config.render.amodal,
    }


@lru_cache(maxsize=16)
def sigmas(confidence: float) -> float:
    """Standard errors to both sides of a mean within which it lies with this probability."""
    return NormalDist().inv_cdf(0.5 * (1.0 + confidence))


def _quality(render: Render) -> _core.Quality:
    return {
        "samples": render.samples,
        "max_bounces": render.max_bounces,
        "volume_steps": render.volume_steps,
        "texture_filter": 1 + get_args(TextureFilter).index(render.texture_filter),
        "tolerance_dn": render.tolerance_dn,
        "target_dn": render.target_error_dn or 0.0,
        "target_sigmas": sigmas(render.target_confidence),
        "force_on": list(render.force_on),
        "force_off": list(render.force_off),
    }


def _exposure(exposure: Exposure) -> _core.Exposure:
    return {
        "mode": exposure.mode,
        "white_radiance": exposure.white_radiance_w_m2_sr or 1.0,  # unused in mode auto
        "percentile": exposure.percentile,
        "key": exposure.key,
        "min_white_radiance": exposure.min_white_radiance_w_m2_sr,
    }


def _ground_labels(ground: GroundLabels) -> dict[str, Any]:
    limits = ground.hazard
    return {
        "baselines_m": np.array(ground.baseline_m),
        "points": ground.points,
        "hazard": (
            limits.footprint_m,
            np.radians(limits.max_slope_deg),
            limits.max_roughness_m,
            limits.max_rock_height_m,
        ),
    }


def _motion(config: Config, keys: Keys | None) -> dict[str, Any] | None:
    """All motion while the shutter is open, in the core's form; None without an exposure time."""
    if keys is None:
        return None
    camera, shape = config.camera, (keys.count, 7)
    return {
        "times": (camera.exposure_time_s, 1e-6 * camera.line_time_us, keys.held),
        "camera": keys.camera,
        "objects": _stacked([keys.entities[name] for name in config.spacecraft], shape),
        "bodies": _stacked([keys.entities[name] for name in config.bodies], shape),
        "sun": keys.sun_m,
        "movers": keys.movers,
    }


def _stacked(rows: list[F64], shape: tuple[int, ...]) -> F64:
    return np.stack(rows) if rows else np.empty((0, *shape))


@lru_cache(maxsize=1)
def object_dtype() -> np.dtype[Any]:
    """dtype of a row of `Sample.objects`."""
    return np.dtype(list(_core.OBJECT_LABEL))


def _component_counts(config: Config) -> dict[int, Callable[[], int]]:
    """What the core's negative numbers of components stand for."""
    return {
        -1: lambda: len(config.labels.levels),
        -2: lambda: bands.count(config.camera),
        -3: lambda: len(config.labels.ground.baseline_m),
        -4: lambda: config.labels.coverage.layers,
    }


@lru_cache(maxsize=1)
def _channels() -> dict[str, tuple[int, np.dtype[Any]]]:
    """Channel -> number of components and dtype."""
    return {row["name"]: (row["components"], np.dtype(row["dtype"])) for row in _core.CHANNELS}


def channel_layout(config: Config, name: str) -> tuple[tuple[int, ...], np.dtype[Any]]:
    """Shape and dtype of a channel's array."""
    if name == OBJECTS:
        return (len(config.objects),), object_dtype()
    if name == MASKS:
        size = (config.camera.height, config.camera.width)
        return (len(config.objects), *size), np.dtype(np.uint8)
    count, dtype = _channels()[name]
    if name == "raw" and bands.has_planes(config.camera):
        count = bands.count(config.camera)
    if count < 0:
        count = _component_counts(config)[count]()
    tail = () if count == 0 else (count,)
    return (config.camera.height, config.camera.width, *tail), dtype


def arrays_of(
    config: Config, names: Sequence[str], out: Mapping[str, Array], pool: Pool
) -> dict[str, Array]:
    """An array for each channel: that of `out` if given, else one of the pool.

    ValueError for an array of `out` with another shape or dtype."""
    arrays: dict[str, Array] = {}
    for name, value in out.items():
        if name not in names:
            near = nearest(name, names)
            raise ValueError(f"out: '{name}' is not among the channels asked for{near}")
        if not isinstance(value, np.ndarray):
            raise TypeError(f"out['{name}']: must be a NumPy array, not {type(value).__name__}")
    for name in names:
        shape, dtype = channel_layout(config, name)
        given = out.get(name)
        if given is None:
            arrays[name] = pool.take(name, shape, dtype)
        elif given.shape != shape or given.dtype != dtype or not given.flags.c_contiguous:
            raise ValueError(
                f"out['{name}']: must be a C-contiguous {dtype} array of shape {shape}, "
                f"not {given.dtype} {given.shape}"
            )
        else:
            arrays[name] = given
    return arrays


def camera_label(request: Mapping[str, Any], sensor: str | None, bent: bool) -> CameraLabel:
    """The camera in the middle of the exposure.

    request: the core's input. bent: the labels include the lens's distortion."""
    opening, closing = request["camera_pose"]
    center, q = 0.5 * (opening[:3] + closing[:3]), rotations.middle(opening[3:], closing[3:])
    motion = request["motion"]
    if motion is not None:
        middle = motion["camera"][len(motion["camera"]) // 2]
        center, q = middle[:3], middle[3:]
    R_w2c = rotations.to_matrix(q).T
    size = request["width"], request["height"]
    lens = request["lens"] if bent else None
    return CameraLabel(request["K"], *size, R_w2c, -R_w2c @ center, sensor, lens)
