"""The check against what a dataset was made of: every planted fault is found, and no other."""

from __future__ import annotations

import shutil

import numpy as np
import pytest
from tests.python.output.conftest import write_probe
from tests.python.output.faults import read, write
from tests.python.output.planted import gamma, noisy, picture, with_tile
from tests.python.output.planted_table import (
    CAMERAS,
    DEPTHS,
    INFOS,
    MASKS,
    NEED_THE_CONFIGURATION,
    PLANTED,
    POSES,
    SHAPES,
)

import perilune
from perilune.export.check import check_bop
from perilune.export.check.findings import Report
from perilune.export.check.pictures import PictureCheck
from perilune.export.writers import merge_bop


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


def checked(sim, out, frames=range(3), rerender=1, **options):
    """The report on an untouched dataset."""
    perilune.write_bop(sim, frames, out, threads=1, **options)
    return check_bop(out, rerender=rerender)


def test_changed_replayed_and_driven_simulations_pass(small_scene, tmp_path):
    driven = {"camera.fov_deg": {"uniform": [30, 40]}}
    changed = perilune.open(small_scene).with_overrides({"camera.fov_deg": 30.0})
    replay = {"index": 1, "drivers": {"camera.fov_deg": 33.0}}
    replayed = perilune.open(small_scene, overrides=driven, replay=replay)
    assert checked(changed, tmp_path / "changed").findings == []
    assert checked(replayed, tmp_path / "replayed").findings == []


def test_few_samples_tell_faults_and_no_others(small_scene, tmp_path):
    """Frames are rendered in full only where few samples see that something is wrong."""
    channels = {"render.samples": 32, "render.channels": ["rgb", "radiance", "normal", "semantic"]}
    sim = perilune.open(small_scene, overrides=channels)
    out = tmp_path / "many"
    report = checked(sim, out, rerender=0)
    assert report.findings == []
    assert "colour of 0 of 3 images was rendered again in full, that of the others compared" in str(
        report
    )
    assert "radiance/ was compared in the images alone" in str(report)
    assert checked(sim, out, rerender=None).findings == []
    for name, change in {
        "mirrored": lambda c: c[:, ::-1],
        "black": np.zeros_like,
        "gamma": gamma(1.3),
        "noise": noisy,
        "swapped bands": lambda c: c[..., ::-1],
        "other frame": lambda c: read(out / "train/000000/rgb/000000.png"),
        "tile": with_tile,
    }.items():
        root = tmp_path / "bad"
        shutil.copytree(out, root)
        picture("rgb", change, image=1, scene="train/000000")(root)
        report = check_bop(root, rerender=0)
        assert [f.file for f in report.findings] == ["train/000000/rgb/000001.png"], name
        assert "colour of 1 of 3 images" in str(report.notes)
        shutil.rmtree(root)


def test_what_cannot_be_compared_is_said(small_scene, tmp_path):
    def still(world):
        return np.array([0.0, 0, 2e7, 0, 1, 0, 0])

    coded = perilune.open(small_scene, trajectory=still)
    report = checked(coded, tmp_path / "coded")
    assert report.findings == []
    assert "not made again for comparison: trajectory were functions given in code" in str(report)

    folder = tmp_path / "moved"
    shutil.copytree(small_scene.parent, folder)
    sim = perilune.open(folder / small_scene.name)
    report = checked(sim, tmp_path / "away")
    assert report.findings == []
    (folder / "probe.glb").unlink()
    report = check_bop(tmp_path / "away")
    assert report.findings == []
    assert "the configuration cannot be opened" in str(report.notes)
    assert "probe.glb" in str(report.notes)
    report = check_bop(tmp_path / "away", base=small_scene.parent)
    assert report.findings == []
    assert "made again; colour" in str(report.notes)

    write_probe(folder / "probe.glb", wing=2.0)
    report = check_bop(tmp_path / "away")
    assert report.findings == []
    assert "no longer those that files_sha256" in str(report.notes)


def test_rays_against_the_models_find_faults_without_a_configuration(good, tmp_path):
    """All but these of the faults of cameras, poses, masks, depth and models."""
    assert check_bop(good, alone=True).findings == []
    tables = {**CAMERAS, **POSES, **INFOS, **MASKS, **DEPTHS, **SHAPES}
    missed = set()
    for name, (mutate, _, _) in tables.items():
        root = tmp_path / "crowd"
        shutil.copytree(good, root)
        mutate(root)
        if not check_bop(root, alone=True).findings:
            missed.add(name)
        shutil.rmtree(root)
    assert missed == NEED_THE_CONFIGURATION


