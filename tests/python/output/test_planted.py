"""The check against what a dataset was made of: every planted fault is found, and no other."""

from __future__ import annotations

import shutil

import pytest
from tests.python.output.planted_table import PLANTED

import perilune
from perilune.check import check_bop


@pytest.fixture(scope="module")
def good(small_scene, crowd, tmp_path_factory):
    sim = perilune.open(small_scene, overrides=crowd)
    out = tmp_path_factory.mktemp("planted") / "crowd"
    perilune.write_bop(sim, range(6), out, chunk_size=3, threads=1, split="test")
    return out


def test_good_dataset_has_no_finding(good):
    report = check_bop(good)
    assert report.findings == []
    assert "colour of all 6 of 6 images was rendered again in full" in report.notes[0]


@pytest.mark.parametrize("name", PLANTED)
def test_fault_is_found(good, tmp_path, name):
    mutate, file, reason = PLANTED[name]
    root = tmp_path / "crowd"
    shutil.copytree(good, root)
    mutate(root)
    findings = check_bop(root).findings
    assert any(file in f.file and reason in f.reason for f in findings), findings
