"""The BOP writer, against the format's rules: read back with code of its own."""

from __future__ import annotations

import errno
import hashlib
import itertools
import json
import re
from typing import get_args

import numpy as np
import pytest
from PIL import Image

import perilune
from perilune import _core
from perilune.config import ConfigError
from perilune.config.docs import described
from perilune.config.file_names import _file_keys
from perilune.config.schema import Config
from perilune.config.types import Strict
from perilune.export.writers import bop_files, bop_source
from perilune.export.writers.bop import LABELS

FRAMES = range(6)
CHANNELS = ("rgb", *LABELS)
JSON = ("camera", "gt", "gt_info", "gt_coco", "frames")


def read_image(path):
    with Image.open(path) as image:
        return np.array(image)


def read_json(path):
    return json.loads(path.read_text())


def read_ply(path):
    """A reader that knows what the BOP toolkit knows: old type names, little-endian, triangles."""
    types = {"float": "<f4", "double": "<f8", "int": "<i4", "uint": "<u4", "uchar": "u1"}
    data = path.read_bytes()
    header, _, body = data.partition(b"end_header\n")
    lines = [line.split() for line in header.decode("ascii").splitlines()]
    assert lines[0] == ["ply"]
    assert lines[1] == ["format", "binary_little_endian", "1.0"]
    counts, fields, element = {}, {"vertex": [], "face": []}, None
    for words in lines[2:]:
        if words[0] == "element":
            element = words[1]
            counts[element] = int(words[2])
        elif words[0] == "property" and element == "vertex":
            fields["vertex"].append((words[2], types[words[1]]))
        elif words[0] == "property":
            assert words[1:] == ["list", "uchar", "int", "vertex_indices"]
    vertex = np.dtype(fields["vertex"])
    face = np.dtype([("n", "u1"), ("i", "<i4", 3)])
    vertices = np.frombuffer(body, vertex, counts["vertex"])
    rest = body[counts["vertex"] * vertex.itemsize :]
    assert len(rest) == counts["face"] * face.itemsize
    faces = np.frombuffer(rest, face)
    assert (faces["n"] == 3).all()
    points = np.stack([vertices[k].astype(float) for k in "xyz"], axis=1)
    return points, faces["i"], vertices


def tree_bytes(folder):
    """Relative path -> hash of every file."""
    return {
        path.relative_to(folder).as_posix(): hashlib.sha256(path.read_bytes()).hexdigest()
        for path in sorted(folder.rglob("*"))
        if path.is_file()
    }


@pytest.fixture(scope="module")
def sim(small_scene, pair):
    return perilune.open(small_scene, overrides=pair)


@pytest.fixture(scope="module")
def dataset(sim, tmp_path_factory):
    out = tmp_path_factory.mktemp("bop") / "probes"
    report = perilune.write_bop(sim, FRAMES, out, chunk_size=4, threads=1)
    assert (report.written, report.kept) == (6, 0)
    return out


def scenes(dataset):
    """(frame, scene folder, image id) of every image."""
    return [(i, dataset / "train" / f"{i // 4:06d}", i % 4) for i in FRAMES]


def test_layout_is_exactly_the_formats(dataset):
    expected = {"camera.json", "config.json", "dataset_info.json", "dataset_info.md"}
    expected |= {"models/models_info.json"}
    expected.add("models/obj_000005.ply")
    expected |= {"models_eval/models_info.json", "models_eval/obj_000005.ply"}
    for scene, images in ((0, 4), (1, 2)):
        folder = f"train/{scene:06d}"
        expected |= {f"{folder}/scene_{k}.json" for k in JSON}
        for image in range(images):
            expected |= {f"{folder}/rgb/{image:06d}.png", f"{folder}/depth/{image:06d}.png"}
            for name in ("mask", "mask_visib"):
                expected |= {f"{folder}/{name}/{image:06d}_{k:06d}.png" for k in range(2)}
    assert set(tree_bytes(dataset)) == expected


