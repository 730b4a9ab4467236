"""Bodies as objects in files: an asteroid alone is a whole BOP scene, and every format of objects
has it beside spacecraft."""

from __future__ import annotations

import json

import cv2
import numpy as np
import pytest
from tests.python.shape_scenes import ball, write_obj

import perilune
from perilune.config import ConfigError
from perilune.export.check import check, check_bop
from perilune.export.check.ply import read_ply
from perilune.export.writers import write
from perilune.export.writers.formats.segments import segments

SIZE = {"camera.width": 48, "camera.height": 36, "render.samples": 1}
RADII_KM = [13.0, 11.4, 9.1]


def asteroid(folder, kind):
    """A body alone, 60 km away, in three sorts."""
    vertices, faces = ball(12)
    body = {
        "ellipsoid": {},
        "shape": {"shape": str(write_obj(folder / "ball.obj", vertices * RADII_KM, faces))},
        "terrain": {"terrain": {"detail": {"strength": 0.1}}},
    }[kind]
    return {
        "version": 1,
        "seed": 2,
        "time": {"epoch": "2026-03-20T12:00:00Z", "step_s": 10},
        "root": "rock",
        "bodies": {
            "rock": {
                "kind": "ellipsoid",
                "radii_km": RADII_KM,
                "gm_km3_s2": 1e-3,
                "albedo": 0.2,
                "annotate": True,
                "landmarks": {"pole": {"lon_deg": 0.0, "lat_deg": 90.0}},
                "rotation": {"spin_axis": [0.0, 0.6, 0.8], "spin_rate_deg_s": 0.5},
                **body,
            }
        },
        "camera": {
            "fov_deg": 30,
            "trajectory": {
                "kind": "orbit_object",
                "target": "rock",
                "distance_m": [45e3, 75e3],
                "aim_jitter_deg": 8.0,
            },
        },
        "render": {"max_bounces": 0},
    }


@pytest.mark.parametrize("kind", ["ellipsoid", "shape", "terrain"])
def test_an_asteroid_alone_is_a_bop_scene(kind, tmp_path):
    sim = perilune.open(asteroid(tmp_path, kind), overrides=SIZE)
    out = tmp_path / "out"
    write("bop", sim, range(3), out, threads=1)
    report = check_bop(out)
    assert not report.findings, report.findings
    assert report.instances == 3
    told = json.loads((out / "models/models_info.json").read_text())["1"]
    assert told["surface"] == kind
    mesh = read_ply(out / "models/obj_000001.ply")
    gt = json.loads((out / "train/000000/scene_gt.json").read_text())
    for index in range(3):
        sample = sim[index]
        (pose,), row = gt[str(index)], sample.objects[0]
        R = np.reshape(pose["cam_R_m2c"], (3, 3))
        t = np.array(pose["cam_t_m2c"])
        pixels, _ = cv2.projectPoints(mesh.points, cv2.Rodrigues(R)[0], t, sample.camera.K, None)
        low, high = pixels.min(axis=(0, 1)), pixels.max(axis=(0, 1))
        x, y, w, h = row["bbox_obj"].tolist()
        assert np.abs(np.array([x, y, x + w, y + h]) - [*low, *high]).max() < 1.1
    if kind == "ellipsoid":
        assert told["size_x"] == pytest.approx(2e6 * RADII_KM[0], rel=1e-7)
        assert told["diameter"] == pytest.approx(2e6 * max(RADII_KM), rel=1e-7)
        on = (mesh.points / (1e6 * np.array(RADII_KM))) ** 2
        np.testing.assert_allclose(on.sum(axis=1), 1.0, atol=1e-6)
        assert (np.einsum("ij,ij->i", mesh.normals, mesh.points) > 0.0).all()


def test_a_wrong_pose_of_a_body_is_found(tmp_path):
    """Rays at the ellipsoid of models_info.json do not meet the masks of another pose."""
    sim = perilune.open(asteroid(tmp_path, "ellipsoid"), overrides=SIZE)
    write("bop", sim, range(1), tmp_path / "out", threads=1)
    path = tmp_path / "out/train/000000/scene_gt.json"
    told = json.loads(path.read_text())
    t = told["0"][0]["cam_t_m2c"]
    told["0"][0]["cam_t_m2c"] = [1.03 * t[0] + 2e6, t[1], t[2]]
    path.write_text(json.dumps(told))
    found = [str(finding) for finding in check_bop(tmp_path / "out").findings]
    assert any("mask" in text and "rays meet" in text for text in found), found


@pytest.fixture(scope="module")
def both(small_scene):
    """The probe before the planet, both objects."""
    changes = {
        **SIZE,
        "bodies.planet.annotate": True,
        "bodies.planet.landmarks": {"a": {"lon_deg": 0.0, "lat_deg": 0.0}},
        "camera.trajectory.sun_angle_deg": None,
        "render.channels": [
            "rgb",
            "instance",
            "part",
            "objects",
            "masks",
            "keypoints",
            "depth",
            "hierarchy",
        ],
    }
    return perilune.open(small_scene, overrides=changes)


FRAMES = range(4)


