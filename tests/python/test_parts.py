"""Parts of a model: cut as the file has them, by connection or by place; names and labels."""

from __future__ import annotations

import json

import numpy as np
import pytest

import perilune
from perilune import _core
from perilune.cli import main
from perilune.config import ConfigError
from perilune.config.parts import Parts
from perilune.document.loader import read_tree
from perilune.frame.labels import BACKGROUND
from perilune.spacecraft.parts import extents, partition, unique_names


@pytest.fixture(scope="module")
def model(request):
    return _core.Model(str(request.config.rootpath / "assets/models/smallsat.glb"))


@pytest.fixture
def scene(repo_dir):
    return read_tree(repo_dir / "tests/python/scene.yaml")


def opened(repo_dir, scene, **craft):
    scene["spacecraft"]["sat"] |= craft
    return perilune.open(scene, base=repo_dir / "tests/python")


def brute_components(positions, indices) -> np.ndarray:
    """Smallest triangle number of each triangle's component, by spreading over shared places."""
    places = np.unique(positions + 0.0, axis=0, return_inverse=True)[1].reshape(-1)[indices]
    label = np.arange(len(indices))
    while True:
        lowest = np.full(places.max() + 1, len(indices))
        np.minimum.at(lowest, places.ravel(), np.repeat(label, 3))
        spread = lowest[places].min(axis=1)
        if (spread == label).all():
            return label
        label = spread


def test_components_against_brute_force(model):
    mesh = model.mesh()
    found, expected = model.components(), brute_components(mesh["positions"], mesh["indices"])
    assert found.dtype == np.uint32
    pairs = np.unique(np.stack([found, expected], axis=1), axis=0)
    assert len(pairs) == found.max() + 1 == len(np.unique(expected)) > 5
    sizes = np.bincount(found)
    first = [np.flatnonzero(found == k)[0] for k in range(len(sizes))]
    order = sorted(range(len(sizes)), key=lambda k: (-sizes[k], first[k]))
    assert order == list(range(len(sizes)))


def test_unique_names():
    assert unique_names(["a", "b", "a", "a#2", "a", "b"]) == ["a", "b", "a#3", "a#2", "a#4", "b#2"]
    assert unique_names([]) == []
    many = unique_names(["panel"] * 1000)
    assert len(set(many)) == 1000
    assert many[:3] == ["panel", "panel#2", "panel#3"]


def test_primitives_are_the_files_own(model):
    cut = partition(model, Parts())
    assert cut.triangle_part is None
    assert [e.base for e in cut.entries] == [p["name"] for p in model.parts]
    assert [e.material for e in cut.entries] == [p["material"] for p in model.parts]
    assert len({e.name for e in cut.entries}) == len(cut.entries)


@pytest.mark.parametrize("split", ["primitive", "node", "component", "none"])
def test_every_triangle_has_one_part(model, split):
    inside = {"everything": {"min": [-1e3, -1e3, -1e3], "max": [1e3, 1e3, 0.0]}}
    for boxes in ({}, inside):
        cut = partition(model, Parts.model_validate({"split": split, "boxes": boxes}))
        part = model.mesh()["triangle_part"] if cut.triangle_part is None else cut.triangle_part
        assert part.shape == (model.triangle_count,)
        assert set(np.unique(part)) == set(range(len(cut.entries)))
        sizes = extents(model, cut)
        assert sum(size.triangles for size in sizes) == model.triangle_count
        low = np.min([size.low for size in sizes], axis=0)
        high = np.max([size.high for size in sizes], axis=0)
        assert (np.stack([low, high]) == model.bounds).all()
        if boxes:
            mesh = model.mesh()
            below = mesh["positions"].astype(float)[mesh["indices"]].mean(axis=1)[:, 2] <= 0.0
            assert ((part == 0) == below).all()
            assert cut.entries[0].name == "everything"


def test_nodes_and_whole(model):
    names = [entry.name for entry in partition(model, Parts(split="node")).entries]
    assert len(names) == len({part["node"] for part in model.parts}) < len(model.parts)
    (whole,) = partition(model, Parts(split="none")).entries
    mesh, parts = model.mesh(), model.parts
    counts: dict[str, int] = {}
    for number, count in enumerate(np.bincount(mesh["triangle_part"])):
        material = parts[number]["material"]
        counts[material] = counts.get(material, 0) + int(count)
    assert counts[whole.material] == max(counts.values())


