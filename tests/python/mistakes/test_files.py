"""Files of all kinds that are missing, of another kind or damaged are told by file and key."""

from __future__ import annotations

import json
import warnings

import pytest
from tests.python.mistakes.rule import fault, message_fault
from tests.python.model_files import SATELLITE, changed_glb

import perilune
from perilune import cli
from perilune.document.loader import read_tree

# Configurations: (file name, what it holds, what the message must hold beside the name)
CONFIGURATIONS = [
    ("deep.yaml", "[" * 5000 + "]" * 5000, ["nested too deeply", "64 levels"]),
    ("deep_map.yaml", "{a: " * 3000 + "1" + "}" * 3000, ["nested too deeply"]),
    ("deep_block.yaml", "\n".join(" " * i + "a:" for i in range(2000)), ["nested too deeply"]),
    ("deep.json", "[" * 100_000, ["nested too deeply"]),
    ("deeper.json", '{"a":' * 80 + "1" + "}" * 80, ["nested too deeply"]),
    ("self.yaml", "a: &a {b: *a}", ["nested too deeply"]),
    ("tab.yaml", "version: 1\ncamera:\n\twidth: 3", ["line 3", "\\t"]),
    ("colon.yaml", "version: 1\nname: a: b", ["line 2", "mapping values"]),
    ("open.yaml", "camera: {width: 3", ["line 1"]),
    ("quote.yaml", "name: 'a", ["line 1"]),
    ("twice.yaml", "seed: 1\nname: a\nseed: 2", ["'seed' occurs twice", "lines 1 and 3"]),
    ("twice.json", '{"seed": 1, "seed": 2}', ["'seed' occurs twice"]),
    ("two.yaml", "a: 1\n---\nb: 2", ["line 2", "document"]),
    ("list.yaml", "- a\n- b", ["mapping of sections", "list of 2"]),
    ("empty.yaml", "", ["mapping of sections", "null"]),
    ("text.yaml", "hello", ["mapping of sections", "a text"]),
    ("number_key.yaml", "3: 4", ["a key must be a text", "3"]),
    ("list_key.yaml", "? [a, b]\n: 3", ["line 1", "a key must be a text"]),
    ("tag.yaml", "a: !!python/object:os.system 3", ["line 1", "python/object"]),
    ("zero.yaml", "a: \x00", ["character 4", "U+0000"]),
    ("huge.yaml", "seed: " + "9" * 5000, ["line 1", "5000 digits"]),
    ("huge.json", '{"seed": ' + "9" * 5000 + "}", ["5000 digits"]),
    ("comma.json", '{"seed": 1,}', ["line 1, column 1"]),
    ("comment.json", '{"seed": 1} // mine', ["line 1, column 13"]),
    ("single.json", "{'seed': 1}", ["line 1, column 2"]),
    ("cut.json", '{"seed": 1', ["line 1"]),
    ("scene.toml", "[camera]\nwidth = 3", ["line 2"]),
    ("binary.yaml", b"\xff\xfe\x00\x01", ["UTF-8"]),
    ("ship.blend", b"BLENDER-v300", ["a model, not a configuration"]),
    ("photo.jpg", b"\xff\xd8\xff", ["a picture, not a configuration"]),
]


@pytest.mark.parametrize(("name", "content", "needed"), CONFIGURATIONS)
def test_a_configuration_that_is_none(tmp_path, name, content, needed):
    path = tmp_path / name
    path.write_bytes(content if isinstance(content, bytes) else content.encode())
    assert not fault(lambda: perilune.open(path), [name, *needed])


MODEL = "spacecraft.sat.model"
OBJ = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"


def stride(tree):
    """A buffer view with strides that no accessor can have."""
    tree["bufferViews"][0]["byteStride"] = 13


def count(tree):
    tree["accessors"][0]["count"] = 10**6


def view(tree):
    tree["accessors"][0]["bufferView"] = 999


def mode(tree):
    tree["meshes"][0]["primitives"][0]["mode"] = 9


def version(tree):
    tree["asset"]["version"] = "1.0"


def required(tree):
    tree["extensionsRequired"] = ["EXT_unheard_of"]


