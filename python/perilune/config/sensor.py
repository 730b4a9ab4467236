"""The section `camera.sensor` of the schema: how radiance becomes digital numbers."""

from __future__ import annotations

import itertools
from collections.abc import Mapping
from typing import Annotated, Any, Literal

from pydantic import Discriminator, Field, Tag, ValidationInfo, model_validator

from perilune.config.bands import QuantumEfficiency
from perilune.config.errors import fail, nearest
from perilune.config.lens_flare import LensFlare
from perilune.config.sensor_presets import PRESETS, Name
from perilune.config.types import FileName, Finite, Fraction, Integer, NonNegative, Positive, Strict

_Gain = Annotated[Positive, Field(ge=1e-3, le=1e3)]
Mosaic = Literal["mono", "rggb", "bggr", "grbg", "gbrg", "planes"]
Band = tuple[Positive, Positive]
Vignetted = tuple[Annotated[float, Field(strict=True, ge=0.0, lt=90.0)], Fraction]
Profile = Annotated[tuple[Vignetted, ...], Field(min_length=1, max_length=64)]
Efficiency = tuple[Fraction, Fraction, Fraction]
Filters = tuple[Band, Band, Band]


class SensorExposure(Strict):
    """Exposure time and gain of the sensor."""

    mode: Literal["auto", "fixed"] = "auto"
    """auto: metered from the scene; fixed: `camera.exposure_time_s`."""
    metering: Literal["percentile", "mean"] = "percentile"
    """auto: what is metered, a percentile of the lit pixels or the mean of all pixels of the
    window."""
    percentile: Annotated[float, Field(strict=True, gt=0.0, le=100.0)] = 99.0
    """auto: percentile of the lit pixels that is brought to the level `key`."""
    key: Annotated[Fraction, Field(ge=1e-6)] = 0.7
    """auto: linear fraction of white to which the metered percentile or mean is brought."""
    window: tuple[Fraction, Fraction, Fraction, Fraction] = (0.0, 0.0, 1.0, 1.0)
    """auto: metered part of the image as [left, upper, right, lower], in fractions of its width and
    height."""
    saturated: Fraction = 1.0
    """auto: largest fraction of the window's pixels that may be overexposed; 1: no limit."""
    min_ms: Annotated[Positive, Field(ge=1e-9, le=1e12)] = 0.01
    """auto: shortest exposure time; brighter scenes are overexposed."""
    max_ms: Annotated[Positive, Field(ge=1e-9, le=1e12)] = 10000.0
    """auto: longest exposure time; darker scenes are underexposed."""
    step_ms: Annotated[NonNegative, Field(le=1e12)] = 0.0
    """auto: exposure times are rounded down to multiples of this; 0: any time."""
    times_ms: Annotated[tuple[Positive, ...], Field(min_length=1, max_length=64)] | None = None
    """auto: list of the exposure times that the camera has, in ascending order; the longest one
    that is not too long is used."""
    gains: Annotated[tuple[_Gain, ...], Field(min_length=1, max_length=16)] = (1.0,)
    """auto: gain factors in ascending order; `gain_e_dn` is divided by the first one for which
    `max_ms` suffices."""
    lag_frames: Annotated[Integer, Field(ge=0, le=1000)] = 0
    """auto: delay of the metering, in frames of this sensor; the first frames of a scene are
    metered from its first frame."""

    @model_validator(mode="after")
    def _read(self) -> SensorExposure:
        if self.mode == "fixed":
            self._only_with("mode: auto", *(set(type(self).model_fields) - {"mode"}))
        if self.metering == "mean":
            self._only_with("metering: percentile", "percentile")
        return self

    @model_validator(mode="after")
    def _ordered(self) -> SensorExposure:
        if self.min_ms > self.max_ms:
            fail("min_ms", f"{self.min_ms:g} is more than max_ms, {self.max_ms:g}")
        if self.window[0] >= self.window[2] or self.window[1] >= self.window[3]:
            fail("window", "must be [left, upper, right, lower], within 0 to 1")
        for key, numbers in (("times_ms", self.times_ms or ()), ("gains", self.gains)):
            if any(a >= b for a, b in itertools.pairwise(numbers)):
                fail(key, "must rise")
        if self.times_ms is not None and not any(
            self.min_ms <= time <= self.max_ms for time in self.times_ms
        ):
            fail("times_ms", f"none is within min_ms, {self.min_ms:g}, and max_ms, {self.max_ms:g}")
        return self


