"""A model may be in any units, and anywhere in them: what is rendered is the same."""

from __future__ import annotations

import json
import struct
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from tests.python.model_files import changed_glb, under

import perilune
from perilune import _core
from perilune.document.loader import read_tree

CHANNELS = ["rgb", "depth", "normal", "part", "object_coords"]
SIZE_M = 4.0


def rendered(repo_dir: Path, model: Path, **craft: Any) -> perilune.Sample:
    scene = read_tree(repo_dir / "tests/python/scene.yaml")
    scene["spacecraft"]["sat"] |= {"model": str(model), "size_m": SIZE_M, **craft}
    scene["camera"] |= {"width": 64, "height": 64, "fov_deg": 15}
    return perilune.open(scene, base=repo_dir / "tests/python").frame(0, channels=CHANNELS)


def check_same(found: perilune.Sample, expected: perilune.Sample) -> None:
    assert (expected["part"] > 0).sum() > 300
    np.testing.assert_array_equal(found["part"], expected["part"])
    np.testing.assert_allclose(found["depth"], expected["depth"], rtol=0, atol=1e-6 * SIZE_M)
    there = expected["depth"] > 0
    error = np.abs(found["object_coords"] - expected["object_coords"])[there]
    assert error.max() < 1e-6 * SIZE_M
    assert np.abs(found["normal"] - expected["normal"]).max() < 1e-3
    # Rays that are a rounding off may draw another texel or reach another lobe, once in a while.
    off = np.abs(found["rgb"].astype(int) - expected["rgb"]).max(axis=2)
    assert (off > 1).mean() < 5e-3


@pytest.fixture(scope="module")
def plain(repo_dir: Path) -> perilune.Sample:
    return rendered(repo_dir, repo_dir / "assets/models/smallsat.glb")


@pytest.mark.parametrize("scale", [1e-30, 1e-20, 1e-15, 1e-5, 1e5, 1e13, 1e16, 1e30])
def test_units_change_nothing(tmp_path, repo_dir, plain, scale):
    model = changed_glb(tmp_path / "sat.glb", lambda tree: under(tree, scale=[scale] * 3))
    check_same(rendered(repo_dir, model), plain)


@pytest.mark.parametrize("far", [1e3, 1e9])
def test_nodes_are_applied_before_anything_is_rounded(tmp_path, repo_dir, plain, far):
    place = [far, -2 * far, 3 * far]
    model = changed_glb(tmp_path / "sat.glb", lambda tree: under(tree, translation=place))
    check_same(rendered(repo_dir, model), plain)


@pytest.mark.parametrize("scale", [1e-20, 1e16])
def test_units_of_what_moves(tmp_path, repo_dir, scale):
    turn = {"node": "panel_left", "axis": [0, 1, 0], "angle_deg": 40.0}
    slide = {"node": "panel_right", "axis": [0, 1, 0], "translation_m": 0.3}
    model = changed_glb(tmp_path / "sat.glb", lambda tree: under(tree, scale=[scale] * 3))
    moves = {"articulation": [turn, slide]}
    plain = rendered(repo_dir, repo_dir / "assets/models/smallsat.glb", **moves)
    check_same(rendered(repo_dir, model, **moves), plain)


def triangle(path: Path, scale: float, node: float) -> Path:
    """One triangle of a size in the file's positions, under a node of another."""
    corners = scale * np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0]], np.float32)
    data = corners.astype("<f4").tobytes()
    tree = {
        "asset": {"version": "2.0"},
        "scene": 0,
        "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0, "scale": [node] * 3}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
        "materials": [{"doubleSided": True}],
        "accessors": [
            {
                "bufferView": 0,
                "componentType": 5126,
                "count": 3,
                "type": "VEC3",
                "min": corners.min(axis=0).tolist(),
                "max": corners.max(axis=0).tolist(),
            }
        ],
        "bufferViews": [{"buffer": 0, "byteLength": len(data)}],
        "buffers": [{"byteLength": len(data)}],
    }
    text = json.dumps(tree).encode()
    text += b" " * (-len(text) % 4)
    chunks = struct.pack("<II", len(text), 0x4E4F534A) + text
    chunks += struct.pack("<II", len(data), 0x004E4942) + data
    path.write_bytes(struct.pack("<III", 0x46546C67, 2, 12 + len(chunks)) + chunks)
    return path


@pytest.mark.parametrize(
    ("scale", "node"),
    [(1, 1e-20), (1, 1e-35), (1, 1e13), (1, 1e16), (1, 1e35), (1e-36, 1), (1e36, 1), (1e36, 1e30)],
)
def test_a_triangle_of_any_size(tmp_path, repo_dir, scale, node):
    """Of 1e-20 and of 1e13 to 1e16 units these ended the process."""
    one = rendered(repo_dir, triangle(tmp_path / "one.glb", 1.0, 1.0))
    found = rendered(repo_dir, triangle(tmp_path / "other.glb", scale, node))
    assert (one["part"] > 0).any()
    assert ((one["part"] > 0) == (found["part"] > 0)).all()
    np.testing.assert_allclose(found["depth"], one["depth"], rtol=0, atol=1e-6 * SIZE_M)


@pytest.mark.parametrize("scale", [1e-20, 1e16])
def test_lengths_that_are_told(tmp_path, repo_dir, scale):
    """Bounds and positions are in the file's units."""
    path = changed_glb(tmp_path / "sat.glb", lambda tree: under(tree, scale=[scale] * 3))
    plain = _core.Model(str(repo_dir / "assets/models/smallsat.glb"))
    model = _core.Model(str(path))
    np.testing.assert_allclose(model.bounds, scale * plain.bounds, rtol=1e-6, atol=1e-7 * scale)
    np.testing.assert_allclose(
        model.mesh()["positions"], scale * plain.mesh()["positions"], rtol=0, atol=4e-7 * scale
    )