def test_small_components_are_merged(model):
    sizes = np.bincount(model.components())
    limit = int(np.median(sizes)) + 1
    cut = partition(model, Parts(split="component", merge_below=limit))
    kept = int((sizes >= limit).sum())
    assert [e.name for e in cut.entries] == [*(f"component-{k}" for k in range(kept)), "small"]
    assert (np.bincount(cut.triangle_part)[:-1] == sizes[:kept]).all()


def test_the_first_box_takes_a_triangle_and_numbers_stay(model):
    half = {"min": [-1e3, -1e3, -1e3], "max": [1e3, 1e3, 0.0]}
    whole = {"min": [-1e3, -1e3, -1e3], "max": [1e3, 1e3, 1e3]}
    text = "earlier boxes hold all"
    with pytest.raises(ConfigError, match=rf"parts\.boxes\.b: .*{text}"):
        partition(model, Parts.model_validate({"boxes": {"a": whole, "b": half}}))
    cut = partition(model, Parts.model_validate({"boxes": {"a": half, "b": whole}}))
    assert [entry.name for entry in cut.entries] == ["a", "b"]
    cut = partition(model, Parts.model_validate({"boxes": {"a": half}, "split": "component"}))
    component = model.components()
    for number, entry in enumerate(cut.entries[1:], start=1):
        stated = int(entry.name.removeprefix("component-"))
        assert (component[cut.triangle_part == number] == stated).all()


def test_an_empty_box_says_where_the_model_is(repo_dir, scene):
    boxes = {"far": {"min": [50, 50, 50], "max": [60, 60, 60]}}
    sim = opened(repo_dir, scene, parts={"boxes": boxes})
    with pytest.raises(ConfigError, match=r"spacecraft\.sat\.parts\.boxes\.far.*the model spans"):
        _ = sim.taxonomy


@pytest.mark.parametrize(
    ("parts", "text"),
    [
        ({"split": "components"}, "parts.split"),
        ({"slit": "node"}, "did you mean 'split'"),
        ({"merge_below": 3}, "only for split: component"),
        ({"split": "component", "merge_below": -3}, "merge_below"),
        ({"boxes": {"a": {"min": [0, 0, 0], "max": [1, 0, 1]}}}, "y: must be above min"),
        ({"boxes": {"a": {"min": [0, 0, 0], "max": [1, float("inf"), 1]}}}, r"max\[1\]"),
        ({"boxes": {"a": {"min": [0, 0], "max": [1, 1, 1]}}}, "boxes.a.min"),
    ],
)
def test_faults_name_the_key(repo_dir, scene, parts, text):
    with pytest.raises(ConfigError) as caught:
        opened(repo_dir, scene, parts=parts)
    assert text.replace("\\", "") in str(caught.value)
    assert "spacecraft.sat.parts" in str(caught.value)


def test_labels_follow_the_parts(repo_dir, scene):
    """Classes by name, by material and by both; the label images agree with the surface's place."""
    plain = opened(repo_dir, scene)
    material = plain.models["sat"].model.parts[0]["material"]
    low, high = plain.models["sat"].model.bounds
    middle = float(low[2] + high[2]) / 2
    upper = {"min": [*(low - 1)[:2].tolist(), middle], "max": (high + 1).tolist()}
    sim = opened(
        repo_dir, scene, parts={"boxes": {"top": upper}, "split": "component"},
        part_classes={"head": ["TOP"], "big": ["component-0", "component-1"],
                      "by_material": [f"component-*/{material}"]},
    )  # fmt: skip
    labels = sim.taxonomy
    parts = {part.id: part for part in labels.parts}
    for part in labels.parts[1:]:
        if part.name == "top":
            expected = "head"
        elif part.name in ("component-0", "component-1"):
            expected = "big"
        else:
            expected = "by_material" if part.material == material else "other"
        assert part.class_name == expected
    shown = set()
    for index in range(3):
        sample = sim.frame(index, channels=["part", "semantic", "instance", "object_coords"])
        reference = plain.frame(index, channels=["instance", "semantic"])
        assert (sample["instance"] == reference["instance"]).all()
        for id_ in np.unique(sample["part"]):
            level = sample["semantic"][sample["part"] == id_, 2]
            name = parts[id_].class_name if id_ else BACKGROUND
            assert {labels.names("semantic/2")[k] for k in level} == {name}
            shown.add(name)
        row = sim.models["sat"]
        z = sample["object_coords"][..., 2] / row.metres_per_unit + row.offset[2]
        top = next(part.id for part in labels.parts if part.name == "top")
        # A triangle that reaches over the edge of the box goes where its centroid is.
        reach = 0.5 * float(high[2] - low[2])
        assert (z[sample["part"] == top] > middle - reach).all()
    assert "head" in shown


