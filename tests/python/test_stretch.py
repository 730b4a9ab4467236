"""A spacecraft stretched along its axes is the same mesh stretched beforehand: what is rendered,
how parts move, and what datasets hold."""

from __future__ import annotations

import json
import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from tests.hard.glb import cube, write_glb
from tests.python.model_files import changed_glb, melted_box, under

import perilune
from perilune import _core
from perilune.config import ConfigError
from perilune.document.loader import read_tree
from perilune.export.check import check_bop

CHANNELS = ["rgb", "depth", "normal", "part", "object_coords", "objects"]
BY_AXIS = (0.5, 1.5, 1.0)
"""Metres a unit along x, y and z, z up."""


def rendered(repo_dir: Path, model: Path, **craft: Any) -> perilune.Sample:
    return opened(repo_dir, model, **craft).frame(1, channels=CHANNELS, threads=1)


def opened(repo_dir: Path, model: Path, **craft: Any) -> perilune.Simulation:
    scene = read_tree(repo_dir / "tests/python/scene.yaml")
    scene["spacecraft"]["sat"] |= {"model": str(model), "size_m": None, **craft}
    scene["camera"] |= {"width": 64, "height": 64, "fov_deg": 25}
    scene["camera"]["trajectory"] |= {
        "distance_m": 15.0,
        "cone_axis": [1, -1, 0.5],
        "cone_angle_deg": 1,
    }
    return perilune.open(scene, base=repo_dir / "tests/python")


def check_same(found: perilune.Sample, expected: perilune.Sample) -> None:
    assert (expected["part"] > 0).sum() > 300
    np.testing.assert_array_equal(found["part"], expected["part"])
    np.testing.assert_allclose(found["depth"], expected["depth"], rtol=0, atol=1e-5)
    there = expected["depth"] > 0
    assert np.abs(found["object_coords"] - expected["object_coords"])[there].max() < 1e-5
    assert np.abs(found["normal"] - expected["normal"]).max() < 1e-3
    off = np.abs(found["rgb"].astype(int) - expected["rgb"]).max(axis=2)
    assert (off > 1).mean() < 5e-3  # rays that are a rounding off may draw another texel


def stretched(path: Path) -> Path:
    """The satellite below a node that stretches it; the file's y is up."""
    x, y, z = BY_AXIS
    return changed_glb(path, lambda tree: under(tree, scale=[x, z, y]))


def ball(path: Path, by_axis: tuple[float, float, float]) -> Path:
    """A sphere of radius 2 m whose points and normals are those of an ellipsoid: its normals turn
    with the inverse of the factors."""
    n = 24
    lon, lat = np.meshgrid(np.linspace(0, 2 * math.pi, 2 * n + 1), np.linspace(-1, 1, n + 1))
    lat = lat * 0.499 * math.pi
    unit = np.stack([np.cos(lat) * np.cos(lon), np.cos(lat) * np.sin(lon), np.sin(lat)], axis=-1)
    unit = unit.reshape(-1, 3)
    row, column = (k.ravel() for k in np.mgrid[:n, : 2 * n])
    a = row * (2 * n + 1) + column
    b, c = a + 1, a + 2 * n + 1
    triangles = np.concatenate([np.stack([a, b, c + 1], 1), np.stack([a, c + 1, c], 1)])
    normals = unit / np.array(by_axis)
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    turned = normals[:, [0, 2, 1]] * [1, 1, -1]  # the file's axes
    points = (2.0 * unit * np.array(by_axis)).astype(np.float32)
    return write_glb(path, points, triangles, {"NORMAL": turned.astype(np.float32)})


def test_positions_and_normals_are_those_of_the_mesh_stretched_beforehand(repo_dir, tmp_path):
    plain, ready = ball(tmp_path / "plain.glb", (1, 1, 1)), ball(tmp_path / "ready.glb", BY_AXIS)
    expected = rendered(repo_dir, ready, metres_per_unit=1.0)
    check_same(rendered(repo_dir, plain, metres_per_unit=list(BY_AXIS)), expected)
    mesh = _core.Model(str(plain), math.pi, np.array(BY_AXIS)).mesh()
    there = _core.Model(str(ready)).mesh()
    assert np.abs(mesh["positions"] - there["positions"]).max() < 1e-6
    assert np.abs(mesh["normals"] - there["normals"]).max() < 1e-6
    even = rendered(repo_dir, plain, metres_per_unit=1.0)
    assert (even["part"] != expected["part"]).mean() > 0.02