def test_json_has_the_keys_of_the_format_and_no_others(dataset, sim):
    camera = read_json(dataset / "camera.json")
    assert set(camera) == {"cx", "cy", "fx", "fy", "width", "height", "depth_scale"}
    assert (camera["cx"], camera["width"]) == (47.5, 96)
    for _, folder, image in scenes(dataset):
        cameras, gts = (read_json(folder / f"scene_{k}.json") for k in ("camera", "gt"))
        assert list(cameras) == list(gts) == [str(k) for k in range(len(gts))]
        entry = cameras[str(image)]
        assert {k: np.size(v) for k, v in entry.items()} == {
            "cam_K": 9,
            "cam_R_w2c": 9,
            "cam_t_w2c": 3,
            "depth_scale": 1,
        }
        assert len(gts[str(image)]) == len(sim.config.spacecraft)
        for instance in gts[str(image)]:
            assert {k: np.size(v) for k, v in instance.items()} == {
                "cam_R_m2c": 9,
                "cam_t_m2c": 3,
                "obj_id": 1,
            }
            assert instance["obj_id"] == 5


def test_images_are_the_samples(dataset, sim):
    for index, folder, image in scenes(dataset):
        sample = sim.frame(index, channels=CHANNELS)
        rgb = read_image(folder / "rgb" / f"{image:06d}.png")
        assert rgb.dtype == np.uint8
        np.testing.assert_array_equal(rgb, sample["rgb"])
        masks = [read_image(folder / "mask_visib" / f"{image:06d}_{k:06d}.png") for k in range(2)]
        for mask, row in zip(masks, sample.objects, strict=True):
            assert mask.dtype == np.uint8
            assert set(np.unique(mask)) <= {0, 255}
            assert np.count_nonzero(mask) == row["px_count_visib"]
        assert not (masks[0] & masks[1]).any()


def test_depth_is_within_half_a_step_of_the_finest_scale_that_fits(dataset, sim):
    for index, folder, image in scenes(dataset):
        sample = sim.frame(index, channels=CHANNELS)
        scale = read_json(folder / "scene_camera.json")[str(image)]["depth_scale"]
        stored = read_image(folder / "depth" / f"{image:06d}.png").astype(float) * scale
        depth_mm = sample["depth"].astype(float) * 1e3
        z_max = depth_mm[np.isin(sample["instance"], sample.objects["instance_id"])].max()
        finer = [d * 10.0**k for k in range(-3, 9) for d in (1, 2, 5) if d * 10.0**k < 0.99 * scale]
        assert z_max / scale <= 65534
        assert all(z_max / other > 65534 for other in finer)
        written = (depth_mm > 0) & (depth_mm < 65534 * scale)
        assert np.abs(stored - depth_mm)[written].max() <= 0.5 * scale * (1 + 1e-9)
        assert (stored[depth_mm > 65535 * scale] == 0).all()
        assert (stored[depth_mm == 0] == 0).all()


def covered(pixels, faces, width, height):
    """Pixel centres inside any projected triangle, and those too near an edge to call."""
    columns, rows = np.meshgrid(np.arange(width), np.arange(height))
    inside = np.zeros((height, width), bool)
    unsure = np.zeros((height, width), bool)
    for corners in pixels[faces]:
        distances = []
        for k in range(3):
            (x0, y0), (x1, y1) = corners[k], corners[(k + 1) % 3]
            length = max(np.hypot(x1 - x0, y1 - y0), 1e-12)
            distances.append(((x1 - x0) * (rows - y0) - (y1 - y0) * (columns - x0)) / length)
        low, high = np.min(distances, axis=0), np.max(distances, axis=0)
        margin = np.maximum(low, -high)  # > 0 inside, whichever way the triangle turns
        inside |= margin > 0.01
        unsure |= np.abs(margin) <= 0.01
    return inside, unsure & ~inside


