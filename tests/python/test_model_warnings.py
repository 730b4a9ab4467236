"""What the reader of models clamps, repairs or leaves out, and that users hear of it."""

from __future__ import annotations

import copy
import json
import pickle
import subprocess
import sys
import warnings
from pathlib import Path

import numpy as np
import pytest
from tests.python.model_files import changed_glb

import perilune
from perilune import _core
from perilune.cli import main
from perilune.config.errors import ModelWarning
from perilune.document.loader import read_tree

POSITIONS = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], "<f4")
INDICES = np.array([0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3], "<u2")


def write(folder: Path, change=lambda tree: None, **attributes: np.ndarray) -> Path:
    """A tetrahedron as glTF, with more attributes of its four vertices."""
    arrays = {"POSITION": POSITIONS, **attributes, "indices": INDICES}
    data, views, accessors = b"", [], []
    for array in arrays.values():
        views.append({"buffer": 0, "byteOffset": len(data), "byteLength": array.nbytes})
        kind = "SCALAR" if array.ndim == 1 else f"VEC{array.shape[1]}"
        number = 5123 if array.dtype == np.dtype("<u2") else 5126
        view = len(accessors)
        accessors.append(
            {"bufferView": view, "componentType": number, "count": len(array), "type": kind}
        )
        data += array.tobytes()
    names = list(arrays)[:-1]
    primitive = {"attributes": {name: k for k, name in enumerate(names)}, "indices": len(names)}
    tree = {
        "asset": {"version": "2.0"},
        "scene": 0,
        "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0, "name": "body"}],
        "meshes": [{"primitives": [primitive | {"material": 0}]}],
        "materials": [{"name": "grey"}],
        "buffers": [{"uri": "data.bin", "byteLength": len(data)}],
        "bufferViews": views,
        "accessors": accessors,
    }
    change(tree)
    (folder / "data.bin").write_bytes(data)
    path = folder / "model.gltf"
    path.write_text(json.dumps(tree))
    return path


def colors(*rows):
    return np.array([*rows, *[[1, 1, 1, 1]] * (4 - len(rows))], "<f4")


def put(*path_and_value):
    """A change of the tree: the value at the path."""
    *path, last, value = path_and_value

    def change(tree):
        node = tree
        for key in path:
            node = node[key] if isinstance(node, list) else node.setdefault(key, {})
        node[last] = value

    return change


P = "meshes[0].primitives[0]"
IDENTITY = [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]
MATERIAL = ("materials", 0, "extensions")
CASES = {
    "colour above 1": (None, {"COLOR_0": colors([2, 0, 0, 1])}, f"{P}.COLOR_0: numbers are cl"),
    "colour below 0": (
        None,
        {"COLOR_0": colors([0, 0, -1, 1], [0, -2, 0, 1])},
        f"{P}.COLOR_0: numbers are clamped to 0..1",
    ),
    "colour without end": (
        None,
        {"COLOR_0": colors([np.inf, 0, 0, 1])},
        f"{P}.COLOR_0: numbers that are not finite count as 1",
    ),
    "coordinates": (
        None,
        {"TEXCOORD_0": np.array([[np.nan, 0], [0, 0], [1, 0], [0, 1]], "<f4")},
        f"{P}.TEXCOORD_0: numbers that are not finite count as 0",
    ),
    "second colours": (None, {"COLOR_1": colors()}, f"{P}: the attribute COLOR_1 is not read"),
    "matrix beside scale": (
        lambda tree: tree["nodes"][0].update(matrix=IDENTITY, scale=[2, 2, 2]),
        {},
        "nodes[0] has a matrix beside translation, rotation or scale",
    ),
    "two scenes": (put("scenes", [{"nodes": [0]}, {"nodes": []}]), {}, "scenes[0] is read, the 1"),
    "a mesh outside": (
        lambda tree: tree["nodes"].append({"mesh": 0}),
        {},
        "1 nodes with meshes are not in the scene and left out",
    ),
    "undeclared extension": (
        put(*MATERIAL, "KHR_materials_sheen", {}),
        {},
        "extension KHR_materials_sheen is not supported and ignored",
    ),
    "thickness": (
        put(*MATERIAL, "KHR_materials_volume", {"thicknessTexture": {"index": 0}}),
        {},
        "materials[0]: KHR_materials_volume: thicknessTexture is not read",
    ),
    "attenuation": (
        put(*MATERIAL, "KHR_materials_volume", {"attenuationColor": [2, 1, 1]}),
        {},
        "materials[0]: KHR_materials_volume: attenuationColor is clamped to 0..1",
    ),
    "factor": (
        put("materials", 0, "pbrMetallicRoughness", {"metallicFactor": 3}),
        {},
        "materials[0]: metallicFactor: 3 is clamped to 0..1",
    ),
    "unlit": (
        put(*MATERIAL, "KHR_materials_unlit", {}),
        {},
        "materials[0]: KHR_materials_unlit is not followed: the surface is lit",
    ),
    "morph targets": (
        put("meshes", 0, "primitives", 0, "targets", [{"POSITION": 0}]),
        {},
        f"{P}: morph targets are ignored",
    ),
    "weights": (
        put(
            "animations",
            [
                {
                    "samplers": [{"input": 0, "output": 0}],
                    "channels": [{"sampler": 0, "target": {"node": 0, "path": "weights"}}],
                }
            ],
        ),
        {},
        "animations[0] is left out: it moves no node of the scene",
    ),
    "skins": (put("skins", [{"joints": [0]}]), {}, "skins are ignored"),
}


