"""The commands as a shell sees them: output, exit codes, one clear message for an error."""

from __future__ import annotations

import json
import os
import resource
import shutil
import signal
import subprocess
import sys
import time

import pytest
from tests.python.command_line import command

import perilune
from perilune.cli.options import frame_range
from perilune.cli.text_table import text_table


def start(*words, **options):
    return subprocess.Popen(
        [sys.executable, "-m", "perilune", *map(str, words)],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        **options,
    )


def shell(*words, **options):
    """(exit code, standard output, standard error) of a process of its own."""
    process = start(*words, **options)
    out, err = process.communicate(timeout=120)
    return process.returncode, out, err


def run(*words):
    """(exit code, standard output, standard error) in this process."""
    done = command(*words)
    return done.returncode, done.stdout, done.stderr


def failed(*words, code=1, run=run):
    """The message of a command that must fail, without traceback."""
    found, out, err = run(*words)
    assert found == code, err
    assert "Traceback" not in err
    assert out == ""
    return err


def render(scene, out, *more, run=run, **options):
    return run("render", scene, "--out", out, "--threads", 1, *more, **options)


def test_a_shell_gets_the_same_as_this_process(small_scene, tmp_path):
    """Every other test here may ask in this process, where exit codes and texts are these."""
    for words, code in (
        (["plan", small_scene, "--json"], 0),
        (["plan", "nothing.yaml"], 1),
        (["plan", small_scene, "--set", "spacecraft.probe.model=none.glb"], 1),
        (["rendr"], 2),
    ):
        assert shell(*words) == run(*words)
        assert run(*words)[0] == code
    code, text, _ = render(small_scene, tmp_path / "a", "--frames", "0:1", run=shell)
    assert (code, text.split(",")[0]) == (0, f"{tmp_path / 'a'}: 1 frames written")
    assert run("check", tmp_path / "a")[0] == 0


def test_render_writes_and_continues(small_scene, tmp_path):
    out = tmp_path / "set"
    code, text, _ = render(small_scene, out, "--frames", "0:3", "--chunk-size", 2)
    assert code == 0
    assert text.startswith(f"{out}: 3 frames written, 0 kept")
    assert "images/s" in text
    assert (out / "train" / "000001" / "scene_gt.json").exists()
    code, text, _ = render(small_scene, out, "--frames", "0:4", "--chunk-size", 2)
    assert code == 0
    assert "1 frames written, 3 kept" in text


def test_a_single_number_of_frames_is_told_to_be_one(small_scene, tmp_path):
    """Taken for a count by all who tried it first."""
    code, text, told = render(small_scene, tmp_path / "set", "--frames", "3")
    assert (code, "1 frames written" in text) == (0, True)
    assert "frame 3 alone; the first 3 are 0:3" in told
    told = render(small_scene, tmp_path / "many", "--frames", "0:1")[2]
    assert "alone" not in told


def test_seed_and_set_change_the_frames(small_scene, tmp_path):
    for name, words in (("a", []), ("b", ["--seed", 9]), ("c", ["--set", "camera.fov_deg=50"])):
        assert render(small_scene, tmp_path / name, "--frames", 0, *words)[0] == 0
    files = [tmp_path / k / "train" / "000000" / "scene_camera.json" for k in "abc"]
    cameras = [json.loads(file.read_text())["0"] for file in files]
    assert cameras[0]["cam_t_w2c"] != cameras[1]["cam_t_w2c"]
    assert cameras[0]["cam_K"] == cameras[1]["cam_K"] != cameras[2]["cam_K"]


def test_preview_writes_a_sheet(small_scene, tmp_path):
    out = tmp_path / "sheet.png"
    code, text, _ = run("preview", small_scene, "--frame", 2, "--out", out)
    assert (code, text.strip()) == (0, str(out))
    assert out.read_bytes().startswith(b"\x89PNG")


