"""Rasters that are given by mistake are told of: of another body, hidden by others, too deep."""

from __future__ import annotations

import shutil
import warnings
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import perilune
from perilune.bodies.elevation import read_elevation
from perilune.bodies.raster_doubts import of_another_body
from perilune.config.elevation import Elevation

MOON_M = (1737.4e3,) * 3
LOCAL = {"kind": "orthographic", "center_lon_lat_deg": [10.0, 20.0], "post_m": 10.0}
WHOLE = {"kind": "cylindrical", "west_deg": 0.0}
CAMERA = {"width": 8, "height": 8, "fov_deg": 40.0}
ORBIT = {"kind": "orbit_object", "target": "moon", "distance_m": 1e7}


@pytest.fixture
def files(tmp_path: Path) -> Path:
    np.save(tmp_path / "whole.npy", np.zeros((18, 36), dtype=np.float32))
    np.save(tmp_path / "local.npy", np.ones((30, 30), dtype=np.float32))
    return tmp_path


def told(terrain: dict[str, Any], body: str = "moon", **keys: Any) -> list[str]:
    hover = {"kind": "hover", "target": body, "lon_deg": 10.0, "lat_deg": 20.0, "height_m": 1e3}
    config = {
        "version": 1,
        "time": {"epoch": "2026-03-03T06:00:00Z"},
        "root": body,
        "bodies": {body: {"kind": body, "terrain": terrain} | keys},
        "camera": CAMERA | {"trajectory": hover},
    }
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        perilune.open(config).terrain(0)
    return [str(row.message) for row in caught]


def rows(files: Path, *places: dict[str, Any]) -> list[dict[str, Any]]:
    names = ["whole.npy" if place["kind"] == "cylindrical" else "local.npy" for place in places]
    return [
        {"file": str(files / name), "projection": place}
        for name, place in zip(names, places, strict=True)
    ]


def test_a_patch_below_a_coarser_model_is_told_of(files: Path) -> None:
    assert told({"elevation": rows(files, WHOLE, LOCAL)}) == []
    (text,) = told({"elevation": rows(files, LOCAL, WHOLE)})
    assert "bodies.moon.terrain.elevation[0]: is not seen: [1], which is coarser, lies over" in text
    beside = LOCAL | {"center_m": [290.0, 0.0], "post_m": 20.0}
    assert told({"elevation": rows(files, LOCAL, beside)}) == []  # it covers a part
    (text,) = told({"mask": rows(files, LOCAL, WHOLE)})
    assert "terrain.mask[0]: is not seen" in text


def test_a_map_of_another_body_is_told_of(data_dir: Path, files: Path) -> None:
    path = shutil.copy(data_dir / "lunar_dem/dem_moon_npole_33x33.tif", files)
    assert told({"elevation": [{"file": str(path)}]}) == []
    (text,) = told({"elevation": [{"file": str(path)}]}, "mars")
    assert "elevation[0].file" in text
    assert "its map is of a sphere of 1737.4 km, that of the body is 3376.2 to 3396.19 km" in text


@pytest.mark.parametrize(
    ("map_m", "datum_m", "radii_m", "words"),
    [
        (0.0, None, MOON_M, ""),
        (1738.0e3, 1738.0e3, MOON_M, ""),
        (3396.19e3, 3389.5e3, (3396.19e3, 3396.19e3, 3376.2e3), ""),
        (11.1e3, 11.1e3, (13.0e3, 11.4e3, 9.1e3), ""),
        (
            6378.137e3,
            None,
            MOON_M,
            "its map is of a sphere of 6378.14 km, that of the body is 1737",
        ),
        (0.0, 3396.19e3, MOON_M, "heights are over a sphere of 3396.19 km, that of the body is 17"),
        (0.0, 1.7374, MOON_M, "a sphere of 0.0017374 km"),
    ],
)
def test_radii(
    map_m: float, datum_m: float | None, radii_m: tuple[float, float, float], words: str
) -> None:
    text = " ".join(of_another_body(map_m, datum_m, radii_m))
    assert words in text
    assert bool(words) == bool(text)


def test_heights_beyond_the_centre_are_refused(files: Path) -> None:
    def read(**keys: Any) -> float:
        given = Elevation(file="local.npy", projection=LOCAL, **keys)
        found = read_elevation(given, files / "local.npy", MOON_M)
        return float(found.heights(np.array([[0.0, 0.0, 1.0]]))[0])

    assert np.isnan(read(offset_m=-1.7e6))
    with pytest.raises(
        ValueError, match=r"offset_m: .*local\.npy: heights go down to -1\.8e\+06 m"
    ):
        read(offset_m=-1.8e6 - 1.0)
    with pytest.raises(ValueError, match="centre of the body"):
        read(offset_m=-1.7374e6, datum_radius_km=1737.3)


def test_a_baseline_of_roughness_needs_hapke(files: Path) -> None:
    with pytest.raises(ValueError, match=r"terrain\.roughness_baseline_m: only for reflectance"):
        told({"roughness_baseline_m": 30.0})
    assert told({"roughness_baseline_m": 30.0}, reflectance="hapke") == []


def test_a_hundred_patches(tmp_path: Path) -> None:
    """Each keeps its posts."""
    numbers = np.random.default_rng(5).normal(size=(6, 6)).astype(np.float32)
    np.save(tmp_path / "local.npy", numbers)
    elevation = [
        {
            "file": str(tmp_path / "local.npy"),
            "projection": LOCAL | {"center_m": [100.0 * (k % 10), 100.0 * (k // 10)]},
            "offset_m": float(k),
            "border_posts": 1.0,
        }
        for k in range(100)
    ]
    config = {
        "version": 1,
        "time": {"epoch": "2026-03-03T06:00:00Z"},
        "root": "moon",
        "bodies": {"moon": {"kind": "moon", "terrain": {"elevation": elevation}}},
        "camera": CAMERA | {"trajectory": ORBIT},
    }
    ground = perilune.open(config).terrain(0)
    for k in (0, 37, 99):
        given = Elevation.model_validate(elevation[k])
        raster = read_elevation(given, tmp_path / "local.npy", MOON_M).raster
        posts = np.array([[c, r] for r in range(1, 5) for c in range(1, 5)], dtype=float)
        heights_m = ground.heights(raster.directions(posts))
        np.testing.assert_array_equal(heights_m, numbers[1:5, 1:5].ravel().astype(float) + k)
