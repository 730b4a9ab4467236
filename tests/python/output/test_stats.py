"""`perilune stats`: distributions against the labels, read and reduced here once more."""

from __future__ import annotations

import json

import numpy as np
import pytest
from tests.python import command_line

import perilune


@pytest.fixture(scope="module")
def dataset(small_scene, crowd, tmp_path_factory):
    out = tmp_path_factory.mktemp("stats") / "crowd"
    sim = perilune.open(small_scene, overrides=crowd)
    perilune.write_bop(sim, range(7), out, chunk_size=4, threads=1)
    return out


def command(*words):
    return command_line.command("stats", *words)


def test_distributions_are_those_of_the_labels(dataset):
    done = command(dataset, "--json")
    assert done.returncode == 0, done.stderr
    found = json.loads(done.stdout)
    assert (found["scenes"], found["images"], found["instances"]) == (2, 7, 21)
    distances, fractions = [], []
    for scene in sorted((dataset / "train").iterdir()):
        poses = json.loads((scene / "scene_gt.json").read_text())
        infos = json.loads((scene / "scene_gt_info.json").read_text())
        for key, rows in poses.items():
            for gt, info in zip(rows, infos[key], strict=True):
                if gt["obj_id"] == 5:
                    distances.append(np.linalg.norm(gt["cam_t_m2c"]) / 1e3)
                    fractions.append(info["visib_fract"])
    row = found["objects"]["5"]
    assert row["instances"] == len(distances) == 14
    assert row["distance_m"]["q0"] == pytest.approx(min(distances))
    assert row["distance_m"]["q50"] == pytest.approx(np.median(distances))
    assert row["visib_fract"]["mean"] == pytest.approx(np.mean(fractions))
    assert row["visib_fract"]["q100"] == max(fractions)
    assert found["objects"]["7"]["visible_px"]["q100"] == 0.0


def test_table_and_errors(dataset, tmp_path):
    done = command(dataset)
    assert done.returncode == 0, done.stderr
    assert "object 5: 14 instances" in done.stdout
    assert {"distance_m", "off_axis_deg", "visib_fract"} <= set(done.stdout.split())
    done = command(tmp_path)
    assert done.returncode == 1
    assert "dataset_info.json: No such file" in done.stderr
