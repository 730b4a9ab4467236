"""Models as they are rendered: sides, holes, moving parts, rolling shutters, bodies alone."""

from __future__ import annotations

import json
import logging

import numpy as np
import pytest
from PIL import Image

import perilune
from perilune.export.check import check_bop

from .retrace import Retrace, read_faces, write_sheets

CLEAR = {"alphaMode": "BLEND", "pbrMetallicRoughness": {"baseColorFactor": [1, 1, 1, 0.2]}}
FRAMES = range(8)


def scene(small_scene, model, **craft):
    changes = {f"spacecraft.probe.{key}": value for key, value in craft.items()}
    return perilune.open(
        small_scene,
        overrides={
            "spacecraft.probe.model": str(model),
            "spacecraft.probe.size_m": None,
            "spacecraft.probe.metres_per_unit": 1.0,
            "camera.width": 64,
            "camera.height": 48,
            "render.samples": 1,
            **changes,
        },
    )


def info_of(out, folder="models"):
    return json.loads((out / folder / "models_info.json").read_text())


def retraced(out):
    """Pixels of masks, and those that differ, of all images."""
    found = [Retrace(out).compare(im_id) for im_id in FRAMES]
    return np.sum(found, axis=0)


def test_sides_and_holes_are_those_that_are_rendered(small_scene, tmp_path):
    """Against the models as they were written before, backs, holes and clear sheets showed."""
    model = write_sheets(
        tmp_path / "sheets.gltf",
        one_sided={"place": [0, 0, 0]},
        two_sided={"place": [0, 3, 0], "axis": 1, "material": {"doubleSided": True}},
        clear={"place": [0, -3, 0], "half": 2.0, "material": CLEAR},
        clear_vertices={"place": [0, 6, 0], "alpha": 0.1, "material": {"alphaMode": "MASK"}},
    )
    out = tmp_path / "out"
    perilune.write_bop(scene(small_scene, model, faces="as_stated"), FRAMES, out, threads=1)
    pixels, wrong = retraced(out)
    assert pixels > 500
    assert wrong == 0
    row = info_of(out)["1"]
    assert len(read_faces(out / "models" / "obj_000001.ply")) == 2 + 4
    assert (row["faces_one_sided"], row["triangles_left_out"]) == (2, 4)
    assert "faces_cut_in_part" not in row
    assert (row["size_x"], row["size_y"], row["size_z"]) == (2000.0, 2000.0, 4000.0)
    assert check_bop(out).findings == []
    card = (out / "dataset_info.md").read_text()
    assert "| 1 | 2 | 0 | 4 |" in card


def test_faces_that_alpha_cuts_in_part_are_the_last_and_counted(small_scene, tmp_path):
    both = {"doubleSided": True, "alphaMode": "MASK"}
    model = write_sheets(
        tmp_path / "sheets.gltf",
        cut={"place": [0, 0, 0], "alpha": [0.0, 1.0, 1.0, 1.0], "material": both},
        whole={"place": [0, 3, 0]},
    )
    out = tmp_path / "out"
    perilune.write_bop(scene(small_scene, model, faces="as_stated"), range(1), out, threads=1)
    row = info_of(out)["1"]
    assert row["faces_cut_in_part"] == 4  # either triangle, from both sides
    faces = read_faces(out / "models" / "obj_000001.ply")
    heights = faces[:, :, 2].mean(axis=1)  # the file's y is up
    assert heights[:2].min() > heights[2:].max()
    assert check_bop(out).findings == []


def test_a_graph_that_leaves_nothing_takes_triangles_away(small_scene, tmp_path):
    model = write_sheets(tmp_path / "s.gltf", a={"place": [0, 0, 0]}, b={"place": [0, 3, 0]})
    graph = {"nodes": {"skin": {"type": "principled", "alpha": 0.0}}}
    sim = perilune.open(
        small_scene,
        overrides={
            "materials": {"gone": graph},
            "spacecraft.probe.model": str(model),
            "spacecraft.probe.materials": [{"material": "b", "use": "gone"}],
            "spacecraft.probe.faces": "as_stated",
        },
    )
    perilune.write_bop(sim, range(1), tmp_path / "out", threads=1)
    assert len(read_faces(tmp_path / "out" / "models" / "obj_000001.ply")) == 2
    assert info_of(tmp_path / "out")["1"]["triangles_left_out"] == 2


