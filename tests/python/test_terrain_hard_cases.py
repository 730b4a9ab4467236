"""Frames of hard grounds: what is seen lies on the heights, without holes, and every value is
finite."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

import perilune
from perilune.base import rotations
from perilune.frame import shutter

F64 = NDArray[np.float64]
MOON_KM = 1737.4
SITE = {"lon_deg": 20.0, "lat_deg": 10.0}
CHANNELS = ["radiance", "position", "range", "elevation", "slope", "normal"]
SIDE = 24


def saved(folder: Path, name: str, heights: Any) -> str:
    np.save(folder / f"{name}.npy", np.asarray(heights, np.float32))
    return str(folder / f"{name}.npy")


def scene(
    terrain: dict[str, Any], site: dict[str, float] | None = None, radius_km: float = MOON_KM,
    height_m: float = 2000.0, sun_deg: float = 40.0, **more: Any,
) -> perilune.Simulation:  # fmt: skip
    """Straight down on a grey ball with terrain."""
    place = site or SITE
    return perilune.open({
        "version": 1,
        "time": {"epoch": "2026-03-03T06:00:00Z"},
        "root": "ball",
        "sun": {"at": place | {"azimuth_deg": 90.0, "elevation_deg": sun_deg}},
        "bodies": {"ball": {"kind": "moon", "radii_km": [radius_km] * 3, "albedo": 0.3,
                            "terrain": terrain}},
        "camera": {"width": SIDE, "height": SIDE, "fov_deg": 40.0, "exposure": {"mode": "auto"},
                   "trajectory": {"kind": "hover", "target": "ball", "height_m": height_m,
                                  "clearance_m": None} | place},
        "render": {"samples": 2, "max_bounces": 1},
    } | more)  # fmt: skip


def over(pattern: F64, kind: str = "orthographic", post_m: float = 50.0) -> dict[str, Any]:
    """A row of `elevation` without its file, for a patch about the site."""
    where = {"kind": kind, "post_m": post_m}
    if kind == "orthographic":
        where["center_lon_lat_deg"] = [SITE["lon_deg"], SITE["lat_deg"]]
    return {"values": pattern, "projection": where}


def globe(values: Any) -> dict[str, Any]:
    return {"values": values, "projection": {"kind": "cylindrical", "west_deg": -180.0}}


NOISE = np.random.default_rng(1).normal(0.0, 30.0, (40, 40))
WORLD = np.random.default_rng(2).normal(0.0, 800.0, (45, 90))
HOLES = np.where(np.random.default_rng(3).random((40, 40)) < 0.3, np.nan, NOISE)
STEP = np.where(np.arange(40) < 20, 0.0, 400.0) * np.ones((40, 1))
PLAIN = {"detail": None}
GROUNDS: dict[str, tuple[list[dict[str, Any]], dict[str, Any], dict[str, Any]]] = {
    # elevation, other keys of terrain, of scene
    "north pole": ([globe(WORLD)], {}, {"site": {"lon_deg": 30.0, "lat_deg": 90.0}}),
    "south pole": ([globe(WORLD)], PLAIN, {"site": {"lon_deg": 0.0, "lat_deg": -90.0}}),
    "date line": ([globe(WORLD)], {}, {"site": {"lon_deg": 180.0, "lat_deg": 5.0}}),
    "edge of the cube": ([globe(WORLD)], {}, {"site": {"lon_deg": 45.0, "lat_deg": 35.26}}),
    "border of a patch": ([over(NOISE, post_m=15.0)], {}, {}),
    "patches of two projections": (
        [globe(WORLD), over(NOISE), over(0.2 * NOISE[:20, :20], post_m=20.0)], {}, {},
    ),
    "missing data": ([over(HOLES)], {}, {}),
    "flat model": ([over(np.full((40, 40), 123.0))], PLAIN, {}),
    "vertical step": ([over(STEP)], PLAIN, {}),
    "vertical step, cubic": ([over(STEP) | {"interpolation": "cubic"}], {}, {}),
    "one row": ([over(NOISE[:1])], {}, {}),
    "one column": ([over(NOISE[:, :1])], PLAIN, {}),
    "one post": ([over(NOISE[:1, :1])], {}, {}),
    "hurst 0": ([], {"detail": {"hurst": 0.0}}, {}),
    "hurst 1": ([], {"detail": {"hurst": 1.0}}, {}),
    "first seed": ([], {"detail": {"seed": 0}, "craters": {"seed": 0}}, {}),
    "last seed": ([], {"detail": {"seed": 2**64 - 1}, "craters": {"seed": 2**64 - 1}}, {}),
    "heights of 1e-6 m": ([over(3e-8 * NOISE)], PLAIN, {}),
    "heights of 1e5 m": ([globe(30.0 * WORLD)], {}, {"height_m": 3e4}),
    "body of 1 km": ([], {}, {"radius_km": 1.0, "height_m": 100.0}),
    "body of 71 000 km": ([], {}, {"radius_km": 71000.0}),
    "body of 1 km, from a mast": ([], {}, {"radius_km": 1.0, "height_m": 1.5}),
    "body of 71 000 km, from a mast": ([], {}, {"radius_km": 71000.0, "height_m": 1.5}),
}  # fmt: skip


def ground_of(folder: Path, name: str) -> tuple[dict[str, Any], dict[str, Any]]:
    rows, keys, more = GROUNDS[name]
    files = [
        {key: value for key, value in row.items() if key != "values"}
        | {"file": saved(folder, f"model{k}", row["values"])}
        for k, row in enumerate(rows)
    ]
    return ({"elevation": files} if files else {}) | keys, more


def check(sim: perilune.Simulation, sample: Any, index: int = 0) -> None:
    """Finite, and within the relief of a few cells of the heights."""
    seen = sample["range"] > 0.0
    assert seen.all()
    for name in CHANNELS:
        assert np.isfinite(sample[name][seen]).all(), name
    pose = shutter.middle(sim.world(index)).poses["ball"][0]
    points = (sample["position"][seen] - pose[:3]) @ rotations.to_matrix(pose[3:])
    away = np.linalg.norm(points, axis=1)
    d = points / away[:, None]
    terrain = sim.terrain(0)
    ground = sim.world(0).ground("ball")
    cell = np.maximum(1.5 * sample["range"][seen] * math.radians(40.0) / SIDE, 0.02) / away
    east = np.cross([0.6, 0.0, 0.8], d)
    north = np.cross(d, east)
    around = [
        terrain.heights(d + (cell * a)[:, None] * east + (cell * b)[:, None] * north)
        for a in (-1.5, -0.7, 0.0, 0.7, 1.5) for b in (-1.5, -0.7, 0.0, 0.7, 1.5)
    ]  # fmt: skip
    off = np.abs(away - ground.datum_m(d) - terrain.heights(d))
    assert (off <= np.ptp(around, axis=0) + 1e-8 * away + 1e-3 * cell * away).mean() > 0.99
    np.testing.assert_allclose(
        sample["elevation"][seen], away - ground.datum_m(d), atol=1e-6 * away.max()
    )


@pytest.mark.filterwarnings("ignore::perilune.config.errors.ConfigWarning")
@pytest.mark.parametrize("name", GROUNDS)
def test_hard_grounds(tmp_path: Path, name: str) -> None:
    terrain, more = ground_of(tmp_path, name)
    sim = scene(terrain, **more)
    check(sim, sim.frame(0, CHANNELS, threads=1))


@pytest.mark.parametrize("sun_deg", [0.2, 0.0, -0.2, -1.0, -90.0])
def test_the_sun_at_and_below_the_horizon(sun_deg: float) -> None:
    """Light ends as the Sun's disc, of half a degree, sets; hills far away may see it longer."""
    sim = scene({"detail": {"seed": 3, "strength": 0.3}}, sun_deg=sun_deg)
    sample = sim.frame(0, CHANNELS, threads=1)
    check(sim, sample)
    lit = (sample["radiance"].max(axis=-1) > 0.0).mean()
    if sun_deg > 0.0:
        assert lit > 0.02
    if sun_deg < -0.9:
        assert lit == 0.0


