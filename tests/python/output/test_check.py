"""The check: silent on a good dataset, and it finds every one of many single faults."""

from __future__ import annotations

import json
import shutil

import pytest
from tests.python import command_line
from tests.python.output.faults import FAULTS, IMAGE

import perilune
from perilune.export.check import check_bop

CHUNK = 3
FRAMES = range(6)


@pytest.fixture(scope="module")
def good(small_scene, crowd, tmp_path_factory):
    sim = perilune.open(small_scene, overrides=crowd)
    out = tmp_path_factory.mktemp("check") / "crowd"
    perilune.write_bop(sim, FRAMES, out, chunk_size=CHUNK, threads=1, split="test")
    return out


def test_good_dataset_has_no_finding(good):
    report = check_bop(good)
    assert report.findings == []
    assert (report.scenes, report.images, report.instances) == (2, 6, 18)


@pytest.mark.parametrize("name", FAULTS)
def test_fault_is_found(good, tmp_path, name):
    mutate, file, reason = FAULTS[name]
    root = tmp_path / "crowd"
    shutil.copytree(good, root)
    mutate(root)
    findings = check_bop(root).findings
    assert any(file in f.file and reason in f.reason for f in findings), findings


def test_fault_of_a_model_is_told_once(good, tmp_path):
    root = tmp_path / "crowd"
    shutil.copytree(good, root)
    (root / "models" / "obj_000005.ply").unlink()
    assert [f.file for f in check_bop(root).findings] == ["models/obj_000005.ply"]


def command(*words):
    done = command_line.command("check", *words)
    assert "Traceback" not in done.stderr
    return done


def test_command_prints_findings_and_fails(good, tmp_path):
    done = command(good)
    assert done.returncode == 0
    note, told = done.stdout.splitlines()
    assert note.startswith("note: models and labels of all images were made again; colour of all 6")
    assert told == f"{good}: 2 scenes, 6 images, 18 instances; 0 findings"
    alone = f"{good}: 2 scenes, 6 images, 18 instances; 0 findings\n"
    assert command(good, "--alone").stdout.endswith(alone)
    root = tmp_path / "crowd"
    shutil.copytree(good, root)
    (root / IMAGE).unlink()
    done = command(root)
    assert done.returncode == 1
    assert done.stdout.splitlines()[0] == f"{IMAGE}: is missing"
    done = command(root, "--json")
    assert done.returncode == 1
    found = json.loads(done.stdout)
    assert found["findings"] == [{"file": IMAGE, "reason": "is missing"}]
    assert (found["images"], found["total"], found["more"]) == (6, 1, [])


def test_findings_of_one_cause_are_told_together(good, tmp_path):
    root = tmp_path / "crowd"
    shutil.copytree(good, root)
    for path in root.glob("test/*/mask/*.png"):
        path.unlink()
    done = command(root, "--alone")
    assert done.stdout.count("is missing") == 3
    assert "  and 15 findings more of this kind" in done.stdout
    assert done.stdout.endswith("18 findings\n")
    found = json.loads(command(root, "--alone", "--json").stdout)
    assert (len(found["findings"]), found["total"]) == (3, 18)
    assert [(row["reason"], row["count"]) for row in found["more"]] == [("is missing", 15)]


def test_folder_that_is_none(tmp_path):
    done = command(tmp_path / "none")
    assert done.returncode == 1
    assert "no such folder" in done.stderr
    assert command(tmp_path).returncode == 1


def test_images_without_any_spacecraft_are_a_good_dataset(small_scene, tmp_path):
    changes = {
        "spacecraft": None,
        "camera.trajectory": {
            "kind": "fixed",
            "target": "planet",
            "position_m": [1e7, 0.0, 0.0],
        },
    }
    sim = perilune.open(small_scene, overrides=changes)
    perilune.write_bop(sim, range(2), tmp_path / "empty", threads=1)
    report = check_bop(tmp_path / "empty")
    assert report.findings == []
    assert (report.images, report.instances) == (2, 0)
    assert json.loads((tmp_path / "empty/train/000000/scene_gt.json").read_text()) == {
        "0": [],
        "1": [],
    }