LENS = {"model": "brown_conrady", "k1": -0.1, "k2": 0.02, "labels": "undistorted"}
SENSORS = {
    "sensors": {"left": {}, "right": {"transformation": [0.5, 0, 0, 1, 0, 0, 0], "focal_px": 140}}
}
UNTOUCHED = {
    "lens": {"camera.lens": LENS},
    "blur": {"camera.exposure_time_s": 0.5},
    "out of focus": {"camera.lens": {"focus_distance_m": 3.0, "aperture_mm": 50.0}},
    "sensors": {**SENSORS, "camera.sensor": {}, "render.channels": ["sensor_rgb", "raw"]},
    "rolling": {
        "camera.line_time_us": 20000.0,
        "camera.exposure_time_s": 0.1,
        "spacecraft.probe.attitude": {"spin_rate_deg_s": 40.0},
        "render.tolerance_dn": 0.0,
    },
    "large": {"camera.width": 300, "camera.height": 20},
    "one pixel": {"camera.width": 1, "camera.height": 1},
    "narrow": {"camera.fov_deg": 0.05, "camera.trajectory.distance_m": [5e3, 9e3]},
}


@pytest.mark.parametrize("name", UNTOUCHED)
def test_untouched_sets_have_no_finding(small_scene, pair, tmp_path, name):
    sim = perilune.open(small_scene, overrides={**pair, "render.samples": 8, **UNTOUCHED[name]})
    report = checked(sim, tmp_path / "out", split="val", chunk_size=2)
    assert report.findings == []
    assert any("made again" in note for note in report.notes)
    alone = check_bop(tmp_path / "out", alone=True)
    assert (alone.findings, alone.notes) == ([], [])


def test_merged_shards_have_no_finding(small_scene, pair, tmp_path):
    sim = perilune.open(small_scene, overrides=pair)
    for k in range(2):
        perilune.write_bop(sim, range(5), tmp_path / f"{k}", chunk_size=2, shard=(k, 2))
    merge_bop([tmp_path / "0", tmp_path / "1"], tmp_path / "out")
    report = check_bop(tmp_path / "out")
    assert report.findings == []
    assert (report.scenes, report.images) == (3, 5)


def boxed(size, column):
    """A picture of a bright box on a dark field, and its mask."""
    mask = np.zeros(size, dtype=bool)
    mask[10:30, column : column + 16] = True
    return np.where(mask[..., None], 200, 20).repeat(3, axis=2).astype(np.uint8), mask


def test_pictures_of_other_images_are_told_without_a_configuration(good, tmp_path):
    root = tmp_path / "looks"
    for k, column in enumerate((5, 40)):
        image, mask = boxed((64, 80), column)
        for folder, array in (("rgb", image), ("mask_visib", mask.astype(np.uint8) * 255)):
            path = root / f"test/000000/{folder}" / f"{k:06d}{'_000000' * (folder != 'rgb')}.png"
            path.parent.mkdir(parents=True, exist_ok=True)
            write(path, array)
    (root / "test/000000/scene_gt.json").write_text('{"0": [{"x": 1}], "1": [{"x": 2}]}')

    def told():
        report = Report(root)
        PictureCheck(report).scene(root / "test/000000")
        return [(f.file[-10:], f.reason) for f in report.findings]

    assert told() == []
    picture("rgb", lambda c: c[:, ::-1], image=0)(root)
    assert told() == [
        (
            "000000.png",
            "edges are not those of the masks, but they would be if it were mirrored left to right",
        )
    ]
    shutil.copy(root / "test/000000/rgb/000001.png", root / "test/000000/rgb/000000.png")
    assert told() == [
        (
            "000001.png",
            "is the same picture as test/000000/rgb/000000.png, where the poses are others",
        ),
        ("000000.png", "edges are not those of the masks, but of those of image 000001"),
    ]

    copied = tmp_path / "crowd"
    shutil.copytree(good, copied)
    rgb = copied / "test/000000/rgb"
    shutil.copy(rgb / "000001.png", rgb / "000002.png")
    assert "is the same picture as" in str(check_bop(copied, alone=True).findings)
