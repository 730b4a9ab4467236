"""Every format as the library reads it that its users use, against the arrays of the frames."""

from __future__ import annotations

import contextlib
import io
import json
import warnings

import cv2
import h5py
import numpy as np
import OpenEXR
import pytest
import webdataset
from PIL import Image
from pycocotools import mask as rle
from pycocotools.coco import COCO
from pycocotools.cocoeval import COCOeval

import perilune
from perilune.export.writers import write
from perilune.export.writers.formats.segments import segments

WIDTH, HEIGHT = 96, 72
FRAMES = range(4)
CHANNELS = ["rgb", "depth", "semantic", "part", "instance", "objects", "masks", "normal", "flow"]
CHANNELS += ["flow_occlusion", "radiance", "range", "position", "keypoints"]


@pytest.fixture(scope="module")
def sim(small_scene):
    changes = {
        "camera.width": WIDTH,
        "camera.height": HEIGHT,
        "render.samples": 1,
        "time.frames_per_scene": 2,
        "time.step_s": 0.5,
        "render.channels": CHANNELS,
    }
    return perilune.open(small_scene, overrides=changes)


@pytest.fixture(scope="module")
def samples(sim):
    return [sim[index] for index in FRAMES]


@pytest.fixture(scope="module")
def out(sim, tmp_path_factory):
    """All formats of one pass but ply, which holds scans alone (test_scan_formats.py)."""
    from perilune.export.writers import WRITERS

    folder = tmp_path_factory.mktemp("formats")
    formats = [name for name in WRITERS if name != "ply"]
    write(formats, sim, FRAMES, folder, chunk_size=3, threads=1)
    return folder


def quiet(task, *arguments):
    with contextlib.redirect_stdout(io.StringIO()):
        return task(*arguments)


def average_precision(truth, kind, results):
    def evaluated():
        evaluation = COCOeval(truth, truth.loadRes(results), kind)
        evaluation.evaluate()
        evaluation.accumulate()
        evaluation.summarize()
        return evaluation.stats[0]

    return quiet(evaluated)


@pytest.mark.parametrize("kind", ["bbox", "segm"])
@pytest.mark.parametrize("name", ["instances", "parts"])
def test_coco_truth_has_a_precision_of_one(out, name, kind):
    truth = quiet(COCO, out / f"coco/annotations/{name}_train.json")
    results = [
        {
            "image_id": row["image_id"],
            "category_id": row["category_id"],
            "bbox": row["bbox"],
            "segmentation": truth.annToRLE(row),
            "score": 1.0,
        }
        for row in truth.anns.values()
    ]
    assert results
    assert average_precision(truth, kind, results) == pytest.approx(1.0)
    moved = [
        {**row, "bbox": [x + 0.2 * w, y, w, h]} for row in results for x, y, w, h in [row["bbox"]]
    ]
    if kind == "bbox":
        assert 0.0 < average_precision(truth, kind, moved) < 1.0


def test_coco_masks_are_the_instances(out, sim, samples):
    truth = quiet(COCO, out / "coco/annotations/instances_train.json")
    names = {row["id"]: row["name"] for row in truth.dataset["categories"]}
    for index, sample in zip(FRAMES, samples, strict=True):
        (image,) = truth.loadImgs([index])
        picture = np.array(Image.open(out / "coco/train" / image["file_name"]))
        np.testing.assert_array_equal(picture, sample["rgb"])
        rows = truth.loadAnns(truth.getAnnIds([index]))
        assert len(rows) == np.count_nonzero(sample.objects["px_count_visib"])
        for row in rows:
            mask = sample["instance"] == row["instance_id"]
            np.testing.assert_array_equal(truth.annToMask(row) != 0, mask)
            assert row["area"] == mask.sum()
            assert row["bbox"] == rle.toBbox(rle.encode(np.asfortranarray(mask))).tolist()
            assert names[row["category_id"]] == "probe"
            assert sim.taxonomy.names("instance")[row["instance_id"]] == row["object"]