def test_the_scene_checks_its_table_of_parts(model):
    """A table of the wrong length, a part that is not in it, and no table with parts not the
    model's: refused; otherwise kept as a copy."""
    part = np.zeros(model.triangle_count, np.uint32)

    def add(triangle_part, parts):
        scene = _core.Scene(1)
        return scene.add_object(
            name="sat", model=model, offset=np.zeros(3), obj_id=1, instance_id=1,
            part_ids=np.ones(parts, np.int32), class_ids=np.ones((parts, 1), np.uint16),
            triangle_part=triangle_part,
        )  # fmt: skip

    assert add(part, 1) == 0
    assert add(None, len(model.parts)) == 0
    with pytest.raises(ValueError, match="triangle_part"):
        add(part[:-1], 1)
    with pytest.raises(ValueError, match="part_ids"):
        add(None, 1)
    part[-1] = 3
    with pytest.raises(ValueError, match=r"object 'sat'.*is of part 3, but there are 3"):
        add(part, 3)


def test_command_lists_what_the_configuration_means(repo_dir, capsys):
    config = str(repo_dir / "tests/python/scene.yaml")
    assert main(["parts", config, "--json"]) == 0
    rows = json.loads(capsys.readouterr().out)["sat"]
    sim = perilune.open(config)
    named = [(p.name, p.material, p.class_name) for p in sim.taxonomy.parts if p.owner == "sat"]
    assert [(row["part"], row["material"], row["class"]) for row in rows] == named
    assert sum(row["triangles"] for row in rows) == sim.models["sat"].model.triangle_count
    assert main(["parts", config, "--split", "component", "--merge-below", "100"]) == 0
    table = capsys.readouterr().out
    assert "component-0 " in table
    assert "small " in table
    assert main(["parts", config, "--spacecraft", "satt"]) == 1
    assert "did you mean 'sat'" in capsys.readouterr().err


def test_command_takes_a_model(repo_dir, capsys):
    path = str(repo_dir / "assets/models/smallsat.glb")
    assert main(["parts", path, "--split", "none"]) == 0
    assert "1 parts" in capsys.readouterr().out
    assert main(["parts", path + "x.glb"]) == 1
    assert "smallsat.glbx.glb" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("name", "craft", "classes"),
    [
        ("voyager_phobos", "voyager",
         {"dish", "boom", "generator", "instrument", "antenna", "adapter", "bus"}),
        ("mro_mars", "mro", {"solar_array", "dish", "engine", "instrument", "antenna", "bus"}),
        ("iss_leo", "iss", {"solar_array", "radiator", "truss", "payload", "module"}),
    ],
)  # fmt: skip
def test_published_models_have_their_classes(repo_dir, data_dir, name, craft, classes):
    """Each class is there, and the dishes and wings have the sizes the spacecraft have."""
    sim = perilune.open(repo_dir / f"configs/{name}.yaml")
    row, cut = sim.models[craft], sim.partitions[craft]
    labels = [part for part in sim.taxonomy.parts if part.owner == craft]
    assert {part.class_name for part in labels} == classes
    sizes = {
        part.name: (size.high - size.low) * row.metres_per_unit
        for part, size in zip(labels, extents(row.model, cut), strict=True)
    }
    if craft == "voyager":  # 3.66 m across
        assert np.abs(sizes["high_gain_antenna"][:2] - 3.66).max() < 0.05
    elif craft == "mro":  # wings of 5.35 m x 2.53 m; the dish of 3 m, some 20 % too large here
        for side in ("left", "right"):
            assert 4.5 < sizes[f"solar_array_{side}"][1] < 6.0
        assert 3.0 < sizes["high_gain_antenna"][1] < 4.0
    else:  # eight wings, each 35 m x 12 m
        for number in range(1, 9):
            x, y, z = sizes[f"wing_{number}"]
            assert abs(x - 11.8) < 0.4
            assert 32.0 < np.hypot(y, z) < 48.0
