"""The sky of a frame: from catalogues and pictures to the core's input."""

from __future__ import annotations

from collections.abc import Callable
from functools import lru_cache
from pathlib import Path
from typing import Any

import erfa
import numpy as np
from numpy.typing import NDArray

from perilune import _core
from perilune.base import files, spectra
from perilune.bodies import maps
from perilune.camera.bands import sun_curve
from perilune.config.bands import Spectrum
from perilune.config.errors import ConfigError
from perilune.config.schema import Config
from perilune.config.sky import Background, Stars
from perilune.config.sun import Sun
from perilune.orbits.almanac import almanac
from perilune.orbits.motion import Kept
from perilune.orbits.setting import ephemeris_name
from perilune.sky.star import STAR
from perilune.sky.star_files import SUN_K, StarTable, read_stars
from perilune.world import World

F64 = NDArray[np.float64]
FilePath = Callable[[str, str], Path]

V_ZERO_W_M2_UM = 3.631e-8
"""Spectral irradiance of a star of V = 0 in the middle of that band (Bessell, Castelli and Plez
1998, table A2)."""
V_UM = (0.506, 0.594)
"""Limits of a box that approximates the band V; its width is the effective one (Bessell 2005, table
1)."""
_C2_UM_K = 1.438776877e4  # second radiation constant, CODATA 2018
_C_M_S = 299792458.0
_ARCSEC2_SR = (np.pi / 180.0 / 3600.0) ** 2
_J2000 = 2451545.0
_YEAR_DAYS = 365.25


def _planck(wavelength_um: F64, temperature_k: F64) -> F64:
    """Spectral radiance of a black body relative to that in the middle of V."""
    middle = np.full(1, 0.5 * (V_UM[0] + V_UM[1]))

    def density(um: F64) -> F64:
        return np.asarray(um**-5.0 / np.expm1(_C2_UM_K / (um * temperature_k)))

    return density(wavelength_um) / density(middle)


@lru_cache(maxsize=16)
def _sun_density(
    wavelengths_um: tuple[float, ...], spectrum: Spectrum | None, stamps: tuple[files.Stamp, ...]
) -> F64:
    """(n,): fraction of the Sun's irradiance per micrometre, averaged over the width of V around
    wavelengths."""
    curve = sun_curve(spectrum)
    half = 0.5 * (V_UM[1] - V_UM[0])
    boxes = [spectra.box(middle - half, middle + half) for middle in wavelengths_um]
    parts = [float(np.sum(spectra.gather(curve, box)["part"])) for box in boxes]
    return np.array(parts) / (2.0 * half)


def irradiance(vmag: F64 | float, temperature_k: F64 | float, sun: Sun) -> F64:
    """(..., 3): irradiance of stars in red, green and blue, W m-2, in the same unit as the Sun's.

    The value for red is the total irradiance of a Sun that is as bright as the star around the red
    wavelength: bands and sensors take the Sun's fraction of it, whatever its spectrum. Stars have
    the spectral irradiance of their magnitude in V, and the spectrum of a black body elsewhere."""
    files_of = () if sun.spectrum is None else (files.stamp(Path(sun.spectrum.file)),)
    parts = _sun_density(sun.wavelengths_um, sun.spectrum, files_of)
    temperatures = np.asarray(temperature_k, np.float64)[..., None]
    color = _planck(np.array(sun.wavelengths_um), temperatures)
    strength = V_ZERO_W_M2_UM * 10.0 ** (-0.4 * np.asarray(vmag, np.float64)[..., None])
    return np.asarray(strength * color / parts)


def magnitude_arcsec2(radiance_w_m2_sr: float) -> float:
    """Surface brightness (V) of a grey with a given radiance under the default Sun."""
    zero = float(irradiance(0.0, SUN_K, Sun())[1]) / _ARCSEC2_SR
    return float(-2.5 * np.log10(radiance_w_m2_sr / zero))


def directions(table: StarTable, years: float) -> F64:
    """(n, 3) unit vectors, ICRF, some Julian years after the catalogue's epoch.

    Motion is along a straight line at the initial distance, without a radial velocity."""
    ra, dec = table.ra_rad, table.dec_rad
    place = np.stack([np.cos(dec) * np.cos(ra), np.cos(dec) * np.sin(ra), np.sin(dec)], axis=-1)
    east = np.stack([-np.sin(ra), np.cos(ra), np.zeros_like(ra)], axis=-1)
    north = np.stack([-np.sin(dec) * np.cos(ra), -np.sin(dec) * np.sin(ra), np.cos(dec)], axis=-1)
    moved = place + years * (table.motion_rad_yr[:, :1] * east + table.motion_rad_yr[:, 1:] * north)
    return np.asarray(moved / np.linalg.norm(moved, axis=-1, keepdims=True))


_MOTION_RAD = np.radians(0.01 / 3600.0)
"""Largest error of a star's position from quantising the time of proper motion."""


def years_since(table: StarTable, years: float) -> float:
    """Julian years after the epoch, in steps within which no star moves by more than twice this
    error, so that frames of a step share one catalogue. 0 at the epoch."""
    fastest = float(np.hypot(*table.motion_rad_yr.T).max(initial=0.0))
    if fastest == 0.0:
        return 0.0
    step = 2.0 * _MOTION_RAD / fastest
    return float(round(years / step) * step)