@pytest.mark.parametrize("off_nadir_deg", [0.0, 90.0])
@pytest.mark.parametrize("height_m", [1e-6, 1e-3])
def test_a_camera_on_the_ground(height_m: float, off_nadir_deg: float) -> None:
    """It sees the cell below it, and the sky only above the horizon."""
    sim = scene({"detail": {"seed": 3}}, height_m=height_m)
    sim = sim.with_overrides({"camera.trajectory.off_nadir_deg": off_nadir_deg})
    sample = sim.frame(0, CHANNELS, threads=1)
    seen = sample["range"] > 0.0
    assert np.isfinite(sample["radiance"]).all()
    assert seen.all() if off_nadir_deg == 0.0 else 0.3 < seen.mean() < 0.9
    assert 0.0 < sample["range"][seen].min() < 0.01


def test_two_cameras_at_the_ends_of_a_body() -> None:
    """Tiles are chosen for each: both see the ground, and the same after each other as alone."""
    far = {"position_m": [0.0, 0.0, 2e3 * MOON_KM + 9000.0], "rotation_deg": [180.0, 0.0, 0.0]}
    sensors = {"near": {}, "far": {"transformation": far}}
    sim = scene({"detail": {"seed": 4}}, height_m=1000.0, sensors=sensors)
    both = [sim.frame(index, CHANNELS, threads=1) for index in (0, 1)]
    for index, sample in enumerate(both):
        check(sim, sample, index)
        assert (sample["range"] < 2e4).all()
        alone = sim.with_overrides({}).frame(index, CHANNELS, threads=1)
        for name in CHANNELS:
            np.testing.assert_array_equal(sample[name], alone[name])
    centre = shutter.middle(sim.world(0)).poses["ball"][0, :3]
    ends = [sample["position"].mean(axis=(0, 1)) - centre for sample in both]
    assert ends[0] @ ends[1] < -0.99 * (1e3 * MOON_KM) ** 2