def test_parts_that_move_are_models_of_their_own(small_scene, tmp_path):
    model = write_sheets(
        tmp_path / "sheets.gltf",
        bus={"place": [0, 0, 0], "material": {"doubleSided": True}},
        wing={"place": [0, 2, 0], "half": 0.8, "material": {"doubleSided": True}},
    )
    joint = {"node": "wing", "axis": [0, 0, 1], "rate_deg_s": 1.0}
    sim = scene(small_scene, model, articulation=[joint])
    out = tmp_path / "out"
    perilune.write_bop(sim, FRAMES, out, threads=1)
    parts = info_of(out, "models_parts")
    assert [(row["obj_id"], row["nodes"]) for row in parts.values()] == [(1, []), (1, ["wing"])]
    pixels, wrong = retraced(out)
    assert pixels > 500
    assert wrong == 0
    whole = read_faces(out / "models" / "obj_000001.ply")
    cut = [read_faces(path) for path in sorted((out / "models_parts").glob("*.ply"))]
    assert sorted(map(str, np.concatenate(cut))) == sorted(map(str, whole))
    assert check_bop(out).findings == []
    assert "models_parts/" in (out / "dataset_info.md").read_text()


@pytest.mark.parametrize("turning", [False, True])
def test_rows_of_a_rolling_shutter_have_poses_of_their_own(small_scene, tmp_path, turning):
    model = write_sheets(
        tmp_path / "sheets.gltf",
        bus={"place": [0, 0, 0], "material": {"doubleSided": True}},
        wing={"place": [0, 2, 0], "half": 0.8, "material": {"doubleSided": True}},
    )
    joint = {"node": "wing", "axis": [0, 0, 1], "rate_deg_s": 9.0}
    sim = scene(
        small_scene,
        model,
        attitude={"spin_rate_deg_s": 7.0},
        articulation=[joint] if turning else [],
    )
    rolling = {"camera.line_time_us": 50000.0, "render.tolerance_dn": 0.0}
    tree = {**sim.document.tree}
    sim = perilune.open(tree, overrides=rolling, base=small_scene.parent)
    out = tmp_path / "out"
    perilune.write_bop(sim, range(3), out, threads=1)
    assert check_bop(out).findings == []
    found = Retrace(out)
    checked = 0
    for im_id in range(3):
        pose = found.gt[str(im_id)][0]
        places = [at["row"] for at in pose["rows"]]
        assert (places[0], places[-1]) == (0, 47)
        assert [at["row"] for at in found.cameras[str(im_id)]["rows"]] == places
        with Image.open(out / f"train/000000/mask_visib/{im_id:06d}_000000.png") as image:
            mask = np.array(image) > 0
        for at in pose["rows"]:
            pixels = np.column_stack([np.arange(64), np.full(64, at["row"])]).astype(float)
            shifts = ([0, 0], [0.05, 0], [-0.05, 0], [0, 0.05], [0, -0.05])
            hits = [np.isfinite(found.hits(im_id, 0, pixels + shift, at)) for shift in shifts]
            sure = np.all(hits, axis=0) | ~np.any(hits, axis=0)
            assert (hits[0] == mask[at["row"]])[sure].all()
            checked += int(mask[at["row"]].sum())
    assert checked > 20
    assert "shutter rolls" in (out / "dataset_info.md").read_text()


def test_a_body_alone_has_depth_and_is_told(small_scene, tmp_path, caplog):
    view = {"kind": "hover", "target": "planet", "height_m": 400e3}
    sim = perilune.open(
        small_scene, overrides={"spacecraft": {}, "camera.trajectory": view, "render.samples": 1}
    )
    out = tmp_path / "out"
    with caplog.at_level(logging.WARNING):
        perilune.write_bop(sim, range(1), out, threads=1)
    assert "spacecraft: there is none" in caplog.text
    truth = sim.frame(0, ["depth"])["depth"] * 1e3
    scale = json.loads((out / "train/000000/scene_camera.json").read_text())["0"]["depth_scale"]
    with Image.open(out / "train/000000/depth/000000.png") as image:
        depth = np.array(image) * scale
    assert (truth > 0).any()
    np.testing.assert_allclose(depth, truth, atol=0.51 * scale)
    assert check_bop(out).findings == []
    assert "There is no object" in (out / "dataset_info.md").read_text()
