"""What is asked for and not met: classes that no part has, a target that no frame shows."""

from __future__ import annotations

import warnings

import pytest

import perilune
from perilune.config.errors import ConfigWarning
from perilune.export.check import check_bop

SMALL = {"camera.width": 32, "camera.height": 24, "render.samples": 1}
CLASSES = {"bus": ["bus*"], "panel": ["pannel*", "bus_fr*"]}


def warned(made):
    with warnings.catch_warnings(record=True) as found:
        warnings.simplefilter("always")
        made()
    return [str(row.message) for row in found if issubclass(row.category, ConfigWarning)]


def test_part_classes_that_fit_nothing(scene_file, tmp_path):
    changes = {"spacecraft.sat.part_classes": CLASSES, "labels.part_classes": {"dish": ["dsh*"]}}
    sim = perilune.open(scene_file, overrides={**SMALL, **changes})
    texts = warned(lambda: [sim.frame(0), sim.frame(1)])
    assert len(texts) == 2
    assert "spacecraft.sat.part_classes.panel: 'pannel*' fits no part" in texts[0]
    assert "labels.part_classes.dish: no part of any spacecraft fits 'dsh*'" in texts[1]
    with pytest.warns(ConfigWarning):
        perilune.open(scene_file, overrides={**SMALL, **changes}).frame(0)
    perilune.write_bop(sim, range(2), tmp_path / "set")
    reasons = [row.reason for row in check_bop(tmp_path / "set").findings]
    assert len(reasons) == 2
    assert reasons[0].startswith("spacecraft.sat.part_classes.panel: 'pannel*' fits no part")


AWAY = {"camera.trajectory": {
    "kind": "fixed", "target": "sat", "position_m": [15, 0, 0], "aim_offset_m": [30, 5, 0],
}}  # fmt: skip


def test_a_target_that_is_never_visible(scene_file, tmp_path):
    sim = perilune.open(scene_file, overrides={**SMALL, **AWAY})
    texts = warned(lambda: [sim.frame(index, ["objects"]) for index in range(12)])
    assert len(texts) == 1
    assert "camera.trajectory.target: 'sat' is visible in none of the first 8 frames" in texts[0]
    perilune.write_bop(sim, range(2), tmp_path / "set")
    (finding,) = check_bop(tmp_path / "set").findings
    assert finding.reason == "camera.trajectory.target: 'sat' is visible in no image"


def test_nothing_is_said_of_a_good_one(scene_file):
    changes = {"spacecraft.sat.part_classes": {"bus": ["bus*"]}}
    sim = perilune.open(scene_file, overrides={**SMALL, **changes})
    assert warned(lambda: [sim.frame(index) for index in range(10)]) == []
