"""Atmospheres: the presets, and the core's settings for a configuration. docs/air.md compares their
sources with published values."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from perilune import _core, orbits
from perilune.base import spectra
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
"""Absorption cross-section of an ozone molecule at 293 K (Serdyuchenko et al. 2014, Atmospheric
Measurement Techniques 7, 625), as rounded in Bruneton (2017), A Precomputed Atmospheric Scattering
Implementation."""
_OZONE_PER_M3 = 4.478e18
"""Number density in the middle of the layer: 300 Dobson units in a triangular profile of 18 km to
each side."""


@dataclass(frozen=True)
class _Layers:
    """A density with scale height height_m below and upper_m above from_m; from_m = 0: one scale
    height."""

    height_m: float
    from_m: float = 0.0
    upper_m: float = 0.0

    def column_m(self, top_m: float) -> float:
        """Vertical column from the surface, in metres at the surface density. The transition is
        smooth: see pl_air_layers in csrc/air/table.h."""
        heights = np.linspace(0.0, top_m, 20001)
        exponent = -heights / self.height_m
        if self.from_m:
            round_m = 0.25 * (self.height_m + self.upper_m)
            bend = heights - self.from_m + np.hypot(heights - self.from_m, round_m)
            exponent -= 0.5 * (1.0 / self.upper_m - 1.0 / self.height_m) * (bend - bend[0])
        return float(np.trapezoid(np.exp(exponent), heights))


@dataclass(frozen=True)
class _Preset:
    """Coefficients at the surface, 1/m, at the requested wavelengths."""

    rayleigh: F64
    mie: F64
    """Extinction coefficient."""
    mie_albedo: F64
    """Single-scattering albedo."""
    mie_g: F64
    ozone: F64
    gas: _Layers = _Layers(8e3)
    haze: _Layers = _Layers(1.2e3)
    ozone_center_m: float = 25e3
    ozone_width_m: float = 15e3
    top_m: float = 100e3
    ground_albedo: _Bands = (0.1, 0.1, 0.1)


_AIR_UM = (0.35, 0.40, 0.45, 0.50, 0.55, 0.60, 0.65, 0.70, 0.75, 0.80, 0.85)
_AIR_DEPTH = (
    0.63031, 0.36022, 0.22111, 0.14336, 0.097069, 0.068092, 0.049188, 0.036424, 0.027552, 0.021228,
    0.016621,
)  # fmt: skip
"""Vertical optical depth of the gas from sea level: Bodhaine et al. (1999), On Rayleigh optical
depth calculations, Journal of Atmospheric and Oceanic Technology 16, 1854, table 3."""


def _air_depth(um: F64) -> F64:
    """Interpolates lambda^-4 times the table's slowly varying factor."""
    beside = np.array(_AIR_DEPTH) * np.array(_AIR_UM) ** 4
    return np.asarray(np.interp(um, _AIR_UM, beside) / um**4)


def _cornette(cosine: F64) -> F64:
    """Parameter g of the Cornette-Shanks phase function for a mean cosine, 3 g (4 + g^2) / (5 (2 +
    g^2))."""
    g = np.linspace(0.0, 0.98, 200)
    return np.asarray(np.interp(cosine, 3.0 * g * (4.0 + g * g) / (5.0 * (2.0 + g * g)), g))


def _earth(um: F64) -> _Preset:
    """The mean atmosphere of the Earth, without its clouds.

    Gas: optical depths of Bodhaine et al. (1999); two layers are within 10 % of the densities of
    the U.S. Standard Atmosphere (1976) up to 50 km. Haze: optical depth, albedo and asymmetry of
    the mean aerosol of Kinne (2019), The MACv2 aerosol climatology, Tellus B 71, 1623639, tables 2
    and 3; the thin stratospheric aerosol is left out. Ozone: 300 Dobson units, with the middle of
    the layer of the U.S. Standard Atmosphere, table 18."""
    gas = _Layers(9.1e3, 10.5e3, 6.5e3)
    haze = _Layers(1.9e3)
    top_m, known_um = 100e3, (0.45, 0.55, 1.0)
    depth = np.exp(np.interp(np.log(um), np.log(known_um), np.log((0.144, 0.122, 0.081))))
    return _Preset(
        rayleigh=_air_depth(um) / gas.column_m(top_m),
        mie=depth / haze.column_m(top_m),
        mie_albedo=np.interp(um, known_um, (0.902, 0.941, 0.956)),
        mie_g=_cornette(np.interp(um, known_um, (0.718, 0.702, 0.693))),
        ozone=np.interp(um, _OZONE_UM, _OZONE_M2) * _OZONE_PER_M3,
        gas=gas,
        haze=haze,
        ozone_center_m=22.5e3,
        ozone_width_m=18e3,
        top_m=top_m,
    )


