"""`perilune check` and `perilune stats` on every format: good ones pass, faults are told."""

from __future__ import annotations

import json
import re
import shutil

import numpy as np
import pytest
from PIL import Image

import perilune
from perilune.cli import main
from perilune.export.check import check
from perilune.export.check.invariants import faults
from perilune.export.writers import write
from perilune.export.writers.formats import record as records
from perilune.export.writers.formats.pixels import from_npy, from_png, ids_image, npy
from perilune.export.writers.formats.tables import FORMATS

CHANNELS = ["rgb", "depth", "semantic", "part", "instance", "objects", "masks", "normal", "flow"]
CHANNELS += ["flow_occlusion", "flow_backward", "range", "position", "keypoints"]
CHANNELS += ["coverage", "coverage_instance"]


@pytest.fixture(scope="module")
def sim(small_scene):
    changes = {
        "camera.width": 48,
        "camera.height": 36,
        "render.samples": 1,
        "time.frames_per_scene": 2,
        "render.channels": CHANNELS,
        "render.scans": ["points"],
    }
    return perilune.open(small_scene, overrides=changes)


@pytest.fixture(scope="module")
def good(sim, tmp_path_factory):
    folder = tmp_path_factory.mktemp("check")
    write(list(FORMATS), sim, range(3), folder, chunk_size=2, threads=1)
    return folder


@pytest.fixture
def dataset(good, tmp_path):
    """A copy of a format's dataset."""

    def of(name):
        return shutil.copytree(good / name, tmp_path / name)

    return of


def told(folder, **options):
    (report,) = check(folder, **options)
    return [f"{finding.file}: {finding.reason}" for finding in report.findings]


def test_good_datasets_have_no_findings(good):
    reports = check(good, rerender=1)
    assert len(reports) == len(FORMATS)
    for report in reports:
        assert report.findings == [], report.folder
        assert report.images == 3
        assert "1 of 3 frames were rendered again" in report.notes[0]


every_format = pytest.mark.parametrize("name", list(FORMATS))