def test_parts_have_their_names(out, sim, samples):
    truth = quiet(COCO, out / "coco/annotations/parts_train.json")
    assert {row["name"] for row in truth.dataset["categories"]} <= set(sim.taxonomy.classes["part"])
    names = {f"probe/{row['part']}" for row in truth.anns.values()}
    assert names <= set(sim.taxonomy.names("part").values())
    assert {row["object"] for row in truth.anns.values()} == {"probe"}
    ids = {name: number for number, name in sim.taxonomy.names("part").items()}
    for row in truth.anns.values():
        mask = samples[row["image_id"]]["part"] == ids[f"probe/{row['part']}"]
        np.testing.assert_array_equal(truth.annToMask(row) != 0, mask)


def test_panoptic_files_keep_the_rules_of_panopticapi(out, samples):
    """Those that its evaluation asks for: segments and pixels tell of the same ids, each with a
    known category, and their areas and boxes are those of the pixels."""
    file = json.loads((out / "coco/annotations/panoptic_train.json").read_text())
    categories = {row["id"]: row for row in file["categories"]}
    assert {row["isthing"] for row in categories.values()} <= {0, 1}
    images = {row["id"]: row for row in file["images"]}
    assert [row["image_id"] for row in file["annotations"]] == sorted(images)
    for row in file["annotations"]:
        assert row["file_name"] == images[row["image_id"]]["file_name"].replace(".jpg", ".png")
        rgb = np.array(Image.open(out / "coco/panoptic_train" / row["file_name"]), np.uint32)
        ids = rgb[:, :, 0] + 256 * rgb[:, :, 1] + 256 * 256 * rgb[:, :, 2]
        np.testing.assert_array_equal(ids, samples[row["image_id"]]["instance"])
        listed = [segment["id"] for segment in row["segments_info"]]
        assert len(set(listed)) == len(listed)
        assert set(np.unique(ids).tolist()) - {0} == set(listed)
        for segment in row["segments_info"]:
            mask = ids == segment["id"]
            assert segment["category_id"] in categories
            assert segment["area"] == mask.sum()
            box = rle.toBbox(rle.encode(np.asfortranarray(mask)))
            assert segment["bbox"] == box.tolist()


def test_openexr_reads_every_layer_to_the_bit(out, samples):
    for index, sample in zip(FRAMES, samples, strict=True):
        with OpenEXR.File(str(out / f"exr/{index:06d}.exr"), separate_channels=True) as file:
            planes = {name: plane.pixels for name, plane in file.channels().items()}
            told = json.loads(file.header()["perilune"])
        assert told["meta"]["time_utc"] == sample.meta["time_utc"]
        for k, name in enumerate("RGB"):
            same_bits(planes[name], sample["radiance"][:, :, k])
        for k, name in enumerate("XYZ"):
            same_bits(planes[f"normal.{name}"], sample["normal"][:, :, k])
        same_bits(planes["depth.Z"], sample["depth"])
        assert planes["instance.V"].dtype == np.uint32
        np.testing.assert_array_equal(planes["instance.V"], sample["instance"])
        for k, level in enumerate(("kind", "object", "part")):
            np.testing.assert_array_equal(planes[f"semantic.{level}"], sample["semantic"][:, :, k])
        assert planes["rgb.R"].dtype == np.float16
        np.testing.assert_array_equal(planes["rgb.R"], sample["rgb"][:, :, 0])
        np.testing.assert_array_equal(planes["masks.probe"] != 0, sample["masks"][0] != 0)


def same_bits(found, expected):
    assert found.dtype == expected.dtype
    assert np.ascontiguousarray(found).tobytes() == np.ascontiguousarray(expected).tobytes()


def test_half_is_the_nearest_half(out, samples):
    with OpenEXR.File(str(out / "exr-half/000001.exr"), separate_channels=True) as file:
        planes = {name: plane.pixels for name, plane in file.channels().items()}
    with np.errstate(over="ignore"):
        same_bits(planes["depth.Z"], samples[1]["depth"].astype(np.float16))
    np.testing.assert_array_equal(planes["instance.V"], samples[1]["instance"])


def same_table(found, expected):
    for name in expected.dtype.names:
        column = found[name]
        if column.dtype.kind == "S":  # texts in HDF5 are UTF-8
            column = np.char.decode(column, "utf-8")
        np.testing.assert_array_equal(column, expected[name])


