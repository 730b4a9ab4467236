"""The section `camera.sensor` of the schema: what turns radiance into digital numbers."""

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
    """How long the sensor gathers light."""

    mode: Literal["auto", "fixed"] = "auto"
    """auto: by what is seen; fixed: `camera.exposure_time_s`."""
    metering: Literal["percentile", "mean"] = "percentile"
    """auto: by the percentile of the lit pixels, or by the mean of all pixels of the window."""
    percentile: Annotated[float, Field(strict=True, gt=0.0, le=100.0)] = 99.0
    """auto: this percentile of the lit pixels ..."""
    key: Annotated[Fraction, Field(ge=1e-6)] = 0.7
    """... or the mean is brought to this fraction of white, linear."""
    window: tuple[Fraction, Fraction, Fraction, Fraction] = (0.0, 0.0, 1.0, 1.0)
    """auto: left, upper, right and lower edge of the part of the image that is metered."""
    saturated: Fraction = 1.0
    """auto: at most this part of the window's pixels may be overexposed; 1: no limit."""
    min_ms: Annotated[Positive, Field(ge=1e-9, le=1e12)] = 0.01
    """auto: the shortest time; what is brighter is overexposed."""
    max_ms: Annotated[Positive, Field(ge=1e-9, le=1e12)] = 10000.0
    """auto: the longest time; what is darker stays dark."""
    step_ms: Annotated[NonNegative, Field(le=1e12)] = 0.0
    """auto: times are whole multiples of this, rounded down; 0: any time."""
    times_ms: Annotated[tuple[Positive, ...], Field(min_length=1, max_length=64)] | None = None
    """auto: the times that the camera has, rising: the longest that is not too long."""
    gains: Annotated[tuple[_Gain, ...], Field(min_length=1, max_length=16)] = (1.0,)
    """auto: steps of gain, rising: gain_e_dn is divided by the first for which max_ms suffices."""
    lag_frames: Annotated[Integer, Field(ge=0, le=1000)] = 0
    """auto: measured so many frames earlier, of this sensor in this scene; the first of a scene
    counts for those before it."""

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
    """What the lens makes of a point: a core, and wings of a power law (glare)."""

    core: Literal["point", "gauss", "airy", "measured"] = "gauss"
    """point: all light in its pixel; airy: diffraction by the aperture; measured: `kernel`, and the
    default where that is given."""
    kernel: FileName | None = None
    """measured: file (.npy, .tif, grey .png) of the image of a point in pixels of the sensor; any
    size, its middle is the pixel (width // 2, height // 2). Divided by its sum."""
    sigma_px: Annotated[Positive, Field(ge=0.001, le=1e4)] = 0.5
    """gauss: standard deviation."""
    wings: Fraction = 0.0
    """Part of the light that is in the wings; lenses have 0.005 to 0.03."""
    wing_radius_px: Annotated[Positive, Field(ge=0.001, le=1e4)] = 2.0
    """Where the wings turn down."""
    wing_beta: Annotated[Positive, Field(ge=1.001, le=100.0)] = 1.4
    """The wings fall as the distance to the power of -2 wing_beta."""

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
    """Particles that leave charge along their tracks."""

    flux_cm2_s: Annotated[NonNegative, Field(le=1e11)] = 0.0
    """Rays a square centimetre and second. Galactic rays in deep space: about 4."""
    electrons_um: Annotated[NonNegative, Field(le=1e9)] = 80.0
    """Electrons that a micrometre of track frees; 80 in silicon by a fast proton."""
    depth_um: Annotated[NonNegative, Field(le=1e6)] = 10.0
    """Of the layer whose charge is gathered."""

    @model_validator(mode="after")
    def _some(self) -> CosmicRays:
        if "flux_cm2_s" not in self.model_fields_set:
            self._only_with("a flux_cm2_s", "electrons_um", "depth_um")
        return self


def _efficiency_tag(value: Any) -> str:
    return "file" if isinstance(value, (Mapping, QuantumEfficiency)) else "boxes"


class Compression(Strict):
    """JPEG: what the channel `sensor_rgb` shows is encoded and decoded again; `raw` is not."""

    quality: Annotated[float, Field(strict=True, ge=1.0, le=100.0)] = 90.0
    """As of libjpeg: 1 is coarsest, 100 finest; rounded to a whole number."""
    chroma: Literal["444", "422", "420"] = "420"
    """How many pixels share a colour: none, 2 in a row, 2 x 2. A text."""