MODELS = [
    ("ship.obj", OBJ, ["Wavefront OBJ", ".glb, .gltf"]),
    ("SHIP.OBJ", OBJ, ["Wavefront OBJ", ".glb, .gltf"]),
    ("ship.stl", "solid a\nendsolid a", ["STL", ".glb, .gltf"]),
    ("ship.blend", "BLENDER-v300", ["Blender", ".glb, .gltf"]),
    ("ship.fbx", "Kaydara FBX Binary", ["FBX", ".glb, .gltf"]),
    ("ship.usdz", "PK", ["USD", ".glb, .gltf"]),
    ("ship.dae", "<COLLADA/>", ["COLLADA", ".glb, .gltf"]),
    ("empty.glb", "", ["empty.glb"]),
    ("text.glb", "hello", ["text.glb"]),
    ("cut.glb", SATELLITE.read_bytes()[:5000], ["cut.glb"]),
    ("open.gltf", "{", ["open.gltf"]),
    ("bare.gltf", "{}", ["bare.gltf", "asset"]),
    ("none.gltf", '{"asset": {"version": "2.0"}}', ["none.gltf"]),
    ("stride.glb", stride, ["bufferViews[0].byteStride", "13", "multiple of 4"]),
    ("count.glb", count, ["count.glb", "accessor"]),
    ("view.glb", view, ["accessors[0].bufferView", "999"]),
    ("mode.glb", mode, ["mode.glb", "mode"]),
    ("version.glb", version, ["version.glb", "1.0"]),
    ("required.glb", required, ["EXT_unheard_of"]),
]


@pytest.mark.parametrize(("name", "content", "needed"), MODELS)
def test_a_model_that_is_none(repo_dir, tmp_path, name, content, needed):
    path = tmp_path / name
    if callable(content):
        changed_glb(path, content)
    else:
        path.write_bytes(content if isinstance(content, bytes) else content.encode())
    sim = perilune.open(repo_dir / "tests/python/scene.yaml", overrides={MODEL: str(path)})
    assert not fault(lambda: sim.models, ["scene.yaml", MODEL, *needed])


CSV = "frame,x,y,z,qw,qx,qy,qz\n"
WAY = "camera.trajectory"
EARTH = "bodies.earth"
HAPKE = {"kind": "earth", "reflectance": "hapke"}
OTHERS = [
    # (key, value that names {file}, what the file holds, what the message must hold)
    (EARTH + ".color_map", "{file}.png", "hello", ["bodies.earth.color_map"]),
    (EARTH + ".color_map", "{file}.png", b"\x89PNG\r\n\x1a\n", ["bodies.earth.color_map"]),
    (EARTH + ".color_map", "{file}.jpg", b"\xff\xd8\xff\xe0", ["bodies.earth.color_map"]),
    (EARTH + ".color_map", "{file}.png", "", ["bodies.earth.color_map"]),
    (EARTH + ".clouds", {"map": "{file}.png"}, "hello", ["bodies.earth.clouds.map"]),
    (EARTH + ".shape", {"file": "{file}.obj"}, "hello", ["bodies.earth.shape"]),
    (EARTH + ".shape", {"file": "{file}.tab"}, "1 2 x", ["bodies.earth.shape"]),
    (EARTH, {**HAPKE, "photometry": {"maps": ["{file}.tif"]}}, "hello", ["photometry.maps"]),
    (EARTH, {**HAPKE, "photometry": {"maps": ["{file}.tif"]}}, "", ["photometry.maps"]),
    (WAY, {"kind": "deterministic", "file": "{file}.csv"}, "", [WAY]),
    (WAY, {"kind": "deterministic", "file": "{file}.csv"}, CSV, [WAY]),
    (WAY, {"kind": "deterministic", "file": "{file}.csv"}, CSV + "0,1,2", [WAY]),
    (WAY, {"kind": "deterministic", "file": "{file}.csv"}, CSV + "0,1,2,3,a,0,0,0", [WAY, "a"]),
    (WAY, {"kind": "deterministic", "file": "{file}.csv"}, CSV + "0,1,2,3,0,0,0,0", [WAY]),
    (WAY, {"kind": "deterministic", "file": "{file}.csv"}, "frame,x,y\n0,1,2", [WAY]),
    ("orbit", {"kind": "table", "file": "{file}.csv"}, "", ["spacecraft.sat"]),
    ("orbit", {"kind": "table", "file": "{file}.csv"}, "a,b\n1,2", ["spacecraft.sat"]),
    ("orbit", {"kind": "table", "file": "{file}.oem"}, "hello", ["spacecraft.sat"]),
    ("orbit", {"kind": "tle", "file": "{file}.tle"}, "hello", ["spacecraft.sat"]),
    ("orbit", {"kind": "tle", "file": "{file}.tle"}, "1 2\n2 3\n", ["spacecraft.sat"]),
    ("materials", {"m": {"file": "{file}.yaml"}}, "[", ["materials.m.file", "line 1"]),
    ("materials", {"m": {"file": "{file}.yaml"}}, "nods: {}", ["nods", "did you mean 'nodes'"]),
    ("materials", {"m": {"file": "{file}.yaml"}}, "- a", ["materials.m.file", "mapping"]),
    ("sky", {"stars": {"catalogue": "{file}.csv"}}, "hello", ["sky.stars"]),
]


