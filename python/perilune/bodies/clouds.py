"""From the clouds of a configuration and the time to the core's settings."""

from __future__ import annotations

import math

from perilune import _core
from perilune.config.clouds import CloudNoise, Clouds
from perilune.config.schema import Config

_HOUR_S = 3600.0


def _turn_rad(given: Clouds, t_s: float) -> float:
    """Rotation of the shell relative to the body, including the centre longitude of its map."""
    turned = given.longitude_deg + given.rotation_deg_h * (t_s / _HOUR_S)
    center = given.map_center_lon_deg if given.map is not None else 0.0
    return math.radians(math.fmod(turned + center, 360.0))


def settings(given: Clouds, t_s: float) -> _core.CloudSettings:
    """The core's settings; t_s: seconds after the epoch."""
    noise = given.noise or CloudNoise(coverage=1.0)  # an overcast, or the map as it is
    coverage = noise.coverage
    if coverage is None:
        coverage = 0.5 if given.map is None else 1.0
    return {
        "altitude_m": 1e3 * given.altitude_km,
        "thickness_m": 1e3 * given.thickness_km,
        "turn_rad": _turn_rad(given, t_s),
        "opacity": given.opacity,
        "depth": given.optical_depth,
        "color": given.color,
        "coverage": coverage,
        "softness": noise.softness,
        "octaves": noise.octaves if given.noise is not None else 0.0,
        "roughness": noise.roughness,
        "size_m": 1e3 * noise.size_km,
        "warp": noise.warp,
        "phase": noise.phase,
        "depth_spread": noise.depth_spread if given.noise is not None else 0.0,
        "relief_m": 1e3 * noise.relief_km if given.noise is not None else 0.0,
        "seed": noise.seed,
    }


def rows(config: Config, t_s: float) -> list[_core.CloudSettings | None]:
    """Settings for each body of a configuration; None without clouds."""
    return [
        None if body.clouds is None else settings(body.clouds, t_s)
        for body in config.bodies.values()
    ]
