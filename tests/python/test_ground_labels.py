"""Slope and roughness of the ground: exact planes, other filters, any camera."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy import ndimage
from tests.python.test_terrain_frames import (
    LAT_DEG,
    LON_DEG,
    MOON_M,
    VIEWS,
    in_body_axes,
    moon,
    over,
)

import perilune

F64 = np.ndarray[Any, np.dtype[np.float64]]


def patch(path: Path, heights_m: F64, post_m: float) -> dict[str, Any]:
    """Terrain of a patch of heights about the site alone; rows are from north to south."""
    np.save(path, heights_m)
    place = {"kind": "orthographic", "center_lon_lat_deg": [LON_DEG, LAT_DEG], "post_m": post_m}
    return {"elevation": [{"file": str(path), "projection": place}], "detail": None}


def axes() -> tuple[F64, F64, F64]:
    """East, north and up at the site, body axes."""
    lon, lat = np.radians([LON_DEG, LAT_DEG])
    up = np.array([np.cos(lat) * np.cos(lon), np.cos(lat) * np.sin(lon), np.sin(lat)])
    east = np.array([-np.sin(lon), np.cos(lon), 0.0])
    return east, np.cross(up, east), up


@pytest.mark.parametrize("off_nadir_deg", [0.0, 55.0])
def test_a_plane_has_its_slope_from_any_side(off_nadir_deg: float, tmp_path: Path) -> None:
    """Sobel gradients over the true distances of points are exact on a plane."""
    x = np.linspace(-2000.0, 2000.0, 101)
    terrain = patch(tmp_path / "plane.npy", 0.25 * x[None, :] - 0.1 * x[:, None], 40.0)
    sim = moon(terrain, {"trajectory": over(300.0, off_nadir_deg)})
    sample = sim.frame(0, ["slope_sobel", "roughness_laplacian", "range"])
    inner = (slice(1, -1), slice(1, -1))
    expected = np.arctan(np.hypot(0.25, 0.1))
    np.testing.assert_allclose(sample["slope_sobel"][inner], expected, atol=2e-4)
    # In perspective, elevations of a plane are not linear in pixels, most of all seen aslant.
    bent = sample["roughness_laplacian"][inner] / sample["range"][inner]
    assert bent.max() < (5e-5 if off_nadir_deg == 0.0 else 2e-3)


@pytest.mark.parametrize("view", VIEWS)
def test_filters_are_those_of_scipy(view: str) -> None:
    """Beside scipy's on the elevations and places of the pixels; nan beside the sky, at the edge,
    and nowhere else."""
    sim = moon({"detail": {"seed": 3}, "rocks": {"seed": 3}}, {"trajectory": VIEWS[view]})
    sample = sim.frame(0, ["position", "range", "slope_sobel", "roughness_laplacian"])
    points, seen = in_body_axes(sim, sample), sample["range"] > 0.0
    points[~seen] = 0.0
    height = np.linalg.norm(points, axis=-1) - MOON_M
    rough = np.abs(ndimage.laplace(height))
    cross = ndimage.generate_binary_structure(2, 1)
    inside = ndimage.binary_erosion(seen, cross)
    np.testing.assert_array_equal(np.isfinite(sample["roughness_laplacian"]), inside)
    np.testing.assert_allclose(sample["roughness_laplacian"][inside], rough[inside], rtol=1e-5,
                               atol=1e-7)  # fmt: skip
    whole = ndimage.binary_erosion(seen, np.ones((3, 3)))
    np.testing.assert_array_equal(np.isfinite(sample["slope_sobel"]), whole)
    up = points / np.maximum(np.linalg.norm(points, axis=-1, keepdims=True), 1.0)
    east = np.cross([0.0, 0.0, 1.0], up)
    east /= np.maximum(np.linalg.norm(east, axis=-1, keepdims=True), 1e-9)
    north = np.cross(up, east)
    changes = [
        [ndimage.sobel(v, axis) / 8.0 for v in (points[..., 0], points[..., 1], points[..., 2])]
        for axis in (1, 0)
    ]
    ground = np.array([[(np.stack(row, -1) * a).sum(-1) for a in (east, north)] for row in changes])
    rise = np.array([ndimage.sobel(height, axis) / 8.0 for axis in (1, 0)])
    rows = ground.transpose(2, 3, 0, 1)[whole], rise.transpose(1, 2, 0)[whole][..., None]
    steep = np.linalg.norm(np.linalg.solve(*rows)[..., 0], axis=-1)
    np.testing.assert_allclose(sample["slope_sobel"][whole], np.arctan(steep), atol=1e-5)


def test_threads_do_not_matter() -> None:
    sim = moon({"detail": {"seed": 3}}, {"trajectory": over(2e3, 30.0)})
    names = ["slope_sobel", "roughness_laplacian"]
    one, three = (sim.frame(0, names, threads=n) for n in (1, 3))
    for name in names:
        np.testing.assert_array_equal(one[name], three[name])


def test_spacecraft_are_not_ground(repo_dir: Path) -> None:
    """Beside their outlines there are no gradients, either; smooth bodies are flat."""
    craft = {
        "model": str(repo_dir / "assets/models/smallsat.glb"),
        "size_m": 200.0,
        "orbit": {"kind": "surface", "around": "moon", "lon_deg": LON_DEG, "lat_deg": LAT_DEG,
                  "heading_deg": 0.0},
    }  # fmt: skip
    sim = moon({}, {"trajectory": over(600.0)}, spacecraft={"sat": craft})
    sample: perilune.Sample = sim.frame(0, ["instance", "slope_sobel"])
    ground = sample["instance"] == 1
    assert 0.2 < ground.mean() < 0.995
    whole = ndimage.binary_erosion(ground, np.ones((3, 3)))
    np.testing.assert_array_equal(np.isfinite(sample["slope_sobel"]), whole)