@pytest.mark.parametrize("case", CASES)
def test_the_reader_says_what_it_changes(tmp_path, case):
    change, attributes, expected = CASES[case]
    path = write(tmp_path, change or (lambda tree: None), **attributes)
    told = _core.Model(str(path)).warnings
    assert any(line.startswith(expected) for line in told), told


def test_a_good_model_has_no_warning(tmp_path):
    extra = {"COLOR_0": colors([0, 0.5, 1, 1]), "_MINE": POSITIONS}
    assert _core.Model(str(write(tmp_path, **extra))).warnings == ()


@pytest.mark.parametrize("name", ["KHR_materials_ior", "KHR_materials_emissive_strength"])
def test_an_extension_that_is_no_object_is_refused(tmp_path, name):
    with pytest.raises(ValueError, match=rf"materials\[0\]\.extensions\.{name}: must be an object"):
        _core.Model(str(write(tmp_path, put(*MATERIAL, name, 1.5))))


@pytest.fixture
def scene(repo_dir, tmp_path):
    """A scene of two satellites of one model with a warning, in a file."""
    changed_glb(tmp_path / "sat.glb", put("skins", [{"joints": [0]}]))
    tree = read_tree(repo_dir / "tests/python/scene.yaml")
    tree["spacecraft"]["sat"]["model"] = "sat.glb"
    other = copy.deepcopy(tree["spacecraft"]["sat"])
    other["orbit"]["mean_anomaly_deg"] = 90.0
    tree["spacecraft"]["other"] = other
    path = tmp_path / "scene.json"
    path.write_text(json.dumps(tree))
    return path


def told(action) -> list[str]:
    with warnings.catch_warnings(record=True) as rows:
        warnings.simplefilter("always")
        action()
    return [str(row.message) for row in rows if row.category is ModelWarning]


def test_users_hear_of_it_once(scene):
    sim = perilune.open(scene)
    rows = told(lambda: [sim.frame(k, ["depth"]) for k in range(3)])
    model = scene.parent / "sat.glb"
    text = "skins are ignored: meshes are placed by their nodes"
    assert rows == [f"{scene}: spacecraft.sat.model: {model}: {text}"]
    copied = pickle.loads(pickle.dumps(sim))  # a worker knows what has been told
    assert told(lambda: copied.frame(0, ["depth"])) == []


def test_one_worker_tells(scene):
    code = f"""
import torch, perilune
data = perilune.Dataset({str(scene)!r}, 4, channels=["depth"])
loader = torch.utils.data.DataLoader(data, batch_size=None, num_workers=2)
assert sum(1 for _ in loader) == 4
"""
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stderr.count("skins are ignored") == 1, done.stderr


@pytest.mark.parametrize(
    "words",
    [
        ("parts", "{}"),
        ("plan", "{}"),
        ("render", "{}", "--frames", "0:2", "--out", "{folder}/out", "--threads", "1"),
        ("parts", "{folder}/sat.glb"),
    ],
)
def test_commands_show_it(scene, capsys, words):
    words = [word.format(scene, folder=scene.parent) for word in words]
    assert main(words) == 0
    shown = capsys.readouterr().err
    assert shown.count("skins are ignored") == 1
    assert "sat.glb: skins" in shown


def test_info_lists_models(scene, capsys):
    assert main(["info", str(scene), "--json"]) == 0
    out = capsys.readouterr()
    first, second = json.loads(out.out)["models"]
    assert (first["key"], second["key"]) == ("spacecraft.sat.model", "spacecraft.other.model")
    assert first["warnings"] == ["skins are ignored: meshes are placed by their nodes"]
    assert out.err == ""
    assert main(["info", str(scene)]) == 0
    assert "  warning: skins are ignored" in capsys.readouterr().out


def test_shapes_of_bodies_have_warnings(repo_dir, tmp_path):
    tree = read_tree(repo_dir / "tests/python/scene.yaml")
    name = next(iter(tree["bodies"]))
    tree["bodies"][name]["shape"] = str(write(tmp_path, put("skins", [{"joints": [0]}])))
    sim = perilune.open(tree, base=repo_dir / "tests/python")
    (row,) = told(lambda: sim.shapes)
    assert f"bodies.{name}.shape.file: {tmp_path}/model.gltf: skins are ignored" in row
