"""Shadows on terrain beside exact ones: of a cone, a ridge and a crater, under three Suns."""

from __future__ import annotations

import math
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

import perilune
from perilune.base import rotations
from perilune.frame import shutter

F64 = NDArray[np.float64]
Shape = Callable[[F64, F64], F64]
RADIUS_M = 1737.4e3
LON, LAT = math.radians(20.0), math.radians(10.0)
EAST = np.array([-math.sin(LON), math.cos(LON), 0.0])
NORTH = np.array([-math.sin(LAT) * math.cos(LON), -math.sin(LAT) * math.sin(LON), math.cos(LAT)])
UP = np.cross(EAST, NORTH)
WIDTH, HEIGHT = 384, 72


def cone(x: F64, y: F64) -> F64:
    return np.maximum(6.0 - 0.3 * np.hypot(x, y), 0.0)


def ridge(x: F64, y: F64) -> F64:
    """A roof with hips."""
    return np.maximum(np.minimum(6.0 - 0.3 * np.abs(x), 0.3 * (30.0 - np.abs(y))), 0.0)


def crater(x: F64, y: F64) -> F64:
    """A bowl 4 m deep, a rim of 1.2 m at a radius of 20 m."""
    r = np.hypot(x, y) / 20.0
    return np.where(r < 1.0, 5.2 * r**2 - 4.0, 1.2 * np.maximum(2.0 - r, 0.0))


SHAPES = {"cone": cone, "ridge": ridge, "crater": crater}
SUNS = {0.5: (760.0, 1.0), 5.0: (130.0, 1.0), 45.0: (90.0, 6.0)}
"""Sun's elevation in degrees -> width of the frame, and a factor on heights."""


def moved(shape: Shape, by_m: float) -> list[Shape]:
    """The shape, and the highest and the lowest that is within half a cell."""

    def around(x: F64, y: F64) -> F64:
        return np.stack([
            shape(x + by_m * a, y + by_m * b) for a in (-1.0, 0.0, 1.0) for b in (-1.0, 0.0, 1.0)
        ])  # fmt: skip

    return [
        shape,
        lambda x, y: around(x, y).max(axis=0),
        lambda x, y: around(x, y).min(axis=0),
    ]


def creased(shape: Shape, steep: float, x: F64, y: F64, by_m: float) -> NDArray[np.bool_]:
    """Where a crease is within this distance: a cell across it lies on neither side."""
    ways = [by_m * np.array([math.cos(turn), math.sin(turn)]) for turn in np.arange(4) * 0.785]
    bends = [shape(x + a, y + b) + shape(x - a, y - b) - 2.0 * shape(x, y) for a, b in ways]
    return np.abs(bends).max(axis=0) > 0.08 * by_m * steep


def points(x: F64, y: F64, height_m: F64) -> F64:
    """Body axes, of orthographic coordinates."""
    z = np.sqrt(RADIUS_M**2 - x**2 - y**2)
    place = x[..., None] * EAST + y[..., None] * NORTH + z[..., None] * UP
    return place * (1.0 + height_m / RADIUS_M)[..., None]


def in_shadow(shape: Shape, x: F64, y: F64, sun: F64, step_m: float) -> NDArray[np.bool_]:
    """Whether points on the shape see none of a point Sun: a march along the way to it, on the
    sphere. The Sun is in the east, and all is flat beyond 55 m."""
    start = points(x, y, shape(x, y))
    first = np.maximum(0.01, (-55.0 - x) / (sun @ EAST))
    dark = np.zeros(len(x), bool)
    for t in np.arange(0.0, 110.0 / (sun @ EAST), step_m):
        at = start + (first + t)[:, None] * sun
        away = np.linalg.norm(at, axis=1)
        over = at * (RADIUS_M / away)[:, None]
        dark |= away - RADIUS_M < shape(over @ EAST, over @ NORTH) - 1e-9
    return dark


