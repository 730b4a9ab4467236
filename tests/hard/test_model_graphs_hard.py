"""Graphs in models by the ill-meaning: functions, files elsewhere, size, depth, broken values."""

from __future__ import annotations

import struct
from pathlib import Path
from typing import Any

import pytest
from tests.python.model_files import changed_glb, with_graphs

import perilune
from perilune.config.errors import ConfigError

SCENE = Path(__file__).parents[1] / "python" / "scene.yaml"
SKIN = {"type": "lambert"}


def refused(model: Path) -> str:
    with pytest.raises(ConfigError) as error:
        perilune.open(SCENE, overrides={"spacecraft.sat.model": str(model)})
    return str(error.value)


def test_a_model_names_no_function(tmp_path: Path) -> None:
    hook = {"hook": "os:getcwd", "ideal": 0.5}
    graph = {"nodes": {"skin": {**SKIN, "base_color": [hook, 0, 0]}}}
    text = refused(with_graphs(tmp_path / "sat.glb", mli_gold=graph))
    assert "nodes.skin.base_color[0].hook: a model's file names no function" in text


ELSEWHERE = ["../secret.png", "/etc/passwd", "data:a.png", "link/a.png", "a\0b"]


@pytest.mark.parametrize("file", ELSEWHERE)
def test_images_stay_in_the_models_folder(tmp_path: Path, file: str) -> None:
    folder = tmp_path / "model"
    folder.mkdir()
    (folder / "link").symlink_to(tmp_path)
    nodes = {"i": {"type": "image", "file": file}, "skin": {**SKIN, "base_color": "i"}}
    text = refused(with_graphs(folder / "sat.glb", mli_gold={"nodes": nodes}))
    assert "nodes.i.file: " in text
    assert "lies outside the model's folder" in text


def test_size_and_depth_have_limits(tmp_path: Path) -> None:
    many = {f"n{k}": {"type": "value", "value": k} for k in range(30_000)}
    text = refused(with_graphs(tmp_path / "sat.glb", mli_gold={"nodes": {**many, "skin": SKIN}}))
    assert "more than 1048576 bytes" in text
    few = {f"n{k}": {"type": "value", "value": k} for k in range(300)}
    text = refused(with_graphs(tmp_path / "sat.glb", mli_gold={"nodes": {**few, "skin": SKIN}}))
    assert "301 nodes: at most 256" in text
    for depth in (80, 5_000):  # beyond a configuration's, and beyond a model's
        graph = {"nodes": {"skin": {**SKIN, "x": "@"}}}
        model = with_graphs(tmp_path / "sat.glb", mli_gold=graph)
        text = refused(_with_text(model, '"@"', "[" * depth + "]" * depth))
        assert "nested" in text


def _with_text(path: Path, old: str, new: str) -> Path:
    """The text put in as it is, beyond what json.dumps would nest."""
    data = path.read_bytes()
    (length,) = struct.unpack_from("<I", data, 12)
    text = data[20 : 20 + length].replace(old.encode(), new.encode())
    text += b" " * (-len(text) % 4)
    chunks = struct.pack("<II", len(text), 0x4E4F534A) + text + data[20 + length :]
    path.write_bytes(struct.pack("<III", 0x46546C67, 2, 12 + len(chunks)) + chunks)
    return path


def test_names_that_cannot_be_told_apart(tmp_path: Path) -> None:
    def change(tree: dict[str, Any]) -> None:
        tree["materials"][0]["extras"] = {"perilune_graph": {"nodes": {"skin": SKIN}}}
        tree["materials"][1]["name"] = tree["materials"][0]["name"].upper()

    assert "another material is named" in refused(changed_glb(tmp_path / "sat.glb", change))


@pytest.mark.parametrize("name", ["[a]*?", "é\n", "0", "x" * 300])
def test_odd_names_of_materials(tmp_path: Path, name: str) -> None:
    def change(tree: dict[str, Any]) -> None:
        tree["materials"][0]["extras"] = {"perilune_graph": {"nodes": {"skin": SKIN}}}
        tree["materials"][0]["name"] = name

    model = changed_glb(tmp_path / "3 sat.glb", change)
    sim = perilune.open(SCENE, overrides={"spacecraft.sat.model": str(model)})
    placed = sim._mine().assignments.of(sim.config).crafts["sat"]
    assert (placed.triangle_graph == 0).sum() > 0