def test_numpy_reads_every_channel(out, samples):
    for index, sample in zip(FRAMES, samples, strict=True):
        with np.load(out / f"npz/{index:06d}.npz") as archive:
            for name in (*CHANNELS, "meta.json"):
                if name == "objects":
                    same_table(archive[name], sample.objects)
                elif name == "keypoints":
                    same_table(archive[name], sample.keypoints)
                elif name == "meta.json":
                    assert json.loads(archive[name])["index"] == index
                else:
                    np.testing.assert_array_equal(archive[name], sample[name])


def test_h5py_reads_every_channel(out, samples):
    for index, sample in zip(FRAMES, samples, strict=True):
        with h5py.File(out / f"hdf5/frames-{index // 3:06d}.h5") as file:
            group = file[f"{index:06d}"]
            assert json.loads(group["record"][()].tobytes())["index"] == index
            for name in CHANNELS:
                if name == "objects":
                    same_table(group[name][()], sample.objects)
                elif name == "keypoints":
                    same_table(group[name][()], sample.keypoints)
                else:
                    np.testing.assert_array_equal(group[name][()], sample[name])


def test_webdataset_reads_every_channel(out, samples):
    shards = [str(path) for path in sorted((out / "webdataset").glob("*.tar"))]
    assert len(shards) == 2
    read = list(webdataset.WebDataset(shards, shardshuffle=False).decode("rgb8"))
    assert [row["__key__"] for row in read] == [f"{index:06d}" for index in FRAMES]
    for row, sample in zip(read, samples, strict=True):
        np.testing.assert_array_equal(row["rgb.png"], sample["rgb"])
        np.testing.assert_array_equal(row["depth.npy"], sample["depth"])
        np.testing.assert_array_equal(row["position.npy"], sample["position"])
        same_table(row["objects.npy"], sample.objects)
        assert row["json"]["meta"]["index"] == sample.meta["index"]


def test_bop_webdataset_is_the_scene_folders(out):
    shards = [str(path) for path in sorted((out / "bop-webdataset").glob("*.tar"))]
    numbers = json.loads((out / "bop-webdataset/key_to_shard.json").read_text())
    for number, shard in enumerate(shards):
        for row in webdataset.WebDataset([shard], shardshuffle=False):
            assert numbers.pop(row["__key__"]) == number
            scene_id, im_id = row["__key__"].split("_")
            scene, image = out / f"bop/train/{scene_id}", str(int(im_id))
            assert row["rgb.png"] == (scene / f"rgb/{im_id}.png").read_bytes()
            assert row["depth.png"] == (scene / f"depth/{im_id}.png").read_bytes()
            for name in ("camera", "gt", "gt_info"):
                expected = json.loads((scene / f"scene_{name}.json").read_text())[image]
                assert json.loads(row[f"{name}.json"]) == expected
            for name in ("mask", "mask_visib"):
                for k, runs in json.loads(row[f"{name}.json"]).items():
                    mask = rle.decode(rle.frPyObjects(runs, *runs["size"]))
                    file = Image.open(scene / f"{name}/{im_id}_{int(k):06d}.png")
                    np.testing.assert_array_equal(mask * 255, np.array(file))
    assert not numbers
    for name in ("models/obj_000001.ply", "models/models_info.json", "camera.json"):
        assert (out / "bop-webdataset" / name).read_bytes() == (out / "bop" / name).read_bytes()