def test_textured_parts_and_what_moves(repo_dir, tmp_path):
    """As below a node of that scale: tangents, joints in either axes, reach."""
    turn = {"node": "panel_left", "axis": [0, 1, 0], "angle_deg": 40.0}
    slide = {"node": "panel_right", "axis": [0, 1, 0.5], "axes": "object", "translation_m": 0.3}
    moving = {"articulation": [turn, slide]}
    plain = repo_dir / "assets/models/smallsat.glb"
    ready = opened(repo_dir, stretched(tmp_path / "ready.glb"), metres_per_unit=1.0, **moving)
    by_axis = opened(repo_dir, plain, metres_per_unit=list(BY_AXIS), **moving)
    expected, found = (sim.frame(1, channels=CHANNELS, threads=1) for sim in (ready, by_axis))
    check_same(found, expected)
    there = expected.meta["articulation"]["sat"]
    for name, row in found.meta["articulation"]["sat"].items():
        assert np.abs(np.array(row["motion"]) - there[name]["motion"]).max() < 1e-7
    assert by_axis.models["sat"].radius_m == pytest.approx(ready.models["sat"].radius_m, rel=1e-6)
    still = rendered(repo_dir, plain, metres_per_unit=list(BY_AXIS))
    assert (still["part"] != expected["part"]).mean() > 0.01
    assert (found.objects["bbox_obj"] == expected.objects["bbox_obj"]).all()


def test_animations_play_within_the_stretched_model(repo_dir, data_dir):
    """The inner box of Khronos' BoxAnimated rises by 2.52 units, along the axis that is doubled."""
    model = data_dir / "gltf/valid/BoxAnimated.glb"
    craft = {"centre": "origin", "animation": {"index": 0, "loop": "clamp", "start_s": 1.25}}
    sim = opened(repo_dir, model, metres_per_unit=[1.0, 1.0, 2.0], **craft)
    motion = sim.frame(0, ["depth"], threads=1).meta["articulation"]["sat"]["inner_box"]["motion"]
    assert motion[:3, 3] == pytest.approx([0.0, 0.0, 5.04], abs=1e-4)
    assert motion[:3, :3] == pytest.approx(np.eye(3), abs=1e-6)


def test_equal_factors_are_a_number(repo_dir):
    model = repo_dir / "assets/models/smallsat.glb"
    even = rendered(repo_dir, model, metres_per_unit=0.7)
    by_axis = rendered(repo_dir, model, metres_per_unit=[0.7, 0.7, 0.7])
    assert all(np.array_equal(even[name], by_axis[name], equal_nan=True) for name in CHANNELS[:-1])


def test_datasets_hold_the_stretched_model(repo_dir, tmp_path):
    box = write_glb(tmp_path / "box.glb", *cube(1.0))
    sim = opened(repo_dir, box, metres_per_unit=[1.0, 2.0, 0.5])
    perilune.write_bop(sim, range(2), tmp_path / "out", threads=1)
    for folder in ("models", "models_eval"):
        (row,) = json.loads((tmp_path / "out" / folder / "models_info.json").read_text()).values()
        assert [row[f"size_{axis}"] for axis in "xyz"] == pytest.approx([2e3, 4e3, 1e3])
        assert row["diameter"] == pytest.approx(1e3 * math.sqrt(21.0))
    assert check_bop(tmp_path / "out").findings == []  # traces the written model anew


def test_moving_parts_in_datasets(repo_dir, tmp_path):
    turn = {"node": "panel_left", "axis": [0, 1, 0], "angle_deg": {"uniform": [0.0, 90.0]}}
    model = repo_dir / "assets/models/smallsat.glb"
    sim = opened(repo_dir, model, metres_per_unit=list(BY_AXIS), articulation=[turn])
    perilune.write_bop(sim, range(2), tmp_path / "out", threads=1)
    assert (tmp_path / "out/models_parts").is_dir()
    assert check_bop(tmp_path / "out").findings == []


