"""Sides of faces: backs that are there or not, for sight, light, labels and datasets alike; and
sheets back to back, of which the one that looks at the viewer is seen."""

from __future__ import annotations

import json
import warnings
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from tests.python.output.retrace import Retrace, read_faces, write_sheets

import perilune
from perilune.config.errors import ConfigError, ConfigWarning
from perilune.document.loader import read_tree
from perilune.export.check import check_bop

CHANNELS = ["rgb", "radiance", "depth", "normal", "part", "instance"]
BLANK = {"pbrMetallicRoughness": {"metallicFactor": 0.0, "roughnessFactor": 1.0}}
BOTH = {**BLANK, "doubleSided": True}
EVERY = ("double_sided", "as_stated", "single_sided")


def opened(model: Path | str, place: list[float], **craft: Any) -> perilune.Simulation:
    """Seen from `place`, object axes, lit from there; far from the Earth, and by the Sun alone."""
    scene = read_tree(Path(__file__).with_name("scene.yaml"))
    orbit = {"around": "earth", "position_km": [0.0, -4.2e5, 0.0]}
    given = {"model": str(model), "size_m": None, "metres_per_unit": 1.0, "orbit": orbit}
    scene["spacecraft"]["sat"] = {**given, "centre": "origin", **craft}
    scene["camera"] |= {"width": 48, "height": 48, "fov_deg": 15}
    looks = {"kind": "fixed", "target": "sat", "position_m": place, "up": [0.1, 0.2, 1.0]}
    scene["camera"]["trajectory"] = looks
    scene["sun"] = {"direction": place}
    scene["camera"]["exposure"] = {"mode": "fixed", "white_radiance_w_m2_sr": 500.0}
    scene["render"] = {"samples": 16, "max_bounces": 2, "tolerance_dn": 0.0}
    return perilune.open(scene, base=Path(__file__).parent)


def seen(*args: Any, **craft: Any) -> perilune.Sample:
    return opened(*args, **craft).frame(0, channels=CHANNELS, threads=1)


def on_craft(sample: perilune.Sample) -> Any:
    return sample["instance"] == 2


@pytest.fixture(scope="module")
def sheet(tmp_path_factory):
    """A sheet of 2 m across the file's and the frame's x axis, which it looks along."""
    path = tmp_path_factory.mktemp("sheet") / "sheet.gltf"
    return write_sheets(path, sheet={"place": [0, 0, 0], "material": BLANK})


def test_the_back_of_a_sheet(sheet):
    """By default it is a surface as its front is: as bright, and its normal looks at the viewer."""
    front, back = (seen(sheet, [x, 0, 0]) for x in (15.0, -15.0))
    lone = np.pi * front["radiance"][on_craft(front)].mean()
    assert lone > 100.0
    assert on_craft(back).sum() == on_craft(front).sum() > 500
    assert np.pi * back["radiance"][on_craft(back)].mean() == pytest.approx(lone, rel=1e-3)
    assert back["normal"][on_craft(back)][:, 2] == pytest.approx(-1.0, abs=1e-3)
    for sides in ("as_stated", "single_sided"):
        assert on_craft(seen(sheet, [15.0, 0, 0], faces=sides)).sum() == on_craft(front).sum()
        assert not on_craft(seen(sheet, [-15.0, 0, 0], faces=sides)).any()


def test_sides_by_the_names_of_materials(tmp_path):
    """The first pattern that fits, in any case; as the file has them where asked for."""
    model = write_sheets(
        tmp_path / "model.gltf",
        one={"place": [0, 3, 0], "material": BLANK},
        two={"place": [0, 0, 0], "material": BOTH},
        three={"place": [0, -3, 0], "material": BLANK},
    )

    def shown(faces: Any) -> set[str]:
        sim = opened(model, [-60.0, 0, 0], faces=faces)
        names = {row.id: row.name for row in sim.taxonomy.parts}
        sample = sim.frame(0, channels=CHANNELS, threads=1)
        return {names[k] for k in np.unique(sample["part"][on_craft(sample)]).tolist()}

    assert shown("double_sided") == {"one", "two", "three"}
    assert shown("as_stated") == {"two"}
    assert shown("single_sided") == set()
    assert shown({"TWO": "single_sided"}) == {"one", "three"}
    assert shown({"th*": "double_sided", "t*": "single_sided", "*": "as_stated"}) == {"three"}


def test_patterns_that_do_nothing_are_told(sheet):
    for faces, told in (
        ({"shet": "as_stated"}, r"sat\.faces\.shet: no material fits 'shet'; did you mean 'sheet'"),
        ({"*": "as_stated", "sh*": "double_sided"}, r"sat\.faces\.sh\*: does nothing: patterns"),
    ):
        with pytest.warns(ConfigWarning, match=told):
            _ = opened(sheet, [15.0, 0, 0], faces=faces).models
    with warnings.catch_warnings():
        warnings.simplefilter("error", ConfigWarning)
        _ = opened(sheet, [15.0, 0, 0], faces={"s*": "as_stated"}).models