def camera_velocity_m_s(world: World) -> F64:
    """(3,): velocity of the camera about the Sun, ICRF axes, as defined by
    `sky.stars.aberration`."""
    config, velocity = world.config, np.zeros(3)
    if config.sun.by_date:
        root = ephemeris_name(config, config.root)
        assert root is not None  # the root always has one
        velocity = almanac(config).relative_state(root, "sun", world.date)[3:]
    trajectory = config.camera.trajectory
    # What the camera moves with; a random box may have a target that it only looks at.
    key = "around" if hasattr(trajectory, "around") else "target"
    target = getattr(trajectory, key, None)
    if target is not None and target in world.velocities_m_s:
        velocity = velocity + world.velocities_m_s[target][0]
    return velocity


def map_axes(background: Background) -> F64:
    """(3, 3): rotation from ICRF to the axes of a map: x at its centre column, z up, y a quarter
    turn to the right of the centre (the sky seen from within is mirrored)."""
    if background.frame == "galactic":
        x, z = (erfa.s2c(*erfa.g2icrs(0.0, lat)) for lat in (0.0, 0.5 * np.pi))
        axes = np.stack([x, np.cross(z, x), z])
    elif background.frame == "ecliptic":
        axes = erfa.ecm06(_J2000, 0.0)
    else:
        axes = np.eye(3)
    lon = np.radians(background.center_lon_deg)
    turn = np.array([[np.cos(lon), np.sin(lon), 0], [-np.sin(lon), np.cos(lon), 0], [0, 0, 1]])
    flip = np.diag([1.0, -1.0 if background.east == "left" else 1.0, 1.0])
    return np.asarray(flip @ turn @ axes)


class Skies:
    """Catalogues and pictures of a configuration, with a cache of the last ones used."""

    def __init__(self, path: FilePath) -> None:
        """path: resolves a path of the configuration; its key is for errors."""
        self._path = path
        self._tables: Kept[StarTable] = Kept(2)
        self._stars: Kept[_core.Stars] = Kept(4)
        self._maps: Kept[_core.Map] = Kept(4)

    def _table(self, path: Path) -> StarTable:
        try:
            return self._tables.get((path, files.stamp(path)), lambda: read_stars(path))
        except ValueError as error:
            raise ConfigError(f"sky.stars.catalogue: {error}") from error

    def _catalogue(self, given: Stars, world: World) -> _core.Stars:
        path = self._path(given.catalogue, "sky.stars.catalogue")
        epoch = world.epoch.day + world.epoch.fraction
        table = self._table(path)
        years = (epoch - _J2000) / _YEAR_DAYS + 2000.0 - given.catalogue_year
        years += years_since(table, world.t_s / 86400.0 / _YEAR_DAYS)
        sun = world.config.sun
        spectrum = None if sun.spectrum is None else files.stamp(Path(sun.spectrum.file))
        limit = np.inf if given.limit_magnitude is None else given.limit_magnitude
        file = (path, files.stamp(path))
        key = (file, years, sun.wavelengths_um, sun.spectrum, spectrum, limit)

        def make() -> _core.Stars:
            kept = table.vmag <= limit
            light = irradiance(table.vmag, table.temperature_k, sun)
            places = directions(table, years)
            return _core.Stars(places[kept], light[kept], table.vmag[kept], table.number[kept])

        return self._stars.get(key, make)

    def _picture(self, path: Path, key: str, wrap: str) -> _core.Map:
        def make() -> _core.Map:
            try:
                return _core.Map(maps.told_picture(path, key), True, wrap, "clamp")
            except ValueError as error:
                raise ConfigError(f"{key}: {error}") from error

        return self._maps.get((path, files.stamp(path), wrap), make)

    def _backdrop(self, given: Background, config: Config) -> dict[str, Any]:
        key, text = ("map", given.map) if given.image is None else ("image", given.image)
        assert text is not None  # the schema asks for one
        path = self._path(text, f"sky.background.{key}")
        wrap = "repeat" if key == "map" else "clamp"
        picture = self._picture(path, f"sky.background.{key}", wrap)
        if key == "map":
            white = irradiance(given.white_mag_arcsec2, SUN_K, config.sun) / _ARCSEC2_SR
        else:
            white = np.full(3, given.brightness)
        return {
            "map": picture,
            "kind": "map" if key == "map" else given.fit,
            "axes": map_axes(given),
            "white": white,
            "by_display": key == "image",
        }

    def request(self, world: World) -> dict[str, Any] | None:
        """The core's input for the sky of a frame; None without a section `sky`."""
        given = world.config.sky
        if given is None:
            return None
        moving = given.stars is not None and given.stars.aberration
        return {
            "stars": None if given.stars is None else self._catalogue(given.stars, world),
            "beta": camera_velocity_m_s(world) / _C_M_S if moving else np.zeros(3),
            "backdrop": None
            if given.background is None
            else self._backdrop(given.background, world.config),
        }


def seen(result: _core.SeenStars) -> NDArray[Any]:
    """Rows of STAR, brightest first."""
    rows = np.empty(len(result["number"]), STAR)
    if not len(rows):
        return rows
    rows["number"], rows["magnitude"] = result["number"], result["magnitude"]
    rows["u"], rows["v"] = result["pixel"].T
    return rows