def test_boxes_of_parts_are_in_the_files_units(repo_dir, tmp_path):
    """So that they need no change with the scale, and are what `perilune parts MODEL` lists."""
    box = write_glb(tmp_path / "box.glb", *cube(1.0))
    top = {"boxes": {"top": {"min": [-1.1, -1.1, 0.9], "max": [1.1, 1.1, 1.1]}}}
    for by_axis in (1.0, [1.0, 2.0, 0.5]):
        sim = opened(repo_dir, box, metres_per_unit=by_axis, parts=top)
        cut = sim.frame(0, ["part"], threads=1)
        assert [row.name for row in sim.taxonomy.parts if row.owner == "sat"] == ["top", "shape"]
        assert len(np.unique(cut["part"])) >= 2
    far = {"boxes": {"top": {"min": [2, 2, 2], "max": [3, 3, 3]}}}
    with pytest.raises(ConfigError, match=r"spans \[-1.0, -1.0, -1.0\] to \[1.0, 1.0, 1.0\]"):
        _ = opened(repo_dir, box, metres_per_unit=[1.0, 2.0, 0.5], parts=far).taxonomy


@pytest.mark.parametrize(
    ("value", "text"),
    [
        ([1.0, -1.0, 1.0], r"metres_per_unit\[1\] = -1.0: .*greater than 0"),
        ([1.0, 0, 1.0], r"metres_per_unit\[1\] = 0: .*greater than 0"),
        ([1.0, 2.0], "metres_per_unit: .*3"),
        ([1.0, {"uniform": [1.0, 2.0]}, 1.0], "metres_per_unit.*: takes no driver"),
        ("1 m", "metres_per_unit = '1 m': must be a finite number"),
        ([1e-30, 1e30, 1.0], "metres_per_unit: .*allowed: 1e-09 to"),
    ],
)
def test_factors_that_cannot_be(repo_dir, value, text):
    with pytest.raises(ConfigError, match=text):
        _ = opened(repo_dir, repo_dir / "assets/models/smallsat.glb", metres_per_unit=value).models


def test_no_driver_changes_them(repo_dir):
    model = repo_dir / "assets/models/smallsat.glb"
    choice = {"choice": [[1.0, 1.0, 1.0], [1.0, 1.0, 2.0]]}
    with pytest.raises(ConfigError, match="metres_per_unit"):
        opened(repo_dir, model, metres_per_unit=choice).frame(0, ["depth"], threads=1)


def test_the_core_refuses_what_is_no_factor(repo_dir):
    path = str(repo_dir / "assets/models/smallsat.glb")
    for wrong in ([1.0, -1.0, 1.0], [0.0, 1.0, 1.0], [math.nan, 1, 1], [math.inf, 1, 1]):
        with pytest.raises(ValueError, match="stretch must be positive and finite"):
            _core.Model(path, 0.5, np.array(wrong))
    with pytest.raises(ValueError, match="stretch"):
        _core.Model(path, 0.5, np.ones(2))


def test_overrides_read_a_model_anew(repo_dir, tmp_path):
    """What is fixed when a scene is built makes another scene where an override changes it."""
    box = melted_box(tmp_path / "box.glb")
    sim = opened(repo_dir, box, metres_per_unit=1.0)
    first = sim.frame(1, CHANNELS, threads=1)
    for key, value in (("metres_per_unit", [1.0, 1.0, 2.0]), ("crease_angle_deg", 180.0)):
        other = sim.with_overrides({f"spacecraft.sat.{key}": value})
        found = other.frame(1, CHANNELS, threads=1)
        fresh = opened(repo_dir, box, **({"metres_per_unit": 1.0} | {key: value}))
        expected = fresh.frame(1, CHANNELS, threads=1)
        assert all(
            np.array_equal(found[name], expected[name], equal_nan=True) for name in CHANNELS[:-1]
        )
        assert (found["rgb"] != first["rgb"]).any()