@every_format
def test_a_changed_byte_is_found(dataset, name):
    folder = dataset(name)
    pack = FORMATS[name].pack_name
    record = records.read(folder / "frames/000001.json")
    victim = pack.format(chunk=0) if pack else sorted(record["files"])[-1]
    data = bytearray((folder / victim).read_bytes())
    data[len(data) // 2] ^= 1
    (folder / victim).write_bytes(bytes(data))
    assert any(line.startswith(victim) for line in told(folder, alone=True))


@every_format
def test_what_is_missing_or_too_much_is_found(dataset, name):
    folder = dataset(name)
    (folder / "frames/000002.json").unlink()
    (folder / "foreign.txt").write_text("")
    lines = told(folder, alone=True)
    assert any("foreign.txt: is not part of the dataset" in line for line in lines)
    assert len(lines) > 1


@every_format
def test_a_changed_record_is_found(dataset, name):
    folder = dataset(name)
    path = folder / "frames/000001.json"
    path.write_text(path.read_text().replace('"seed": 3', '"seed": 4'))
    assert "frames/000001.json: is damaged" in told(folder, alone=True)


@every_format
def test_another_pose_is_found_by_rendering_again(dataset, name):
    """Even where sums are made anew."""
    folder = dataset(name)
    record = records.read(folder / "frames/000001.json")
    record["meta"]["sun"]["direction"][0] += 1e-9
    del record["crc32"]
    records.write(folder, record)
    lines = told(folder, rerender=None)
    assert "frames/000001.json: frame 1: meta is not what the configuration makes" in lines


def replant(folder, index, name, data):
    """Puts another file into a frame, with sums that agree."""
    (folder / name).write_bytes(data)
    record = records.read(records.path_of(folder, index))
    record["files"][name] = records.sums(data)
    del record["crc32"]
    records.write(folder, record)


def test_an_unknown_id_names_frame_and_channel(dataset):
    folder = dataset("png")
    name = "instance/000001.png"
    ids = from_png((folder / name).read_bytes()).copy()
    ids[0, 0] = 77
    replant(folder, 1, name, ids_image(ids, {"77": ""}))
    lines = told(folder, alone=True)
    assert any("frame 1: instance has ids without a name, [77]" in line for line in lines)


def test_a_line_of_yolo_that_is_about_something_else(dataset):
    folder = dataset("yolo")
    replant(folder, 0, "labels/train/000000.txt", b"0 0.5 0.5 0.1 0.1\n")
    (line,) = (line for line in told(folder, alone=True) if "labels/train" in line)
    assert "frame 0: object 'probe': labels/train/000000.txt is not about its pixels" in line


def test_an_annotation_that_does_not_fit_names_frame_and_object(dataset):
    folder = dataset("coco")
    record = records.read(folder / "frames/000000.json")
    record["labels"]["instances"][0]["bbox"][0] += 1
    del record["crc32"]
    records.write(folder, record)
    expected = "frame 0: object 'probe': its annotation is not about its pixels"
    assert any(expected in line for line in told(folder, alone=True))


def test_summaries_are_compared_with_the_frames(dataset):
    folder = dataset("coco")
    path = folder / "annotations/instances_train.json"
    path.write_text(path.read_text().replace('"iscrowd": 0', '"iscrowd": 1', 1))
    expected = "annotations/instances_train.json: does not agree with the frames"
    assert expected in told(folder, alone=True)


@pytest.fixture(scope="module")
def frame(good):
    """Info, record and arrays of a frame."""
    folder = good / "hdf5"
    info = json.loads((folder / "dataset_info.json").read_text())
    record = records.read(folder / "frames/000000.json")
    with FORMATS["hdf5"].unpack(folder / "frames-000000.h5") as reader:
        arrays = FORMATS["hdf5"].decode(info, record, reader.read)
    after = records.read(folder / "frames/000001.json")
    assert list(faults(info, record, arrays, {1: after}.get)) == []
    return info, record, arrays, after


def seen(arrays, info):
    (number,) = (r["id"] for r in info["taxonomy"]["instances"] if r["name"] == "probe")
    return np.argwhere(arrays["instance"] == number)[0], number


def plant_nan(info, record, arrays):
    arrays["depth"][0, 0] = np.nan


def plant_infinity(info, record, arrays):
    arrays["normal"][0, 0, 0] = np.inf


def plant_a_long_normal(info, record, arrays):
    (y, x), _ = seen(arrays, info)
    arrays["normal"][y, x] *= 2


def plant_a_lost_pixel(info, record, arrays):
    (y, x), _ = seen(arrays, info)
    arrays["instance"][y, x] = 1


def plant_a_hole_in_the_mask(info, record, arrays):
    (y, x), _ = seen(arrays, info)
    arrays["masks"][0, y, x] = 0


def plant_a_full_mask(info, record, arrays):
    arrays["masks"][0] = 1


def plant_a_wide_box(info, record, arrays):
    record["objects"][0]["bbox_visib"][2] += 1


def plant_a_mirror(info, record, arrays):
    record["objects"][0]["R_m2c"][0] = [-v for v in record["objects"][0]["R_m2c"][0]]


def plant_a_fraction(info, record, arrays):
    record["objects"][0]["visib_fract"] *= 0.5


def plant_a_class(info, record, arrays):
    arrays["semantic"][0, 0, 1] = 999


def plant_a_part_elsewhere(info, record, arrays):
    (y, x), _ = seen(arrays, info)
    arrays["part"][y, x] = 0


def plant_seen_sky_flow(info, record, arrays):
    arrays["flow"][0, 0] = np.nan
    arrays["flow_occlusion"][0, 0] = 0


def plant_another_size(info, record, arrays):
    arrays["depth"] = arrays["depth"][:-1]


def plant_a_moved_pose(info, record, arrays):
    record["objects"][0]["t_m2c"][2] += 1e-3


def plant_a_turned_pose(info, record, arrays):
    rows = record["objects"][0]["R_m2c"]
    rows[0], rows[1] = rows[1], [-v for v in rows[0]]


def plant_another_range(info, record, arrays):
    (y, x), _ = seen(arrays, info)
    arrays["range"][y, x] *= 1.00001


def plant_another_position(info, record, arrays):
    (y, x), _ = seen(arrays, info)
    arrays["position"][y, x, 0] += 0.1


def plant_a_depth_of_nothing(info, record, arrays):
    (y, x), _ = seen(arrays, info)
    arrays["depth"][y, x] *= 2


def plant_a_silhouette_elsewhere(info, record, arrays):
    arrays["instance"][0, 0] = seen(arrays, info)[1]


def plant_a_mask_elsewhere(info, record, arrays):
    arrays["masks"][0, 0, 0] = 1


def plant_a_long_flow(info, record, arrays):
    (y, x), _ = seen(arrays, info)
    arrays["flow"][y, x, 0] += 0.1


def plant_a_moved_keypoint(info, record, arrays):
    arrays["keypoints"]["xy"][0, 1] += 0.01


def plant_an_unseen_keypoint(info, record, arrays):
    arrays["keypoints"]["visible"][0] = 0


def plant_the_lens_of_another(info, record, arrays):
    record["camera"]["lens"] = {"model": "brown_conrady", "coefficients": [0.5] + [0.0] * 7}


def plant_too_large_a_part(info, record, arrays):
    arrays["coverage"][0, 0, :2] = [0.75, 0.5]


def plant_an_unknown_layer(info, record, arrays):
    arrays["coverage_instance"][0, 0, 0] = 999


def plant_a_part_of_nothing(info, record, arrays):
    (y, x), _ = seen(arrays, info)
    arrays["coverage_instance"][y, x, 0] = 0


PLANTED = {
    plant_too_large_a_part: r"coverage is no parts of a pixel, .* row 0",
    plant_an_unknown_layer: r"coverage_instance has ids of no instance at 1 pixels",
    plant_a_part_of_nothing: r"instance is in no layer of coverage_instance at 1 pixels",
    plant_a_moved_pose: r"object 'probe': t_m2c is 0\.001 m away from its state",
    plant_a_turned_pose: r"object 'probe': R_m2c is not the attitude of its state",
    plant_another_range: r"range is not the distance of what depth tells at 1 pixels",
    plant_another_position: r"position is not where depth tells at 1 pixels",
    plant_a_depth_of_nothing: r"object 'probe': depth lies up to .* outside of its model's box",
    plant_a_silhouette_elsewhere: r"object 'probe': it is seen beside its model's box at 1 pixels",
    plant_a_mask_elsewhere: r"object 'probe': its mask is seen beside its model's box",
    plant_a_long_flow: r"object 'probe': flow is up to 0\.1 pixels from where depth and motion",
    plant_a_moved_keypoint: r"object 'probe': keypoint 'nose': xy is",
    plant_an_unseen_keypoint: r"keypoint 'nose': visible is 0, its image .* lies inside",
    plant_the_lens_of_another: r"keypoint 'nose': xy is",
    plant_nan: r"depth is nan at 1 pixels, the first at column 0, row 0",
    plant_infinity: r"normal is infinite",
    plant_a_long_normal: r"normal is no unit vector",
    plant_a_lost_pixel: r"object 'probe': px_count_visib is (\d+), instance shows \d+ pixels",
    plant_a_hole_in_the_mask: r"object 'probe': is seen outside of its mask",
    plant_a_full_mask: r"object 'probe': its mask has 1728 pixels",
    plant_a_wide_box: r"object 'probe': bbox_visib is",
    plant_a_mirror: r"object 'probe': R_m2c is no rotation",
    plant_a_fraction: r"object 'probe': visib_fract is",
    plant_a_class: r"semantic/object has ids without a name, \[999\]",
    plant_a_part_elsewhere: r"part and instance are of different objects",
    plant_seen_sky_flow: r"flow_occlusion is 0 where flow is nan",
    plant_another_size: r"depth has 48 x 35 pixels, must have 48 x 36",
}


@pytest.mark.parametrize("plant", list(PLANTED), ids=lambda plant: plant.__name__)
def test_planted_faults_are_told(frame, plant):
    info, record, arrays, after = frame
    record = json.loads(json.dumps(record))
    arrays = {name: array.copy() for name, array in arrays.items()}
    plant(info, record, arrays)
    lines = list(faults(info, record, arrays, {1: after}.get))
    assert any(re.search(PLANTED[plant], line) for line in lines), lines


def edited(name, change):
    """A change of a JSON member of a BOP shard."""

    def to(record, members):
        (key,) = (key for key in members if key.endswith(f".{name}.json"))
        told = json.loads(members[key])
        change(told)
        members[key] = json.dumps(told).encode()

    return to


def move(record, _):
    record["objects"][0]["t_m2c"][0] += 0.01


OF_POSES = {
    ("speed", "a pose"): (move, "object 'probe': its pose is not that of its record"),
    ("bop-webdataset", "a pose"): (move, "gt.json does not have the poses of its record"),
    ("bop-webdataset", "intrinsics"): (
        edited("camera", lambda told: told["cam_K"].__setitem__(0, 1.0)),
        "camera.json does not have the intrinsics of its record",
    ),
    ("bop-webdataset", "counts"): (
        edited("gt_info", lambda told: told[0].update(px_count_valid=1)),
        "object 'probe': gt_info.json is not that of its masks",
    ),
    ("bop-webdataset", "what is seen"): (
        edited("mask_visib", lambda told: told["0"].update(counts=[0, 48 * 36])),
        "object 'probe': is seen outside of its mask",
    ),
}


@pytest.mark.parametrize("case", OF_POSES, ids=" ".join)
def test_faults_of_poses_and_masks_are_told(good, case):
    change, expected = OF_POSES[case]
    fmt, folder = FORMATS[case[0]], good / case[0]
    info = json.loads((folder / "dataset_info.json").read_text())
    record = records.read(folder / "frames/000000.json")
    if fmt.pack_name is None:
        members = {name: (folder / name).read_bytes() for name in record["files"]}
    else:
        with fmt.unpack(folder / fmt.pack_name.format(chunk=0)) as reader:
            members = {name: reader.read(name) for name in record["files"]}
    arrays = fmt.decode(info, record, members.__getitem__)
    assert list(fmt.faults(info, record, arrays, members.__getitem__)) == []
    change(record, members)
    assert expected in list(fmt.faults(info, record, arrays, members.__getitem__))


def test_arrays_come_back_from_npy():
    table = np.zeros(3, dtype=[("a", "f8"), ("b", "i4", (4,))])
    assert from_npy(npy(table)).dtype == table.dtype


@every_format
def test_the_commands_know_every_format(good, capsys, name):
    assert main(["check", str(good / name), "--alone"]) == 0
    assert "3 images, 3 instances; 0 findings" in capsys.readouterr().out
    assert main(["stats", str(good / name), "--json"]) == 0
    found = json.loads(capsys.readouterr().out)
    assert found["images"] == 3
    assert found["instances"] == 3


@pytest.mark.parametrize("name", ["npz", "coco"])
def test_figures_of_statistics(good, tmp_path, name):
    path = tmp_path / "figure.png"
    assert main(["stats", str(good / name), "--figure", str(path)]) == 0
    with Image.open(path) as image:
        assert len(np.unique(np.array(image.convert("RGB")).reshape(-1, 3), axis=0)) > 10


def test_a_format_of_the_future_is_refused(dataset, capsys):
    folder = dataset("npz")
    path = folder / "dataset_info.json"
    path.write_text(path.read_text().replace('"format": "npz"', '"format": "npx"'))
    assert main(["check", str(folder)]) != 0
    assert "there is no 'npx'; did you mean 'npz'" in capsys.readouterr().err