def _mars(um: F64) -> _Preset:
    """Carbon dioxide at 610 Pa, and dust of optical depth 0.375 at 0.7 um.

    The depth is the annual mean of the Mars Climate Database (Montabone et al. 2015, Icarus 251,
    65; 0.20 to 0.76 over the seasons). The dust's single-scattering albedo is that of Wolff et al.
    (2009), JGR 114, E00D04: 0.73, 0.965 and 0.975 at 388, 638 and 700 nm. Its scale height is the
    middle of 6 to 12 km over the seasons (Vincendon and Langevin 2010, Icarus 207, 923). At angles
    of 75 degrees and more its phase function is within 27 % of the two lobes of Chen-Chen et al.
    (2019), Icarus 330, 16; at smaller angles it is too large, by up to 2.5 times at 35 degrees."""
    gas, dust = _Layers(11e3), _Layers(9e3)
    top_m = 110e3
    depth = 0.375 * np.ones_like(um)
    return _Preset(
        rayleigh=2.4e-7 * (0.55 / um) ** 4,
        mie=depth / dust.column_m(top_m),
        mie_albedo=np.interp(um, (0.388, 0.638, 0.70), (0.73, 0.965, 0.975)),
        mie_g=np.interp(um, (0.44, 0.55, 0.68), (0.59, 0.57, 0.55)),
        ozone=np.zeros_like(um),
        gas=gas,
        haze=dust,
        top_m=top_m,
        ground_albedo=(0.3, 0.15, 0.08),
    )


def _none(um: F64) -> _Preset:
    zero = np.zeros_like(um)
    return _Preset(zero, zero, zero + 0.9, zero + 0.8, zero)


_PRESETS: dict[str, Callable[[F64], _Preset]] = {"earth": _earth, "mars": _mars, "none": _none}


@lru_cache(maxsize=1)
def _srgb() -> tuple[F64, F64]:
    """Wavelengths (n,), um, and their contributions to red, green and blue of sRGB in sunlight, (3,
    n); the weights of each colour, some of them negative, have the sum 1."""
    um = np.linspace(0.38, 0.78, 201)
    sun = um**-5.0 / np.expm1(14387.77 / (um * 5850.0)) * np.where(um < 0.4, 0.7, 1.0)
    weights = spectra.srgb_response(um) * sun
    return um, weights / weights.sum(axis=1, keepdims=True)


def _bands(values: NDArray[np.floating]) -> _Bands:
    red, green, blue = (float(value) for value in values)
    return red, green, blue


def _per_m(given: _Bands | None, default: _Bands) -> _Bands:
    return default if given is None else _bands(1e-3 * np.array(given))


def _m(given_km: float | None, default_m: float) -> float:
    return default_m if given_km is None else 1e3 * given_km


def _layers(
    given_km: float | None, from_km: float | None, upper_km: float | None, preset: _Layers
) -> _Layers:
    """The layers, where a scale height given by the user removes the preset's upper layer."""
    base = preset if given_km is None else _Layers(1e3 * given_km)
    return _Layers(base.height_m, _m(from_km, base.from_m), _m(upper_km, base.upper_m))


def settings(given: Atmosphere, wavelengths_um: _Bands | None = None) -> _core.AirSettings:
    """The core's settings; wavelengths_um: those of the colour bands.

    Without wavelengths the bands are those of sRGB, and a preset's value is the mean over a band's
    light, so that thin air has exactly the colour of its spectrum."""
    um, weights = (np.array(wavelengths_um), np.eye(3)) if wavelengths_um is not None else _srgb()
    preset = _PRESETS[given.preset](um)

    def mean(values: F64) -> F64:
        return np.maximum(0.0, weights @ values)

    scattered = preset.mie * preset.mie_albedo
    share = mean(scattered) / mean(preset.mie) if preset.mie.any() else preset.mie_albedo[:3]
    scattering = _per_m(given.mie_scattering_per_km, _bands(mean(scattered)))
    gas = _layers(
        given.rayleigh_height_km, given.rayleigh_upper_from_km, given.rayleigh_upper_height_km,
        preset.gas,
    )  # fmt: skip
    haze = _layers(
        given.mie_height_km, given.mie_upper_from_km, given.mie_upper_height_km, preset.haze
    )
    return {
        "rayleigh_scattering": _per_m(given.rayleigh_per_km, _bands(mean(preset.rayleigh))),
        "rayleigh_height_m": gas.height_m,
        "rayleigh_upper_m": (gas.from_m, gas.upper_m),
        "mie_scattering": scattering,
        "mie_extinction": _per_m(given.mie_extinction_per_km, _bands(np.array(scattering) / share)),
        "mie_height_m": haze.height_m,
        "mie_upper_m": (haze.from_m, haze.upper_m),
        "mie_g": given.mie_g or _bands(weights @ preset.mie_g),
        "ozone_absorption": _per_m(given.ozone_per_km, _bands(mean(preset.ozone))),
        "ozone_center_m": _m(given.ozone_center_km, preset.ozone_center_m),
        "ozone_width_m": _m(given.ozone_width_km, preset.ozone_width_m),
        "top_m": _m(given.top_km, preset.top_m),
        "ground_albedo": given.ground_albedo or preset.ground_albedo,
        "multiple": given.multiple_scattering,
    }


@lru_cache(maxsize=16)
def _air(given: Atmosphere, wavelengths_um: _Bands | None, radius_m: float) -> _core.Air:
    """Its tables take a fifth of a second; simulations of a process share them."""
    return _core.Air(settings(given, wavelengths_um), radius_m)


def air_of(config: Config, body: Body) -> _core.Air | None:
    """The atmosphere of a body of a configuration."""
    if body.atmosphere is None:
        return None
    radius_m = float(np.cbrt(np.prod(orbits.radii_m(body))))
    return _air(body.atmosphere, config.sun.band_wavelengths_um, radius_m)
