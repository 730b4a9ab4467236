"""Shards and their merge: the same bytes as one run, and nothing missing goes unnoticed."""

from __future__ import annotations

import hashlib
import shutil

import pytest
from tests.python.command_line import command

import perilune
from perilune.export.check import check_bop
from perilune.export.writers import merge_bop
from perilune.export.writers.shards import chunks, shard_chunks

FRAMES = range(1, 12, 2)  # images 1, 3, 5 of scene 0, then 1, 3, 5 of scene 1
CHUNK = 6
COUNT = 2


def tree_bytes(folder):
    return {
        path.relative_to(folder).as_posix(): hashlib.sha256(path.read_bytes()).hexdigest()
        for path in sorted(folder.rglob("*"))
        if path.is_file()
    }


@pytest.fixture(scope="module")
def sim(small_scene, crowd):
    return perilune.open(small_scene, overrides=crowd)


def write(sim, out, frames=FRAMES, **options):
    return perilune.write_bop(
        sim, frames, out, chunk_size=CHUNK, threads=1, split="test", **options
    )


@pytest.fixture(scope="module")
def whole(sim, tmp_path_factory):
    out = tmp_path_factory.mktemp("whole") / "set"
    write(sim, out)
    return tree_bytes(out)


@pytest.fixture
def shards(sim, tmp_path):
    """Folders of the two shards."""
    folders = [tmp_path / f"shard{k}" for k in range(COUNT)]
    for k, folder in enumerate(folders):
        report = write(sim, folder, shard=(k, COUNT))
        assert report.written == 3
    return folders


def test_shards_split_at_chunks_and_hold_everything():
    frames = range(3, 95)
    for count in (1, 2, 3, 7, 12):
        parts = [shard_chunks(frames, 10, (k, count)) for k in range(count)]
        joined = {scene: images for part in parts for scene, images in part.items()}
        assert joined == chunks(frames, 10)
        assert sum(map(len, parts)) == len(joined)
        assert max(map(len, parts)) - min(map(len, parts)) <= 1


def test_one_folder_for_all_shards(sim, whole, tmp_path):
    out = tmp_path / "set"
    for k in reversed(range(COUNT)):
        write(sim, out, shard=(k, COUNT))
    assert any("merge" in finding.reason for finding in check_bop(out).findings)
    report = merge_bop([out])
    assert (report.scenes, report.images) == (2, 6)
    assert tree_bytes(out) == whole
    assert check_bop(out).findings == []


def test_a_folder_for_each_shard(shards, whole, tmp_path):
    out = tmp_path / "set"
    merge_bop(shards[::-1], out)
    assert tree_bytes(out) == whole
    assert merge_bop(shards, out).images == 6  # again: the same
    assert tree_bytes(out) == whole


def test_merge_goes_on_where_it_was_interrupted(shards, whole, tmp_path):
    out = tmp_path / "set"
    merge_bop(shards, out)
    shutil.rmtree(out / "test" / "000001")
    shutil.rmtree(out / "models")
    (out / "dataset_info.md").unlink()
    (out / ".merge" / "rgb").mkdir(parents=True)  # half of a scene, not under its name yet
    merge_bop(shards, out)
    assert tree_bytes(out) == whole
    assert not (out / ".merge").exists()


def test_more_shards_than_chunks_leave_some_empty(sim, whole, tmp_path):
    folders = [tmp_path / f"shard{k}" for k in range(3)]
    counts = [write(sim, f, shard=(k, 3)).written for k, f in enumerate(folders)]
    assert sorted(counts) == [0, 3, 3]
    merge_bop(folders, tmp_path / "set")
    assert tree_bytes(tmp_path / "set") == whole


def test_whole_datasets_of_other_frames_join(sim, whole, tmp_path):
    parts = [tmp_path / "a", tmp_path / "b"]
    write(sim, parts[0], range(1, 6, 2))
    write(sim, parts[1], range(7, 12, 2))
    merge_bop(parts, tmp_path / "set")
    assert tree_bytes(tmp_path / "set") == whole


def test_a_run_after_the_shards_completes_them(sim, shards, whole):
    report = write(sim, shards[0])
    assert (report.written, report.kept) == (3, 3)
    assert tree_bytes(shards[0]) == whole


def test_missing_shard_is_named(shards, tmp_path):
    with pytest.raises(ValueError, match=r"frames 1:12:2, 1/2 is missing"):
        merge_bop(shards[:1], tmp_path / "set")
    assert not (tmp_path / "set").exists()


