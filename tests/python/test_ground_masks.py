"""Masks of the ground as rasters, and meshes of a stated patch."""

from __future__ import annotations

import math
import warnings
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

import perilune
from perilune.base import rotations
from perilune.config.errors import ConfigError
from perilune.frame import shutter

F64 = NDArray[np.float64]
SITE = {"lon_deg": 10.0, "lat_deg": 20.0}
CENTER = [10.0, 20.0]


def moon(terrain: dict[str, Any], height_m: float = 2000.0, **more: Any) -> perilune.Simulation:
    tree = {
        "version": 1,
        "time": {"epoch": "2026-03-03T06:00:00Z", "step_s": 0.0},
        "root": "moon",
        "sun": {"at": SITE | {"azimuth_deg": 100.0, "elevation_deg": 10.0}},
        "bodies": {"moon": {"kind": "moon", "albedo": 0.3, "terrain": terrain}},
        "camera": {
            "width": 48,
            "height": 36,
            "fov_deg": 50.0,
            "trajectory": {"kind": "hover", "target": "moon", "height_m": height_m} | SITE,
        },
        "render": {"samples": 1, "max_bounces": 0},
    }
    return perilune.open(tree | more)


def seen_from_center(sim: perilune.Simulation, sample: Any) -> F64:
    pose = shutter.middle(sim.world(0)).poses["moon"][0]
    return np.asarray((sample["position"] - pose[:3]) @ rotations.to_matrix(pose[3:]))


def test_a_mask_is_the_number_nearest_to_the_point(tmp_path: Path) -> None:
    """Beside an independent search of the nearest post; a finer mask lies over it; gaps are 0."""
    rng = np.random.default_rng(3)
    wide = rng.integers(0, 65536, (40, 40)).astype(np.float32)
    wide[18:21, 18:21] = -32768.0
    fine = rng.integers(1, 9, (5, 5), dtype=np.uint8)
    np.save(tmp_path / "wide.npy", wide)
    np.save(tmp_path / "fine.npy", fine)
    place = {"kind": "orthographic", "center_lon_lat_deg": CENTER}
    masks = [
        {"file": str(tmp_path / "wide.npy"), "projection": place | {"post_m": 40.0}},
        {
            "file": str(tmp_path / "fine.npy"),
            "projection": place | {"post_m": 60.0, "center_m": [300.0, 0.0]},
        },
    ]
    sim = moon({"detail": {"seed": 1}, "mask": masks})
    sample = sim.frame(0, ["ground_mask", "position"])
    at = seen_from_center(sim, sample)
    d = at / np.linalg.norm(at, axis=-1, keepdims=True)
    lon, lat = np.radians(CENTER)
    east = np.array([-math.sin(lon), math.cos(lon), 0.0])
    north = np.array(
        [-math.sin(lat) * math.cos(lon), -math.sin(lat) * math.sin(lon), math.cos(lat)]
    )
    x, y = 1737.4e3 * (d @ east), 1737.4e3 * (d @ north)
    expected = np.zeros(x.shape, np.int64)
    for grid, post_m, x0 in ((np.where(wide < 0, 0, wide), 40.0, 0.0), (fine, 60.0, 300.0)):
        half = 0.5 * (grid.shape[0] - 1)
        u, v = (x - x0) / post_m + half, half - y / post_m
        inside = (np.abs(u - half) < half + 0.5) & (np.abs(v - half) < half + 0.5)
        rows = np.clip(np.rint(v), 0, len(grid) - 1).astype(int)
        columns = np.clip(np.rint(u), 0, len(grid) - 1).astype(int)
        expected = np.where(inside, grid[rows, columns], expected)
    assert sample["ground_mask"].dtype == np.int32
    assert (sample["ground_mask"] == expected).mean() > 0.999
    assert (expected == 0).any()
    assert (expected > 0).mean() > 0.4
    plain = moon({"detail": {"seed": 1}}).frame(0, ["ground_mask"])
    assert not plain["ground_mask"].any()


@pytest.mark.parametrize("bad", [0.5, -1.0, 65536.0])
def test_masks_are_whole_numbers(tmp_path: Path, bad: float) -> None:
    np.save(tmp_path / "mask.npy", np.array([[1.0, bad], [2.0, 3.0]]))
    place = {"kind": "orthographic", "center_lon_lat_deg": CENTER, "post_m": 40.0}
    mask = {"file": str(tmp_path / "mask.npy"), "projection": place}
    with pytest.raises(ConfigError, match=rf"mask\[0\].file: .*holds {bad:g}; allowed: whole"):
        moon({"mask": [mask]}).frame(0, ["ground_mask"])


def test_the_mesh_is_fine_in_the_patch_alone() -> None:
    """In the square, ground is that of a mesh without a patch, to the bit; beside it the mesh is
    coarse, and not open."""
    more = {"camera.width": 192, "camera.height": 144}
    whole = moon({"detail": {"seed": 1}}).with_overrides(more)
    patch = {"center_lon_lat_deg": CENTER, "side_m": 600.0}
    cut = moon({"detail": {"seed": 1}, "patch": patch}).with_overrides(more)
    channels = ["position", "elevation", "instance"]
    a, b = whole.frame(0, channels), cut.frame(0, channels)
    assert b["instance"].all()
    at = seen_from_center(whole, a)
    up = np.array([math.cos(math.radians(angle)) for angle in CENTER])
    lon, lat = np.radians(CENTER)
    east = np.array([-math.sin(lon), math.cos(lon), 0.0])
    north = np.array([-math.sin(lat) * math.cos(lon), -math.sin(lat) * math.sin(lon), up[1]])
    reach = np.maximum(np.abs(at @ east), np.abs(at @ north))
    off_m = np.abs(a["elevation"] - b["elevation"])
    assert (off_m[reach < 290.0] == 0.0).all()
    assert (reach < 290.0).sum() > 100
    assert (off_m[reach > 800.0] > 0.0).mean() > 0.5


@pytest.mark.parametrize(("east_m", "missed"), [(0.0, 0), (3000.0, 1), (2.73e6, 1)])
def test_a_patch_out_of_sight_is_told_once(east_m: float, missed: int) -> None:
    """The frame is about 1 km wide at the camera's foot, over the centre; the last patch is
    behind the horizon."""
    lon_deg = CENTER[0] + math.degrees(east_m / 1737.4e3)
    patch = {"center_lon_lat_deg": [lon_deg, CENTER[1]], "side_m": 100.0}
    sim = moon({"detail": {"seed": 1}, "patch": patch})
    with warnings.catch_warnings(record=True) as told:
        warnings.simplefilter("always")
        for index in (0, 1):
            sim.frame(index, ["depth"])
    assert [
        str(one.message).count("terrain.patch: the camera sees none of it") for one in told
    ] == [1] * missed


def test_a_patch_needs_a_side() -> None:
    with pytest.raises(ConfigError, match=r"patch\.side_m"):
        moon({"patch": {"center_lon_lat_deg": CENTER, "side_m": 0.0}})
    with pytest.raises(ConfigError, match=r"patch\.side_m"):
        moon({"patch": {"center_lon_lat_deg": CENTER}})
