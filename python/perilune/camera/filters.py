"""Response of an image sensor's filters to sunlight: from curves to the core's numbers."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from perilune.base import files, spectra
from perilune.camera import bands
from perilune.config.bands import UM_PER_UNIT, Bands, QuantumEfficiency, Spectrum
from perilune.config.camera import Camera
from perilune.config.schema import Config
from perilune.config.sensor import Efficiency, Filters

F64 = NDArray[np.float64]
Efficiencies = Efficiency | QuantumEfficiency

_SOME_UM = 0.55
"""Placeholder wavelength for light without any response."""


def efficiencies(given: Efficiencies, bands_nm: Filters) -> list[F64]:
    """Quantum efficiency curves: one per filter, or curves that add up to a bare sensor's."""
    if isinstance(given, QuantumEfficiency):
        table = spectra.read(Path(given.file), UM_PER_UNIT[given.wavelength_unit])
        return [table[:, [0, column]] for column in range(1, table.shape[1])]
    return [
        spectra.box(low * 1e-3, high * 1e-3, part)
        for part, (low, high) in zip(given, bands_nm, strict=True)
    ]


def _seen(sun: F64 | None, products: Sequence[tuple[F64, ...]]) -> F64:
    """(2, 3): for red, green and blue, what products of curves gather together: the fraction of the
    Sun's irradiance, and its moment in um, which gives photon counts."""
    lights = [spectra.gather(sun, *curves) for curves in products]
    seen = np.array([[light["part"], light["moment_um"]] for light in lights])
    return np.asarray(seen.sum(axis=0))


def _mean_m(parts: F64, moments_um: F64) -> F64:
    """Mean wavelengths, m."""
    lit = parts > 0.0
    return np.asarray(np.where(lit, moments_um / np.where(lit, parts, 1.0), _SOME_UM) * 1e-6)


def _bare(sun: F64 | None, products: Sequence[tuple[F64, ...]]) -> F64:
    """(2, 3): fractions and mean wavelengths, m, of red, green and blue that reach all pixels."""
    parts, moments = _seen(sun, products)
    return np.stack([parts, _mean_m(parts, moments)])


def _mosaic(sun: F64 | None, curves: Sequence[F64]) -> dict[str, F64]:
    parts, moments = np.stack([_seen(sun, [(curve,)]) for curve in curves], axis=1)
    share, charge = parts.sum(axis=1), moments.sum(axis=1)
    lit = charge[:, None] > 0.0
    mix = np.where(lit, moments / np.where(lit, charge[:, None], 1.0), np.eye(3))
    return {"band_share": share, "wavelength_m": _mean_m(share, charge), "mix": mix}


def _planes(sun: F64 | None, filters: Sequence[F64], curves: Sequence[F64]) -> dict[str, F64]:
    planes = np.array([_bare(sun, [(through, curve) for curve in curves]) for through in filters])
    charge = planes[:, 0] * planes[:, 1]
    longest = planes[:, 1].max()
    # the sensor's own numbers: the plane that fills first, its wavelengths taken for the longest
    first = charge[np.argmax(charge.sum(axis=1))] / longest
    return {"band_share": first, "wavelength_m": np.full(3, longest), "planes": planes}


@lru_cache(maxsize=64)
def _described(
    mosaic: str,
    given: Efficiencies,
    bands_nm: Filters,
    chosen: Bands,
    spectrum: Spectrum | None,
    stamps: tuple[files.Stamp, ...],
) -> dict[str, F64]:
    sun = bands.sun_curve(spectrum)
    curves = efficiencies(given, bands_nm)
    if mosaic == "planes":
        return _planes(sun, bands.curves(chosen), curves)
    if mosaic == "mono":
        share, wavelength = _bare(sun, [(curve,) for curve in curves])
        return {"band_share": share, "wavelength_m": wavelength}
    return _mosaic(sun, curves)


def described(camera: Camera, spectrum: Spectrum | None) -> dict[str, Any]:
    """The keys band_share, wavelength_m, mix and planes of the core's sensor. Its quantum
    efficiency is 1, because the fractions include the configuration's.

    ValueError for a curve that reaches beyond the Sun's spectrum."""
    sensor = camera.sensor
    assert sensor is not None
    given = sensor.quantum_efficiency
    chosen: Bands = camera.bands if sensor.mosaic == "planes" else "srgb"
    stamps = bands.stamps(chosen, spectrum)
    if isinstance(given, QuantumEfficiency):
        stamps += (files.stamp(Path(given.file)),)
    return _described(sensor.mosaic, given, sensor.bands_nm, chosen, spectrum, stamps)


def check(config: Config) -> Iterator[tuple[str, str]]:
    """Key and message for each sensor without any response, or with one beyond the Sun's
    spectrum."""
    for name, camera in config.cameras.items():
        if camera.sensor is None:
            continue
        planes = camera.sensor.mosaic == "planes"
        if planes and camera.bands == "srgb":
            key = config.place(name, "bands")
            yield key, "srgb is no filter: mosaic planes needs a list, or monochrome"
            continue
        where = f"{config.place(name, 'sensor')}.quantum_efficiency"
        try:
            seen = described(camera, config.sun.spectrum)
        except ValueError as error:
            yield where, str(error)
            continue
        shares = seen["planes"][:, 0] if planes else seen["band_share"][None]
        for i, share in enumerate(shares):
            if not share.any():
                yield where, f"the sensor sees nothing of bands[{i}]" if planes else "sees no light"