def test_pillow_reads_ids_and_the_legend_names_them(out, sim, samples):
    legend = json.loads((out / "png/legend.json").read_text())
    for index, sample in zip(FRAMES, samples, strict=True):
        name = f"{index:06d}.png"
        np.testing.assert_array_equal(np.array(Image.open(out / "png/rgb" / name)), sample["rgb"])
        for channel in ("instance", "part"):
            picture = Image.open(out / "png" / channel / name)
            assert picture.mode == "P"
            np.testing.assert_array_equal(np.array(picture), sample[channel])
            colors = np.array(picture.convert("RGB"))
            for number in np.unique(sample[channel]):
                told = legend[channel][str(number)]
                assert told["name"] == sim.taxonomy.names(channel)[int(number)]
                assert (colors[sample[channel] == number] == told["rgb"]).all()
        for k, level in enumerate(("kind", "object", "part")):
            picture = Image.open(out / f"png/semantic/{level}" / name)
            np.testing.assert_array_equal(np.array(picture), sample["semantic"][:, :, k])
        record = json.loads((out / f"png/frames/{index:06d}.json").read_text())
        for channel in ("depth", "range"):
            step = record["labels"]["metres_per_step"][channel]
            read = np.array(Image.open(out / "png" / channel / name)).astype(np.float64) * step
            np.testing.assert_allclose(read, sample[channel], rtol=0, atol=0.5001 * step)
        mask = np.array(Image.open(out / f"png/masks/{index:06d}_000.png"))
        np.testing.assert_array_equal(mask == 255, sample["masks"][0] != 0)


def yolo_lines(path):
    return [np.array([float(word) for word in line.split()]) for line in open(path)]


def test_yolo_labels_keep_ultralytics_rules(out, samples):
    """Its checks of a label file: a class and four shares in [0, 1], no line twice."""
    for index, sample in zip(FRAMES, samples, strict=True):
        rows = yolo_lines(out / f"yolo/labels/train/{index:06d}.txt")
        assert len(rows) == np.count_nonzero(sample.objects["px_count_visib"])
        for row in rows:
            assert row.shape == (5,)
            assert row[0] == 0
            assert ((row[1:] >= 0) & (row[1:] <= 1)).all()
            x, y, w, h = row[1:] * [WIDTH, HEIGHT, WIDTH, HEIGHT]
            mask = np.asfortranarray(sample["instance"] == sample.objects["instance_id"][0])
            expected = rle.toBbox(rle.encode(mask))
            np.testing.assert_allclose([x - w / 2, y - h / 2, w, h], expected, atol=1e-5)


def test_yolo_polygons_fill_the_mask(out, samples):
    """As Ultralytics makes masks of them: scaled, cut to whole pixels, filled by OpenCV."""
    for index, sample in zip(FRAMES, samples, strict=True):
        for row in yolo_lines(out / f"yolo-segment/labels/train/{index:06d}.txt"):
            corners = (row[1:].reshape(-1, 2) * [WIDTH, HEIGHT]).astype(np.int32)
            mask = np.zeros((HEIGHT, WIDTH), np.uint8)
            cv2.fillPoly(mask, [corners], 1)
            expected = sample["instance"] == sample.objects["instance_id"][0]
            different = np.count_nonzero((mask != 0) != expected)
            assert different <= 0.02 * expected.sum()  # pieces are joined by lines


def test_speed_projects_the_spacecraft_where_it_is(out, samples):
    """By the formulas of SPEED's own tools: p_camera = dcm(q)^T p + r, and its camera matrix."""
    camera = json.loads((out / "speed/camera.json").read_text())
    rows = json.loads((out / "speed/train.json").read_text())
    assert [row["filename"] for row in rows] == [f"{index:06d}.png" for index in FRAMES]
    for row, sample in zip(rows, samples, strict=True):
        q0, q1, q2, q3 = row["q_vbs2tango_true"]
        dcm = np.array(  # of speed-utils' quat2dcm
            [
                [2 * q0**2 - 1 + 2 * q1**2, 2 * q1 * q2 + 2 * q0 * q3, 2 * q1 * q3 - 2 * q0 * q2],
                [2 * q1 * q2 - 2 * q0 * q3, 2 * q0**2 - 1 + 2 * q2**2, 2 * q2 * q3 + 2 * q0 * q1],
                [2 * q1 * q3 + 2 * q0 * q2, 2 * q2 * q3 - 2 * q0 * q1, 2 * q0**2 - 1 + 2 * q3**2],
            ]
        )
        np.testing.assert_allclose(dcm.T, sample.objects["R_m2c"][0], atol=1e-12)
        np.testing.assert_array_equal(row["r_Vo2To_vbs_true"], sample.objects["t_m2c"][0])
        np.testing.assert_allclose(camera["cameraMatrix"], sample.camera.K)