def frame(
    folder: Path, shape: Shape, elevation_deg: float, wide_m: float
) -> tuple[F64, F64, NDArray[np.bool_]]:
    """Coordinates of pixels, and whether they are in shadow; a point Sun in the east. What the mask
    says is black in colour, and the rest of that faces away."""
    along = 0.25 * np.arange(-220, 221)
    y, x = np.meshgrid(along[::-1], along, indexing="ij")
    np.save(folder / "shape.npy", shape(x, y).astype(np.float32))
    site = {"lon_deg": math.degrees(LON), "lat_deg": math.degrees(LAT)}
    place = {"kind": "orthographic", "center_lon_lat_deg": list(site.values()), "post_m": 0.25}
    fov = math.radians(30.0)
    west_m = 0.5 * wide_m - 35.0
    above = {
        "kind": "hover", "target": "moon", "clearance_m": None, "altitude_above": "datum",
        "lon_deg": math.degrees(LON - west_m / RADIUS_M / math.cos(LAT)),
        "lat_deg": site["lat_deg"], "azimuth_deg": 0.0,
        "height_m": 0.5 * wide_m / math.tan(0.5 * fov),
    }  # fmt: skip
    tree: dict[str, Any] = {
        "version": 1,
        "time": {"epoch": "2026-03-03T06:00:00Z"},
        "root": "moon",
        "sun": {"at": site | {"azimuth_deg": 90.0, "elevation_deg": elevation_deg}},
        "bodies": {"moon": {"kind": "moon", "albedo": 0.3, "terrain": {
            "elevation": [{"file": str(folder / "shape.npy"), "projection": place}],
            "detail": None}}},
        "camera": {"width": WIDTH, "height": HEIGHT, "fov_deg": math.degrees(fov),
                   "trajectory": above, "exposure": {"mode": "auto"}},
        "render": {"samples": 1, "max_bounces": 0, "force_off": ["soft_sun", "antialiasing"]},
    }  # fmt: skip
    sim = perilune.open(tree)
    sample = sim.frame(0, ["radiance", "position", "shadow", "incidence"], threads=1)
    black, masked = sample["radiance"][..., 1] == 0.0, sample["shadow"] == 1
    away = sample["incidence"] > 0.5 * math.pi - 1e-4
    assert (masked & ~black).sum() + (black & ~masked & ~away).sum() <= 5  # by rounding
    pose = shutter.middle(sim.world(0)).poses["moon"][0]
    place_m = (sample["position"].astype(float) - pose[:3]) @ rotations.to_matrix(pose[3:])
    over = place_m * (RADIUS_M / np.linalg.norm(place_m, axis=-1, keepdims=True))
    return over @ EAST, over @ NORTH, masked


@pytest.mark.parametrize("elevation_deg", SUNS)
@pytest.mark.parametrize("name", SHAPES)
def test_shadows_have_exact_outlines(tmp_path: Path, name: str, elevation_deg: float) -> None:
    """Within half of a cell's diagonal, cells being up to 1.4 pixels wide: a pixel counts where it
    stays light, or dark, if it or the shape moves by so much, and where no crease is as near."""
    wide_m, steep = SUNS[elevation_deg]

    def shape(x: F64, y: F64) -> F64:
        return steep * SHAPES[name](x, y)

    x, y, dark = frame(tmp_path, shape, elevation_deg, wide_m)
    half_m = wide_m / WIDTH
    # Half of the pixels are near an outline.
    edge = np.zeros_like(dark)
    for axis in (0, 1):
        for step in (-5, 5):
            edge |= np.roll(dark, step, axis) != dark
    rng = np.random.default_rng(1)
    near = rng.permutation(np.flatnonzero(edge))[:150]
    pick = np.concatenate([near, rng.integers(0, dark.size, 150)])
    x, y, dark = x.ravel()[pick], y.ravel()[pick], dark.ravel()[pick]
    elevation = math.radians(elevation_deg)
    sun = math.cos(elevation) * EAST + math.sin(elevation) * UP
    found = np.stack([
        in_shadow(of, x + a, y + b, sun, 0.2)
        for of in moved(shape, half_m)
        for a, b in ((0.0, 0.0), (half_m, 0.0), (-half_m, 0.0), (0.0, half_m), (0.0, -half_m))
    ])  # fmt: skip
    sure = (found.all(axis=0) | ~found.any(axis=0)) & ~creased(shape, steep, x, y, half_m)
    assert 0.2 < dark.mean() < 0.8
    assert sure[len(near) :].mean() > 0.8
    assert sure[: len(near)].mean() > 0.4
    np.testing.assert_array_equal(dark[sure], found[0][sure])
    assert (dark != found[0]).mean() < 0.08


