"""Poses in written BOP files are the orbit's: out of the camera, back in the world."""

from __future__ import annotations

import json
import math

import numpy as np

import perilune
from perilune.base import rotations


def places_m(folder, index, obj_id):
    """Of an object in the root frame, from scene_gt.json and scene_camera.json alone; and its
    axes."""
    (scene,) = sorted(p.parent for p in folder.rglob("scene_gt.json"))
    camera = json.loads((scene / "scene_camera.json").read_text())[str(index)]
    rows = json.loads((scene / "scene_gt.json").read_text())[str(index)]
    (row,) = [row for row in rows if row["obj_id"] == obj_id]
    turn = np.array(camera["cam_R_w2c"]).reshape(3, 3)
    from_camera = np.array(row["cam_t_m2c"]) - np.array(camera["cam_t_w2c"])
    return turn.T @ from_camera / 1e3, turn.T @ np.array(row["cam_R_m2c"]).reshape(3, 3)


def test_poses_are_the_orbits_states(small_scene, tmp_path):
    """To 1e-9 of the distance: against the system's states, and a circular orbit written down."""
    sim = perilune.open(small_scene, overrides={"render.samples": 1})
    perilune.write_bop(sim, range(0, 40, 8), tmp_path / "set")
    gm, radius, tilt = 398600.0e9, 6878.0e3, math.radians(30.0)
    for index in range(0, 40, 8):
        expected = sim.system(index).states(np.array([60.0 * index])).poses["probe"][0]
        place, axes = places_m(tmp_path / "set", index, sim.models["probe"].obj_id)
        assert np.linalg.norm(place - expected[:3]) < 1e-9 * radius
        assert np.allclose(axes, rotations.to_matrix(expected[3:]), rtol=0, atol=1e-9)
        u = math.radians(10.0) + math.sqrt(gm / radius**3) * 60.0 * index
        circle = [math.cos(u), math.sin(u) * math.cos(tilt), math.sin(u) * math.sin(tilt)]
        assert np.linalg.norm(place - radius * np.array(circle)) < 1e-9 * radius
