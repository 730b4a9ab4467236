"""From the section `camera.sensor` to the numbers of the core."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from perilune.camera import filters, measured
from perilune.config.bands import Spectrum
from perilune.config.camera import Camera
from perilune.config.lens_flare import LensFlare
from perilune.config.schema import Config
from perilune.config.sensor import Compression, ImageSensor, SensorExposure

F64 = NDArray[np.float64]
F_NUMBER = 4.0
"""F-number of a lens if neither f_number nor aperture_mm is given."""


def _auto_time(exposure: SensorExposure) -> dict[str, Any] | None:
    if exposure.mode == "fixed":
        return None
    low, high = exposure.min_ms, exposure.max_ms
    times = [t * 1e-3 for t in exposure.times_ms or () if low <= t <= high]
    return {
        "metering": exposure.metering,
        "percentile": exposure.percentile,
        "window": exposure.window,
        "saturated": exposure.saturated,
        "times_s": times,
        "gains": exposure.gains,
        "key": exposure.key,
        "min_s": exposure.min_ms * 1e-3,
        "max_s": exposure.max_ms * 1e-3,
        "step_s": exposure.step_ms * 1e-3,
    }


def _lens_flare(flare: LensFlare | None) -> dict[str, Any] | None:
    if flare is None:
        return None
    rows = [(g.scale, math.radians(g.radius_deg), *g.intensity) for g in flare.ghosts]
    return {"ghosts": np.array(rows), "baffle_rad": np.radians(flare.baffle_deg)}


def _compression(compression: Compression | None) -> dict[str, Any] | None:
    if compression is None:
        return None
    return {"quality": round(compression.quality), "chroma": compression.chroma}


def intrinsics(camera: Camera) -> F64:
    """K (3, 3) with integer pixel centres: a centred camera has cx = (width - 1) / 2."""
    if camera.K is not None:
        return np.array(camera.K).reshape(3, 3)
    focal = camera.focal_px
    cx, cy = 0.5 * (camera.width - 1), 0.5 * (camera.height - 1)
    if focal is None and camera.is_panorama:  # all directions
        fx, fy = camera.width / (2.0 * math.pi), camera.height / math.pi
        return np.array([[fx, 0.0, cx], [0.0, fy, cy], [0.0, 0.0, 1.0]])
    if focal is None:
        assert camera.fov_deg is not None  # the schema asks for one of the three
        focal = 0.5 * camera.width / math.tan(0.5 * math.radians(camera.fov_deg))
    return np.array([[focal, 0.0, cx], [0.0, focal, cy], [0.0, 0.0, 1.0]])


def f_number(camera: Camera) -> float:
    """F-number of a camera's sensor, from its aperture if given; ValueError for an impossible
    lens."""
    sensor = camera.sensor
    assert sensor is not None
    if sensor.aperture_mm is None:
        return F_NUMBER if sensor.f_number is None else sensor.f_number
    K = intrinsics(camera)
    focal_mm = math.sqrt(K[0, 0] * K[1, 1]) * sensor.pixel_um * 1e-3
    number = focal_mm / sensor.aperture_mm
    if not 0.5 <= number <= 1e6:
        raise ValueError(
            f"aperture_mm = {sensor.aperture_mm:g}: with the focal length of "
            f"{focal_mm:g} mm (focal length in pixels times pixel_um) the lens is f/{number:g}; "
            "allowed: f/0.5 to f/1e6"
        )
    return number


def check(config: Config) -> Iterator[tuple[str, str]]:
    """Key and message for each sensor with an impossible aperture."""
    for name, camera in config.cameras.items():
        if camera.sensor is not None:
            try:
                f_number(camera)
            except ValueError as error:
                key, _, complaint = str(error).partition(": ")
                yield f"{config.place(name, 'sensor')}.{key}", complaint


def sensor_of(
    camera: Camera,
    path: Callable[[str, str], Path] = lambda text, _: Path(text),
    spectrum: Spectrum | None = None,
    where: str = "camera.sensor",
) -> dict[str, Any] | None:
    """The core's description of a camera's sensor; None without a sensor.

    path: resolves a path of the configuration; its second argument is the key. where: key path of
    the section."""
    sensor = camera.sensor
    if sensor is None:
        return None
    shaded = sensor.vignetting_profile is not None or sensor.flat_field is not None
    profile = [(math.radians(angle), part) for angle, part in sensor.vignetting_profile or ()]
    flat, kernel = sensor.flat_field, sensor.point_spread.kernel
    return {
        "f_number": f_number(camera),
        "plane_pupil": sensor.pupil == "plane",
        "transmission": sensor.transmission,
        "psf": sensor.point_spread.model_dump(exclude={"kernel"}),
        "kernel": measured.kernel(path(kernel, f"{where}.point_spread.kernel")) if kernel else None,
        "lens_flare": _lens_flare(sensor.lens_flare),
        "pixel_m": sensor.pixel_um * 1e-6,
        "mosaic": "mono" if sensor.mosaic == "planes" else sensor.mosaic,
        "quantum_efficiency": (1.0, 1.0, 1.0),
        **filters.described(camera, spectrum),
        "exposure_s": camera.exposure_time_s,
        "auto_time": _auto_time(sensor.exposure),
        "vignetting": (0.0 if shaded else 4.0) if sensor.vignetting is None else sensor.vignetting,
        "vignetting_profile": np.array(profile) if profile else None,
        "flat_field": measured.flat_field(path(flat, f"{where}.flat_field")) if flat else None,
        **_pixels(sensor),
        **_electronics(sensor),
        "compression": _compression(sensor.compression),
    }


def _pixels(sensor: ImageSensor) -> dict[str, Any]:
    """Sources of charge other than light."""
    warmth = (sensor.temperature_c - sensor.dark_reference_c) / sensor.dark_doubling_k
    rays = sensor.cosmic_rays
    return {
        "serial": sensor.serial,
        "prnu": sensor.prnu,
        "dark_current": min(1e12, sensor.dark_current_e_s * 2.0 ** min(warmth, 1000.0)),
        "dark_nonuniform": sensor.dark_nonuniform,
        "hot_pixels": sensor.hot_pixels,
        "hot_current": sensor.hot_current_e_s,
        "dead_pixels": sensor.dead_pixels,
        "ray_flux": rays.flux_cm2_s * 1e4,
        "ray_electrons_per_m": rays.electrons_um * 1e6,
        "ray_depth_m": rays.depth_um * 1e-6,
        "full_well": sensor.full_well_e,
        "drain": sensor.drain,
    }


def _electronics(sensor: ImageSensor) -> dict[str, Any]:
    """Parameters from charge to digital numbers."""
    return {
        "shift_s": sensor.shift_us * 1e-6,
        "reset_s": sensor.reset_us * 1e-6,
        "read_noise": sensor.read_noise_e,
        "column_noise": sensor.column_noise_e,
        "column_flicker": sensor.column_flicker_e,
        "row_noise": sensor.row_noise_e,
        "gain": sensor.gain_e_dn,
        "black_level": sensor.black_level_dn,
        "bits": sensor.bits,
    }