@pytest.mark.parametrize(
    ("faces", "told"),
    [
        ("both", r"faces = 'both': .*double_sided"),
        ({"sheet": "two"}, r"faces\.sheet = 'two': .*as_stated"),
        ({}, "faces: .*at least 1"),
        (2, "faces = 2"),
        ({"choice": ["as_stated", "double_sided"]}, "faces: takes no driver"),
    ],
)
def test_mistakes(sheet, faces, told):
    with pytest.raises(ConfigError, match=told):
        opened(sheet, [15.0, 0, 0], faces=faces).frame(0, ["depth"], threads=1)


@pytest.mark.parametrize("faces", EVERY)
def test_what_the_sun_sees_casts_a_shadow(tmp_path, faces):
    """A sheet that looks at the Sun is in the light of what is behind it, seen from aside."""
    model = write_sheets(
        tmp_path / "model.gltf",
        ground={"place": [-2, 0, 0], "half": 2.0, "material": BLANK},
        screen={"place": [2, 0, 0], "half": 1.0, "material": BLANK},
    )
    tree = opened(model, [12.0, 12.0, 0.0], faces=faces).document.tree
    tree = {**tree, "sun": {"direction": [1.0, 0.0, 0.0]}}
    sim = perilune.open(tree, base=Path(__file__).parent)
    sample = sim.frame(0, [*CHANNELS, "object_coords"], threads=1)
    at = sample["object_coords"]
    ground = on_craft(sample) & (np.abs(at[..., 0] + 2.0) < 0.01)
    inner = ground & (np.abs(at[..., 1:]).max(axis=-1) < 0.8)
    outer = ground & (np.abs(at[..., 1:]).max(axis=-1) > 1.2)
    assert inner.sum() > 20
    assert np.median(sample["radiance"][inner]) < 0.01 * sample["radiance"][outer].mean()


@pytest.mark.parametrize("faces", EVERY)
@pytest.mark.parametrize("gap", [1e-4, 1e-7, 0.0, -1e-7, -1e-4])
def test_sheets_back_to_back(sheet, tmp_path, gap, faces):
    """A glimpse of either side is of the sheet that looks there, whole and as bright as one that
    is alone, in whichever order rounding has put them: no stripes, no shade of one on the other."""
    write_sheets(
        tmp_path / "model.gltf",
        front={"place": [0, 0, 0], "half": 1.0, "material": BLANK},
        back={"place": [gap, 0, 0], "half": 1.0, "material": BLANK},
    )
    tree = json.loads((tmp_path / "model.gltf").read_text())
    # Both are primitives of one node, and the second is turned about the file's y.
    tree["nodes"] = [{"name": "wing", "children": [1]}, {"name": "sheets", "mesh": 0}]
    tree["scenes"][0]["nodes"] = [0]
    second = tree["meshes"].pop()["primitives"][0]
    tree["meshes"][0]["primitives"].append(second)
    (tmp_path / "model.gltf").write_text(json.dumps(turned(tree, gap)))
    for x, name in ((15.0, "sheets"), (-15.0, "sheets#2")):
        sim = opened(tmp_path / "model.gltf", [x, 3.0, 4.0], faces=faces)
        sample = sim.frame(0, channels=CHANNELS, threads=1)
        there = on_craft(sample)
        names = {row.id: row.name for row in sim.taxonomy.parts}
        assert {names[k] for k in np.unique(sample["part"][there]).tolist()} == {name}
        light = sample["radiance"][there].mean(axis=1)
        inner = light[light > 0.5 * light.max()]
        assert len(inner) > 0.9 * len(light)  # the others are outlines
        lone = seen(sheet, [15.0, 3.0, 4.0])
        alone = np.median(lone["radiance"][on_craft(lone)].mean(axis=1))
        assert np.median(light) == pytest.approx(alone, rel=1e-3)


def turned(tree: dict[str, Any], gap: float) -> dict[str, Any]:
    """The second primitive runs the other way round, `gap` along the file's x, by data of its
    own."""
    import base64

    points = np.array([[gap, y, z] for y, z in ((-1, -1), (1, -1), (1, 1), (-1, 1))], dtype="<f4")
    faces = np.array([0, 2, 1, 0, 3, 2], dtype="<u2")
    data = points.tobytes() + faces.tobytes()
    uri = "data:application/octet-stream;base64," + base64.b64encode(data).decode()
    tree["buffers"].append({"byteLength": len(data), "uri": uri})
    views, accessors = tree["bufferViews"], tree["accessors"]
    views += [
        {"buffer": 1, "byteOffset": 0, "byteLength": 48},
        {"buffer": 1, "byteOffset": 48, "byteLength": 12},
    ]
    low, high = points.min(axis=0).tolist(), points.max(axis=0).tolist()
    corners = {"bufferView": len(views) - 2, "componentType": 5126, "count": 4, "type": "VEC3"}
    accessors += [
        {**corners, "min": low, "max": high},
        {"bufferView": len(views) - 1, "componentType": 5123, "count": 6, "type": "SCALAR"},
    ]
    second = tree["meshes"][0]["primitives"][1]
    second["attributes"], second["indices"] = {"POSITION": len(accessors) - 2}, len(accessors) - 1
    return tree