def filled(value, file):
    if isinstance(value, dict):
        return {key: filled(item, file) for key, item in value.items()}
    if isinstance(value, list):
        return [filled(item, file) for item in value]
    return value.format(file=file) if isinstance(value, str) else value


@pytest.mark.parametrize(("key", "value", "content", "needed"), OTHERS)
def test_another_file_that_is_none(repo_dir, tmp_path, key, value, content, needed):
    value = filled(value, tmp_path / "bad")
    names = [str(value)] if isinstance(value, str) else [json.dumps(value)]
    suffix = "." + names[0].rsplit("bad.", 1)[1].split('"')[0]
    (tmp_path / f"bad{suffix}").write_bytes(
        content if isinstance(content, bytes) else content.encode()
    )
    tree = read_tree(repo_dir / "tests/python/scene.yaml")
    if key == "orbit":
        key, value = "spacecraft.sat.orbit", {"around": "earth", **value}
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")

        def made():
            folder = repo_dir / "tests/python"
            return perilune.open(tree, overrides={key: value}, base=folder).frame(0)

        assert not fault(made, [f"bad{suffix}", *needed])


MISSING = [
    ("spacecraft.sat.model", "../../assets/models/smalsat.glb", ["did you mean 'smallsat.glb'"]),
    ("spacecraft.sat.model", "../../asets/models/smallsat.glb", ["did you mean 'assets'"]),
    ("spacecraft.sat.model", "data:models/ships.glb", ["PERILUNE_DATA", "did you mean 'ship.glb'"]),
    ("spacecraft.sat.model", "data:modles/ship.glb", ["did you mean 'models'"]),
    ("spacecraft.sat.model", "data:models/ship.gltf", ["did you mean 'ship.glb'"]),
    ("spacecraft.sat.model", "data:models", ["a folder"]),
    ("spacecraft.sat.model", "data:models/xyz.glb", ["holds ship.glb"]),
    ("bodies.earth.color_map", "../nowhere.png", ["no such file"]),
]


@pytest.mark.parametrize(("key", "value", "needed"), MISSING)
def test_a_file_that_is_missing(repo_dir, tmp_path, monkeypatch, key, value, needed):
    (tmp_path / "models").mkdir()
    (tmp_path / "models" / "ship.glb").write_bytes(b"")
    monkeypatch.setenv("PERILUNE_DATA", str(tmp_path))
    sim = perilune.open(repo_dir / "tests/python/scene.yaml", overrides={key: value})
    needed = [part.replace("PERILUNE_DATA", str(tmp_path)) for part in needed]
    assert not fault(lambda: sim.frame(0), ["scene.yaml", key, *needed])


def test_data_without_its_folder(repo_dir, monkeypatch):
    change = {"spacecraft.sat.model": "data:a.glb"}
    sim = perilune.open(repo_dir / "tests/python/scene.yaml", overrides=change)
    monkeypatch.delenv("PERILUNE_DATA", raising=False)
    assert not fault(lambda: sim.models, ["spacecraft.sat.model", "export PERILUNE_DATA="])
    monkeypatch.setenv("PERILUNE_DATA", "/nowhere/at/all")
    assert not fault(lambda: sim.models, ["spacecraft.sat.model", "no folder: /nowhere/at/all"])


def test_a_dataset_that_is_damaged(repo_dir, tmp_path, capsys):
    for name, content in (("dataset_info.json", "{"), ("dataset_info.json", "[]")):
        (tmp_path / name).write_text(content)
        for command in ("stats", "merge"):
            assert cli.main([command, str(tmp_path)]) == 1
            assert not message_fault(capsys.readouterr().err, [name])


def test_the_mistakes_are_different_ones():
    rows = [*CONFIGURATIONS, *MODELS, *OTHERS, *MISSING]
    assert len({repr(row[:3]) for row in rows}) == len(rows) >= 75
