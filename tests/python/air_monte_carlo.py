"""Radiance of air over round ground by Monte Carlo, for tests, benchmarks and figures.

Backward paths of all orders of scattering in spherical geometry, in NumPy, that share nothing with
the core but the numbers of `_core.AirSettings`: each part of a path is cut into cells along the
ray, the next event (scattering in a cell, or the Lambert ground) is drawn by what the bands scatter
there on the mean, and the sun, a point at infinity, is asked for at each event (next-event
estimation). The weights are exact for any choice of cells, so that nothing but the noise and the
integrals of optical depths (CELLS, NODES) is left.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from perilune import _core

F64 = NDArray[np.float64]

CELLS, NODES, ORDERS = 96, 24, 64
_GAUSS = np.polynomial.legendre.leggauss(NODES)


@dataclass(frozen=True)
class Radiance:
    """(bands,) each, 1/sr for a sun of irradiance 1."""

    once: F64
    """Scattered once in the air."""
    ground: F64
    """Sent by the ground straight to the eye, lit by the sun alone."""
    more: F64
    """All that is left: of two events and more."""
    noise: F64
    """Standard error of the sum."""

    @property
    def total(self) -> F64:
        return np.asarray(self.once + self.ground + self.more)


def layers(height_m: F64, scale_m: float, from_m: float, upper_m: float) -> F64:
    """A density of scale height scale_m below and upper_m above from_m, where its logarithm is a
    hyperbola, round over half of their mean; from_m 0: of one scale height."""
    if from_m <= 0.0:
        return np.exp(-height_m / scale_m)
    round_m = 0.25 * (scale_m + upper_m)

    def bend(x: F64 | float) -> F64:
        return np.asarray(0.5 * (x - from_m + np.hypot(x - from_m, round_m)))

    bent = bend(height_m) - bend(0.0)
    return np.exp(-height_m / scale_m - (1.0 / upper_m - 1.0 / scale_m) * bent)


def densities(air: _core.AirSettings, height_m: F64) -> F64:
    """(3, ...) of Rayleigh, Mie and ozone over those of reference; 0 below the ground."""
    inside = (height_m <= air["top_m"]) & (height_m > -1e3)
    away = np.abs(height_m - air["ozone_center_m"]) / air["ozone_width_m"]
    gas = layers(height_m, air["rayleigh_height_m"], *air["rayleigh_upper_m"])
    haze = layers(height_m, air["mie_height_m"], *air["mie_upper_m"])
    return np.stack([gas * inside, haze * inside, np.maximum(0.0, 1.0 - away) * inside])


def extinctions(air: _core.AirSettings) -> F64:
    """(3 constituents, bands), 1/m."""
    return np.array([air["rayleigh_scattering"], air["mie_extinction"], air["ozone_absorption"]])


def rayleigh_phase(cosine: F64) -> F64:
    return 3.0 / (16.0 * math.pi) * (1.0 + cosine**2)


def mie_phase(cosine: F64, g: F64) -> F64:
    """Of Cornette and Shanks."""
    shape = (1.0 - g**2) * (1.0 + cosine**2) / (1.0 + g**2 - 2.0 * g * cosine) ** 1.5
    return np.asarray(3.0 / (8.0 * math.pi) / (2.0 + g**2) * shape)


class World:
    """A round body under air; the sun is towards `sun`, of unit length."""

    def __init__(self, air: _core.AirSettings, radius_m: float, sun: F64, albedo: F64) -> None:
        self.air, self.radius_m, self.sun, self.albedo = air, radius_m, sun, albedo
        self.extinction = extinctions(air)
        self.scattering = np.array([air["rayleigh_scattering"], air["mie_scattering"]])
        self.g = np.array(air["mie_g"])

    def ends(self, at: F64, along: F64) -> tuple[F64, F64, NDArray[np.bool_]]:
        """Of rays in the air: distances to its start and end, and whether the ground ends them."""
        b = (at * along).sum(axis=1)
        r2 = (at**2).sum(axis=1)
        outer = b * b - r2 + (self.radius_m + self.air["top_m"]) ** 2
        inner = b * b - r2 + self.radius_m**2
        reach = np.sqrt(np.maximum(0.0, outer))
        ground = (inner > 0.0) & (b < 0.0) & (outer > 0.0)
        start = np.maximum(0.0, -b - reach)
        end = np.where(ground, -b - np.sqrt(np.maximum(0.0, inner)), np.maximum(start, -b + reach))
        return start, np.where(outer > 0.0, end, start), ground

    def height_m(self, at: F64, along: F64, distance: F64) -> F64:
        """(n, k) of n rays at k distances each."""
        b = (at * along).sum(axis=1)[:, None]
        r2 = (at**2).sum(axis=1)[:, None]
        return np.sqrt(r2 + distance * (2.0 * b + distance)) - self.radius_m

    def depth_to_sun(self, at: F64) -> tuple[F64, NDArray[np.bool_]]:
        """(n, bands), and whether the sun is up."""
        along = np.broadcast_to(self.sun, at.shape)
        _, end, shaded = self.ends(at, along)
        lowest = np.clip(-(at @ self.sun), 0.0, end)
        columns = np.zeros((3, len(at)))
        for low, high in ((lowest, np.zeros_like(end)), (lowest, end)):
            v = 0.5 * (1.0 + _GAUSS[0])  # dense at the lowest point, by a square law
            distance = low[:, None] + (high - low)[:, None] * v**2
            weight = np.abs(high - low)[:, None] * 2.0 * v * 0.5 * _GAUSS[1]
            density = densities(self.air, np.maximum(0.0, self.height_m(at, along, distance)))
            columns += (density * weight).sum(axis=2)
        return columns.T @ self.extinction, ~shaded


def _edges(world: World, at: F64, along: F64) -> tuple[F64, NDArray[np.bool_]]:
    """(n, CELLS + 1) distances, dense about the lowest point, and whether the ground is behind."""
    start, end, ground = world.ends(at, along)
    lowest = np.clip(-(at * along).sum(axis=1), start, end)
    scale = 5e-3 * world.radius_m
    low, high = np.arcsinh((start - lowest) / scale), np.arcsinh((end - lowest) / scale)
    w = low[:, None] + (high - low)[:, None] * np.linspace(0.0, 1.0, CELLS + 1)
    return lowest[:, None] + scale * np.sinh(w), ground


def _step(
    world: World, at: F64, along: F64, u: F64, rng: np.random.Generator
) -> tuple[F64, F64, NDArray[np.bool_]]:
    """The next event of each ray: the place, the weight of each band, whether it is the ground."""
    n = len(at)
    edges, ground = _edges(world, at, along)
    step = np.diff(edges, axis=1)
    height = np.maximum(0.0, world.height_m(at, along, 0.5 * (edges[:, 1:] + edges[:, :-1])))
    density = densities(world.air, height)
    before = np.zeros((3, n, CELLS + 1))
    np.cumsum(density * step, axis=2, out=before[:, :, 1:])
    taken = np.einsum("pnk,pb->nkb", before, world.extinction)
    middle = np.exp(-0.5 * (taken[:, 1:] + taken[:, :-1]))
    sent = np.einsum("pnk,pb->nkb", density[:2], world.scattering) * middle
    masses = np.concatenate(
        [sent.mean(axis=2) * step,
         (ground * (world.albedo * np.exp(-taken[:, -1])).mean(axis=1))[:, None]], axis=1
    )  # fmt: skip
    total = masses.sum(axis=1)
    sums = np.cumsum(masses, axis=1)
    cell = np.minimum((sums < (u * total)[:, None]).sum(axis=1), CELLS)
    hit = cell == CELLS
    k, row = np.minimum(cell, CELLS - 1), np.arange(n)
    part = rng.random(n)
    distance = np.where(hit, edges[:, -1], edges[row, k] + part * step[row, k])
    here = densities(world.air, np.maximum(0.0, world.height_m(at, along, distance[:, None]))[:, 0])
    dimmed = taken[row, k] + (part * step[row, k])[:, None] * (
        0.5 * (here + density[:, row, k]).T @ world.extinction
    )
    chance = masses[row, cell] / np.maximum(total, 1e-300)
    scattered = here[:2].T @ world.scattering
    air = scattered * np.exp(-dimmed) * (step[row, k] / np.maximum(chance, 1e-300))[:, None]
    soil = world.albedo * np.exp(-taken[:, -1]) / np.maximum(chance, 1e-300)[:, None]
    weight = np.where(hit[:, None], soil, air) * (total > 0.0)[:, None]
    return at + distance[:, None] * along, weight, hit


def _turn(along: F64, cosine: F64, azimuth: F64) -> F64:
    """Directions at an angle from others."""
    helper = np.where(np.abs(along[:, :1]) < 0.9, [[1.0, 0.0, 0.0]], [[0.0, 1.0, 0.0]])
    x = np.cross(along, helper)
    x /= np.linalg.norm(x, axis=1, keepdims=True)
    y = np.cross(along, x)
    sine = np.sqrt(np.maximum(0.0, 1.0 - cosine**2))[:, None]
    around = np.cos(azimuth)[:, None] * x + np.sin(azimuth)[:, None] * y
    return np.asarray(sine * around + cosine[:, None] * along)


def _scatter(world: World, at: F64, along: F64, rng: np.random.Generator) -> tuple[F64, F64]:
    """A new direction in the air, and each band's phase function over the chance of it."""
    n = len(at)
    density = densities(world.air, np.maximum(0.0, np.linalg.norm(at, axis=1) - world.radius_m))
    each = density[:2].T[:, :, None] * world.scattering  # (n, 2, bands)
    share = each / np.maximum(each.sum(axis=1, keepdims=True), 1e-300)
    haze = share[:, 1].mean(axis=1)
    mean_g = float(world.g.mean())
    u, v = rng.random(n), rng.random(n)
    q = 4.0 * u - 2.0
    root = np.cbrt(q + np.sqrt(q * q + 1.0))
    rayleigh = root - 1.0 / root
    s = (1.0 - mean_g**2) / (1.0 - mean_g + 2.0 * mean_g * u)
    henyey = (1.0 + mean_g**2 - s * s) / (2.0 * mean_g) if mean_g else 2.0 * u - 1.0
    cosine = np.clip(np.where(v < haze, henyey, rayleigh), -1.0, 1.0)
    drawn = (1.0 - haze) * rayleigh_phase(cosine) + haze * (1.0 - mean_g**2) / (
        4.0 * math.pi * (1.0 + mean_g**2 - 2.0 * mean_g * cosine) ** 1.5
    )
    is_ = share[:, 0] * rayleigh_phase(cosine)[:, None]
    is_ = is_ + share[:, 1] * mie_phase(cosine[:, None], world.g)
    return _turn(along, cosine, 2.0 * math.pi * rng.random(n)), is_ / drawn[:, None]


