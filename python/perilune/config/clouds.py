"""The clouds of a body."""

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
    """A pattern of clouds and gaps, and how it, or the map, is bent."""

    coverage: Fraction | None = None
    """Mean part of the body that clouds cover (default 0.5); with a map a factor on its cover
    (default 1)."""
    size_km: _Length = 2000.0
    """Of the largest clouds and gaps."""
    octaves: _Octaves = 10.0
    """Each adds detail of half the size."""
    roughness: Fraction = 0.55
    """Strength of an octave by the one before."""
    softness: _Softness = 0.35
    """Of the edges: 0.1 is crisp, 1 is mist, 100 leaves a map as it is."""
    warp: _Warp = 0.0
    """By which clouds are bent, over size_km: about 0.3 makes swirls."""
    phase: _Phase = 0.0
    """Changes how they are bent: clouds flow from one shape to the next with it."""
    depth_spread: _Spread = 0.7
    """How uneven the clouds are: standard deviation of the logarithm of their optical depth. 0 is
    a sheet; cloud fields have 0.3 (stratus) to 1.2 (cumulus). Softness makes it less."""
    relief_km: _Relief = 0.3
    """How uneven their tops are: standard deviation of their height. Slopes towards the sun are
    brighter, those away from it darker. Softness makes it less."""
    seed: Annotated[Integer, Field(ge=0, lt=2**32)] = 0
    """Another seed, another pattern."""

    @model_validator(mode="after")
    def _bent(self) -> CloudNoise:
        if "warp" not in self.model_fields_set:
            self._only_with("a warp", "phase")
        return self


class Clouds(Strict):
    """A shell of clouds; a map, a noise or both say what part of each place is covered.

    Without both it is an overcast. Clouds scatter and do not absorb, but for `color`; light that
    goes to and fro between them and the ground is left out. Beneath them the sky is dimmed as the
    sun is.
    """

    map: FileName | None = None
    """Equirectangular PNG, JPEG, WebP or TIFF of the cover: the part of each place that has clouds,
    white for all, as the file's numbers are (red); relative to this file, or data:... under
    PERILUNE_DATA."""
    map_center_lon_deg: StaticFinite = 0.0
    """East longitude of the map's centre column at the start, before `longitude_deg`."""
    latitudes: Latitudes | None = None
    """What latitude the map counts by, as of the body, and by default the body's."""
    altitude_km: _Length = 8.0
    """Of the shell, over the surface."""
    thickness_km: _Length = 2.0
    """Of the layer: rays that pass it level are in it for so long a way as this makes."""
    longitude_deg: Finite = 0.0
    """By which the shell is turned eastwards against the body at the start."""
    rotation_deg_h: Finite = 0.0
    """Degrees an hour at which it turns on eastwards against the body."""
    opacity: Fraction = 1.0
    """Factor on the cover."""
    optical_depth: _Depth = 15.0
    """Of what is covered, straight down: 3 is a veil, 10 a common cloud, 50 a storm."""
    color: _Shares = (1.0, 1.0, 1.0)
    """Factor on the light that they scatter."""
    noise: CloudNoise | None = None
    """Clouds without a map; or what breaks a map's cover into clouds and gaps finer than it shows,
    of the same mean."""

    @model_validator(mode="after")
    def _something_turns(self) -> Clouds:
        if self.map is None:
            self._only_with("a map", "map_center_lon_deg", "latitudes")
            if self.noise is None:
                self._only_with("a map or noise", "longitude_deg", "rotation_deg_h")
        return self
