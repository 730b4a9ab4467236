"""Symmetries against the model itself, and evaluation models against the models."""

from __future__ import annotations

import json
import logging

import numpy as np
import pytest

import perilune
from perilune import _core
from perilune.config import ConfigError
from perilune.export.check import check_bop

from .retrace import read_faces, write_sheets

BOTH = {"doubleSided": True}
AXIS_M = [3.0, 0.0, 1.0]
"""Where the squares of the model lie: off the origin of its file. Its y is up, the frame's z."""


@pytest.fixture(scope="module")
def cross(tmp_path_factory):
    """Two crossing squares of sides 2 and 2: turned by half about x, y or z as before."""
    folder = tmp_path_factory.mktemp("cross")
    return write_sheets(
        folder / "cross.gltf",
        a={"place": [3, 1, 0], "axis": 0, "material": BOTH},
        b={"place": [3, 1, 0], "axis": 2, "material": BOTH},
    )


def opened(small_scene, model, symmetries, **changes):
    return perilune.open(
        small_scene,
        overrides={
            "spacecraft.probe.model": str(model),
            "spacecraft.probe.size_m": None,
            "spacecraft.probe.metres_per_unit": 1.0,
            "spacecraft.probe.centre": "origin",
            "spacecraft.probe.symmetries": symmetries,
            "camera.trajectory.distance_m": [20.0, 30.0],
            **changes,
        },
    )


def info(out, folder="models"):
    return json.loads((out / folder / "models_info.json").read_text())["1"]


def test_symmetries_about_points_off_the_origin(small_scene, cross, tmp_path):
    stated = {
        "discrete": [
            {"rotation_deg": [0, 0, 90], "offset_m": AXIS_M},
            {"rotation_deg": [0, 0, 180], "offset_m": [3.0, 0.0, -7.0]},
        ],
    }
    sim = opened(small_scene, cross, stated)
    perilune.write_bop(sim, range(1), tmp_path / "out", threads=1)
    points = read_faces(tmp_path / "out/models/obj_000001.ply").reshape(-1, 3)
    places = {tuple(row) for row in np.round(points)}
    for matrix in info(tmp_path / "out")["symmetries_discrete"]:
        M = np.reshape(matrix, (4, 4))
        turned = points @ M[:3, :3].T + M[:3, 3]
        assert {tuple(row) for row in np.round(turned) + 0.0} == places
    told = info(tmp_path / "out", "models_eval")
    assert told["symmetries_discrete"] == info(tmp_path / "out")["symmetries_discrete"]
    assert check_bop(tmp_path / "out", alone=True).findings == []


