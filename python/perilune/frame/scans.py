"""Sensors that trace rays of their own: from the sections of a configuration to the core."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from perilune import _core
from perilune.camera.label import CameraLabel
from perilune.config.camera import Camera
from perilune.config.errors import nearest
from perilune.config.events import Events
from perilune.config.lidar import BANDS, Flash, Lidar, Lissajous, Pattern, Raster, Rosette
from perilune.config.schema import Config
from perilune.config.time_of_flight import TimeOfFlight
from perilune.orbits import sun_position_m
from perilune.world import World

Array = NDArray[Any]
F64 = NDArray[np.float64]


def chosen(config: Config, name: str | None) -> tuple[str, Lidar]:
    """A LiDAR by name; the only one by default."""
    known = list(config.lidars)
    if name is None and len(known) == 1:
        name = known[0]
    if name is None or name not in config.lidars:
        have = f"the configuration has {', '.join(known)}" if known else "the section is empty"
        asked = "name one of `lidars`" if name is None else f"no entry of lidars is named '{name}'"
        raise ValueError(f"{asked}: {have}{nearest(name or '', known)}")
    return name, config.lidars[name]


def _angles(pattern: Any, **names: str) -> dict[str, float]:
    """Keys in degrees as the core's values in radians."""
    return {ours: math.radians(getattr(pattern, key)) for ours, key in names.items()}


def _numbers(pattern: Any, *names: str) -> dict[str, float]:
    return {name: float(getattr(pattern, name)) for name in names}


def _spec(pattern: Pattern) -> dict[str, Any]:
    """The pattern as a ray source of the core, see _core.RAY_SOURCES."""
    if isinstance(pattern, Flash):
        size = _angles(pattern, width_rad="width_deg", height_rad="height_deg")
        return {**_numbers(pattern, "columns", "rows"), **size}
    if isinstance(pattern, Raster):
        size = _angles(pattern, width_rad="width_deg", height_rad="height_deg")
        return {**_numbers(pattern, "columns", "rows", "rate_hz"), **size}
    if isinstance(pattern, Lissajous):
        size = _angles(
            pattern, width_rad="width_deg", height_rad="height_deg", phase_rad="phase_deg"
        )
        return {**_numbers(pattern, "pulses", "x_hz", "y_hz", "rate_hz"), **size}
    if isinstance(pattern, Rosette):
        turns = _numbers(pattern, "pulses", "first_hz", "second_hz", "rate_hz")
        return {**turns, **_angles(pattern, first_rad="first_deg", second_rad="second_deg")}
    return {
        **_numbers(pattern, "steps", "rate_hz"),
        **_angles(pattern, from_rad="from_deg", to_rad="to_deg"),
        "elevations_rad": np.radians(pattern.elevations_deg),
    }


def source_of(lidar: Lidar) -> dict[str, Any]:
    """The ray source of a LiDAR."""
    return {
        "kind": lidar.pattern.kind,
        **_spec(lidar.pattern),
        "sub_rays": lidar.sub_rays,
        "divergence_rad": math.radians(lidar.divergence_deg),
        "aperture_m": lidar.aperture_m,
    }


def pixels(sub_rays: int = 1) -> dict[str, Any]:
    """The rays of a camera's pixels."""
    return {"kind": "pixels", "sub_rays": sub_rays, "divergence_rad": 0.0, "aperture_m": 0.0}


def given(rays: Any) -> dict[str, Any]:
    """Rays one by one: (n, 6), origin and direction, or (n, 7) with a time."""
    rows = np.asarray(rays, dtype=np.float64)
    if rows.ndim != 2 or rows.shape[1] not in (6, 7):
        raise ValueError(f"rays: must be (n, 6) or (n, 7), not {rows.shape}")
    if rows.shape[1] == 6:
        rows = np.column_stack([rows, np.zeros(len(rows))])
    if not (np.isfinite(rows).all() and (rows[:, 6] >= 0.0).all()):
        raise ValueError("rays: must be finite, and times at least 0")
    if len(rows) and not (np.linalg.norm(rows[:, 3:6], axis=1) > 0.0).all():
        raise ValueError("rays: a direction must not be zero")
    return {
        "kind": "given",
        "rays": rows,
        "sub_rays": 1,
        "divergence_rad": 0.0,
        "aperture_m": 0.0,
    }


def receiver_of(lidar: Lidar, stream: int) -> dict[str, Any]:
    """What the core needs of a LiDAR beside its rays. stream: its number among all."""
    return {
        "keep": lidar.returns,
        "most": lidar.max_returns,
        "stream": stream,
        "resolution_m": lidar.range_resolution_m,
        "min_range_m": lidar.range_m[0],
        "max_range_m": lidar.range_m[1],
        "reference_m": lidar.reference_range_m,
        "least_intensity": lidar.min_intensity,
        "dropout": lidar.dropout,
        "noise_m": lidar.range_noise_m,
        "shot_noise_m": lidar.shot_noise_m,
        "gain_noise": lidar.intensity_noise,
        "ambiguity_m": lidar.unambiguous_range_m or 0.0,
    }


