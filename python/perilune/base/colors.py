"""Colours of labels and values: a perceptual ramp, a stable palette for ids, scaling of values."""

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

F64 = NDArray[np.float64]
U8 = NDArray[np.uint8]

BACKGROUND = np.array([17, 19, 25], dtype=np.uint8)
"""Colour of the sheet itself."""
EMPTY = np.array([30, 33, 41], dtype=np.uint8)
"""Colour of pixels without a value (nothing hit, undefined, class 0)."""

_RAMP_SIZE = 1024
_GOLDEN_ANGLE_RAD = np.pi * (3.0 - np.sqrt(5.0))
_LOG_RATIO = 30.0
"""Values that span more than this ratio are spread logarithmically."""
_SAMPLE_COUNT = 65536
"""Values used to find percentiles: enough for a picture, and bounded for large images."""


def srgb(linear: F64) -> F64:
    """sRGB's encoding of linear values from 0 to 1 (IEC 61966-2-1)."""
    return np.where(linear <= 0.0031308, 12.92 * linear, 1.055 * linear ** (1 / 2.4) - 0.055)


def oklab_to_srgb(lab: F64) -> U8:
    """Oklab (..., 3) to 8-bit sRGB, clipped to the gamut.

    Source: B. Ottosson, "A perceptual color space for image processing", 2020. Steps that are equal
    in Oklab look equal, so a ramp of even lightness shows shape without false edges.
    """
    lightness, a, b = lab[..., 0], lab[..., 1], lab[..., 2]
    long = (lightness + 0.3963377774 * a + 0.2158037573 * b) ** 3
    medium = (lightness - 0.1055613458 * a - 0.0638541728 * b) ** 3
    short = (lightness - 0.0894841775 * a - 1.2914855480 * b) ** 3
    linear = np.stack(
        [
            4.0767416621 * long - 3.3077115913 * medium + 0.2309699292 * short,
            -1.2684380046 * long + 2.6097574011 * medium - 0.3413193965 * short,
            -0.0041960863 * long - 0.7034186147 * medium + 1.7076147010 * short,
        ],
        axis=-1,
    ).clip(0.0, 1.0)
    encoded = srgb(linear)
    return np.rint(encoded * 255.0).astype(np.uint8)


def _lch_to_srgb(lightness: F64, chroma: F64, hue_rad: F64) -> U8:
    lab = np.stack([lightness, chroma * np.cos(hue_rad), chroma * np.sin(hue_rad)], axis=-1)
    return oklab_to_srgb(lab)


@lru_cache(maxsize=1)
def ramp() -> U8:
    """(n, 3): pale yellow (0) through rose to deep blue (1), evenly falling in lightness."""
    t = np.linspace(0.0, 1.0, _RAMP_SIZE)
    hue_rad = np.deg2rad(95.0 - 195.0 * t)
    return _lch_to_srgb(0.95 - 0.60 * t, 0.10 + 0.09 * np.sin(np.pi * t), hue_rad)


def id_colors(ids: NDArray[np.integer]) -> U8:
    """A colour for each id (...,), the same in every sheet; id 0 is the background."""
    index = np.asarray(ids).astype(np.float64)
    lightness = 0.60 + 0.12 * np.mod(index, 3.0)
    colors = _lch_to_srgb(lightness, np.full_like(index, 0.13), index * _GOLDEN_ANGLE_RAD)
    colors[np.asarray(ids) == 0] = EMPTY
    return colors


def colored_ids(ids: NDArray[np.integer]) -> U8:
    """(H, W) ids to (H, W, 3). Looks colours up once per id, not per pixel."""
    smallest, largest = int(ids.min()), int(ids.max())
    if largest - smallest < 1 << 16:
        palette = id_colors(np.arange(smallest, largest + 1))
        return np.asarray(palette[ids.astype(np.int64) - smallest])
    unique, inverse = np.unique(ids, return_inverse=True)
    return np.asarray(id_colors(unique)[inverse.reshape(ids.shape)])


@dataclass(frozen=True)
class Scaled:
    """Values scaled to 0..1 for colouring."""

    t: NDArray[np.float64]  # (H, W), 0 where undefined
    low: float
    high: float
    rule: str  # "linear" | "log"


def _thinned(values: NDArray[np.floating]) -> F64:
    step = max(1, values.size // _SAMPLE_COUNT)
    return np.sort(values[::step].astype(np.float64))


def scale_values(
    values: NDArray[np.floating], valid: NDArray[np.bool_], spread: bool = True
) -> Scaled | None:
    """Monotonic map of the valid values to 0..1; None if there are none.

    With `spread`, positive values of a large ratio are mapped by the mean of their logarithm and
    their rank, so that a spacecraft metres away and a limb thousands of kilometres away both show
    relief."""
    chosen = values[valid]
    if chosen.size == 0:
        return None
    low, high = float(chosen.min()), float(chosen.max())
    t = np.zeros(values.shape)
    if high <= low:
        t[valid] = 0.5
        return Scaled(t, low, high, "linear")
    if spread and low > 0.0 and high / low > _LOG_RATIO:
        sample = _thinned(chosen)
        rank = np.interp(chosen, sample, np.linspace(0.0, 1.0, sample.size))
        t[valid] = 0.5 * rank + 0.5 * np.log(chosen / low) / np.log(high / low)
        return Scaled(t, low, high, "log")
    t[valid] = (chosen - low) / (high - low)
    return Scaled(t, low, high, "linear")


def colored_values(scaled: Scaled | None, valid: NDArray[np.bool_]) -> U8:
    """(H, W, 3): the ramp over `scaled`, dark where not valid."""
    image = np.empty((*valid.shape, 3), dtype=np.uint8)
    image[:] = EMPTY
    if scaled is not None:
        image[valid] = ramp()[(scaled.t[valid] * (_RAMP_SIZE - 1)).astype(np.int64)]
    return image


def stretch_by_group(
    values: NDArray[np.floating], valid: NDArray[np.bool_], groups: NDArray[np.integer] | None
) -> U8:
    """(H, W, 3) vectors as colours: each axis is stretched to 0..255 within each group of pixels.

    Without groups the whole picture is one. Grouping by instance keeps the relief of a satellite
    visible beside a planet whose coordinates are a million times larger."""
    image = np.empty(values.shape, dtype=np.uint8)
    image[:] = EMPTY
    keys = np.zeros(valid.shape, dtype=np.int64) if groups is None else groups.astype(np.int64)
    for key in np.unique(keys[valid]):
        mask = valid & (keys == key)
        chosen = values[mask].astype(np.float64)
        low, high = chosen.min(axis=0), chosen.max(axis=0)
        span = np.where(high > low, high - low, 1.0)
        image[mask] = np.rint(35.0 + 220.0 * (chosen - low) / span).astype(np.uint8)
    return image
