"""Atmospheres: what the presets hold, and the core's settings of a configuration."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from perilune import _core, orbits
from perilune.config.atmosphere import Atmosphere
from perilune.config.body import Body
from perilune.config.schema import Config

F64 = NDArray[np.float64]
_Bands = tuple[float, float, float]

_OZONE_UM = np.arange(0.40, 0.801, 0.02)
_OZONE_M2 = 1e-27 * np.array(
    [
        *(1.527, 5.52, 15.82, 36.69, 77.52, 148.0, 213.9, 309.1, 426.6, 439.8, 501.9),
        *(374.0, 266.2, 185.2, 120.9, 74.55, 51.05, 42.28, 24.51, 25.34, 14.65),
    ]
)
"""Cross-section of a molecule of ozone, at 293 K (Serdyuchenko et al. 2014, Atmospheric Measurement
Techniques 7, 625), as rounded in Bruneton (2017), A Precomputed Atmospheric Scattering
Implementation."""
_OZONE_PER_M3 = 5.374e18
"""In the middle of the layer: 300 Dobson units in a tent of 15 km to each side."""


@dataclass(frozen=True)
class _Preset:
    """1/m at the surface for the wavelengths of three bands."""

    rayleigh: _Bands = (0.0, 0.0, 0.0)
    rayleigh_height_m: float = 8e3
    mie: _Bands = (0.0, 0.0, 0.0)
    mie_albedo: _Bands = (0.9, 0.9, 0.9)
    """Scattering over extinction."""
    mie_height_m: float = 1.2e3
    mie_g: _Bands = (0.8, 0.8, 0.8)
    ozone: _Bands = (0.0, 0.0, 0.0)
    ozone_center_m: float = 25e3
    ozone_width_m: float = 15e3
    top_m: float = 100e3
    ground_albedo: _Bands = (0.1, 0.1, 0.1)


def _bands(values: NDArray[np.floating]) -> _Bands:
    red, green, blue = (float(value) for value in values)
    return red, green, blue


def _earth(wavelengths_um: F64) -> _Preset:
    """Clear air with some haze.

    The gas's depth is the standard 0.0973 at 550 nm (Bodhaine et al. 1999): the widely used law
    1.24062e-6 / wavelength^4 times 0.897. Haze and layers as in Bruneton (2017), Hillaire (2020).
    """
    ozone = np.interp(wavelengths_um, _OZONE_UM, _OZONE_M2) * _OZONE_PER_M3
    return _Preset(
        rayleigh=_bands(0.897 * 1.24062e-6 / wavelengths_um**4),
        mie=(3.996e-6, 3.996e-6, 3.996e-6),
        ozone=_bands(ozone),
    )


def _mars(wavelengths_um: F64) -> _Preset:
    """Carbon dioxide at 610 Pa, and dust of depth 0.5, mixed with it evenly.

    Between 440, 550 and 680 nm the dust scatters 0.75, 0.94 and 0.97 of what it meets, more forward
    the shorter the wavelength: hence the blue about the low sun.
    """
    um = [0.44, 0.55, 0.68]
    albedo = np.interp(wavelengths_um, um, [0.75, 0.94, 0.97])
    height_m, depth = 11e3, 0.5
    return _Preset(
        rayleigh=_bands(2.4e-7 * (0.55 / wavelengths_um) ** 4),
        rayleigh_height_m=height_m,
        mie=_bands(albedo * depth / height_m),
        mie_albedo=_bands(albedo),
        mie_height_m=height_m,
        mie_g=_bands(np.interp(wavelengths_um, um, [0.70, 0.675, 0.65])),
        top_m=110e3,
        ground_albedo=(0.3, 0.15, 0.08),
    )


def _none(wavelengths_um: F64) -> _Preset:
    del wavelengths_um
    return _Preset()


_PRESETS: dict[str, Callable[[F64], _Preset]] = {"earth": _earth, "mars": _mars, "none": _none}


def _per_m(given: _Bands | None, default: _Bands) -> _Bands:
    return default if given is None else _bands(1e-3 * np.array(given))


def _m(given_km: float | None, default_m: float) -> float:
    return default_m if given_km is None else 1e3 * given_km


def settings(given: Atmosphere, wavelengths_um: _Bands) -> _core.AirSettings:
    """As the core takes them; wavelengths_um: of the colour bands."""
    preset = _PRESETS[given.preset](np.array(wavelengths_um))
    scattering = _per_m(given.mie_scattering_per_km, preset.mie)
    extinction = _bands(np.array(scattering) / np.array(preset.mie_albedo))
    return {
        "rayleigh_scattering": _per_m(given.rayleigh_per_km, preset.rayleigh),
        "rayleigh_height_m": _m(given.rayleigh_height_km, preset.rayleigh_height_m),
        "mie_scattering": scattering,
        "mie_extinction": _per_m(given.mie_extinction_per_km, extinction),
        "mie_height_m": _m(given.mie_height_km, preset.mie_height_m),
        "mie_g": given.mie_g or preset.mie_g,
        "ozone_absorption": _per_m(given.ozone_per_km, preset.ozone),
        "ozone_center_m": _m(given.ozone_center_km, preset.ozone_center_m),
        "ozone_width_m": _m(given.ozone_width_km, preset.ozone_width_m),
        "top_m": _m(given.top_km, preset.top_m),
        "ground_albedo": given.ground_albedo or preset.ground_albedo,
        "multiple": given.multiple_scattering,
    }


def air_of(config: Config, body: Body) -> _core.Air | None:
    """The air of a body of a configuration."""
    if body.atmosphere is None:
        return None
    radius_m = float(np.cbrt(np.prod(orbits.radii_m(body))))
    return _core.Air(settings(body.atmosphere, config.sun.wavelengths_um), radius_m)