def check_projection(sim, out, frames):
    """The written model at the written pose, drawn by other means, is the visible mask."""
    perilune.write_bop(sim, frames, out, threads=1)
    folder = out / "train" / "000000"
    cameras, gts = (read_json(folder / f"scene_{k}.json") for k in ("camera", "gt"))
    for index in frames:
        K = np.reshape(cameras[str(index)]["cam_K"], (3, 3))
        R_w2c = np.reshape(cameras[str(index)]["cam_R_w2c"], (3, 3))
        assert np.abs(R_w2c @ R_w2c.T - np.eye(3)).max() < 1e-9
        (pose,) = gts[str(index)]
        R, t = np.reshape(pose["cam_R_m2c"], (3, 3)), np.array(pose["cam_t_m2c"])
        assert np.abs(R @ R.T - np.eye(3)).max() < 1e-9
        assert np.linalg.det(R) == pytest.approx(1.0, abs=1e-9)
        points, faces, _ = read_ply(out / "models" / f"obj_{pose['obj_id']:06d}.ply")
        projected = (points @ R.T + t) @ K.T
        pixels = projected[:, :2] / projected[:, 2:]
        mask = read_image(folder / "mask_visib" / f"{index:06d}_000000.png") > 0
        inside, unsure = covered(pixels, faces, mask.shape[1], mask.shape[0])
        assert inside.sum() > 500
        np.testing.assert_array_equal(mask[~unsure], inside[~unsure])
        rows, columns = np.nonzero(mask)
        # Sharp corners may fall between pixel centres, so the mask's box may be smaller, never
        # larger than that of the vertices.
        low, high = pixels.min(axis=0) - 0.01, pixels.max(axis=0) + 0.01
        assert (low <= [columns.min(), rows.min()]).all()
        assert (high >= [columns.max(), rows.max()]).all()


@pytest.mark.parametrize("centre", ["bounds", "origin"])
def test_poses_project_the_model_onto_its_mask(small_scene, tmp_path, centre):
    changes = {"spacecraft.probe.centre": centre, "camera.width": 320, "camera.height": 240}
    sim = perilune.open(small_scene, overrides={**changes, "camera.fov_deg": 60.0})
    check_projection(sim, tmp_path / "probe", range(8))


def test_model_is_in_millimetres_about_its_box(dataset):
    points, faces, vertices = read_ply(dataset / "models" / "obj_000005.ply")
    assert len(faces) == 24
    assert faces.min() == 0
    assert faces.max() == len(points) - 1
    low, high = points.min(axis=0), points.max(axis=0)
    np.testing.assert_allclose(low + high, 0.0, atol=1e-3)
    # 5 x 1 x 1.5 units of a y-up file, the longest side scaled to 4 m; z is up here.
    np.testing.assert_allclose(sorted(high - low), [800.0, 1200.0, 4000.0], rtol=1e-6)
    assert high[2] - low[2] == pytest.approx(800.0, rel=1e-6)
    normals = np.stack([vertices[k] for k in ("nx", "ny", "nz")], axis=1)
    np.testing.assert_allclose(np.linalg.norm(normals, axis=1), 1.0, atol=1e-6)
    corners = points[faces]
    facing = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    assert ((facing * normals[faces[:, 0]]).sum(axis=1) > 0).all()
    colors = {tuple(int(v[k]) for k in ("red", "green", "blue")) for v in vertices}
    assert len(colors) == 2


def test_models_info_agrees_with_brute_force(dataset):
    points, _, _ = read_ply(dataset / "models" / "obj_000005.ply")
    info = read_json(dataset / "models" / "models_info.json")["5"]
    pairs = itertools.combinations(points, 2)
    assert info["diameter"] == pytest.approx(max(np.linalg.norm(a - b) for a, b in pairs))
    for axis, name in enumerate("xyz"):
        assert info[f"min_{name}"] == points[:, axis].min()
        assert info[f"size_{name}"] == pytest.approx(np.ptp(points[:, axis]))
    keys = {"diameter", *(f"{a}_{b}" for a in ("min", "size") for b in "xyz")}
    assert set(info) == keys | {"faces_one_sided"}
    assert info["faces_one_sided"] == 24


def test_same_bytes_again_in_parts_and_with_other_threads(sim, dataset, tmp_path):
    before = tree_bytes(dataset)
    report = perilune.write_bop(sim, FRAMES, dataset, chunk_size=4, threads=1)
    assert (report.written, report.kept) == (0, 6)
    assert tree_bytes(dataset) == before
    parts = tmp_path / "probes"
    perilune.write_bop(sim, range(3, 6), parts, chunk_size=4, threads=2)
    report = perilune.write_bop(sim, range(0, 6), parts, chunk_size=4, threads=2)
    assert (report.written, report.kept) == (3, 3)
    assert tree_bytes(parts) == before


