"""Published models with moving parts, rendered: an animation, and normal maps that turn along."""

from __future__ import annotations

import numpy as np
import pytest

import perilune
from perilune.document.loader import read_tree


def opened(repo_dir, model, camera, **craft):
    tree = read_tree(repo_dir / "tests/python/scene.yaml")
    tree["sun"] = {"direction": [0.6, -1.0, 0.4]}
    sat = tree["spacecraft"]["sat"]
    del sat["size_m"]
    # Far enough from the Earth that its light does not matter.
    sat |= {"orbit": {"around": "earth", "position_km": [0.0, -42000.0, 0.0]}, "centre": "origin"}
    sat |= {"model": str(model), "metres_per_unit": 1.0, **craft}
    tree["time"]["step_s"] = 0.625
    tree["camera"] |= {"width": 96, "height": 64}
    tree["camera"]["trajectory"] = {"kind": "fixed", "target": "sat", "position_m": camera}
    tree["render"] = {"samples": 16, "tolerance_dn": 0.0, "max_bounces": 1}
    return perilune.open(tree)


def test_the_animated_box(repo_dir, data_dir):
    """Khronos' BoxAnimated: its inner box rises by 2.52 units until 1.25 s, turns by half a turn
    until 2.5 s, and sinks until 3.708 s: the file's numbers. It is 0.67 wide and 0.99 high."""
    model = data_dir / "gltf/valid/BoxAnimated.glb"
    sim = opened(repo_dir, model, [1.5, -13.0, 6.0], animation={"index": 0, "loop": "clamp"})
    low, high = np.array(sim.models["sat"].model.bounds)
    assert np.allclose([low, high], [[-0.5] * 3, [0.5] * 3], atol=1e-6)
    down = 2.52 * (3.708330 - 3.125) / 1.208330
    heights = {0: 0.0, 1: 1.26, 2: 2.52, 3: 2.52, 4: 2.52, 5: down, 8: 0.0}
    for index, height in heights.items():
        sample = sim.frame(index, ["rgb", "part", "object_coords"], threads=1)
        inner = sample["part"] == 3  # the second part of the model, after 1, what is no part
        assert inner.sum() > 5  # the outer box is open above
        points = sample["object_coords"][inner]
        half = [0.335, 0.495, 0.335] if index == 3 else [0.335, 0.335, 0.495]  # it lies, or stands
        middle = np.array([0.0, 0.0, height])
        assert (np.abs(points - middle) < np.array(half) + 0.01).all()
        assert points[:, 2].max() == pytest.approx(height + half[2], abs=0.03)
        assert sample["rgb"][inner].max() > 30  # lit
        turn = sample.meta["articulation"]["sat"]["inner_box"]["motion"]
        assert turn[2, 3] == pytest.approx(height, abs=1e-5)
    half = sim.frame(3, ["depth"], threads=1).meta["articulation"]["sat"]["inner_box"]["motion"]
    # (0, 0, 0, -1) to (1, 0, 0, 0): about x, at the middle by a quarter turn.
    assert np.abs(half[1:3, 1:3]) == pytest.approx(np.array([[0, 1], [1, 0]]), abs=1e-5)


@pytest.mark.parametrize("axis", [0, 1, 2])
@pytest.mark.parametrize("node", ["node 0", "NormalTangentTest_low"])
def test_normal_maps_turn_with_their_piece(repo_dir, data_dir, node, axis):
    """A plate with a normal map, turned as a piece or turned as an object: the same picture.

    Khronos' NormalTangentTest has no tangents of its own: they are the reader's."""
    model = data_dir / "gltf/valid/NormalTangentTest.glb"
    turn, angle = np.eye(3)[axis], (20.0, 70.0, 20.0)[axis]
    joint = {"node": node, "axis": turn.tolist(), "axes": "object", "angle_deg": angle}
    still = {"attitude": {"rotation_deg": [0.0, 0.0, 0.0]}, "articulation": [joint]}
    turned = {"attitude": {"rotation_deg": (angle * turn).tolist()}}
    pictures = [
        opened(repo_dir, model, [0.5, -4.0, 0.3], **craft).frame(0, ["rgb", "normal"], threads=1)
        for craft in (still, turned)
    ]
    apart = np.abs(pictures[0]["rgb"].astype(int) - pictures[1]["rgb"])
    # By rounding a sample may fall on another lobe.
    assert np.count_nonzero(apart > 1) <= 2
    assert apart.max() <= 8
    assert np.allclose(pictures[0]["normal"], pictures[1]["normal"], atol=1e-5, equal_nan=True)
    flat = opened(repo_dir, model, [0.5, -4.0, 0.3]).frame(0, ["rgb"], threads=1)
    assert np.abs(flat["rgb"].astype(int) - pictures[0]["rgb"]).max() > 50  # it did turn