class ImageSensor(Strict):
    """An image sensor behind a lens: makes the channels `raw` and `sensor_rgb`.

    The linear model of EMVA 1288: photons, electrons, digital numbers.
    """

    preset: Name | None = None
    """A ready sensor, whose values are the defaults of all keys that are not given; see
    perilune.config.sensor_presets for what is from data sheets and what is assumed."""
    f_number: Annotated[Positive, Field(ge=0.5, le=1e6)] | None = None
    """Focal length over aperture; 4 where neither this nor aperture_mm is given."""
    aperture_mm: Positive | None = None
    """Diameter of the aperture instead; the focal length is the camera's in pixels of pixel_um."""
    pupil: Literal["sine", "plane"] = "sine"
    """Irradiance on the axis of a radiance L. sine: pi L / (4 N^2), of lenses without coma; plane:
    pi L / (4 N^2 + 1), through a flat opening. They differ by 6 % at N = 2."""
    transmission: Fraction = 0.9
    """Of the lens, all surfaces."""
    vignetting: Annotated[NonNegative, Field(le=100.0)] | None = None
    """Light falls off as this power of the cosine of the angle to the axis; 4: a thin lens. Left
    out: 4, or 0 where a profile or a flat field says what is left."""
    vignetting_profile: Profile | None = None
    """[angle to the axis in degrees, part of the light], by rising angle; linear between."""
    flat_field: FileName | None = None
    """File (.npy, .tif, grey .png) of a measured flat field: its ratio to its middle multiplies.
    Stretched over the image."""
    point_spread: PointSpread = PointSpread()
    """Blur and glare of the lens."""
    lens_flare: LensFlare | None = None
    """Ghosts of bright sources; `{}` has those of a generic lens."""
    pixel_um: Annotated[Positive, Field(ge=0.01, le=1e6)] = 5.5
    """Side of a pixel."""
    mosaic: Mosaic = "rggb"
    """Filters of the first two pixels and of those below them; mono: none; planes: the bands of
    `camera.bands` before the whole sensor in turn, at one time: `raw` is (H, W, bands), and there
    is no `sensor_rgb`."""
    quantum_efficiency: Annotated[
        Annotated[Efficiency, Tag("boxes")] | Annotated[QuantumEfficiency, Tag("file")],
        Discriminator(_efficiency_tag),
    ] = (0.45, 0.5, 0.4)
    """Electrons a photon in the red, green and blue of `bands_nm`, or a file of curves."""
    bands_nm: Filters = ((600.0, 700.0), (500.0, 600.0), (400.0, 500.0))
    """Red, green and blue: where each begins and ends. Without filters all three count."""
    serial: Annotated[Integer, Field(ge=0, lt=2**63)] = 0
    """Which unit of its kind: what is fixed in a unit is drawn from it."""
    exposure: SensorExposure = SensorExposure()
    """Of `raw` and `sensor_rgb`; `camera.exposure` is that of `rgb`."""
    prnu: Fraction = 0.008
    """Relative standard deviation of the pixels' response."""
    dark_current_e_s: Annotated[NonNegative, Field(le=1e9)] = 5.0
    """Electrons a second and pixel at `dark_reference_c`."""
    dark_reference_c: Finite = 20.0
    """Temperature of the sensor that `dark_current_e_s` is of."""
    dark_doubling_k: Positive = 7.0
    """Warming by this doubles the dark current."""
    temperature_c: Annotated[Finite, Field(ge=-273.15, le=200.0)] = 20.0
    """Of the sensor."""
    dark_nonuniform: Annotated[NonNegative, Field(le=100.0)] = 0.3
    """Relative standard deviation of the dark current between pixels (log-normal)."""
    hot_pixels: Fraction = 0.0
    """Part of the pixels that have the dark current `hot_current_e_s`."""
    hot_current_e_s: Annotated[NonNegative, Field(le=1e9)] = 20000.0
    """Of hot pixels; from half to one and a half of it, at any temperature."""
    dead_pixels: Fraction = 0.0
    """Part of the pixels that see nothing."""
    shift_us: Annotated[NonNegative, Field(le=1e9)] = 0.0
    """Time in which a frame-transfer CCD without a shutter shifts by a row: smear."""
    drain: Fraction = 1.0
    """Part of a full pixel's excess that is drained off; the rest blooms along the column. CMOS and
    CCDs with anti-blooming gates: 1; CCDs without: 0."""
    reset_us: Annotated[NonNegative, Field(le=1e9)] = 0.0
    """Time from a CMOS pixel's reset to the sample that its signal is counted from. What it gathers
    then is missing; where that fills the pixel the image is black, as the sun's. 0: protected."""
    cosmic_rays: CosmicRays = CosmicRays()
    """None by default."""
    full_well_e: Annotated[Positive, Field(ge=1.0, le=1e12)] = 20000.0
    """Electrons that a pixel holds."""
    read_noise_e: Annotated[NonNegative, Field(le=1e9)] = 8.0
    """Standard deviation of the noise of reading a pixel."""
    column_noise_e: Annotated[NonNegative, Field(le=1e9)] = 0.0
    """Standard deviation of an offset that a column keeps in all frames."""
    column_flicker_e: Annotated[NonNegative, Field(le=1e9)] = 0.0
    """Standard deviation of an offset that a column has anew in each frame."""
    row_noise_e: Annotated[NonNegative, Field(le=1e9)] = 0.0
    """Standard deviation of an offset that a row has anew in each frame."""
    gain_e_dn: Annotated[Positive, Field(ge=1e-9, le=1e9)] = 5.0
    """Electrons a digital number."""
    black_level_dn: NonNegative = 64.0
    """Digital number of no light."""
    bits: Annotated[Integer, Field(ge=1, le=16)] = 12
    """Of a digital number."""

    compression: Compression | None = None
    """Artefacts of JPEG in the channel `sensor_rgb`; none without it."""

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
