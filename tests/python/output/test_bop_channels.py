"""Channels beside BOP: what is asked for is on disk, as it was rendered."""

from __future__ import annotations

import json
import shutil

import numpy as np
import pytest
from PIL import Image

import perilune
from perilune import _core
from perilune.cli import main
from perilune.export.check import check_bop

PICTURES = {"rgb", "sensor_rgb", "raw"}
NAMES = [row["name"] for row in _core.CHANNELS if row["name"] not in {"depth", *PICTURES}]


def read(folder, name, entry):
    path = folder / name / f"000000.{entry['file']}"
    if entry["file"] == "npy":
        return np.load(path, allow_pickle=False)
    with Image.open(path) as image:
        return np.array(image)


@pytest.fixture(scope="module")
def sim(small_scene, pair):
    bands = [{"center_um": c, "width_um": 0.1} for c in (0.5, 0.6, 0.7, 0.8)]
    changes = {
        "render.channels": NAMES,
        "render.samples": 1,
        "camera.bands": bands,
        "camera.sensor": {},
    }
    return perilune.open(small_scene, overrides={**pair, **changes})


@pytest.fixture(scope="module")
def dataset(sim, tmp_path_factory):
    out = tmp_path_factory.mktemp("channels") / "out"
    perilune.write_bop(sim, range(2), out, threads=1)
    return out


def test_every_channel_of_the_core_is_on_disk_as_it_is(dataset, sim):
    info = json.loads((dataset / "dataset_info.json").read_text())
    assert set(info["channels"]) == set(NAMES)
    sample = sim.frame(0, NAMES)
    for name, entry in info["channels"].items():
        found = read(dataset / "train/000000", name, entry)
        assert found.dtype.name == entry["dtype"]
        np.testing.assert_array_equal(found, sample[name], err_msg=name)
    assert {name for name, row in info["channels"].items() if row["file"] == "png"} == {
        "semantic",
        "part",
        "instance",
        "hazard",
        "shadow",
        "shadow_cause",
        "flow_occlusion",
        "flow_occlusion_backward",
    }
    names = {"0": "background", "1": "planet", "2": "probe", "3": "mate"}
    assert info["labels"]["instance"] == names
    assert [row["level"] for row in info["labels"]["semantic"]] == ["kind", "object", "part"]


def test_what_is_not_stated_is_not_written(small_scene, tmp_path):
    perilune.write_bop(perilune.open(small_scene), range(1), tmp_path / "out", threads=1)
    folders = {path.name for path in (tmp_path / "out/train/000000").iterdir() if path.is_dir()}
    assert folders == {"rgb", "depth", "mask", "mask_visib"}


def test_the_command_writes_what_is_asked(small_scene, tmp_path):
    out = tmp_path / "out"
    asked = "render.channels=[semantic, part, instance]"
    arguments = ["render", str(small_scene), "--frames", "0:1", "--out", str(out), "--set", asked]
    assert main(arguments) == 0
    for name in ("semantic", "part", "instance"):
        assert (out / "train/000000" / name / "000000.png").is_file()
    assert "`semantic/`: PNG, uint8, 3 values a pixel" in (out / "dataset_info.md").read_text()


def test_large_ids_and_two_levels(small_scene, tmp_path):
    ids = {"labels.ids": {"object": {"probe": 40000}}, "render.channels": ["semantic"]}
    cases = (["object"], "uint16"), (["kind", "object"], "npy"), (["kind", "part"], 3)
    for levels, kind in cases:
        sim = perilune.open(small_scene, overrides={**ids, "labels.levels": levels})
        out = tmp_path / "-".join(levels)
        perilune.write_bop(sim, range(1), out, threads=1)
        entry = json.loads((out / "dataset_info.json").read_text())["channels"]["semantic"]
        assert kind in entry.values()
        found, truth = read(out / "train/000000", "semantic", entry), sim.frame(0)["semantic"]
        np.testing.assert_array_equal(found.reshape(72, 96, -1)[..., : len(levels)], truth)
        assert check_bop(out).findings == []


def test_same_bytes_in_parts_and_the_check_passes(dataset, sim, tmp_path):
    assert check_bop(dataset).findings == []
    out = tmp_path / "out"
    perilune.write_bop(sim, range(1), out, threads=2)
    perilune.write_bop(sim, range(2), out, threads=2)
    for path in dataset.rglob("*"):
        if path.is_file():
            assert path.read_bytes() == (out / path.relative_to(dataset)).read_bytes(), path
    (out / "train/000000/normal/000001.npy").unlink()
    report = perilune.write_bop(sim, range(2), out, threads=2)
    assert (report.written, report.kept) == (1, 1)


@pytest.mark.parametrize(
    ("name", "change", "told"),
    [
        ("range/000000.npy", lambda data: data[:-4], "is no NPY file"),
        ("range/000000.npy", lambda data: data.replace(b"<f4", b"<i4"), "must be float32"),
        ("normal/000000.npy", lambda data: data.replace(b"72, 96", b"96, 72"), "must be 72 x 96"),
        ("instance/000000.png", lambda data: data[: len(data) // 2], "chunk"),
        ("part/000000.png", None, "is missing"),
        ("semantic/000009.png", b"", "is not part of the dataset"),
    ],
)
def test_the_check_tells_faults(dataset, tmp_path, name, change, told):
    out = tmp_path / "out"
    shutil.copytree(dataset, out)
    path = out / "train/000000" / name
    if change is None:
        path.unlink()
    else:
        path.write_bytes(change(path.read_bytes()) if callable(change) else change)
    findings = check_bop(out).findings
    assert any(finding.file.endswith(name) and told in finding.reason for finding in findings)
