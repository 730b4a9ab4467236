"""Worlds with clouds, straight through the core, and what a picture of them should be."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import air_worlds
import numpy as np
from numpy.typing import NDArray
from PIL import Image

from perilune import _core
from perilune.bodies import clouds
from perilune.config.clouds import Clouds

F64 = NDArray[np.float64]
G = 0.85


def write_map(path: Path, cover: F64) -> str:
    """A grey picture of (H, W) of 0..1."""
    Image.fromarray(np.rint(255.0 * cover).astype(np.uint8)).save(path)
    return str(path)


def render(
    given: Clouds | None,
    asked: dict[str, Any],
    *,
    air: _core.Air | None = None,
    t_s: float = 0.0,
    threads: int = 1,
) -> dict[str, Any]:
    """Of the first body; others have none. given.map: a path."""
    world = _core.Scene(1)
    cover = None if given is None or given.map is None else _core.Map(given.map, srgb=False)
    for index in range(len(asked["body_radii"])):
        world.add_body(
            name=f"body{index}",
            map=None,
            map_center_lon_rad=0.0,
            reflectance="lambert",
            instance_id=index + 1,
            part_id=index + 1,
            class_ids=np.array([index + 1], dtype=np.uint16),
            regolith_map=None,
            air=air if index == 0 else None,
            cloud_map=cover if index == 0 else None,
        )
    row = None if given is None else clouds.settings(given, t_s)
    asked = {**asked, "body_clouds": [row] + [None] * (len(asked["body_radii"]) - 1)}
    return air_worlds.render(world, asked, threads)


def reflected(depth: float, mu: F64 | float) -> F64:
    """The delta-Eddington albedo of a layer without absorption (Meador and Weaver 1980)."""
    mu = np.asarray(mu, dtype=np.float64)
    scaled, g = (1.0 - G * G) * depth, G / (1.0 + G)
    g1, g3 = 0.75 * (1.0 - g), 0.5 - 0.75 * g * mu
    part = g1 * scaled + (g3 - g1 * mu) * -np.expm1(-scaled / mu)
    return np.asarray(part / (1.0 + g1 * scaled))


def photons(depth: float, mu: float, count: int, seed: int) -> tuple[float, float]:
    """Parts of the light that a layer sends back and lets through straight: photons that scatter by
    Henyey and Greenstein's law until they are out."""
    rng = np.random.default_rng(seed)
    at, cosine = np.zeros(count), np.full(count, mu)  # depth, and cosine downwards
    at += -np.log(rng.random(count)) * cosine
    straight = float((at > depth).mean())
    inside = at <= depth
    back, at, cosine = 0, at[inside], cosine[inside]
    while len(at):
        u = (1.0 - G * G) / (1.0 - G + 2.0 * G * rng.random(len(at)))
        turn = (1.0 + G * G - u * u) / (2.0 * G)
        azimuth = 2.0 * math.pi * rng.random(len(at))
        across = np.sqrt((1.0 - turn**2) * np.maximum(0.0, 1.0 - cosine**2))
        cosine = np.clip(turn * cosine + across * np.cos(azimuth), -1.0, 1.0)
        at = at - np.log(rng.random(len(at))) * cosine
        back += int((at < 0.0).sum())
        inside = (at >= 0.0) & (at <= depth)
        at, cosine = at[inside], cosine[inside]
    return back / count, straight


def hit(origin: F64, directions: F64, radius_m: float, far: bool = False) -> F64:
    """Distance to a sphere about the origin; nan for none ahead. origin: (3,) or (n, 3)."""
    along = (origin * directions).sum(axis=-1)
    left = along**2 - (origin * origin).sum(axis=-1) + radius_m**2
    with np.errstate(invalid="ignore"):
        t = -along + np.sqrt(left) * (1.0 if far else -1.0)
    return np.asarray(np.where(t > 0.0, t, np.nan))
