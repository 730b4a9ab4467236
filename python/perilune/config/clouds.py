"""The section `clouds` of a body."""

from __future__ import annotations

from typing import Annotated

from pydantic import BeforeValidator, Field, model_validator

from perilune.config.types import (
    FileName,
    Finite,
    Fraction,
    Integer,
    Latitudes,
    StaticFinite,
    Strict,
    triple,
)

_Length = Annotated[float, Field(strict=True, allow_inf_nan=False, ge=1e-9, le=1e12)]
_Depth = Annotated[float, Field(strict=True, allow_inf_nan=False, ge=0.0, le=1e6)]
_Octaves = Annotated[float, Field(strict=True, ge=1.0, le=16.0)]
_Softness = Annotated[float, Field(strict=True, ge=0.01, le=100.0)]
_Warp = Annotated[float, Field(strict=True, ge=-10.0, le=10.0)]
_Phase = Annotated[float, Field(strict=True, ge=-1e6, le=1e6)]
_Spread = Annotated[float, Field(strict=True, ge=0.0, le=5.0)]
_Relief = Annotated[float, Field(strict=True, ge=0.0, le=1e6)]
_Shares = Annotated[tuple[Fraction, Fraction, Fraction], BeforeValidator(triple)]


class CloudNoise(Strict):
    """A procedural pattern of clouds and gaps, and its distortion."""

    coverage: Fraction | None = None
    """Mean fraction of the body that clouds cover (default 0.5); with a map, a factor on its cover
    (default 1)."""
    size_km: _Length = 2000.0
    """Size of the largest clouds and gaps."""
    octaves: _Octaves = 10.0
    """Number of octaves; each adds detail of half the size."""
    roughness: Fraction = 0.55
    """Amplitude of an octave relative to the one before."""
    softness: _Softness = 0.35
    """Softness of the edges: 0.1 is crisp, 1 is mist, 100 leaves a map unchanged."""
    warp: _Warp = 0.0
    """Domain warping, as a fraction of size_km; about 0.3 makes swirls."""
    phase: _Phase = 0.0
    """Phase of the warping; clouds flow from one shape to the next as it changes."""
    depth_spread: _Spread = 0.7
    """Variation of the optical depth: standard deviation of its logarithm. 0: a uniform sheet;
    measured cloud fields have 0.3 (stratus) to 1.2 (cumulus). Softness reduces it."""
    relief_km: _Relief = 0.3
    """Variation of the tops: standard deviation of their height. Slopes facing the Sun are
    brighter, those facing away darker. Softness reduces it."""
    seed: Annotated[Integer, Field(ge=0, lt=2**32)] = 0
    """Seed of the pattern."""

    @model_validator(mode="after")
    def _bent(self) -> CloudNoise:
        if "warp" not in self.model_fields_set:
            self._only_with("a warp", "phase")
        return self


class Clouds(Strict):
    """A cloud layer whose cover comes from a map, a noise or both; an overcast without either.

    Clouds scatter light and, but for `color`, do not absorb it. Light reflected to and fro between
    clouds and ground is left out. Beneath clouds, skylight is dimmed as sunlight is."""

    map: FileName | None = None
    """Cloud cover: equirectangular PNG, JPEG, WebP or TIFF, whose red channel is read linearly;
    white is fully covered. Relative to this file, or data:... under PERILUNE_DATA."""
    map_center_lon_deg: StaticFinite = 0.0
    """East longitude of the map's centre column at the epoch, before `longitude_deg`."""
    latitudes: Latitudes | None = None
    """Latitude of the map, geodetic or geocentric. Default: the body's."""
    altitude_km: _Length = 8.0
    """Altitude of the layer above the surface."""
    thickness_km: _Length = 2.0
    """Thickness of the layer; it limits the path of horizontal rays within the layer."""
    longitude_deg: Finite = 0.0
    """Eastward rotation of the layer relative to the body at the epoch."""
    rotation_deg_h: Finite = 0.0
    """Eastward rate of rotation relative to the body."""
    opacity: Fraction = 1.0
    """Factor on the cover."""
    optical_depth: _Depth = 15.0
    """Vertical optical depth where covered: 3 is thin, 10 common, 50 a storm."""
    color: _Shares = (1.0, 1.0, 1.0)
    """Factor on the scattered light: a number for all bands, or [r, g, b]."""
    noise: CloudNoise | None = None
    """Procedural clouds. With a map, the noise breaks its cover into clouds and gaps finer than its
    texels and keeps the mean."""

    @model_validator(mode="after")
    def _something_turns(self) -> Clouds:
        if self.map is None:
            self._only_with("a map", "map_center_lon_deg", "latitudes")
            if self.noise is None:
                self._only_with("a map or noise", "longitude_deg", "rotation_deg_h")
        return self
