"""Tracks of wheels: from the configuration to heights, rocks and albedo."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from pydantic import ValidationError

import perilune
from perilune import _core
from perilune.base.curves import curve
from perilune.bodies.terrain import core_terrain
from perilune.config.terrain import Terrain

RADII_M = np.full(3, 1737400.0)
TRACK: dict[str, Any] = {
    "lon_deg": 10.0,
    "lat_deg": 20.0,
    "waypoints_m": [[-20.0, -5.0], [0.0, 0.0], [10.0, 12.0]],
    "gauge_m": 1.4,
    "wheel_width_m": 0.3,
    "depth_m": 0.02,
    "grousers": None,
}
SITE = np.array([np.cos(np.radians(20.0)), 0.0, np.sin(np.radians(20.0))])
F64 = NDArray[np.float64]


def terrain(**keys: Any) -> _core.Terrain:
    return core_terrain(Terrain.model_validate(keys), RADII_M, [])


def places(points: F64) -> F64:
    """Directions of points (n, 2), metres to the east and the north of the site."""
    lon, lat = np.radians(10.0), np.radians(20.0)
    up = np.array([np.cos(lat) * np.cos(lon), np.cos(lat) * np.sin(lon), np.sin(lat)])
    east = np.array([-np.sin(lon), np.cos(lon), 0.0])
    to = up + points[:, :1] / RADII_M[0] * east + points[:, 1:] / RADII_M[0] * np.cross(up, east)
    return np.asarray(to / np.linalg.norm(to, axis=1, keepdims=True))


def ruts() -> F64:
    """Points in the middle of both ruts."""
    way = curve(tuple(map(tuple, TRACK["waypoints_m"])))
    rows = [way.at(along) for along in np.linspace(1.0, way.length - 1.0, 60)]
    return np.array([p + side * 0.7 * np.array([-t[1], t[0]]) for p, t in rows for side in (-1, 1)])


def test_ruts_follow_the_way_of_a_traverse() -> None:
    detail = {"seed": 3, "strength": 0.3}
    bare, driven = terrain(detail=detail), terrain(detail=detail, tracks=[TRACK])
    at = places(ruts())
    np.testing.assert_allclose(driven.heights(at) - bare.heights(at), -0.02, atol=2e-4)
    between = places(np.array([curve(tuple(map(tuple, TRACK["waypoints_m"]))).at(9.0)[0]]))
    assert driven.heights(between) == bare.heights(between)
    low, high = bare.bounds
    assert driven.bounds == pytest.approx((low - 0.02, high + 0.006), abs=1e-6)
    imprints = terrain(detail=detail, tracks=[{**TRACK, "grousers": {"spacing_m": 0.1}}])
    depth = bare.heights(at) - imprints.heights(at)
    assert depth.min() < 0.021
    assert depth.max() > 0.024


def test_no_rock_lies_in_a_rut_and_all_others_stay() -> None:
    rocks = {"law": "haworth", "density": 3.0, "min_diameter_m": 0.2}
    keys = {"detail": {"strength": 0.1}, "rocks": rocks}
    fields = [core_rocks(terrain(**keys)), core_rocks(terrain(**keys, tracks=[TRACK]))]
    gone = np.isin(fields[0]["id"], fields[1]["id"], invert=True)
    assert 5 < gone.sum() < 0.3 * len(gone)
    assert np.isin(fields[1]["id"], fields[0]["id"]).all()
    at = places(ruts()) * RADII_M
    away = np.linalg.norm(fields[0]["direction"][:, None] * RADII_M - at, axis=-1).min(axis=1)
    clear = away - 0.5 * fields[0]["diameter_m"]
    assert clear[gone].max() < 0.15 + 0.4  # the ruts are 0.3 m wide, points 0.6 m apart
    assert clear[~gone].min() > 0.14


def core_rocks(ground: _core.Terrain) -> NDArray[np.void]:
    field = _core.RockField(
        {
            "radius_m": float(np.cbrt(np.prod(RADII_M))),
            "law": "haworth",
            "density": 3.0,
            "min_diameter_m": 0.2,
            "repose_rad": 0.6,
        }
    )
    return field.list(ground, places(np.zeros((1, 2)))[0], 25.0, 0.2)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"gauge_m": 0.2}, "above wheel_width_m"),
        ({"depth_m": 1.0}, "at most wheel_width_m"),
        ({"waypoints_m": [[0.0, 0.0], [0.0, 0.0]]}, "point before it"),
        ({"grousers": {"depth_m": 1.0}}, "at most wheel_width_m"),
        ({"wheel_m": 1.0}, "unknown key"),
    ],
)
def test_errors(change: dict[str, Any], words: str) -> None:
    with pytest.raises(ValidationError, match=words):
        Terrain.model_validate({"tracks": [{**TRACK, **change}]})


def pictures(**more: Any) -> dict[str, NDArray[Any]]:
    """Flat ground from above, in 48x32 pixels of 0.1 m."""
    terrain = {"detail": {"strength": 0.0}, "finest_cell_m": 1.0, **more}
    place = {"target": "moon", "lon_deg": 10.0, "lat_deg": 20.0}
    sun = {"azimuth_deg": 100.0, "elevation_deg": 60.0}
    config = {
        "version": 1,
        "time": {"epoch": "2026-03-03T06:00:00Z", "step_s": 1.0},
        "root": "moon",
        "sun": {"at": {"lon_deg": 10.0, "lat_deg": 20.0, **sun}},
        "bodies": {"moon": {"kind": "moon", "albedo": 0.3, "terrain": terrain}},
        "camera": {
            "width": 48,
            "height": 32,
            "fov_deg": 20.0,
            "trajectory": {"kind": "hover", **place, "height_m": 13.6},
            "exposure": {"mode": "fixed", "white_radiance_w_m2_sr": 200.0},
        },
        "render": {"samples": 4, "channels": ["rgb", "semantic", "instance", "radiance"]},
    }
    return dict(perilune.open(config)[0].items())


def test_pixels_are_darker_and_labels_stay() -> None:
    """Ruts alone change, by their albedo."""
    bare = pictures()
    way = [[-10.0, 0.0], [10.0, 0.0]]
    driven = pictures(tracks=[{**TRACK, "waypoints_m": way, "albedo": 0.5}])
    for name in ("semantic", "instance"):
        np.testing.assert_array_equal(driven[name], bare[name])
    ratio = driven["radiance"][..., 1] / bare["radiance"][..., 1]
    assert ratio.max() < 1.02
    assert ratio.min() == pytest.approx(0.5, abs=0.02)
    # Two ruts of 0.3 m on the 3.2 or 4.8 m across the picture.
    assert 1.0 - ratio.mean() == pytest.approx(0.5 * 0.6 / np.array([3.2, 4.8]).mean(), rel=0.35)
