"""Materials in files of their own: what stands beside the key, errors, drivers, where they are."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml

import perilune
from perilune.config.errors import ConfigError
from perilune.document.loader import read_tree
from perilune.document.material_files import merged

SCENE = Path(__file__).parent / "scene.yaml"
DRIVER = {"ideal": 0.5, "jitter_variance": 0.1, "clip_min": 0.2, "clip_max": 0.9}
PAINT: dict[str, Any] = {
    "doc": "Two stripes.",
    "nodes": {
        "where": {"type": "coordinates"},
        "along": {"type": "vector_math", "function": "dot", "a": "where", "b": [0, 0, 12.0]},
        "wave": {"type": "math", "function": "sine", "a": "along.value"},
        "skin": {"type": "principled", "base_color": "wave", "roughness": DRIVER},
    },
    "surface": "skin",
}
USES = [{"material": "*", "use": "m"}]


def opened(material: dict[str, Any], **more: Any) -> perilune.Simulation:
    changes = {"materials": {"m": material}, "spacecraft.sat.materials": USES}
    return perilune.open(SCENE, overrides={**changes, **more})


def written(folder: Path, tree: Any, name: str = "paint.yaml") -> str:
    """The path of a file of a material, as a configuration may give it."""
    path = folder / name
    path.write_text(json.dumps(tree) if name.endswith(".json") else yaml.safe_dump(tree))
    return str(path)


@pytest.mark.parametrize("name", ["paint.yaml", "paint.json"])
def test_a_file_is_as_its_keys_in_place(tmp_path: Path, name: str) -> None:
    inside, outside = opened(PAINT), opened({"file": written(tmp_path, PAINT, name)})
    assert outside.document.tree == inside.document.tree
    assert [row.name for row in outside.document.drivers] == ["materials.m.nodes.skin.roughness"]
    assert np.array_equal(inside[1]["rgb"], outside[1]["rgb"])


def test_keys_beside_a_file_replace_its_own(tmp_path: Path) -> None:
    beside = {
        "file": written(tmp_path, PAINT),
        "nodes": {
            "along": {"b": [9, 0, 0]},
            "wave": {"type": "value", "value": 0.3},
            "other": {"type": "lambert"},
        },
    }
    sim = opened(beside, **{"materials.m.nodes.skin.roughness": 0.25})
    nodes = sim.config.materials["m"].nodes
    assert nodes["along"] == {**PAINT["nodes"]["along"], "b": [9, 0, 0]}
    assert nodes["wave"] == {"type": "value", "value": 0.3}  # of another type: nothing is left
    assert nodes["skin"] == {"type": "principled", "base_color": "wave", "roughness": 0.25}
    assert list(nodes) == ["along", "skin", "wave", "where", "other"]  # the file's, by name
    assert sim.config.materials["m"].doc == PAINT["doc"]
    assert not sim.document.drivers


def test_drivers_of_a_file_merge_by_their_keys() -> None:
    held = {"drivers": {"drivers": {"a": DRIVER, "b": DRIVER}, "jitter_strength": 1.0}}
    beside = {
        "drivers": {
            "drivers": {"a": {"clip_max": 0.7}, "b": {"uniform": [0, 1]}},
            "step_interval": 2,
        }
    }
    assert merged(held, beside) == {
        "drivers": {
            "drivers": {"a": {**DRIVER, "clip_max": 0.7}, "b": {"uniform": [0, 1]}},
            "jitter_strength": 1.0,
            "step_interval": 2,
        }
    }


def test_a_path_is_relative_to_the_configuration_or_below_the_data(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "deep").mkdir()
    written(tmp_path, PAINT)
    tree = read_tree(SCENE)
    tree["spacecraft"]["sat"]["materials"] = USES
    monkeypatch.setenv("PERILUNE_DATA", str(tmp_path))
    for text in ("../paint.yaml", "data:paint.yaml"):
        tree["materials"] = {"m": {"file": text}}
        sim = perilune.open(tree, base=tmp_path / "deep")
        assert set(sim.config.materials["m"].nodes) == set(PAINT["nodes"])


def faulty(node: str, **keys: Any) -> dict[str, Any]:
    return {**PAINT, "nodes": {**PAINT["nodes"], node: {**PAINT["nodes"].get(node, {}), **keys}}}


@pytest.mark.parametrize(
    ("tree", "texts"),
    [
        (faulty("skin", rough=1), ["paint.yaml: nodes.skin.rough (here: materials.m.nodes.skin.r"]),
        (faulty("skin", roughness="wav"), ["paint.yaml: nodes.skin.roughness", "no node 'wav'"]),
        (faulty("1x", type="value"), ["paint.yaml: nodes", "a node's name is letters"]),
        (faulty("new", value=1), ["paint.yaml: nodes.new", "type", "required, but missing"]),
        (faulty("along", b="wave"), ["materials.m: nodes form a cycle"]),
        ({**PAINT, "node": {}}, ["paint.yaml: node (here: materials.m.node)"]),
        ({**PAINT, "surface": "ski"}, ["paint.yaml: surface", "no surface 'ski'; did you mean"]),
        ({"doc": "none"}, ["materials.m.nodes: required, but missing"]),
        ({"file": "paint.yaml"}, ["paint.yaml:", "names no other file"]),
        ([1, 2], ["paint.yaml: must be a mapping"]),
    ],
)
def test_errors_name_the_file_and_its_key(tmp_path: Path, tree: Any, texts: list[str]) -> None:
    with pytest.raises(ConfigError) as error:
        opened({"file": written(tmp_path, tree)})
    for text in texts:
        assert text in str(error.value)


def test_errors_of_keys_beside_a_file_are_not_the_files(tmp_path: Path) -> None:
    beside = {"file": written(tmp_path, PAINT), "nodes": {"skin": {"metallic": "x"}}}
    with pytest.raises(ConfigError) as error:
        opened(beside)
    assert "\n  materials.m.nodes.skin.metallic: no node 'x'" in str(error.value)


def test_errors_of_the_path_name_the_key(tmp_path: Path) -> None:
    with pytest.raises(FileNotFoundError, match=r"materials\.m\.file: no such file: .*gone\.yaml"):
        opened({"file": "gone.yaml"})
    with pytest.raises(ConfigError, match=r"materials\.m\.file: must be the path of a file, not 3"):
        opened({"file": 3})
    (tmp_path / "bad.yaml").write_text("nodes: [")
    with pytest.raises(ConfigError, match=r"bad\.yaml: line 1"):
        opened({"file": str(tmp_path / "bad.yaml")})
