"""From the section `camera.sensor` to the numbers that the core asks for."""

from __future__ import annotations

from functools import lru_cache
from typing import Any

import numpy as np

from perilune.config.camera import Camera
from perilune.config.sensor import SensorExposure

SUN_K = 5772.0
"""Effective temperature of the sun (IAU 2015 resolution B3)."""
_C2_NM_K = 1.438776877e7  # second radiation constant, CODATA 2018


@lru_cache(maxsize=64)
def solar_band(first_nm: float, last_nm: float) -> tuple[float, float]:
    """Share of the sun's irradiance between two wavelengths, as of a black body of SUN_K, and the
    energy-weighted mean wavelength, m: photons are energy times it over h c."""
    nm = np.linspace(first_nm, last_nm, 2001)
    spectrum = nm**-5.0 / np.expm1(_C2_NM_K / (nm * SUN_K))
    energy = float(np.trapezoid(spectrum, nm))
    total = np.pi**4 / 15.0 * (SUN_K / _C2_NM_K) ** 4
    return energy / total, float(np.trapezoid(nm * spectrum, nm)) / energy * 1e-9


def _auto_time(exposure: SensorExposure) -> dict[str, float] | None:
    if exposure.mode == "fixed":
        return None
    return {
        "percentile": exposure.percentile,
        "key": exposure.key,
        "min_s": exposure.min_ms * 1e-3,
        "max_s": exposure.max_ms * 1e-3,
        "step_s": exposure.step_ms * 1e-3,
    }


def sensor_of(camera: Camera) -> dict[str, Any] | None:
    """The core's description of a camera's sensor; None if it has none."""
    sensor = camera.sensor
    if sensor is None:
        return None
    bands = [solar_band(*band) for band in sensor.bands_nm]
    warmth = (sensor.temperature_c - sensor.dark_reference_c) / sensor.dark_doubling_k
    return {
        "f_number": sensor.f_number,
        "transmission": sensor.transmission,
        "psf": sensor.point_spread.model_dump(),
        "pixel_m": sensor.pixel_um * 1e-6,
        "mosaic": sensor.mosaic,
        "quantum_efficiency": sensor.quantum_efficiency,
        "band_share": [share for share, _ in bands],
        "wavelength_m": [wavelength for _, wavelength in bands],
        "serial": sensor.serial,
        "exposure_s": camera.exposure_time_s,
        "auto_time": _auto_time(sensor.exposure),
        "prnu": sensor.prnu,
        "dark_current": min(1e12, sensor.dark_current_e_s * 2.0 ** min(warmth, 1000.0)),
        "dark_nonuniform": sensor.dark_nonuniform,
        "vignetting": sensor.vignetting,
        "hot_pixels": sensor.hot_pixels,
        "hot_current": sensor.hot_current_e_s,
        "dead_pixels": sensor.dead_pixels,
        "shift_s": sensor.shift_us * 1e-6,
        "drain": sensor.drain,
        "ray_flux": sensor.cosmic_rays.flux_cm2_s * 1e4,
        "ray_electrons_per_m": sensor.cosmic_rays.electrons_um * 1e6,
        "ray_depth_m": sensor.cosmic_rays.depth_um * 1e-6,
        "full_well": sensor.full_well_e,
        "read_noise": sensor.read_noise_e,
        "column_noise": sensor.column_noise_e,
        "gain": sensor.gain_e_dn,
        "black_level": sensor.black_level_dn,
        "bits": sensor.bits,
    }
