"""Bands of cameras: from the configuration to the small matrices that the core applies."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import lru_cache
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from perilune import _core
from perilune.base import files, spectra
from perilune.config.bands import UM_PER_UNIT, Band, Bands, Spectrum
from perilune.config.camera import Camera
from perilune.config.schema import Config
from perilune.config.sun import SRGB_UM, Sun

F64 = NDArray[np.float64]

MONOCHROME_UM = (0.4, 0.9)
"""Range of the preset `monochrome`: where silicon without filters is sensitive."""


def stamps(bands: Bands, spectrum: Spectrum | None) -> tuple[files.Stamp, ...]:
    """Time stamps of all files, which invalidate caches when they change."""
    names = [] if isinstance(bands, str) else [band.file for band in bands]
    names.append(spectrum.file if spectrum is not None else None)
    return tuple(files.stamp(Path(name)) for name in names if name is not None)


def sun_curve(spectrum: Spectrum | None) -> F64 | None:
    """The Sun's spectrum; None for the core's own."""
    if spectrum is None:
        return None
    return spectra.read(Path(spectrum.file), UM_PER_UNIT[spectrum.wavelength_unit])


def curve_of(band: Band) -> F64:
    """Response curve of a band."""
    if band.file is not None:
        return spectra.read(Path(band.file), UM_PER_UNIT[band.wavelength_unit])
    center_um, width_um = band.center_um, band.width_um
    assert center_um is not None  # the schema has checked it
    assert width_um is not None
    if band.shape == "gaussian":
        return spectra.gaussian(center_um, width_um)
    return spectra.box(center_um - 0.5 * width_um, center_um + 0.5 * width_um)


def curves(bands: Bands) -> Sequence[F64]:
    """Response curves of bands."""
    if bands == "srgb":
        return spectra.srgb_curves()
    if bands == "monochrome":
        return (spectra.box(*MONOCHROME_UM),)
    return [curve_of(band) for band in bands]


def count(camera: Camera) -> int:
    """Number of a camera's bands."""
    return {"srgb": 3, "monochrome": 1}[b] if isinstance(b := camera.bands, str) else len(b)


def has_planes(camera: Camera) -> bool:
    """Whether the sensor makes an image through each band."""
    return camera.sensor is not None and camera.sensor.mosaic == "planes"


@lru_cache(maxsize=64)
def _gathered(
    bands: Bands, spectrum: Spectrum | None, stamps: tuple[files.Stamp, ...]
) -> tuple[_core.BandLight, ...]:
    sun = sun_curve(spectrum)
    return tuple(spectra.gather(sun, curve) for curve in curves(bands))


def gathered(camera: Camera, sun: Sun) -> tuple[_core.BandLight, ...]:
    """Sunlight gathered by each band of a camera; ValueError for a band beyond the spectrum."""
    return _gathered(camera.bands, sun.spectrum, stamps(camera.bands, sun.spectrum))


def matrix(camera: Camera, sun: Sun) -> F64:
    """(bands, 3): fraction of the Sun's irradiance that each band gathers of red, green and
    blue."""
    return np.array([band["part"] for band in gathered(camera, sun)])


def described(camera: Camera, sun: Sun) -> list[dict[str, str | float]]:
    """For each band its name, the mean wavelength of sunlight in it (um), and the fraction of the
    Sun's irradiance that it gathers: a white surface facing the Sun has fraction * irradiance /
    pi."""
    if isinstance(camera.bands, str):
        names = {"srgb": ["red", "green", "blue"]}.get(camera.bands, [camera.bands])
    else:
        names = [band.name for band in camera.bands]
    return [
        {"name": name, "mean_um": light["mean_um"], "sun_part": sum(light["part"])}
        for name, light in zip(names, gathered(camera, sun), strict=True)
    ]


def wavelengths_um(camera: Camera, sun: Sun) -> tuple[float, float, float]:
    """Wavelengths of limb darkening in red, green and blue: the mean that the camera's bands see of
    each colour, or, for a colour that they do not see, of everything they see."""
    if sun.band_wavelengths_um is not None or camera.bands == "srgb":
        return sun.wavelengths_um
    lights = gathered(camera, sun)
    parts = np.array([light["part"] for light in lights]).sum(axis=0)
    moments = np.array([light["moment_um"] for light in lights]).sum(axis=0)
    every = moments.sum() / parts.sum() if parts.sum() > 0.0 else SRGB_UM[1]
    some = parts > 1e-6 * parts.sum()
    red, green, blue = np.where(some, moments / np.where(some, parts, 1.0), every).tolist()
    return red, green, blue


def check(config: Config) -> Iterator[tuple[str, str]]:
    """Key and message for each band that does not work with the Sun's spectrum."""
    spectrum = config.sun.spectrum
    for name, camera in config.cameras.items():
        key = config.place(name, "bands")
        for i, fault in _faults(camera.bands, spectrum, stamps(camera.bands, spectrum)):
            yield key if isinstance(camera.bands, str) else f"{key}[{i}]", fault


@lru_cache(maxsize=64)
def _faults(
    bands: Bands, spectrum: Spectrum | None, stamps: tuple[files.Stamp, ...]
) -> tuple[tuple[int, str], ...]:
    """Index and message for each band that does not work with the Sun's spectrum. The limits of all
    drivers ask for the same."""
    sun, found = sun_curve(spectrum), []
    for i, curve in enumerate(curves(bands)):
        try:
            spectra.gather(sun, curve)
        except ValueError as error:
            found.append((i, str(error)))
    return tuple(found)