class Counted:
    """A simulation that notes which frames are rendered, and may stop before one."""

    def __init__(self, sim, stop_at=None, error=KeyboardInterrupt):
        self._sim, self._stop_at, self._error = sim, stop_at, error
        self.rendered = []

    def __getattr__(self, name):
        return getattr(self._sim, name)

    def frame(self, index, **options):
        if index == self._stop_at:
            raise self._error
        self.rendered.append(index)
        return self._sim.frame(index, **options)


@pytest.mark.parametrize("name", [f"scene_{name}.json" for name in JSON])
def test_chunk_without_its_json_is_made_again(sim, dataset, tmp_path, name):
    out = tmp_path / "probes"
    perilune.write_bop(sim, FRAMES, out, chunk_size=4, threads=1)
    (out / "train" / "000001" / name).unlink()
    counted = Counted(sim)
    perilune.write_bop(counted, FRAMES, out, chunk_size=4, threads=1)
    assert counted.rendered == [4, 5]
    assert tree_bytes(out) == tree_bytes(dataset)


@pytest.mark.parametrize(
    "text",
    ["", "[]", "{", '{"images": 3}', '{"images": [{}]}', '{"annotations": [{"image_id": 9}]}'],
)
def test_damaged_json_is_made_again(sim, dataset, tmp_path, text):
    out = tmp_path / "probes"
    perilune.write_bop(sim, FRAMES, out, chunk_size=4, threads=1)
    (out / "train" / "000001" / "scene_gt_coco.json").write_text(text)
    perilune.write_bop(sim, FRAMES, out, chunk_size=4, threads=1)
    assert tree_bytes(out) == tree_bytes(dataset)


@pytest.mark.parametrize("name", ["mask", "mask_visib"])
def test_missing_file_is_made_again(sim, dataset, tmp_path, name):
    out = tmp_path / "probes"
    perilune.write_bop(sim, FRAMES, out, chunk_size=4, threads=1)
    (out / "train" / "000000" / name / "000002_000001.png").unlink()
    counted = Counted(sim)
    perilune.write_bop(counted, FRAMES, out, chunk_size=4, threads=1)
    assert counted.rendered == [2]
    assert tree_bytes(out) == tree_bytes(dataset)


def test_interrupted_run_continues_where_it_was(sim, dataset, tmp_path):
    out = tmp_path / "probes"
    with pytest.raises(KeyboardInterrupt):
        perilune.write_bop(Counted(sim, stop_at=3), FRAMES, out, chunk_size=4, threads=1)
    folder = out / "train" / "000000"
    assert not (folder / "scene_gt.json").exists()
    finished = {path.stem for path in (folder / ".partial").glob("*.json")}
    leftover = folder / "rgb" / "000002.png.123.0.tmp"
    leftover.write_bytes(b"half")
    counted = Counted(sim)
    perilune.write_bop(counted, FRAMES, out, chunk_size=4, threads=1)
    assert counted.rendered == [i for i in FRAMES if f"{i:06d}" not in finished]
    assert tree_bytes(out) == tree_bytes(dataset)


def test_full_disk_leaves_no_half_frame(sim, dataset, tmp_path, monkeypatch):
    out = tmp_path / "probes"
    write, calls = _core.png_write, itertools.count()

    def full(path, array, level=6):
        if next(calls) == 6:
            raise OSError(errno.ENOSPC, "No space left on device", path)
        write(path, array, level)

    with monkeypatch.context() as patch:
        patch.setattr(_core, "png_write", full)
        with pytest.raises(OSError, match="No space left"):
            perilune.write_bop(sim, FRAMES, out, chunk_size=4, threads=1)
    assert not list(out.rglob("*.tmp"))
    assert not list(out.rglob("scene_gt.json"))
    perilune.write_bop(sim, FRAMES, out, chunk_size=4, threads=1)
    assert tree_bytes(out) == tree_bytes(dataset)


