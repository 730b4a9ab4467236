"""Hard cases of every format: nothing in view, 500 objects, names in Unicode, depths and tables
beyond what a first try holds."""

from __future__ import annotations

import copy
import json
from dataclasses import replace

import numpy as np
import pytest

import perilune
from perilune.export.check import check
from perilune.export.check.invariants import faults
from perilune.export.stats import statistics
from perilune.export.writers import write
from perilune.export.writers.formats.channels import TABLE, Channel, described
from perilune.export.writers.formats.folder import frame_of, record_for, rendered_for
from perilune.export.writers.formats.info import folder_info
from perilune.export.writers.formats.tables import FORMATS

CHANNELS = ["rgb", "depth", "semantic", "part", "instance", "objects", "masks", "keypoints"]
SMALL = {"camera.width": 40, "camera.height": 30, "render.samples": 1}
MANY = 500
NOT_PLY = [name for name in FORMATS if name != "ply"]
every_format = pytest.mark.parametrize("name", NOT_PLY)


@pytest.fixture(scope="module")
def sims(small_scene):
    """Format -> a simulation that asks for what it holds."""
    sim = perilune.open(small_scene, overrides={**SMALL, "time.frames_per_scene": 2})
    every = described(sim, [*CHANNELS, "flow", "flow_occlusion"])

    def of(name):
        held = [key for key, row in every.items() if not FORMATS[name].problem(row)]
        return sim.with_overrides({"render.channels": held})

    return of


@pytest.fixture(scope="module")
def frames(sims):
    """Format -> dataset_info.json and a frame; rendered once for all."""
    made = {}

    def of(name):
        fmt, sim = FORMATS[name], sims(name)
        info = folder_info(fmt, sim, 1000, "train")
        asked = tuple(rendered_for(sim, info))
        if asked not in made:
            made[asked] = sim.frame(0, channels=list(asked))
        sample = made[asked]
        frame = frame_of(info, sample, {}, record_for(sim, info, sample))
        return info, replace(frame, next_picture=sample["rgb"] if fmt.needs_next else None)

    return of


def round_trip(fmt, info, frame):
    """Arrays from the files of a frame, and its record with labels; no fault of the format."""
    encoded = fmt.encode(info, frame)
    record = {**frame.record, "labels": encoded.labels, "files": dict.fromkeys(encoded.files)}
    arrays = fmt.decode(info, record, encoded.files.__getitem__)
    assert list(fmt.faults(info, record, arrays, encoded.files.__getitem__)) == []
    return arrays, record


@pytest.fixture(scope="module")
def crowd(frames):
    """Format -> the same with 500 objects, one or two pixels each, one split in two."""

    def of(name):
        info, frame = frames(name)
        info, record = copy.deepcopy(info), copy.deepcopy(dict(frame.record))
        (first,) = (row for row in info["taxonomy"]["instances"] if row["kind"] == "spacecraft")
        (object_row,) = record.get("objects", [None])
        base = max(row["id"] for row in info["taxonomy"]["instances"])
        ids = np.zeros((30, 40), np.int32)
        ids.ravel()[: 2 * MANY : 2] = base + 1 + np.arange(MANY)
        ids[29, 39] = base + 1
        rows = []
        for k in range(MANY):
            number, label = base + 1 + k, f"craft_{k:03d}"
            info["taxonomy"]["instances"].append({**first, "id": number, "name": label})
            if "instance" in info.get("labels", {}):
                info["labels"]["instance"][str(number)] = label
            y, x = np.nonzero(ids == number)
            box = [int(x.min()), int(y.min()), int(np.ptp(x)), int(np.ptp(y))]
            counts = {"px_count_visib": len(x), "px_count_all": len(x), "px_count_valid": len(x)}
            boxes = {"bbox_visib": box, "bbox_obj": box, "visib_fract": 1.0}
            rows.append({**object_row, **counts, **boxes, "name": label, "instance_id": number})
        info["taxonomy"]["instances"] = [
            row for row in info["taxonomy"]["instances"] if row is not first and row != first
        ] + [first]
        table = np.repeat(frame.sample.objects, MANY)
        table["instance_id"] = base + 1 + np.arange(MANY)
        arrays = dict(frame.arrays)
        for key, value in {
            "instance": ids,
            "masks": np.stack([ids == row["instance_id"] for row in rows]),
            "objects": table,
        }.items():
            if key in arrays:
                arrays[key] = value
        arrays.pop("keypoints", None)
        info["channels"].pop("keypoints", None)
        sample = copy.copy(frame.sample)
        sample._objects = table
        return info, replace(
            frame, arrays=arrays, record={**record, "objects": rows}, sample=sample
        )

    return of


