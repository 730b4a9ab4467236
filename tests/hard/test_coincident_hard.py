"""Faces of several objects in one place: which is seen where materials have holes, where objects
are articulated, and however many there are. And no light passes between things that touch."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from tests.hard.glb import write_glb
from tests.hard.test_decals import DECAL, HALF, sheet, write
from tests.hard.test_surfaces_hard import HALVES, SQUARE, before_the_ball, leaning

import perilune
from perilune.document.loader import read_tree

HOLE = {"nodes": {"skin": {"type": "lambert", "alpha": 0.0}}}
CHECKED = {
    "nodes": {
        "where": {"type": "coordinates"},
        "cells": {"type": "checker", "vector": "where", "scale": 3.0},
        "skin": {"type": "lambert", "alpha": "cells.value"},
    }
}


@pytest.mark.parametrize("cells", [1, 3])
def test_a_decal_that_is_not_there_is_not_seen(repo_dir: Path, tmp_path: Path, cells: int) -> None:
    """One model: the face below is seen wherever the material of the one above leaves none."""
    path = write(tmp_path / "m.glb", [sheet(2, HALF, 0.2), sheet(cells, DECAL, 0.2)], True)
    tree = read_tree(repo_dir / "tests/python/scene.yaml")
    tree["spacecraft"]["sat"].update(model=str(path), size_m=6.0)
    tree["camera"].update(width=96, height=72)
    tree["camera"]["trajectory"] = {"kind": "orbit_object", "target": "sat", "distance_m": 8}
    plain = perilune.open(tree, base=repo_dir).frame(0, ["part", "instance"])
    base, decal = np.unique(plain["part"][plain["instance"] == plain["instance"].max()])
    above = plain["part"] == decal
    assert above.sum() > 300
    tree["materials"] = {"hole": HOLE, "checked": CHECKED}
    for name, seen in (("hole", 0.0), ("checked", 0.5)):
        tree["spacecraft"]["sat"]["materials"] = [{"material": "1", "use": name}]
        sample = perilune.open(tree, base=repo_dir).frame(0, ["part", "instance"])
        assert abs((sample["part"][above] == decal).mean() - seen) < 0.2
        assert (sample["part"][above & (sample["part"] != decal)] == base).all()
        assert np.array_equal(sample["instance"], plain["instance"])


def squares(folder: Path, count: int, angle: float) -> dict[str, Path]:
    """As many objects of one shape, each cut into triangles in one of two ways."""
    return {
        f"square{k}": write_glb(folder / f"{k}.glb", leaning(SQUARE, angle), HALVES[k % 2])
        for k in range(count)
    }


JOINT = [{"node": "shape", "axis": [0.0, 0.0, 1.0], "angle_deg": 0.0}]


@pytest.mark.parametrize("angle", [0.0, 0.4, 1.0])
@pytest.mark.parametrize("position", [[0.0, 0.0, 12.0], [3.0, 1.0, 6.0]])
@pytest.mark.parametrize("moving", [(), (0,), (1,), (0, 1)])
def test_the_later_object_is_seen_whichever_is_articulated(
    tmp_path: Path, moving: tuple[int, ...], position: list[float], angle: float
) -> None:
    """And nothing changes where the earlier one is taken away."""
    models = squares(tmp_path, 2, angle)
    joints = {f"spacecraft.square{k}.articulation": JOINT for k in moving}
    image = before_the_ball(tmp_path, models, position, **joints).frame(0, ["instance"])["instance"]
    last = {"square1": models["square1"]}
    alone = before_the_ball(tmp_path, last, position).frame(0, ["instance"])["instance"]
    assert (alone == 2).sum() > 100
    assert np.array_equal(image == 3, alone == 2)


def test_the_last_of_many_is_seen(tmp_path: Path) -> None:
    """Ten objects in one place; the order began anew at the ninth."""
    models = squares(tmp_path, 10, 0.4)
    sample = before_the_ball(tmp_path, models, [3.0, 1.0, 6.0]).frame(0, ["instance"])
    assert set(np.unique(sample["instance"])) <= {0, 1, 11}
    assert (sample["instance"] == 11).sum() > 100
    places = {
        "materials": {"hole": HOLE},
        **{f"spacecraft.square{k}.materials": [{"material": "*", "use": "hole"}] for k in (9, 7)},
    }
    below = before_the_ball(tmp_path, models, [3.0, 1.0, 6.0], **places).frame(0, ["instance"])
    assert np.array_equal(below["instance"] == 10, sample["instance"] == 11)


def test_the_shadow_of_a_wall_begins_at_its_foot(tmp_path: Path) -> None:
    """On a floor 200 km away, as the second object and as the eighth: objects used to be moved
    towards the camera by their number, off the floor, and light passed under them."""
    wall = SQUARE[:, [0, 2, 1]] * np.float32(40.0) + np.float32([0.0, 10.0, 40.0])
    far = SQUARE + np.float32([0.0, 0.0, -5e3])
    position = [0.0, -1.5e5, 1.5e5]
    changes: dict[str, Any] = {
        "camera.fov_deg": 0.015,
        "sun.direction": [0.0, 1.0, 0.3],
        "render.samples": 16,
    }
    frames = []
    for between in (0, 6):  # in the order of their names
        models = {"a": write_glb(tmp_path / "floor.glb", SQUARE * np.float32(200.0), HALVES[0])}
        for k in range(between):
            models[f"b{k}"] = write_glb(tmp_path / f"far{k}.glb", far, HALVES[0])
        models["c"] = write_glb(tmp_path / "wall.glb", wall.astype(np.float32), HALVES[0])
        frames.append(before_the_ball(tmp_path, models, position, **changes).frame(0, SEEN))
    few, many = frames
    assert (few["instance"] == 2).sum() > 1000
    assert np.array_equal(few["instance"] == 3, many["instance"] == 9)
    assert np.array_equal(few["instance"] == 2, many["instance"] == 2)
    for sample in frames:
        assert sample["radiance"].max() == 0.0  # the back of the wall, and its shadow
    np.testing.assert_array_equal(few["depth"], many["depth"])


SEEN = ["radiance", "instance", "depth"]