def test_folder_that_cannot_be_made_is_an_error(sim, tmp_path):
    blocker = tmp_path / "file"
    blocker.write_text("")
    with pytest.raises(OSError, match="file"):
        perilune.write_bop(sim, range(1), blocker / "out", threads=1)


@pytest.mark.parametrize(
    ("changes", "options", "named"),
    [
        ({"seed": 4}, {}, "seed"),
        ({"render.samples": 3}, {}, "configuration: render.samples was 2, here 3"),
        ({}, {"chunk_size": 5}, "chunk_size"),
        ({}, {"split": "test"}, "split"),
    ],
)
def test_folder_of_another_source_is_refused(small_scene, pair, dataset, changes, options, named):
    before = tree_bytes(dataset)
    other = perilune.open(small_scene, overrides={**pair, **changes})
    with pytest.raises(ValueError, match=f"another {named}"):
        perilune.write_bop(other, FRAMES, dataset, **{"chunk_size": 4, "threads": 1, **options})
    assert tree_bytes(dataset) == before


def test_size_that_varies_is_refused(small_scene, tmp_path):
    driver = {"ideal": 4.0, "jitter_variance": 0.1, "clip_min": 3.0, "clip_max": 5.0}
    sim = perilune.open(small_scene, overrides={"spacecraft.probe.size_m": driver})
    with pytest.raises(ConfigError, match=r"spacecraft\.probe\.size_m"):
        perilune.write_bop(sim, range(1), tmp_path / "out")
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize(
    ("frames", "options"),
    [
        (range(0), {}),
        (range(-2, 1), {}),
        (range(1), {"chunk_size": 0}),
        (range(1), {"split": "Train-1"}),
    ],
)
def test_bad_arguments_are_refused_before_anything_is_made(sim, tmp_path, frames, options):
    with pytest.raises(ValueError, match=r"frames|chunk_size|split"):
        perilune.write_bop(sim, frames, tmp_path / "out", **options)
    assert not (tmp_path / "out").exists()


def test_depth_scale_is_the_smallest_that_fits():
    assert bop_files.depth_scale_mm(0.0) == 0.001
    assert bop_files.depth_scale_mm(65.53) == 0.001
    assert bop_files.depth_scale_mm(65.535) == 0.002
    assert bop_files.depth_scale_mm(65534.0) == 1.0
    assert bop_files.depth_scale_mm(65535.0) == 2.0
    assert bop_files.depth_scale_mm(4e11) == 1e7
    with pytest.raises(ValueError, match="finite"):
        bop_files.depth_scale_mm(float("nan"))


def test_depth_beyond_the_last_step_is_no_measurement():
    depth_m = np.array([[0.0, 0.001, 65.534, 65.5346, 65.536, np.inf, np.nan]])
    steps = bop_files.encode_depth(depth_m, 1.0)
    assert steps.tolist() == [[0, 1, 65534, 0, 0, 0, 0]]


def test_ids_are_ordered_as_numbers():
    text = bop_files.json_by_id({10: 1, 9: 2, 100: 3})
    assert list(json.loads(text)) == ["9", "10", "100"]