def test_plan_as_json_and_as_table(small_scene):
    code, text, _ = run("plan", small_scene, "--frame", 1, "--json")
    assert code == 0
    document = json.loads(text)
    effects = document["effects"]
    rows = perilune.open(small_scene).plan(1)
    assert [row["name"] for row in effects] == [row["name"] for row in rows]
    for effect, row in zip(effects, rows, strict=True):
        assert effect == dict(row)  # the scene has no bound that is infinite
    assert document["spent_dn"] == sum(row["spent_dn"] for row in rows)
    code, text, _ = run("plan", small_scene, "--frame", 1)
    assert code == 0
    head, *lines, told, quality = text.splitlines()
    assert [line.split()[0] for line in lines] == [row["name"] for row in rows]
    column = head.index("reason")
    assert all(line[column:] == row["reason"] for line, row in zip(lines, rows, strict=True))
    assert told == perilune.open(small_scene).plan(1, predict=True).text
    assert document["quality"] == "adaptive"
    assert quality.startswith("quality: adaptive (")


def test_plan_measures(small_scene):
    quick = ("--set", "render.samples=1", "--set", "camera.width=8", "--set", "camera.height=6")
    code, text, _ = run("plan", small_scene, "--measure", "--json", "--threads", 1, *quick)
    assert code == 0
    for row in json.loads(text)["effects"]:
        assert ("measured_ms" in row) is (row["ceiling"] > 0)
    code, text, _ = run("plan", small_scene, "--measure", *quick)
    assert code == 0
    assert "takes changes 99.9 % reason" in " ".join(text.splitlines()[0].split())
    assert "measured twice" in text


def test_info_names_versions_and_data(tmp_path, monkeypatch):
    monkeypatch.setenv("PERILUNE_DATA", str(tmp_path))
    code, text, _ = run("info", "--json")
    assert code == 0
    facts = json.loads(text)
    assert {"perilune", "embree", "instruction_set", "threads", "PERILUNE_DATA"} <= set(facts)
    assert facts["PERILUNE_DATA"] == str(tmp_path)
    monkeypatch.setenv("PERILUNE_DATA", str(tmp_path / "none"))
    assert "no such folder" in run("info")[1]
    monkeypatch.delenv("PERILUNE_DATA")
    assert "not set" in run("info")[1]


def test_errors_are_one_message(small_scene, tmp_path):
    assert "nothing.yaml" in failed("plan", "nothing.yaml")
    text = failed("plan", small_scene, "--set", "camera.widht=3")
    assert "camera.widht" in text
    assert "'width'" in text
    assert "key=value" in failed("plan", small_scene, "--set", "camera")
    assert ".png" in failed("preview", small_scene, "--out", tmp_path / "sheet.tif")
    blocker = tmp_path / "file"
    blocker.write_text("")
    text = failed("render", small_scene, "--frames", "0:1", "--out", blocker / "set")
    assert str(blocker) in text
    assert len(text.splitlines()) == 1
    assert "cannot be written to" in text
    text = failed("render", small_scene, "--frames", "0:1", "--out", blocker)
    assert f"{blocker}: cannot be written to: a file stands there" in text
    text = failed("render", small_scene, "--frames", 0, "--split", "Test", "--out", tmp_path / "s")
    assert "split: 'Test' must be lower-case" in text


def test_missing_model_leaves_no_folder(small_scene, tmp_path):
    words = ["--frames", 0, "--set", "spacecraft.probe.model=none.glb", "--out", tmp_path / "set"]
    assert "none.glb" in failed("render", small_scene, *words)
    assert not (tmp_path / "set").exists()


def test_debug_shows_the_traceback():
    code, _, err = shell("plan", "nothing.yaml", "--debug")
    assert code == 1
    assert "Traceback" in err


@pytest.mark.parametrize(
    ("words", "named"),
    [
        ([], "COMMAND"),
        (["rendr"], "rendr"),
        (["render", "x.yaml", "--out", "o"], "--frames"),
        (["render", "x.yaml", "--out", "o", "--frames", "5:5"], "no frame"),
        (["render", "x.yaml", "--out", "o", "--frames", "0:1", "--format", "cocoa"], "cocoa"),
        (["render", "x.yaml", "--out", "o", "--frames", "0", "--format", "bpo"], "mean 'bop'?"),
        (["render", "x.yaml", "--out", "o", "--frames", "0", "--shard", "1"], "K/N"),
        (["render", "x.yaml", "--out", "o", "--frames", "0:5000000000"], "2147483647"),
        (["preview", "x.yaml", "--out", "o", "--frame", "5000000000"], "too large"),
        (["render", "x.yaml", "--out", "o", "--frames", "0:1", "--threads", "0"], "too small"),
        (["plan", "x.yaml", "--frame", "one"], "whole number"),
    ],
)
def test_wrong_usage_is_code_two(words, named):
    assert named in failed(*words, code=2)