def test_missing_scene_is_named(shards, tmp_path):
    shutil.rmtree(shards[1] / "test")
    with pytest.raises(ValueError, match=r"frame 7\) is missing; run --shard 1/2 again"):
        merge_bop(shards, tmp_path / "set")


def test_unfinished_scene_is_named(sim, shards, tmp_path):
    (shards[0] / "test" / "000000" / "scene_gt_coco.json").unlink()
    with pytest.raises(ValueError, match=r"000000: is not finished; run --shard 0/2 again"):
        merge_bop(shards, tmp_path / "set")
    write(sim, shards[0], shard=(0, COUNT))
    assert merge_bop(shards, tmp_path / "set").images == 6


def test_shards_of_other_sources_are_refused(small_scene, crowd, shards, tmp_path):
    other = perilune.open(small_scene, seed=9, overrides=crowd)
    write(other, tmp_path / "other", shard=(1, COUNT))
    with pytest.raises(ValueError, match=r"another dataset.*seed is 9"):
        merge_bop([shards[0], tmp_path / "other"], tmp_path / "set")


def test_folder_of_another_dataset_is_not_merged_into(sim, small_scene, crowd, shards, tmp_path):
    write(perilune.open(small_scene, seed=9, overrides=crowd), tmp_path / "set", range(1))
    before = tree_bytes(tmp_path / "set")
    with pytest.raises(ValueError, match="another dataset"):
        merge_bop(shards, tmp_path / "set")
    assert tree_bytes(tmp_path / "set") == before


def test_same_scene_with_other_images_is_refused(sim, tmp_path):
    parts = [tmp_path / "a", tmp_path / "b"]
    write(sim, parts[0], range(1))
    write(sim, parts[1], range(1, 2))
    with pytest.raises(ValueError, match="another scene"):
        merge_bop(parts, tmp_path / "set")


def test_no_dataset_and_no_folder_to_write_to(shards, tmp_path):
    with pytest.raises(FileNotFoundError, match="no dataset"):
        merge_bop([tmp_path])
    with pytest.raises(ValueError, match="--out"):
        merge_bop(shards)


def test_extended_dataset_has_no_card_until_it_is_whole(sim, tmp_path):
    out = tmp_path / "set"
    write(sim, out, range(2))

    class Stopped:
        def __getattr__(self, name):
            return getattr(sim, name)

        def frame(self, index, **options):
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        write(Stopped(), out, range(4))
    assert not (out / "dataset_info.md").exists()
    assert not (out / "test_targets_bop19.json").exists()
    assert any("not finished" in finding.reason for finding in check_bop(out).findings)


@pytest.mark.parametrize("shard", [(2, 2), (-1, 2), (0, 0)])
def test_bad_shards_are_refused(sim, tmp_path, shard):
    with pytest.raises(ValueError, match="shard"):
        write(sim, tmp_path / "set", shard=shard)
    assert not (tmp_path / "set").exists()


def test_commands(small_scene, tmp_path):
    words = ["--frames", "0:4", "--chunk-size", 2, "--threads", 1, "--split", "test"]
    folders = [tmp_path / "a", tmp_path / "b"]
    for k, folder in enumerate(folders):
        done = command("render", small_scene, *words, "--shard", f"{k}/2", "--out", folder)
        assert done.returncode == 0, done.stderr
    done = command("merge", *folders, "--out", tmp_path / "set")
    assert done.stdout == f"{tmp_path / 'set'}: 2 scenes, 4 images, complete\n", done.stderr
    done = command("render", small_scene, *words, "--out", tmp_path / "whole")
    assert tree_bytes(tmp_path / "set") == tree_bytes(tmp_path / "whole")
    done = command("merge", folders[1])
    assert done.returncode == 1
    assert "0/2 is missing" in done.stderr
    done = command("render", small_scene, *words, "--shard", "2/2", "--out", "x")
    assert done.returncode == 2
    assert "0 <= K < N" in done.stderr


def test_a_shard_without_frames_says_why(small_scene, tmp_path):
    words = ["--frames", "0:2", "--format", "bop"]
    done = command("render", small_scene, *words, "--shard", "0/2", "--out", tmp_path / "set")
    assert done.returncode == 0
    assert "0 frames written" in done.stdout
    assert "--shard 0/2 has no frames" in done.stderr
    assert "there are 1 of them; a --chunk-size below 1000" in done.stderr