def flight_of(camera: TimeOfFlight) -> dict[str, Any]:
    """What the core needs of a time-of-flight camera beside its rays."""
    return {
        "modulation_hz": np.array(camera.modulation_hz, dtype=np.float64),
        "signal_e": camera.signal_e,
        "ambient_e": camera.ambient_e,
        "read_e": camera.read_noise_e,
        "contrast": camera.contrast,
        "full_well_e": camera.full_well_e,
        "least_e": camera.min_amplitude_e,
    }


def events_of(camera: Events) -> dict[str, Any]:
    """What the core needs of an event camera."""
    return {
        "on": camera.on_threshold,
        "off": camera.off_threshold,
        "mismatch": camera.mismatch,
        "dark": camera.dark_radiance_w_m2_sr,
        "refractory_s": 1e-6 * camera.refractory_us,
        "leak_hz": camera.leak_hz,
        "noise_hz": camera.noise_hz,
        "tolerance": camera.tolerance,
        "tolerated_pixels": camera.tolerated_pixels,
        "instants": camera.instants,
        "halvings": camera.max_halvings,
    }


def band_of(name: str) -> int:
    """Index of a colour."""
    return BANDS.index(name)


def during(world: World, camera: Camera, window_s: float) -> World:
    """The world of a frame's step for another time: from the opening of the shutter on.

    camera: the section of the camera; its lens stays, its shutter is global."""
    own = camera.model_copy(update={"exposure_time_s": window_s, "line_time_us": 0.0})
    states = world.system.states(np.array([world.t_s, world.t_s + window_s]))
    return replace(
        world,
        config=world.config.model_copy(update={"camera": own}),
        poses=states.poses,
        velocities_m_s=states.velocities_m_s,
        sun_position_m=sun_position_m(world.config, world.epoch, world.t_s + 0.5 * window_s),
        window_s=window_s,
        longest=None,
    )


def _layout(record: Sequence[tuple[Any, ...]], levels: int | None) -> np.dtype[Any]:
    """The core's record without what only fills it; `levels`: number of levels of `semantic`."""
    whole = np.dtype(list(record))
    names = [field for field in whole.names or () if field != "unused"]
    formats: list[Any] = [whole[field] for field in names]
    assert whole.fields is not None
    offsets = [whole.fields[field][1] for field in names]
    if levels is not None:
        formats[names.index("semantic")] = (np.uint16, (levels,))
    return np.dtype(
        {"names": names, "formats": formats, "offsets": offsets, "itemsize": whole.itemsize}
    )


def lidar_dtype(levels: int) -> np.dtype[Any]:
    """dtype of a LiDAR's returns."""
    return _layout(_core.LIDAR_RETURN, levels)


def flight_dtype() -> np.dtype[Any]:
    """dtype of the pixels of a time-of-flight camera."""
    return _layout(_core.TIME_OF_FLIGHT_PIXEL, None)


def event_dtype() -> np.dtype[Any]:
    """dtype of events."""
    return _layout(_core.EVENT, None)


POINT_CHANNELS = ("range", "position", "normal", "semantic", "part", "instance")


def _turns(rows: Sequence[Mapping[str, Any]], height: int) -> F64:
    """(height, 3, 3): rotations from root to camera axes of all rows, from those of some, which
    are near each other."""
    known = [row["row"] for row in rows]
    matrices = np.stack([row["R_w2c"] for row in rows]).reshape(len(rows), 9)
    every = np.arange(height)
    columns = [np.interp(every, known, matrices[:, k]) for k in range(9)]
    return np.stack(columns, axis=1).reshape(height, 3, 3)


def points_of(
    channels: Mapping[str, Array],
    camera: CameraLabel,
    levels: int,
    shutter: Sequence[Mapping[str, Any]] = (),
) -> Array:
    """The surface points of a frame: a structured array with a row per pixel that hits something.

    channels: POINT_CHANNELS, and `rgb` if it was rendered. shutter: Sample.meta["rows"]. With a
    rolling shutter, points lie in the axes that the camera has at the time of their own row."""
    seen = channels["range"] > 0.0
    rows, columns = np.nonzero(seen)
    fields: list[Any] = [
        ("u", np.int32),
        ("v", np.int32),
        ("camera_m", np.float64, (3,)),
        ("position_m", np.float64, (3,)),
        ("normal", np.float32, (3,)),
        ("range_m", np.float32),
        ("instance", np.int32),
        ("part", np.int32),
        ("semantic", np.uint16, (levels,)),
    ]
    colour = "rgb" in channels
    out = np.empty(len(rows), np.dtype([*fields, ("rgb", np.uint8, (3,))] if colour else fields))
    out["u"], out["v"] = columns, rows
    out["position_m"] = channels["position"][seen]
    out["range_m"] = channels["range"][seen]
    normal = channels["normal"][seen]
    if shutter:
        pixels = np.stack([columns, rows], axis=1).astype(np.float64)
        directions = _core.unproject(camera.K, camera.lens, pixels)
        out["camera_m"] = out["range_m"][:, None] * directions
        turned = np.einsum("ni,nij->nj", normal, _turns(shutter, len(seen))[rows])
        out["normal"] = turned / np.linalg.norm(turned, axis=1, keepdims=True)
    else:
        out["camera_m"] = out["position_m"] @ camera.R_w2c.T + camera.t_w2c
        out["normal"] = normal @ camera.R_w2c.astype(np.float32)
    for name in ("instance", "part", "semantic", *(("rgb",) if colour else ())):
        out[name] = channels[name][seen]
    return out
