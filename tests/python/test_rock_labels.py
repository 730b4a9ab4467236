"""The channel of rocks and their table in a frame, beside all rocks that are drawn."""

from __future__ import annotations

import math
from functools import cache
from typing import Any

import numpy as np
import pytest
from tests.python.test_terrain_frames import MOON_M, in_body_axes, moon, over

import perilune
from perilune import _core
from perilune.base import rotations
from perilune.frame import shutter
from perilune.frame.craters import camera_pixels
from perilune.frame.rocks import ROCK_LABEL

ROCKS = {"law": "haworth", "min_diameter_m": 0.4, "max_diameter_m": 3.0, "density": 3.0, "seed": 2}
TERRAIN = {"detail": {"seed": 3, "strength": 0.5}, "rocks": ROCKS}
CHANNELS = ["rock_id", "instance", "position", "range", "elevation"]


def seen(trajectory: dict[str, Any], **rocks: Any) -> perilune.Simulation:
    terrain = TERRAIN | {"rocks": ROCKS | rocks}
    return moon(terrain, {"trajectory": trajectory, "width": 128, "height": 96})


@cache
def above() -> tuple[perilune.Simulation, perilune.Sample, np.ndarray]:
    sim = seen(over(30.0))
    return sim, sim.frame(0, CHANNELS), sim.rocks(0)


def test_the_table_says_what_the_channel_shows() -> None:
    _, sample, rows = above()
    ids = sample["rock_id"]
    assert rows.dtype == ROCK_LABEL
    assert len(rows) > 20
    assert (np.diff(rows["px_count_visib"]) <= 0).all()
    assert set(rows["id"].tolist()) == set(np.unique(ids).tolist()) - {0}
    for row in rows:
        lines, columns = np.nonzero(ids == row["id"])
        assert len(lines) == row["px_count_visib"]
        box = [columns.min(), lines.min(), np.ptp(columns) + 1, np.ptp(lines) + 1]
        np.testing.assert_array_equal(row["bbox_visib"], box)
        at_edge = {0, 127} & set(columns.tolist()) or {0, 95} & set(lines.tolist())
        assert row["cut"] == bool(at_edge)


def test_pixels_lie_on_their_rocks() -> None:
    """Within the rock's reach of its centre; and where there is none, on the ground."""
    sim, sample, rows = above()
    points, ids = in_body_axes(sim, sample), sample["rock_id"]
    by_id = {int(row["id"]): row for row in rows}
    for line, column in zip(*np.nonzero(ids), strict=True):
        row = by_id[int(ids[line, column])]
        away = np.linalg.norm(points[line, column] - row["center_m"])
        assert away < 1.2 * row["diameter_m"]
    terrain, _ = sim._mine().terrain_of(sim.config, "moon")
    bare = points[ids == 0]
    radius = np.linalg.norm(bare, axis=1)
    heights = terrain.heights(bare / radius[:, None])
    np.testing.assert_allclose(radius - MOON_M - heights, 0.0, atol=0.15)


def test_all_large_rocks_in_the_picture_are_in_the_table() -> None:
    sim, sample, rows = above()
    terrain, _ = sim._mine().terrain_of(sim.config, "moon")
    middle = in_body_axes(sim, sample)[48, 64]
    field = _core.RockField({"radius_m": MOON_M, **ROCKS})
    listed = field.list(terrain, middle, 25.0, 0.8)
    pose = shutter.middle(sim.world(0)).poses["moon"][0]
    root = listed["center"] @ rotations.to_matrix(pose[3:]).T + pose[:3]
    camera = sample.camera
    points = root @ camera.R_w2c.T + camera.t_w2c
    u, v = camera_pixels(camera, points).T
    inside = (u > 3.0) & (u < 124.0) & (v > 3.0) & (v < 92.0)
    assert inside.sum() > 5
    assert set(listed["id"][inside].tolist()) <= set(rows["id"].tolist())