@pytest.fixture(scope="module")
def written(both, tmp_path_factory):
    folder = tmp_path_factory.mktemp("both")
    names = ["bop", "bop-webdataset", "coco", "yolo", "yolo-pose", "npz", "png"]
    write(names, both, FRAMES, folder, threads=1)
    for name in names:
        for report in check(folder / name):
            assert not report.findings, (name, report.findings)
    return folder


def planet_seen(both):
    ids = both.taxonomy.instances
    return [(both[k]["instance"] == ids["planet"]).any() for k in FRAMES]


def test_coco_has_bodies(both, written):
    told = json.loads((written / "coco/annotations/instances_train.json").read_text())
    kinds = {row["supercategory"] for row in told["categories"]}
    assert kinds == {"spacecraft", "body"}
    number = both.taxonomy.instances["planet"]
    rows = {row["image_id"]: row for row in told["annotations"] if row["instance_id"] == number}
    assert [k in rows for k in FRAMES] == planet_seen(both)
    assert any(planet_seen(both))
    for index, row in rows.items():
        segment = segments(both[index]["instance"])[number]
        label = both[index].objects[1]
        assert row["bbox"] == list(segment.box)
        assert row["area"] == segment.area
        x, y, w, h = label["bbox_obj"].tolist()
        assert row["bbox_amodal"] == [x, y, w + 1, h + 1]
        np.testing.assert_array_equal(row["t_m2c"], label["t_m2c"])
        assert len(row["keypoints"]) == 3
    parts = json.loads((written / "coco/annotations/parts_train.json").read_text())
    assert {row["object"] for row in parts["annotations"]} == {"probe", "planet"}


def test_hierarchy_in_files(both, written):
    """As annotations with parents in COCO, as a table elsewhere."""
    told = json.loads((written / "coco/annotations/hierarchy_train.json").read_text())
    rows = {row["id"]: row for row in told["annotations"]}
    assert {row["kind"] for row in rows.values()} == {"spacecraft", "node", "part"}
    for row in rows.values():
        assert row["parent"] is None or rows[row["parent"]]["image_id"] == row["image_id"]
    for index in FRAMES:
        table = both.frame(index, ["hierarchy"]).hierarchy
        seen = table[table["px_count_visib"] > 0]
        mine = [row for row in rows.values() if row["image_id"] == index]
        assert [row["name"] for row in mine] == seen["name"].tolist()
        assert [row["area"] for row in mine] == seen["px_count_visib"].tolist()
        bop = np.load(written / f"bop/train/000000/hierarchy/{index:06d}.npy")
        np.testing.assert_array_equal(bop, table)
        npz = np.load(written / f"npz/{index:06d}.npz")["hierarchy"]
        np.testing.assert_array_equal(npz, table)


def test_yolo_has_bodies(both, written):
    for index, seen in enumerate(planet_seen(both)):
        lines = (written / f"yolo/labels/train/{index:06d}.txt").read_text().splitlines()
        assert len(lines) == 1 + seen


def test_depth_of_bop_is_fine_where_a_spacecraft_is_seen(both, written):
    """The planet is ten thousand kilometres away; its depth does not coarsen that of the probe."""
    cameras = json.loads((written / "bop/train/000000/scene_camera.json").read_text())
    for index in FRAMES:
        if both[index].objects[0]["px_count_visib"]:
            assert cameras[str(index)]["depth_scale"] < 1.0
    infos = json.loads((written / "bop/train/000000/scene_gt_info.json").read_text())
    assert all(len(rows) == 2 for rows in infos.values())


def test_speed_of_a_body(tmp_path):
    sim = perilune.open(asteroid(tmp_path, "ellipsoid"), overrides=SIZE)
    write("speed", sim, range(2), tmp_path / "out", threads=1)
    told = json.loads((tmp_path / "out/train.json").read_text())
    for index, row in enumerate(told):
        np.testing.assert_array_equal(row["r_Vo2To_vbs_true"], sim[index].objects[0]["t_m2c"])


def test_a_driver_of_the_model_is_refused(tmp_path):
    world = asteroid(tmp_path, "ellipsoid")
    world["bodies"]["rock"]["radii_km"] = {
        "ideal": 10.0,
        "jitter_variance": 0.1,
        "clip_min": 9.0,
        "clip_max": 11.0,
    }
    sim = perilune.open(world, overrides=SIZE)
    with pytest.raises(ConfigError, match=r"bodies\.rock\.radii_km: has a driver, but models of a"):
        write("bop", sim, range(1), tmp_path / "out")


def test_relief_between_the_cells_of_a_model_is_no_finding(tmp_path):
    """The model's cells are up to 1/20 of the body: ground between them stands out of its box."""
    scene = asteroid(tmp_path, "terrain")
    scene["bodies"]["rock"] |= {
        "radii_km": [0.5, 0.35, 0.3],
        "terrain": {"detail": {"seed": 2}, "craters": {"seed": 2}},
    }
    scene["camera"] = {
        "fov_deg": 50.0,
        "trajectory": {"kind": "orbit_object", "target": "rock", "distance_m": 1500.0},
    }
    size = SIZE | {"camera.width": 96, "camera.height": 72}
    write("bop", perilune.open(scene, overrides=size), range(2), tmp_path / "out", threads=1)
    report = check_bop(tmp_path / "out")
    assert not report.findings, report.findings