@pytest.mark.parametrize(
    ("text", "frames"),
    [("7", range(7, 8)), ("0:20", range(20)), (":3", range(3)), ("2:9:3", range(2, 9, 3))],
)
def test_frame_ranges(text, frames):
    assert frame_range(text) == frames


@pytest.mark.parametrize("text", ["", "a", "1:", "1:2:3:4", "-1:3", "3:1", "0:5:0", "0:5:-1"])
def test_faulty_frame_ranges(text):
    with pytest.raises(Exception, match=r"none of|no frame|start at 0"):
        frame_range(text)


def interrupted(small_scene, out):
    """Starts a long run and stops it by ctrl-C after some frames."""
    process = start(
        "render",
        small_scene,
        "--frames",
        "0:100000",
        "--out",
        out,
        "--threads",
        1,
        "--format",
        "bop",
    )
    partial = out / "train" / "000000" / ".partial"
    try:
        deadline = time.monotonic() + 60
        while time.monotonic() < deadline and len(list(partial.glob("*.json"))) < 3:
            assert process.poll() is None, process.communicate()
            time.sleep(0.02)
        process.send_signal(signal.SIGINT)
        return (process, *process.communicate(timeout=60))
    finally:
        process.kill()


def test_ctrl_c_leaves_a_folder_that_continues(small_scene, tmp_path):
    out, whole = tmp_path / "set", tmp_path / "whole"
    process, _, err = interrupted(small_scene, out)
    assert process.returncode == 130
    assert "Traceback" not in err
    assert "interrupted" in err
    assert not list(out.rglob("*.tmp"))
    code, text, _ = render(small_scene, out, "--frames", "0:5")
    assert code == 0
    assert "5 frames written, 0 kept" not in text
    assert render(small_scene, whole, "--frames", "0:5")[0] == 0
    for name in ("scene_gt.json", "scene_camera.json"):
        done = json.loads((out / "train" / "000000" / name).read_text())
        fresh = json.loads((whole / "train" / "000000" / name).read_text())
        assert {key: done[key] for key in fresh} == fresh


LIMIT = 4000
"""Bytes: less than a picture. Models are larger, and written before."""


def limit_file_size():
    resource.setrlimit(resource.RLIMIT_FSIZE, (LIMIT, LIMIT))


def test_full_disk_is_a_message_and_leaves_no_half_file(small_scene, tmp_path):
    """A limit on file size stands for the full disk: write fails in the middle of a PNG."""
    out = tmp_path / "set"
    words = ["--frames", "0:3", "--set", "camera.width=640", "--set", "camera.height=480"]
    assert render(small_scene, out, *words)[0] == 0
    shutil.rmtree(out / "train")
    # Python would write its compiled modules cut short, and later processes would read them.
    environment = os.environ | {"PYTHONDONTWRITEBYTECODE": "1"}
    limited = {"preexec_fn": limit_file_size, "env": environment}
    code, _, err = render(small_scene, out, *words, run=shell, **limited)
    assert code == 1
    assert "Traceback" not in err
    assert ".png: cannot be written" in err
    assert not list(out.rglob("*.tmp"))
    assert not list(out.rglob("scene_gt.json"))
    assert render(small_scene, out, *words)[0] == 0
    assert max(path.stat().st_size for path in out.rglob("*.png")) > LIMIT


def test_reader_that_leaves_is_no_error(small_scene):
    process = start("plan", small_scene)
    process.stdout.close()
    assert "Traceback" not in process.stderr.read()
    assert process.wait(timeout=60) in (0, 1)


def test_tables_leave_texts_as_they_are():
    rows = [["bus", "1e3", ""], ["a/long_name", "-0.50", "007"]]
    assert text_table(["part", "size", "class"], rows, ["size"]).split("\n") == [
        "part          size  class",
        "bus            1e3",
        "a/long_name  -0.50  007",
    ]
    assert text_table(["part", "size"], [], ["size"]) == "part  size"