def test_symmetries_about_the_origin_and_lines(small_scene, tmp_path):
    model = write_sheets(
        tmp_path / "sheet.gltf", disc={"place": [0, 1, 0], "axis": 1, "material": BOTH}
    )
    stated = {
        "discrete_deg": [[0, 0, 90]],
        "continuous": [{"axis": [0, 0, 2.0], "offset_m": [0.002, 0, 0]}],
    }
    # A square is no disc, but near enough for a line where the tolerance is 15 mm.
    tiny = {"spacecraft.probe.metres_per_unit": 0.01, "camera.trajectory.distance_m": [0.2, 0.3]}
    sim = opened(small_scene, model, stated, **tiny)
    perilune.write_bop(sim, range(1), tmp_path / "out", threads=1)
    row = info(tmp_path / "out")
    matrix = np.reshape(row["symmetries_discrete"][0], (4, 4))
    expected = [[0, -1, 0, 0], [1, 0, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]
    np.testing.assert_allclose(matrix, expected, atol=1e-9)
    (line,) = row["symmetries_continuous"]
    np.testing.assert_allclose(line["axis"], [0, 0, 1], atol=1e-15)
    np.testing.assert_allclose(line["offset"], [2.0, 0.0, -10.0], atol=1e-6)


@pytest.mark.parametrize(
    ("stated", "key", "away_mm"),
    [
        ({"discrete_deg": [[0, 0, 180]]}, "discrete_deg[0]", 6000.0),
        ({"discrete": [{"rotation_deg": [0, 0, 180]}]}, "discrete[0]", 6000.0),
        ({"discrete": [{"rotation_deg": [0, 0, 45], "offset_m": AXIS_M}]}, "discrete[0]", 707.1),
        ({"continuous": [{"axis": [0, 0, 1], "offset_m": AXIS_M}]}, "continuous[0]", 702.0),
        ({"continuous": [{"axis": [0, 0, 1]}]}, "continuous[0]", 6000.0),
    ],
)
def test_false_symmetries_are_refused_with_how_far_off_they_are(
    small_scene, cross, tmp_path, stated, key, away_mm
):
    """A half turn about the origin takes the squares 6 m away, an eighth of a turn about their
    middle their edges half a side times the sine of 45 degrees."""
    sim = opened(small_scene, cross, stated)
    with pytest.raises(ConfigError) as error:
        perilune.write_bop(sim, range(1), tmp_path / "out", threads=1)
    text = str(error.value)
    assert f"spacecraft.probe.symmetries.{key}: " in text
    measured = float(text.split("is up to ")[1].split(" mm")[0])
    assert measured == pytest.approx(away_mm, abs=30.0)
    assert not (tmp_path / "out").exists()


def test_symmetries_that_nearly_hold_are_told(small_scene, tmp_path, caplog):
    model = write_sheets(
        tmp_path / "sheets.gltf",
        plate={"place": [0, 0, 0], "axis": 1, "material": BOTH},
        lug={"place": [0, 0.15, 0], "axis": 1, "half": 0.1, "material": BOTH},
    )
    sim = opened(small_scene, model, {"discrete_deg": [[180, 0, 0]]})
    with caplog.at_level(logging.WARNING):
        perilune.write_bop(sim, range(1), tmp_path / "out", threads=1)
    assert "symmetries.discrete_deg[0]: the model turned so is up to 1" in caplog.text


def test_spacecraft_of_one_id_share_symmetries(small_scene, pair, cross, tmp_path):
    turn = {"discrete": [{"rotation_deg": [0, 0, 180], "offset_m": AXIS_M}]}
    half = {"discrete": [{"rotation_deg": [0, 0, 90], "offset_m": AXIS_M}]}
    mate = {**pair["spacecraft.mate"], "model": str(cross), "centre": "origin"}
    mate = {**mate, "size_m": None, "metres_per_unit": 1.0, "symmetries": turn}
    changes = {"spacecraft.probe.obj_id": 5, "spacecraft.mate": mate}
    sim = opened(small_scene, cross, {}, **changes)
    perilune.write_bop(sim, range(1), tmp_path / "out", threads=1)
    told = json.loads((tmp_path / "out/models/models_info.json").read_text())["5"]
    assert len(told["symmetries_discrete"]) == 1
    sim = opened(small_scene, cross, half, **changes)
    with pytest.raises(ConfigError, match=r"mate\.symmetries: differ from those of probe"):
        perilune.write_bop(sim, range(1), tmp_path / "other", threads=1)


def test_evaluation_models_are_near_even_and_in_the_same_frame(repo_dir, tmp_path):
    small = {"camera.width": 64, "camera.height": 48, "render.samples": 1}
    sim = perilune.open(repo_dir / "configs/demo.yaml", overrides=small)
    perilune.write_bop(sim, range(1), tmp_path / "out", threads=1)
    whole, coarse = info(tmp_path / "out"), info(tmp_path / "out", "models_eval")
    size = whole["diameter"]
    for key in ("diameter", "min_x", "min_y", "min_z", "size_x", "size_y", "size_z"):
        assert coarse[key] == pytest.approx(whole[key], abs=0.004 * size)
    faces = read_faces(tmp_path / "out/models_eval/obj_000001.ply")
    vertices = np.unique(faces.reshape(-1, 3), axis=0)
    assert 5_000 < len(vertices) < 25_000
    edges = np.linalg.norm(faces - np.roll(faces, 1, axis=1), axis=2)
    areas = np.linalg.norm(np.cross(faces[:, 1] - faces[:, 0], faces[:, 2] - faces[:, 0]), axis=1)
    assert edges.max() <= 3.0 * np.sqrt(areas.sum() / 2 / 8000) * 1.001
    # Every vertex of the model has the coarse surface near by, and the other way round.
    fine = read_faces(tmp_path / "out/models/obj_000001.ply").reshape(-1, 3)
    from scipy.spatial import cKDTree

    spread = np.concatenate([faces.reshape(-1, 3), faces.mean(axis=1)])
    away, _ = cKDTree(spread).query(fine[::7])
    assert away.max() < edges.max()
    assert check_bop(tmp_path / "out", alone=True).findings == []


def test_simplifying_keeps_to_its_tolerance_and_refuses_what_is_no_mesh():
    """A flat grid needs two triangles; a bent one keeps its bend."""
    n = 20
    x, y = np.meshgrid(np.arange(n + 1.0), np.arange(n + 1.0), indexing="ij")
    flat = np.stack([x.ravel(), y.ravel(), 0 * x.ravel()], axis=1).astype(np.float32)
    k = (np.arange(n)[:, None] * (n + 1) + np.arange(n)).ravel()
    quads = [[k, k + n + 1, k + n + 2], [k, k + n + 2, k + 1]]
    faces = np.concatenate([np.stack(row, axis=1) for row in quads]).astype(np.uint32)
    assert len(_core.simplify(flat, faces, 0, 1e-3)) <= 4
    bent = flat.copy()
    bent[:, 2] = np.abs(bent[:, 0] - 10)
    kept = _core.simplify(bent, faces, 0, 1e-3)
    assert 4 <= len(kept) < 40
    assert set(np.unique(bent[kept][:, :, 2])) >= {0.0, 10.0}
    assert len(_core.simplify(flat, faces, 800, 1.0)) == 800
    with pytest.raises(ValueError, match="index 441"):
        _core.simplify(flat, faces + 1, 0, 0.1)
    with pytest.raises(ValueError, match="finite"):
        _core.simplify(flat * np.nan, faces, 0, 0.1)
    with pytest.raises(ValueError, match="target"):
        _core.simplify(flat, faces, -1, 0.1)
    with pytest.raises(ValueError, match="error"):
        _core.simplify(flat, faces, 0, 2.0)