@pytest.mark.parametrize(
    ("section", "named"),
    [
        ({"shape": "a.bin"}, {"shape.file": "a"}),
        ({"shape": {"file": "a.bin", "smooth": False}}, {"shape.file": "a"}),
        ({"clouds": {"map": "a.bin"}}, {"clouds.map": "a"}),
        ({"rings": {"inner_radius_km": 1.0, "outer_radius_km": 2.0, "color_map": "a.bin"}},
         {"rings.color_map": "a"}),
        ({"relief": {"height_map": "a.bin", "height_m": 1.0, "normal_map": "b.bin"}},
         {"relief.height_map": "a", "relief.normal_map": "b"}),
        ({"ocean": {"map": "a.bin"}, "night_lights": {"map": "b.bin"}},
         {"ocean.map": "a", "night_lights.map": "b"}),
        ({"photometry": {"maps": ["a.bin"]}, "reflectance": "hapke"}, {"photometry.maps[0]": "a"}),
        ({"color_map": {"choice": ["a.bin", "b.bin"]}},
         {"color_map": "a", "color_map.choice[0]": "a", "color_map.choice[1]": "b"}),
        ({"clouds": {"map": {"choice": ["a.bin", "b.bin"]}}},
         {"clouds.map": "a", "clouds.map.choice[0]": "a", "clouds.map.choice[1]": "b"}),
        ({"shape": {"choice": ["a.bin", {"file": "b.bin"}]}},
         {"shape.file": "a", "shape.choice[0].file": "a", "shape.choice[1].file": "b"}),
        ({"clouds": {"choice": [{"opacity": 0.5}, {"map": "b.bin"}]}},
         {"clouds.choice[1].map": "b"}),
    ],
)  # fmt: skip
def test_files_of_bodies_are_those_of_the_dataset(section, named, small_scene):
    """Frames show what is in them, so that a dataset does not go on with others."""
    for name in "ab":
        (small_scene.parent / f"{name}.bin").write_text(name)
    begin = "bodies.planet."
    sim = perilune.open(small_scene, overrides={begin + key: section[key] for key in section})
    files = bop_source.dataset_info(sim, 4, "train")["files_sha256"]
    assert {key: value for key, value in files.items() if key.startswith(begin)} == {
        begin + key: hashlib.sha256(text.encode()).hexdigest() for key, text in named.items()
    }


def test_files_of_the_sky_are_those_of_the_dataset(small_scene, tmp_path):
    """A dataset does not go on under other stars, or before another picture."""
    stars, back = tmp_path / "stars.csv", tmp_path / "back.png"
    stars.write_text("ra_deg,dec_deg,vmag\n10,20,1\n")
    _core.png_write(str(back), np.zeros((2, 4, 3), np.uint8))
    sky = {"stars": {"catalogue": str(stars)}, "background": {"map": str(back)}}
    sim = perilune.open(small_scene, overrides={"sky": sky})
    perilune.write_bop(sim, range(1), tmp_path / "out", threads=1)
    files = read_json(tmp_path / "out/dataset_info.json")["files_sha256"]
    assert {key for key in files if key.startswith("sky")} == {
        "sky.stars.catalogue", "sky.background.map"
    }  # fmt: skip
    before = stars.read_text()
    stars.write_text("ra_deg,dec_deg,vmag\n10,20,2\n")
    with pytest.raises(ValueError, match="another files_sha256"):
        perilune.write_bop(sim, range(2), tmp_path / "out", threads=1)
    stars.write_text(before)
    _core.png_write(str(back), np.ones((2, 4, 3), np.uint8))
    with pytest.raises(ValueError, match="another files_sha256"):
        perilune.write_bop(sim, range(2), tmp_path / "out", threads=1)
    assert len(list((tmp_path / "out/train/000000/rgb").iterdir())) == 1


def test_files_of_orbits_and_sensors_are_those_of_the_dataset(small_scene):
    folder = small_scene.parent
    (folder / "flat.png").write_bytes(b"flat")
    (folder / "states.csv").write_text("t_s,x_km,y_km,z_km\n-1e9,7000,0,0\n1e9,7000,1,0\n")
    changes = {
        "camera.sensor": {"flat_field": "flat.png"},
        "spacecraft.probe.orbit": {"kind": "table", "around": "planet", "file": "states.csv"},
    }
    sim = perilune.open(small_scene, overrides=changes)
    assert {"camera.sensor.flat_field", "spacecraft.probe.orbit.file"} <= set(
        bop_source.dataset_info(sim, 4, "train")["files_sha256"]
    )


def _sections(section, done):
    """All sections below one."""
    if section not in done:
        done.add(section)
        for field in section.model_fields.values():
            below = [field.annotation]
            while below:
                found = below.pop()
                below += get_args(found)
                if isinstance(found, type) and issubclass(found, Strict):
                    _sections(found, done)
    return done


def test_all_keys_that_name_files_say_so():
    """By what their documentation says; a graph's own file is in the tree when it is loaded."""
    told = {
        (section.__name__, name)
        for section in _sections(Config, set())
        for name, text in described(section).items()
        if re.search(r"elative to (this|its) file|under\s+PERILUNE_DATA", text)
        and name not in _file_keys(section)
    }
    assert told == {("Material", "file")}