def test_opencv_reads_flow_as_kitti_has_it(out, samples):
    """Of the development kit: (value - 2^15) / 64, and the third channel says where."""
    for index in FRAMES:
        sample, folder = samples[index], out / "kitti-flow/training"
        file = cv2.imread(str(folder / f"flow_occ/{index:06d}_10.png"), cv2.IMREAD_UNCHANGED)
        valid, v, u = np.moveaxis(file.astype(np.float64), 2, 0)
        steps = np.rint(64.0 * sample["flow"] + 2**15)  # nan is neither
        expected = ((steps >= 0) & (steps <= 65535)).all(axis=2)
        np.testing.assert_array_equal(valid != 0, expected)
        found = (np.stack([u, v], axis=2) - 2**15) / 64
        np.testing.assert_allclose(found[expected], sample["flow"][expected], atol=1 / 128 + 1e-4)
        for name, of in (("10", index), ("11", index + 1 if index % 2 == 0 else index)):
            picture = np.array(Image.open(folder / f"image_2/{index:06d}_{name}.png"))
            np.testing.assert_array_equal(picture, samples[of]["rgb"])
        seen = cv2.imread(str(folder / f"flow_noc/{index:06d}_10.png"), cv2.IMREAD_UNCHANGED)
        hidden = expected & (sample["flow_occlusion"] != 0)
        np.testing.assert_array_equal(seen[:, :, 0] != 0, expected & ~hidden)


@pytest.mark.parametrize("seed", range(20))
def test_segments_are_those_of_pycocotools(seed):
    """Of random images of ids, with pixel (0, 0), single pixels, holes and pieces."""
    random = np.random.default_rng(seed)
    shape = tuple(random.integers(1, 24, 2))
    ids = random.integers(0, random.integers(1, 6) + 1, shape).astype(np.int32)
    if seed % 3 == 0:
        ids = np.repeat(np.repeat(ids, 3, axis=0), 4, axis=1)
    found = segments(ids)
    assert set(found) == set(np.unique(ids).tolist()) - {0}
    for number, segment in found.items():
        mask = ids == number
        encoded = rle.encode(np.asfortranarray(mask))
        assert segment.area == mask.sum()
        assert list(segment.box) == rle.toBbox(encoded).tolist()
        assert rle.frPyObjects(segment.rle(), *shape)["counts"] == encoded["counts"]
        np.testing.assert_array_equal(segment.mask(), mask)


def test_arrays_that_deflate_does_not_halve_are_stored(tmp_path):
    """Noise as it is, ids deflated; both come back, also from tables with texts, without a
    warning."""
    from perilune.export.writers.formats.pixels import deflates, from_npy, npy
    from perilune.export.writers.formats.tables import FORMATS

    noise = np.random.default_rng(1).random((60, 80, 3), dtype=np.float32)
    ids = np.repeat(np.arange(60, dtype=np.int32), 80).reshape(60, 80)
    table = np.array([(b"a\xc3\xa9", 1.5)], dtype=[("name", "S8"), ("t", "<f8")])
    assert not deflates(noise)
    assert deflates(ids)
    half = np.concatenate([noise, np.zeros((90, 80, 3), np.float32)])
    assert deflates(half)
    assert deflates(np.zeros((0, 4)))
    large = np.tile(half, (12, 1, 1))[:-7]  # several chunks, the last one cut
    hdf5, path = FORMATS["hdf5"], tmp_path / "frames.h5"
    arrays = {"noise": noise, "ids": ids, "table": table, "large": large}
    hdf5.pack({}, path, [(f"000000/{name}.npy", npy(array)) for name, array in arrays.items()])
    with h5py.File(path) as file:
        assert file["000000/noise"].compression is None
        assert file["000000/ids"].compression == "gzip"
        assert file["000000/large"].id.get_num_chunks() > 1
        assert file["000000/large"].id.get_storage_size() < 0.5 * large.nbytes
    with warnings.catch_warnings(), hdf5.unpack(path) as reader:
        warnings.simplefilter("error")
        for name, array in arrays.items():
            back = from_npy(reader.read(f"000000/{name}.npy"))
            assert back.dtype == array.dtype
            assert np.array_equal(back, array)