class PointSpread(Strict):
    """Point-spread function of the lens: a core, and power-law wings (glare)."""

    core: Literal["point", "gauss", "airy", "measured"] = "gauss"
    """point: all light stays in its pixel; gauss: a Gaussian; airy: diffraction by the aperture;
    measured: `kernel`. Default: measured if `kernel` is given, else gauss."""
    kernel: FileName | None = None
    """measured: file (.npy, .tif or grey .png) with the image of a point source, sampled in pixels
    of the sensor. Any size; its centre is the pixel (width // 2, height // 2). It is normalised to
    a sum of 1."""
    sigma_px: Annotated[Positive, Field(ge=0.001, le=1e4)] = 0.5
    """gauss: standard deviation of the core."""
    wings: Fraction = 0.0
    """Fraction of the light in the wings; 0.005 to 0.03 for real lenses."""
    wing_radius_px: Annotated[Positive, Field(ge=0.001, le=1e4)] = 2.0
    """Core radius of the wings, a Moffat profile (1 + (r / radius)^2)^-beta."""
    wing_beta: Annotated[Positive, Field(ge=1.001, le=100.0)] = 1.4
    """Exponent beta of the wings: far out they fall as r^(-2 beta)."""

    @model_validator(mode="before")
    @classmethod
    def _measured(cls, data: Any) -> Any:
        known = isinstance(data, Mapping) and data.get("kernel") is not None
        return {"core": "measured", **data} if known else data

    @model_validator(mode="after")
    def _one_core(self) -> PointSpread:
        if (self.core == "measured") != (self.kernel is not None):
            fail("core", "the core `measured` needs a `kernel`, and a kernel this core")
        if self.core != "gauss":
            self._only_with("core: gauss", "sigma_px")
        if "wings" not in self.model_fields_set:
            self._only_with("wings", "wing_radius_px", "wing_beta")
        return self


class CosmicRays(Strict):
    """Charged particles that leave electrons along their tracks."""

    flux_cm2_s: Annotated[NonNegative, Field(le=1e11)] = 0.0
    """Particles per square centimetre and second; about 4 for galactic cosmic rays in deep
    space."""
    electrons_um: Annotated[NonNegative, Field(le=1e9)] = 80.0
    """Electrons freed per micrometre of track; 80 for a fast proton in silicon."""
    depth_um: Annotated[NonNegative, Field(le=1e6)] = 10.0
    """Thickness of the layer that collects charge."""

    @model_validator(mode="after")
    def _some(self) -> CosmicRays:
        if "flux_cm2_s" not in self.model_fields_set:
            self._only_with("a flux_cm2_s", "electrons_um", "depth_um")
        return self


def _efficiency_tag(value: Any) -> str:
    return "file" if isinstance(value, (Mapping, QuantumEfficiency)) else "boxes"


class Compression(Strict):
    """JPEG artefacts: `sensor_rgb` is encoded and decoded again; `raw` is not."""

    quality: Annotated[float, Field(strict=True, ge=1.0, le=100.0)] = 90.0
    """Quality as in libjpeg, from 1 (coarsest) to 100 (finest), rounded to a whole number."""
    chroma: Literal["444", "422", "420"] = "420"
    """Chroma subsampling, as a quoted text: 444 none, 422 by 2 horizontally, 420 by 2 in both
    directions."""