def _leave(world: World, at: F64, rng: np.random.Generator) -> F64:
    """From the ground, by its cosine."""
    n = len(at)
    up = at / np.linalg.norm(at, axis=1, keepdims=True)
    return _turn(up, np.sqrt(rng.random(n)), 2.0 * math.pi * rng.random(n))


def _from_sun(world: World, at: F64, along: F64, hit: NDArray[np.bool_]) -> F64:
    """What an event sends along its ray of the sun's light, over what it scatters, 1/sr."""
    r = np.linalg.norm(at, axis=1)
    on = np.where(hit[:, None], at * (world.radius_m / r)[:, None] * (1.0 + 1e-12), at)
    depth, up = world.depth_to_sun(on)
    mu = (at @ world.sun) / r
    up = np.where(hit, mu > 0.0, up)
    density = densities(world.air, np.maximum(0.0, r - world.radius_m))
    each = density[:2].T[:, :, None] * world.scattering
    share = each / np.maximum(each.sum(axis=1, keepdims=True), 1e-300)
    cosine = along @ world.sun
    phase = share[:, 0] * rayleigh_phase(cosine)[:, None]
    phase = phase + share[:, 1] * mie_phase(cosine[:, None], world.g)
    ground = np.maximum(0.0, mu)[:, None] / math.pi
    return np.where(hit[:, None], ground, phase) * np.exp(-depth) * up[:, None]