class Heights:
    """Heights of the ground about the south pole, between nodes of one lattice of a face of the
    cube."""

    def __init__(self, terrain: Any, level: int, middle: F64, half: int) -> None:
        self.level = level
        i, j = (int(k) for k in self.columns(middle[None])[0])
        self.corner = np.array([i - half, j - half])
        self.nodes = terrain.block(5, level, i - half, j - half, 2 * half, 2 * half)

    def columns(self, directions: F64) -> F64:
        tangents = directions[:, 1::-1] / np.abs(directions[:, 2:])
        return 2.0 ** (self.level - 1) * (1.0 + np.arctan(tangents) * (4.0 / math.pi))

    def __call__(self, directions: F64) -> F64:
        """NaN beyond the nodes."""
        place = self.columns(directions) - self.corner
        low = np.clip(place.astype(int), 0, len(self.nodes) - 2)
        i, j = low.T
        x, y = (place - low).T
        south = self.nodes[j, i] * (1.0 - x) + self.nodes[j, i + 1] * x
        north = self.nodes[j + 1, i] * (1.0 - x) + self.nodes[j + 1, i + 1] * x
        within = (place >= 0.0).all(axis=1) & (place < len(self.nodes) - 1).all(axis=1)
        return np.where(within, south * (1.0 - y) + north * y, np.nan)


def hidden(grids: list[Heights], d: F64, sun: F64, cell_m: float) -> NDArray[np.bool_]:
    """Whether the ground, of the finest of the grids that reaches a place, is anywhere above the
    way from points on it to the Sun."""
    start = d * (RADIUS_M + grids[0](d))[:, None]
    dark = np.zeros(len(d), bool)
    t = 0.5 * cell_m
    while t < 1.2e5:
        at = start + t * sun
        away = np.linalg.norm(at, axis=1)
        h = np.full(len(d), np.nan)
        for grid in grids:
            h = np.where(np.isnan(h), grid(at / away[:, None]), h)
        assert not np.isnan(h).any()
        dark |= away - RADIUS_M < h
        t += max(0.5 * cell_m, 0.01 * t)
    return dark


@pytest.mark.needs_data
def test_shadows_at_the_pole_are_those_of_a_march() -> None:
    """Of pixels of configs/lunar_pole.yaml: where the ground hides the whole Sun, or none of it, on
    lattices of both widths that a pixel's cells may have, the frame says so, but for a few pixels
    right at the borders of shadows."""
    width, fov = 160, 30.0
    changes = {
        "camera.width": width, "camera.height": 120, "camera.fov_deg": fov,
        "camera.trajectory.height_m": 8000.0, "camera.trajectory.off_nadir_deg": 30.0,
        "render.samples": 1, "render.max_bounces": 0,
        "render.force_off": ["soft_sun", "antialiasing"],
    }  # fmt: skip
    config = Path(__file__).resolve().parents[2] / "configs/lunar_pole.yaml"
    sim = perilune.open(config, overrides=changes)
    sample = sim.frame(0, ["radiance", "position", "range"], threads=1)
    middle = shutter.middle(sim.world(0))
    pose = middle.poses["moon"][0]
    axes = rotations.to_matrix(pose[3:])
    rng = np.random.default_rng(2)
    pick = rng.permutation(sample["range"].size)[:2000]
    place = (sample["position"].reshape(-1, 3)[pick].astype(float) - pose[:3]) @ axes
    d = place / np.linalg.norm(place, axis=1, keepdims=True)
    dark = sample["radiance"].reshape(-1, 3)[pick, 1] == 0.0
    pixel_m = float(np.median(sample["range"])) * math.radians(fov) / width
    sun = (middle.sun_position_m - pose[:3]) @ axes
    sun /= np.linalg.norm(sun)
    terrain = sim.terrain(0)
    up = d.mean(axis=0) / np.linalg.norm(d.mean(axis=0))
    level = terrain.level(pixel_m)
    coarse = [Heights(terrain, level - k, up, half) for k, half in ((2, 400), (4, 500))]
    upper = np.cross(np.cross(sun, up), sun)
    found = []
    for finest in (level - 1, level):
        grids = [Heights(terrain, finest, up, 400), *coarse]
        for limb_rad in (-0.00466, 0.0, 0.00466):
            toward = sun + limb_rad * upper / np.linalg.norm(upper)
            found.append(hidden(grids, d, toward, terrain.cell_m(finest)))
    sure = np.all(found, axis=0) | ~np.any(found, axis=0)
    wrong = sure & (dark != found[0])
    shown = np.pad(sample["radiance"][..., 1] == 0.0, 1, mode="edge")
    around = np.stack([shown[i : i + 120, j : j + width] for i in range(3) for j in range(3)])
    border = (around.any(axis=0) & ~around.all(axis=0)).ravel()[pick]
    assert 0.1 < dark.mean() < 0.9
    assert sure.mean() > 0.9
    assert wrong.mean() < 0.01
    assert not (wrong & ~border).any()
    assert (dark & ~border).sum() > 50