@pytest.mark.parametrize("faces", EVERY)
def test_datasets_hold_the_faces_that_are_seen(tmp_path, faces):
    model = write_sheets(
        tmp_path / "model.gltf",
        one={"place": [0, 2, 0], "axis": 0, "material": BLANK},
        two={"place": [0, -2, 0], "axis": 1, "material": BOTH},
        three={"place": [2, 0, 0], "axis": 2, "material": BLANK},
    )
    sim = opened(model, [20.0, 15.0, 10.0], faces=faces, attitude={"spin_rate_deg_s": 1.0})
    perilune.write_bop(sim, range(3), tmp_path / "out", threads=1)
    counts = {"double_sided": 12, "as_stated": 8, "single_sided": 6}
    assert len(read_faces(tmp_path / "out/models/obj_000001.ply")) == counts[faces]
    pixels, wrong = np.sum([Retrace(tmp_path / "out").compare(k) for k in range(3)], axis=0)
    assert pixels > 100
    assert wrong == 0
    assert check_bop(tmp_path / "out").findings == []


def test_the_back_of_what_shines_is_dark(tmp_path):
    """What a file has single-sided emits by its front alone; what it has double-sided, by both."""
    strong = {"KHR_materials_emissive_strength": {"emissiveStrength": 100.0}}
    glow = {**BLANK, "emissiveFactor": [1.0, 1.0, 1.0], "extensions": strong}
    for material, bright in ((glow, False), ({**glow, "doubleSided": True}, True)):
        model = write_sheets(
            tmp_path / "lamp.gltf",
            lamp={"place": [0, 0, 0], "material": material},
            ground={"place": [-2, 0, 0], "half": 2.0, "material": BLANK},
        )
        tree = opened(model, [-10.0, 10.0, 0.0]).document.tree
        tree = {**tree, "sun": {"direction": [0.0, 0.0, -1.0]}}
        sim = perilune.open(tree, base=Path(__file__).parent)
        names = {row.name: row.id for row in sim.taxonomy.parts}
        sample = sim.frame(0, channels=CHANNELS, threads=1)
        lamp = sample["radiance"][sample["part"] == names["lamp"]]
        assert len(lamp) > 20
        assert (np.median(lamp) > 10.0) == bright
        tree = {**tree, "camera": {**tree["camera"]}}
        tree["camera"]["trajectory"] = {**tree["camera"]["trajectory"], "position_m": [9, 9, 0]}
        other = perilune.open(tree, base=Path(__file__).parent).frame(0, CHANNELS, threads=1)
        assert np.median(other["radiance"][other["part"] == names["lamp"]]) > 10.0
        lit = other["radiance"][other["part"] == names["ground"]]
        assert (np.median(lit) > 0.5) == bright  # the ground is behind the lamp


def test_the_wings_of_the_station(data_dir):
    """Draco has put the two sheets of its wings, a centimetre apart at most, in either order: half
    of what the Sun sees of them was black, and each was striped with the other's paint where both
    have two sides."""
    model = data_dir / "spacecraft/plain/iss.glb"
    for y, paint in ((1000.0, "panel_01_p"), (-1000.0, "panel_01_p#2")):
        for faces in ("double_sided", "as_stated"):
            sim = opened(model, [200.0, y, 300.0], faces=faces, centre="bounds")
            tree = sim.document.tree
            tree["camera"] |= {"fov_deg": 1.3}
            tree["camera"]["trajectory"] |= {"aim_offset_m": [-45.0, 0.0, 18.0]}
            sim = perilune.open(tree, base=Path(__file__).parent)
            sample = sim.frame(0, channels=CHANNELS, threads=1)
            names = {row.id: row.name for row in sim.taxonomy.parts}
            wing = np.isin(sample["part"], [k for k in names if names[k].startswith("panel_01_p")])
            assert wing.sum() > 300
            mine = np.array([names[k] == paint for k in sample["part"][wing].tolist()])
            assert mine.mean() > 0.95
            light = sample["radiance"][wing].mean(axis=1)
            assert (light < 0.2 * np.median(light)).mean() < 0.03