def radiance(
    air: _core.AirSettings,
    radius_m: float,
    point: F64,
    direction: F64,
    sun: F64,
    albedo: F64,
    paths: int,
    seed: int = 0,
) -> Radiance:
    """Along a ray from `point`, (3,), about the body's centre, or the mean over as many rays as
    there are paths: `direction` (3,) or (paths, 3); `sun`: unit, towards it."""
    rng = np.random.default_rng(seed)
    world = World(air, radius_m, np.asarray(sun, np.float64), np.asarray(albedo, np.float64))
    at = np.tile(point, (paths, 1))
    along = np.broadcast_to(direction, (paths, 3)).copy()
    bands = len(world.g)
    parts = np.zeros((3, paths, bands))
    through, owner = np.ones((paths, bands)), np.arange(paths)
    u = (rng.permutation(paths) + rng.random(paths)) / paths
    for order in range(ORDERS):
        at, weight, hit = _step(world, at, along, u, rng)
        through = through * weight
        light = through * _from_sun(world, at, along, hit)
        kind = np.where(hit, 1, 0) if order == 0 else np.full(len(at), 2)
        np.add.at(parts, (kind, owner), light)
        turned, over = _scatter(world, at, along, rng)
        along = np.where(hit[:, None], _leave(world, at, rng), turned)
        through = np.where(hit[:, None], through, through * over)
        # Russian roulette on what is left; paths of no weight end.
        keep = np.minimum(1.0, through.max(axis=1) / 0.1)
        stays = rng.random(len(keep)) < keep
        if not stays.any():
            break
        at, along, owner = at[stays], along[stays], owner[stays]
        through = through[stays] / keep[stays][:, None]
        at = np.where(hit[stays][:, None], at * (1.0 + 1e-9 * radius_m / radius_m), at)
        u = rng.random(len(at))
    total = parts.sum(axis=0)
    return Radiance(*parts.mean(axis=1), noise=total.std(axis=0) / math.sqrt(paths))


def limb_ray(radius_m: float, height_m: float, tangent_m: float) -> tuple[F64, F64]:
    """From a height over the +z axis, a ray in the plane of x whose lowest point is at tangent_m,
    or that would be under the ground."""
    sine = (radius_m + tangent_m) / (radius_m + height_m)
    return np.array([0.0, 0.0, radius_m + height_m]), np.array(
        [sine, 0.0, -math.sqrt(1.0 - sine * sine)]
    )