class ImageSensor(Strict):
    """An image sensor behind a lens: makes the channels `raw` and `sensor_rgb`.

    The linear model of EMVA 1288: photons, electrons, digital numbers.
    """

    preset: Name | None = None
    """Ready sensor, which sets the defaults of all keys that are not given.
    perilune.config.sensor_presets names its sources and assumptions."""
    f_number: Annotated[Positive, Field(ge=0.5, le=1e6)] | None = None
    """Focal length divided by the diameter of the aperture. Default: 4, unless aperture_mm is
    given."""
    aperture_mm: Positive | None = None
    """Diameter of the aperture, instead of f_number. The focal length in mm follows from the
    camera's focal length in pixels and pixel_um."""
    pupil: Literal["sine", "plane"] = "sine"
    """Irradiance on the axis of a scene of radiance L at f-number N. sine: pi L / (4 N^2), for a
    lens without coma; plane: pi L / (4 N^2 + 1), for a flat opening. They differ by 6 % at N =
    2."""
    transmission: Fraction = 0.9
    """Transmittance of the lens, all surfaces together."""
    vignetting: Annotated[NonNegative, Field(le=100.0)] | None = None
    """Natural vignetting: light falls off as this power of the cosine of the angle to the optical
    axis; 4 for a thin lens. Default: 4, or 0 if vignetting_profile or flat_field is given."""
    vignetting_profile: Profile | None = None
    """Measured vignetting: rows of [angle to the optical axis in degrees, relative illumination],
    by ascending angle, interpolated linearly."""
    flat_field: FileName | None = None
    """File (.npy, .tif or grey .png) of a measured flat field, stretched over the image. The image
    is multiplied by its ratio to its centre."""
    point_spread: PointSpread = PointSpread.of_defaults()
    """Blur and glare of the lens."""
    lens_flare: LensFlare | None = None
    """Ghosts of bright sources; `{}` gives those of a generic lens."""
    pixel_um: Annotated[Positive, Field(ge=0.01, le=1e6)] = 5.5
    """Pixel pitch."""
    mosaic: Mosaic = "rggb"
    """Colour filter array, named by the upper left 2 x 2 pixels. mono: no filters. planes: all
    bands of `camera.bands` in the same instant, each over the whole sensor; `raw` is then (H, W,
    bands), and there is no `sensor_rgb`."""
    quantum_efficiency: Annotated[
        Annotated[Efficiency, Tag("boxes")] | Annotated[QuantumEfficiency, Tag("file")],
        Discriminator(_efficiency_tag),
    ] = (0.45, 0.5, 0.4)
    """Electrons per photon within the red, green and blue of `bands_nm`, or a file of curves."""
    bands_nm: Filters = ((600.0, 700.0), (500.0, 600.0), (400.0, 500.0))
    """[begin, end] of the red, green and blue filters. A sensor without filters responds to all
    three."""
    serial: Annotated[Integer, Field(ge=0, lt=2**63)] = 0
    """Serial number of the unit. It seeds all that is fixed in a unit: fixed-pattern noise and
    defects."""
    exposure: SensorExposure = SensorExposure.of_defaults()
    """Exposure of `raw` and `sensor_rgb`; `camera.exposure` is that of `rgb`."""
    prnu: Fraction = 0.008
    """Photo-response non-uniformity: relative standard deviation of the pixels' response."""
    dark_current_e_s: Annotated[NonNegative, Field(le=1e9)] = 5.0
    """Mean dark current per pixel at `dark_reference_c`."""
    dark_reference_c: Finite = 20.0
    """Temperature at which `dark_current_e_s` was measured."""
    dark_doubling_k: Positive = 7.0
    """Temperature rise that doubles the dark current."""
    temperature_c: Annotated[Finite, Field(ge=-273.15, le=200.0)] = 20.0
    """Temperature of the sensor."""
    dark_nonuniform: Annotated[NonNegative, Field(le=100.0)] = 0.3
    """Dark-signal non-uniformity: relative standard deviation of the dark current between pixels
    (log-normal)."""
    hot_pixels: Fraction = 0.0
    """Fraction of hot pixels, which have the dark current `hot_current_e_s`."""
    hot_current_e_s: Annotated[NonNegative, Field(le=1e9)] = 20000.0
    """Mean dark current of hot pixels at any temperature; each has 0.5 to 1.5 times as much."""
    dead_pixels: Fraction = 0.0
    """Fraction of pixels that do not respond to light."""
    shift_us: Annotated[NonNegative, Field(le=1e9)] = 0.0
    """Smear: time that a frame-transfer CCD without a shutter takes to shift by one row."""
    drain: Fraction = 1.0
    """Blooming: fraction of a full pixel's excess charge that is drained; the rest spreads along
    the column. 1: CMOS and CCDs with anti-blooming gates; 0: CCDs without."""
    reset_us: Annotated[NonNegative, Field(le=1e9)] = 0.0
    """Time between the reset of a CMOS pixel and its reference sample. Charge collected in it is
    subtracted from the signal; where it fills the pixel, as in the image of the Sun, the pixel
    turns black. 0: protected against this."""
    cosmic_rays: CosmicRays = CosmicRays.of_defaults()
    """Cosmic rays; none by default."""
    full_well_e: Annotated[Positive, Field(ge=1.0, le=1e12)] = 20000.0
    """Full-well capacity of a pixel."""
    read_noise_e: Annotated[NonNegative, Field(le=1e9)] = 8.0
    """Standard deviation of the read noise."""
    column_noise_e: Annotated[NonNegative, Field(le=1e9)] = 0.0
    """Standard deviation of the column offsets that are the same in all frames."""
    column_flicker_e: Annotated[NonNegative, Field(le=1e9)] = 0.0
    """Standard deviation of the column offsets that are new in each frame."""
    row_noise_e: Annotated[NonNegative, Field(le=1e9)] = 0.0
    """Standard deviation of the row offsets that are new in each frame."""
    gain_e_dn: Annotated[Positive, Field(ge=1e-9, le=1e9)] = 5.0
    """Gain: electrons per digital number."""
    black_level_dn: NonNegative = 64.0
    """Digital number without light or noise."""
    bits: Annotated[Integer, Field(ge=1, le=16)] = 12
    """Bit depth of the digital numbers."""

    compression: Compression | None = None
    """JPEG artefacts in `sensor_rgb`; none by default."""

    @model_validator(mode="before")
    @classmethod
    def _from_preset(cls, data: Any) -> Any:
        if isinstance(data, Mapping) and isinstance(name := data.get("preset"), str):
            if name not in PRESETS:
                fail("preset", f"no sensor '{name}'{nearest(name, PRESETS)}")
            values = dict(PRESETS[name].values)
            if "aperture_mm" in data:
                values.pop("f_number", None)
            return {**values, **data}
        return data

    @model_validator(mode="after")
    def _read(self) -> ImageSensor:
        given = self.model_fields_set
        if "hot_pixels" not in given:
            self._only_with("hot_pixels", "hot_current_e_s")
        if not {"temperature_c", "dark_reference_c"} & given:
            self._only_with("a temperature_c other than dark_reference_c", "dark_doubling_k")
        return self

    @model_validator(mode="after")
    def _sound(self, info: ValidationInfo) -> ImageSensor:
        self._exactly_one("f_number", "aperture_mm", optional=True)
        angles = [angle for angle, _ in self.vignetting_profile or ()]
        if any(a >= b for a, b in itertools.pairwise(angles)):
            fail("vignetting_profile", "the angles must rise")
        for i, (first, last) in enumerate(self.bands_nm):
            if not 10.0 <= first < last <= 100000.0:
                fail(f"bands_nm[{i}]", "must be [shortest, longest], within 10 to 100000")
        if self.black_level_dn > 2**self.bits - 2:
            fail("black_level_dn", f"must be below the largest of {self.bits} bits")
        if isinstance(self.quantum_efficiency, QuantumEfficiency):
            self.quantum_efficiency.check(1 if self.mosaic in ("mono", "planes") else 3, info)
            if "bands_nm" in self.model_fields_set:
                fail("bands_nm", "not together with a file of quantum_efficiency")
        elif not any(self.quantum_efficiency):
            fail("quantum_efficiency", "must be more than 0")
        if self.transmission == 0.0:
            fail("transmission", "must be more than 0")
        return self
