"""Brightness of ground whose detail is finer than its mesh, and frames that do not shimmer."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import perilune

SITE = {"lon_deg": 10.0, "lat_deg": 20.0}


def ground(
    cells: float,
    sun_deg: float,
    normals: bool = True,
    lon_deg: float = SITE["lon_deg"],
    height_m: float = 2.0,
    baseline_m: float = 100.0,
    longest_m: float = 6e5,
    smooth: bool = False,
    terrain: dict[str, Any] | None = None,
    body: dict[str, Any] | None = None,
) -> dict[str, np.ndarray]:
    """Lunar highlands under a camera, pixels of 15 mm from 2 m."""
    own = {
        "detail": {"seed": 3, "longest_m": longest_m},
        "cells_per_pixel": cells,
        "finest_cell_m": 0.001,
    }
    moon = {"kind": "moon", "reflectance": "hapke", "albedo": 0.33, "terrain": own} | (body or {})
    if moon["reflectance"] == "hapke":
        own["roughness_baseline_m"] = baseline_m
    own |= terrain or {}
    off = ["sub_cell_normals"] if not normals else ["terrain", "sub_cell_normals"] if smooth else []
    place = {"lon_deg": lon_deg, "lat_deg": SITE["lat_deg"]}
    tree = {
        "version": 1,
        "time": {"epoch": "2026-03-03T06:00:00Z"},
        "root": "moon",
        "sun": {"at": SITE | {"azimuth_deg": 100.0, "elevation_deg": sun_deg}},
        "bodies": {"moon": moon},
        "camera": {
            "width": 48,
            "height": 48,
            "fov_deg": 20.0,
            "trajectory": {"kind": "hover", "target": "moon", "height_m": height_m} | place,
            "exposure": {"mode": "fixed", "white_radiance_w_m2_sr": 60.0},
        },
        "render": {
            "samples": 16,
            "max_bounces": 0,
            "force_off": ["soft_sun", *off],
            "force_on": ["antialiasing"],
        },
    }
    sample = perilune.open(tree).frame(0, ["rgb", "radiance", "depth", "normal"])
    return {key: sample[key] for key in ("rgb", "radiance", "depth", "normal")}


BODIES = {
    "hapke": {},
    "lambert": {"reflectance": "lambert", "albedo": 0.2},
    "minnaert": {"reflectance": "minnaert", "albedo": 0.2},
}


@pytest.mark.parametrize(
    ("model", "sun_deg", "limit"),
    [
        ("hapke", 10.0, 0.015),
        ("hapke", 20.0, 0.013),
        ("hapke", 45.0, 0.006),
        ("lambert", 20.0, 0.013),
        ("minnaert", 20.0, 0.017),
    ],
)
def test_brightness_does_not_depend_on_cells(model: str, sun_deg: float, limit: float) -> None:
    """The mean over a field with cells of four pixels, of one and of an eighth, in which all
    detail is geometry. The limits are mostly the chance of 700 mm of ground."""

    def mean(cells: float, normals: bool = True) -> float:
        drawn = ground(cells, sun_deg, normals, baseline_m=0.0, body=BODIES[model])
        return float(drawn["radiance"].mean())

    fine = mean(8.0)
    assert abs(mean(0.25) / fine - 1.0) < limit
    assert abs(mean(1.0) / fine - 1.0) < limit
    if sun_deg == 20.0:  # what is left out would be missed
        assert abs(mean(0.25, normals=False) / fine - 1.0) > 0.024


@pytest.mark.soak
def test_no_more_shimmer_than_with_fine_cells() -> None:
    """Of two frames a third of a pixel apart, with coarse cells and with four a pixel."""
    step_deg = float(np.degrees(0.3 * 0.0147 / (1737.4e3 * np.cos(np.radians(SITE["lat_deg"])))))

    def change(cells: float) -> float:
        a, b = (ground(cells, 20.0, lon_deg=SITE["lon_deg"] + k * step_deg) for k in (0, 1))
        return float(np.abs(a["rgb"].astype(float) - b["rgb"]).mean())

    assert change(1.0) < 1.02 * change(4.0)
    assert change(0.25) < 1.02 * change(4.0)


def test_labels_are_of_the_mesh() -> None:
    on, off = (ground(0.5, 20.0, normals) for normals in (True, False))
    assert (on["radiance"] != off["radiance"]).mean() > 0.9
    assert np.array_equal(on["depth"], off["depth"])
    assert np.array_equal(on["normal"], off["normal"])


@pytest.mark.parametrize(("sun_deg", "limit"), [(20.0, 0.018), (45.0, 0.018)])
def test_from_afar_the_ground_is_as_bright_as_its_law(sun_deg: float, limit: float) -> None:
    """Pixels of 150 m. The law's roughness is shared with the detail below its baseline: else the
    ground has both, and is too dark."""
    flat = ground(1.0, sun_deg, height_m=20e3, longest_m=100.0, smooth=True)["radiance"].mean()
    shared = ground(1.0, sun_deg, height_m=20e3, longest_m=100.0)["radiance"].mean()
    twice = ground(1.0, sun_deg, height_m=20e3, longest_m=100.0, baseline_m=0.0)["radiance"].mean()
    assert abs(shared / flat - 1.0) < limit
    assert twice < 0.995 * shared


FIELD = {"law": "haworth", "density": 25.0, "cutoff_m": 0.0}
FIELD |= {"min_diameter_m": 0.8, "max_diameter_m": 1.25}


def plain(
    model: str, sun_deg: float, view_deg: tuple[float, float], size: int, wide_m: float, **own: Any
) -> float:
    """Mean radiance of a plain with cells of a pixel; the view is off the nadir, and towards an
    azimuth. The Sun is in the east."""
    off_nadir_deg, azimuth_deg = view_deg
    height_m, place = 600.0, {"lon_deg": SITE["lon_deg"], "lat_deg": SITE["lat_deg"]}
    terrain = {"detail": {"seed": 3, "strength": 1e-4}, "finest_cell_m": 0.001} | own
    hover = {"kind": "hover", "target": "moon", "off_nadir_deg": off_nadir_deg}
    hover |= {"height_m": height_m * np.cos(np.radians(off_nadir_deg)), "azimuth_deg": azimuth_deg}
    moon = {"kind": "moon", "reflectance": model, "albedo": 0.2, "terrain": terrain}
    tree = {
        "version": 1,
        "time": {"epoch": "2026-03-03T06:00:00Z"},
        "root": "moon",
        "sun": {"at": place | {"azimuth_deg": 90.0, "elevation_deg": sun_deg}},
        "bodies": {"moon": moon},
        "camera": {
            "width": size,
            "height": size,
            "fov_deg": 2.0 * float(np.degrees(np.arctan(0.5 * wide_m / height_m))),
            "trajectory": hover | place,
            "exposure": {"mode": "fixed", "white_radiance_w_m2_sr": 60.0},
        },
        "render": {"samples": 1, "max_bounces": 0, "force_off": ["soft_sun"]},
    }
    return float(perilune.open(tree).frame(0, ["radiance"])["radiance"].mean())


@pytest.mark.parametrize("model", ["lambert", "hapke"])
@pytest.mark.parametrize(
    ("sun_deg", "view_deg"),
    [(5.0, (0.0, 90.0)), (10.0, (0.0, 90.0)), (10.0, (60.0, 0.0)), (45.0, (60.0, 270.0))],
)
def test_rocks_below_the_cells_are_as_bright_as_those_that_are_shown(
    model: str, sun_deg: float, view_deg: tuple[float, float]
) -> None:
    """Rocks of about 1 m on 5 % of a plain, in pixels of 0.4 m, where all are shown, and of 2 m,
    where none is. The chance of so many rocks is 0.4 % of the light at a Sun of 10 degrees."""
    shown = plain(model, sun_deg, view_deg, 240, 96.0, rocks=FIELD)
    assert abs(plain(model, sun_deg, view_deg, 48, 96.0, rocks=FIELD) / shown - 1.0) < 0.01
    if sun_deg < 45.0:  # what is left out would be missed
        assert abs(plain(model, sun_deg, view_deg, 48, 96.0) / shown - 1.0) > 0.04


@pytest.mark.parametrize("model", ["lambert", "hapke"])
def test_rocks_are_as_bright_with_few_triangles_as_with_many(model: str) -> None:
    """Of 8 and of 2.5 pixels: with other meshes, and relief in them or in their law."""
    few, many = (plain(model, 10.0, (0.0, 90.0), n, 16.0, rocks=FIELD) for n in (40, 128))
    assert abs(few / many - 1.0) < 0.003
