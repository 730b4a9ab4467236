"""From the rings of a configuration to the core's settings."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from perilune import _core
from perilune.config.rings import Rings

F64 = NDArray[np.float64]

_ALPHA_MAX = 1.0 - 0.5 / 255.0
"""Opaque texels of 8 bits count as half a step less: an optical depth of 6.2."""


@dataclass(frozen=True)
class Profile:
    """Radial intervals of uniform ring material."""

    edges_m: F64
    """(n + 1,) radii, ascending."""
    depth: F64
    """(n,) optical depth along the normal."""
    albedo: F64
    """(n, 3) single-scattering albedo, linear."""


def _of_map(given: Rings, columns: F64) -> Profile:
    """columns: (n, 4) linear RGBA."""
    assert given.inner_radius_km is not None
    assert given.outer_radius_km is not None
    factor = 1.0 if given.optical_depth is None else given.optical_depth
    edges_km = np.linspace(given.inner_radius_km, given.outer_radius_km, len(columns) + 1)
    alpha = np.minimum(columns[:, 3], _ALPHA_MAX)
    albedo = np.minimum(columns[:, :3] * np.array(given.albedo or (1.0, 1.0, 1.0)), 1.0)
    return Profile(1e3 * edges_km, -factor * np.log1p(-alpha), albedo)


def _of_ringlets(given: Rings) -> Profile:
    edges_km, depth, albedo = [given.ringlets[0].inner_radius_km], [], []
    for ringlet in given.ringlets:
        if ringlet.inner_radius_km > edges_km[-1]:
            edges_km.append(ringlet.inner_radius_km)
            depth.append(0.0)
            albedo.append((0.0, 0.0, 0.0))
        edges_km.append(ringlet.outer_radius_km)
        depth.append(ringlet.optical_depth)
        albedo.append(ringlet.albedo)
    return Profile(1e3 * np.array(edges_km), np.array(depth), np.array(albedo))


def profile(given: Rings, columns: F64 | None) -> Profile:
    """columns: (n, 4) mean linear RGBA of the map's columns, if there is a map."""
    if given.ringlets:
        return _of_ringlets(given)
    if columns is not None:
        return _of_map(given, columns)
    assert given.inner_radius_km is not None
    assert given.outer_radius_km is not None
    edges_m = 1e3 * np.array([given.inner_radius_km, given.outer_radius_km])
    return Profile(edges_m, np.array([given.optical_depth]), np.array([given.albedo]))


def rings_of(given: Rings, columns: F64 | None) -> _core.Rings:
    """The core's settings; columns: see `profile`."""
    made = profile(given, columns)
    return _core.Rings(
        made.edges_m,
        made.depth,
        made.albedo,
        given.phase_exponent,
        given.dust_share,
        given.dust_g,
    )