def test_a_rock_has_the_same_id_from_a_rover() -> None:
    """And the same place and size: the tables differ in pixels alone."""
    _, _, rows = above()
    near = seen(over(1.6, 65.0)).rocks(0)
    both, a, b = np.intersect1d(rows["id"], near["id"], return_indices=True)
    assert len(both) >= 3
    for name in ("center_m", "diameter_m", "height_m", "burial", "family", "rotation"):
        np.testing.assert_array_equal(rows[name][a], near[name][b])
    assert (near["px_count_visib"][b] > 4 * rows["px_count_visib"][a]).any()


def aslant(times: int = 1, **rocks: Any) -> np.ndarray:
    """Rows of rocks in a view of 128x96 pixels over a field of many, or of the picture about it
    that is some times as wide and high."""
    width, focal_px = 128 * times, 110.0
    camera = {
        "trajectory": over(6.0, 70.0),
        "width": width,
        "height": 96 * times,
        "fov_deg": math.degrees(2.0 * math.atan(0.5 * width / focal_px)),
    }
    many = ROCKS | {"density": 20.0} | rocks
    return moon(TERRAIN | {"rocks": many}, camera).rocks(0)


def test_whole_boxes_of_cut_rocks_are_those_of_a_larger_picture() -> None:
    """To a pixel, few to two: which centres of pixels a far rock covers, its mesh decides."""
    rows, wide = aslant(), aslant(3)
    _, a, b = np.intersect1d(rows["id"], wide["id"], return_indices=True)
    assert len(a) == len(rows)
    cut = rows["cut"][a]
    assert cut.sum() > 10
    shown = wide["bbox_visib"][b] - [128, 96, 0, 0]
    off = np.abs(rows["bbox_obj"][a] - shown)[cut].max(axis=1)
    assert (off <= 1).mean() > 0.9
    assert off.max() <= 2
    assert (np.abs(rows["bbox_visib"][a] - shown)[cut].max(axis=1) > 1).sum() > 8


def test_whole_boxes_of_hidden_rocks_are_those_of_rocks_alone() -> None:
    """With the small rocks gone that were before them. Large ones still hide each other, so a few
    boxes differ."""
    rows, alone = aslant(), aslant(min_diameter_m=0.9)
    _, a, b = np.intersect1d(rows["id"], alone["id"], return_indices=True)
    same = ~alone["cut"][b]
    off = np.abs(rows["bbox_obj"][a] - alone["bbox_visib"][b])[same].max(axis=1)
    assert len(off) > 60
    assert (off <= 1).mean() > 0.94
    assert off.max() <= 4
    hidden = rows["px_count_visib"][a] < 0.9 * alone["px_count_visib"][b]
    assert hidden.sum() > 15


def test_whole_boxes_hold_the_visible_ones() -> None:
    rows = aslant()
    low, seen = rows["bbox_obj"][:, :2], rows["bbox_visib"][:, :2]
    assert (low <= seen).all()
    high = low + rows["bbox_obj"][:, 2:]
    assert (high >= seen + rows["bbox_visib"][:, 2:]).all()


def test_none() -> None:
    sim = seen(over(30.0), density=0.0)
    assert len(sim.rocks(0)) == 0
    assert not sim.frame(0, ["rock_id"])["rock_id"].any()
    with pytest.raises(ValueError, match=r"body: no body has terrain\.rocks"):
        moon({}, {"trajectory": over(30.0)}).rocks(0)
    terrain, _ = above()[0]._mine().terrain_of(above()[0].config, "moon")
    one, eye = np.array([1], dtype=np.uint64), np.zeros(3)
    with pytest.raises(ValueError, match="no rock with the id 1"):
        terrain.rocks(one)
    with pytest.raises(ValueError, match="no rock with the id 1"):
        terrain.rock_surfaces(one, eye, 1e-3)
    with pytest.raises(ValueError, match="pixel_rad: must be finite and above 0"):
        terrain.rock_surfaces(one, eye, 0.0)
    bare = _core.Terrain(np.full(3, MOON_M))
    with pytest.raises(ValueError, match="the terrain has no rocks"):
        bare.rocks(one)
    with pytest.raises(ValueError, match="the terrain has no rocks"):
        bare.rock_surfaces(one, eye, 1e-3)