@pytest.mark.parametrize("name", ["coco", "yolo", "yolo-segment", "png", "npz", "exr", "exr-half",
                                  "webdataset", "hdf5", "bop-webdataset"])  # fmt: skip
def test_500_instances(crowd, name):
    info, frame = crowd(name)
    arrays, record = round_trip(FORMATS[name], info, frame)
    if "instance" in arrays:
        np.testing.assert_array_equal(arrays["instance"], frame.arrays["instance"])
        assert len(np.unique(arrays["instance"])) == MANY + 1
    if "masks" in arrays:
        assert len(arrays["masks"]) == MANY
    own = {key: arrays[key] for key in ("instance", "masks") if key in arrays}
    told = [text for text in faults(info, record, own) if "state" not in text]
    assert [text for text in told if "model's box" not in text] == []


@every_format
def test_an_empty_frame(small_scene, sims, tmp_path, name):
    """Nothing but the sky: the camera looks away from all."""

    def away(world):
        return np.array([0.0, 0.0, 2e7, 1.0, 0.0, 0.0, 0.0])

    changes = {**SMALL, "render.channels": sims(name).config.render.channels,
               "time.frames_per_scene": 2}  # fmt: skip
    sim = perilune.open(small_scene, overrides=changes, trajectory=away)
    if name == "speed":
        sim = sim.with_overrides({"camera.trajectory.target": "probe"})
    write(name, sim, range(2), tmp_path, threads=1)
    (report,) = check(tmp_path, alone=True)
    assert report.findings == []
    assert report.images == 2


@pytest.mark.parametrize("name", ["bop", *FORMATS])
def test_names_in_unicode(small_scene, sims, tmp_path, name):
    """Of spacecraft, levels, classes, keypoints, the description and the folder: no finding by
    `check`, which renders again, and figures by `stats`."""
    held = list(sims(name).config.render.channels) if name in NOT_PLY else ["rgb", "keypoints"]
    (tmp_path / "points.json").write_text('{"nez_é": [0.9, 0, 0.4], "尾": [-0.9, 0, 0]}', "utf-8")
    changes = {
        **SMALL,
        "description": "größer, 探査機",
        "time.frames_per_scene": 2,
        "spacecraft.зонд-é.class": "衛星",
        "spacecraft.зонд-é.classes": {"材料": "金属"},
        "labels.levels": ["kind", "object", "part", "材料"],
        "spacecraft.зонд-é.keypoints": {"file": str(tmp_path / "points.json")},
        "labels.part_classes": {"tragfläche_µ": ["*wing*"]},
        "render.channels": held,
    }
    if name == "ply":
        changes |= {"render.scans": ["points"], "render.channels": ["objects"]}
    out = tmp_path / "größe 探査"
    document = perilune.open(small_scene).document
    tree = json.loads(json.dumps(document.tree).replace('"probe"', json.dumps("зонд-é")))
    sim = perilune.open(tree, overrides=changes, base=document.base)
    write(name, sim, range(1), out, threads=1)
    (report,) = check(out, rerender=1)
    assert report.findings == []
    assert statistics(out)["images"] == 1


@pytest.mark.parametrize("far_m", [1e5, 7e8, 4.4e12])
@pytest.mark.parametrize("name", ["png", "bop-webdataset", "exr", "npz"])
def test_depths_beyond_65535_steps(frames, name, far_m):
    """Steps grow with the depth of a frame: the farthest is within half a step, of 1/30 000."""
    info, frame = frames(name)
    depth = np.where(frame.arrays["depth"] > 0, far_m, 0).astype(np.float32)
    depth[tuple(np.argwhere(depth)[0])] = 0.5 * far_m
    frame = replace(frame, arrays={**frame.arrays, "depth": depth})
    arrays, _ = round_trip(FORMATS[name], info, frame)
    if "depth" in arrays:
        np.testing.assert_allclose(arrays["depth"], depth, rtol=2e-5 if name == "png" else 0)


@pytest.mark.parametrize(
    "name", [name for name, fmt in FORMATS.items() if fmt.holds(Channel("craters", TABLE, "table"))]
)
def test_10_000_craters(frames, name):
    info, frame = frames(name)
    info = copy.deepcopy(info)
    entry = Channel("craters", TABLE, "table").entry()
    info["channels"]["craters"] = entry
    kind = [("id", "i8"), ("center", "f8", (2,)), ("semi_axes", "f8", (2,)), ("cut", "?")]
    table = np.zeros(10_000, kind)
    table["id"] = np.arange(10_000) * 2**40
    table["center"] = np.random.default_rng(1).random((10_000, 2))
    frame = replace(frame, arrays={**frame.arrays, "craters": table})
    arrays, _ = round_trip(FORMATS[name], info, frame)
    for field in table.dtype.names:
        np.testing.assert_array_equal(arrays["craters"][field], table[field])
