"""Choices among whole materials: the bits of each choice alone, in any order, on one scene."""

from __future__ import annotations

import copy
import json
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import perilune
from perilune.config import ConfigError
from perilune.document.loader import read_tree

SCENE = Path(__file__).parent / "scene.yaml"
FRAMES = 8
CHANNELS = ["rgb", "depth", "instance"]
RED: dict[str, Any] = {"nodes": {"skin": {"type": "lambert", "base_color": [0.8, 0.05, 0.05]}}}
LAMP: dict[str, Any] = {
    "nodes": {
        "driver:glow": {"type": "value", "value": 400.0},
        "where": {"type": "coordinates"},
        "noise": {"type": "noise", "vector": "where", "scale": 2.0},
        "skin": {
            "type": "principled",
            "base_color": "noise",
            "emission_color": [0.1, 0.9, 0.1],
            "emission_strength": "driver:glow",
        },
    }
}
GLOW = {"uniform": [100.0, 700.0]}
USE = "spacecraft.sat.materials[0].use"


def tree(**craft: Any) -> dict[str, Any]:
    found = read_tree(SCENE)
    found["materials"] = {"red": copy.deepcopy(RED), "lamp": copy.deepcopy(LAMP)}
    found["spacecraft"]["sat"].update(copy.deepcopy(craft))
    return found


def chosen(**use: Any) -> dict[str, Any]:
    return tree(materials=[{"material": "*", "use": {"choice": ["red", "lamp"]}, **use}])


def exact(raw: dict[str, Any]) -> dict[str, Any]:
    """All effects on: their bounds are wider for values that vary than for fixed ones."""
    raw["render"]["tolerance_dn"] = 0.0
    return raw


def opened(raw: dict[str, Any], **more: Any) -> perilune.Simulation:
    return perilune.open(raw, base=SCENE.parent, **{"seed": 3, **more})


def assert_same(first: Any, second: Any, plan: bool = True) -> None:
    for name in CHANNELS:
        assert np.array_equal(first[name], second[name]), name
    assert first.meta["white_radiance"] == second.meta["white_radiance"]
    assert not plan or first.plan == second.plan


def test_each_frame_has_the_bits_of_its_choice_alone() -> None:
    sim = opened(chosen())
    seen = set()
    for index in range(FRAMES):
        use = sim.config_at(index)[1][USE]
        seen.add(use)
        alone = opened(tree(materials=[{"material": "*", "use": use}]))
        assert_same(sim.frame(index, CHANNELS), alone.frame(index, CHANNELS))
    assert seen == {"red", "lamp"}


def test_order_and_threads_change_nothing() -> None:
    sim = opened(chosen())
    there = {index: sim.frame(index, CHANNELS, threads=1) for index in range(FRAMES)}
    for index in (5, 0, 7, 3, 3, 1):
        assert_same(sim.frame(index, CHANNELS, threads=2), there[index])
        assert_same(opened(chosen()).frame(index, CHANNELS, threads=2), there[index])


def test_the_scene_and_its_accelerators_stay() -> None:
    sim = opened(chosen())
    handles = sim._mine()
    renderers = {id(handles.renderer_of(sim.config_at(index)[0])) for index in range(FRAMES)}
    assert len(renderers) == 1
    # What the scene has let go of is not kept: references to a graph do not grow.
    cores = [graph.core for graph in handles.assignments._graphs.values()]
    before = [sys.getrefcount(core) for core in cores]
    for _ in range(5):
        for index in range(FRAMES):
            handles.renderer_of(sim.config_at(index)[0])
    assert [sys.getrefcount(core) for core in cores] == before


def test_sets_of_patterns_do_not_pile_up() -> None:
    """More of them than are kept: each comes back right."""
    names = ["mli_*", "solar_cell", "panel_back", "*", "mli_gold"]
    uses = [{"material": name, "use": "red"} for name in names]
    lists = [[a, b] for a in uses for b in uses if a != b]
    sim = opened(tree(materials={"choice": lists, "interval": 1}))
    assignments = sim._mine().assignments
    assert len(lists) == 20
    assert len(assignments._triangles) == 16
    for _ in range(2):
        for index in range(30):
            assignment = assignments.of(sim.config_at(index)[0])
            alone = opened(tree(materials=sim.config_at(index)[1]["spacecraft.sat.materials"]))
            expected = alone._mine().assignments.of(alone.config).crafts["sat"].triangle_graph
            assert np.array_equal(assignment.crafts["sat"].triangle_graph, expected)
            assert len(assignments._triangles) <= 16


def test_once_a_scene_and_at_intervals() -> None:
    raw = chosen()
    raw["time"]["frames_per_scene"] = 4
    values = [opened(raw).config_at(index)[1][USE] for index in range(16)]
    assert all(len(set(values[k : k + 4])) == 1 for k in range(0, 16, 4))
    raw["spacecraft"]["sat"]["materials"][0]["use"]["interval"] = 1
    values = [opened(raw).config_at(index)[1][USE] for index in range(16)]
    assert any(len(set(values[k : k + 4])) == 2 for k in range(0, 16, 4))


def test_on_parts_that_move() -> None:
    hinge = [{"node": "panel_left", "axis": [0, 1, 0], "angle_deg": 25.0}]
    uses = [{"material": "mli_*", "use": {"choice": ["red", "lamp"]}}]
    sim = opened(tree(materials=uses, articulation=hinge))
    for index in range(4):
        uses[0]["use"] = sim.config_at(index)[1][USE]
        alone = opened(tree(materials=uses, articulation=hinge))
        assert_same(sim.frame(index, CHANNELS), alone.frame(index, CHANNELS))


def test_lists_of_uses_by_choice() -> None:
    """With and without graphs, by other patterns, wrapped or not."""
    lists: list[Any] = [
        [],
        [{"material": "mli_*", "use": "red"}],
        [{"part": "*", "use": "lamp", "mode": "wrap"}, {"material": "*", "use": "red"}],
    ]
    sim = opened(tree(materials={"choice": lists}))
    seen = []
    for index in range(10):
        found = sim.config_at(index)[1]["spacecraft.sat.materials"]
        seen.append(lists.index(found))
        alone = opened(tree(materials=found))
        assert_same(sim.frame(index, CHANNELS), alone.frame(index, CHANNELS))
    assert set(seen) == {0, 1, 2}


def test_holes_by_choice() -> None:
    raw = tree(materials=[{"material": "*", "use": {"choice": ["net", "lamp"]}}])
    stripes = {"type": "checker", "scale": 3.0}
    raw["materials"]["net"] = {"nodes": {"holes": stripes, "skin": {"type": "lambert"}}}
    raw["materials"]["net"]["nodes"]["skin"]["alpha"] = "holes.value"
    sim = opened(raw)
    seen = set()
    for index in range(4):
        use = sim.config_at(index)[1][USE]
        seen.add(use)
        alone = copy.deepcopy(raw)
        alone["spacecraft"]["sat"]["materials"][0]["use"] = use
        assert_same(sim.frame(index, CHANNELS), opened(alone).frame(index, CHANNELS))
    assert seen == {"net", "lamp"}


def test_on_bodies() -> None:
    raw = tree()
    raw["bodies"]["earth"] = {"kind": "earth", "material": {"choice": ["red", "lamp"]}}
    sim = opened(raw)
    seen = set()
    for index in range(4):
        use = sim.config_at(index)[1]["bodies.earth.material"]
        seen.add(use)
        fixed = copy.deepcopy(raw)
        fixed["bodies"]["earth"]["material"] = use
        assert_same(sim.frame(index, CHANNELS), opened(fixed).frame(index, CHANNELS))
    assert seen == {"red", "lamp"}


def test_colours_by_choice() -> None:
    raw = tree(materials=[{"material": "*", "use": "red"}])
    raw["materials"]["red"]["nodes"]["OAISYS_tint"] = {"type": "color", "color": 0.5}
    raw["materials"]["red"]["nodes"]["skin"]["base_color"] = "OAISYS_tint"
    colours = [[0.9, 0.1, 0.1], [0.1, 0.1, 0.9], 0.7]
    raw["material_drivers"] = {"drivers": {"tint": {"choice": colours}}}
    sim = opened(exact(raw))
    seen = []
    for index in range(12):
        colour = sim.config_at(index)[1]["material_drivers.drivers.tint"]
        seen.append(colours.index(colour))
        fixed = tree(materials=[{"material": "*", "use": "red"}])
        fixed["materials"]["red"]["nodes"]["skin"]["base_color"] = colour
        alone = opened(exact(fixed)).frame(index, CHANNELS)
        assert_same(sim.frame(index, CHANNELS), alone, plan=False)
    assert len(set(seen)) == 3


def test_drivers_of_what_may_be_chosen(tmp_path: Path) -> None:
    """Each instance's drivers too, and a dataset replays them."""
    raw = chosen()
    raw["materials"]["lamp"]["drivers"] = {"drivers": {"glow": GLOW}, "per": "instance"}
    sim = opened(exact(raw))
    key = "materials.lamp.instances.sat.drivers.glow"
    frames = [index for index in range(FRAMES) if sim.config_at(index)[1][USE] == "lamp"]
    index = frames[-1]
    values = sim.config_at(index)[1]
    fixed = tree(materials=[{"material": "*", "use": "lamp"}])
    fixed["materials"]["lamp"]["nodes"]["driver:glow"]["value"] = values[key]
    alone = opened(exact(fixed)).frame(index, CHANNELS)
    assert_same(sim.frame(index, CHANNELS), alone, plan=False)
    perilune.write_bop(sim, range(index + 1), tmp_path / "out", threads=1)
    cameras = json.loads((tmp_path / "out/train/000000/scene_camera.json").read_text())
    again = opened(raw, replay=cameras[str(index)]["frame"])
    assert_same(again.frame(index, CHANNELS), sim.frame(index, CHANNELS))
    swapped = opened(raw, overrides={**values, USE: "red"})
    red = opened(exact(tree(materials=[{"material": "*", "use": "red"}])))
    assert_same(swapped.frame(index, CHANNELS), red.frame(index, CHANNELS))


@pytest.mark.parametrize(
    ("materials", "text"),
    [
        ([{"material": "*", "use": {"choice": ["red", "lump"]}}], f"{USE}: no entry named 'lump';"),
        (
            {"choice": [[], [{"material": "mli_gol", "use": "red"}]]},
            "spacecraft.sat.materials[0].material: no material fits 'mli_gol'; did you mean",
        ),
        ({"choice": [[], [{"use": "red"}]]}, "say where: material"),
        ([{"material": {"choice": ["mli_*", "x"]}, "use": "red"}], "no material fits 'x'"),
        (
            [{"box": {"min": [{"uniform": [-2, -1]}, -1, -1], "max": [1, 1, 1]}, "use": "red"}],
            "takes no driver",
        ),
    ],
)
def test_errors_come_with_the_first_frame(materials: Any, text: str) -> None:
    """Also of what its frame has not chosen."""
    with pytest.raises(ConfigError) as error:
        opened(tree(materials=materials)).frame(0, ["depth"])
    assert text in str(error.value)


def test_whole_graphs_are_chosen_by_their_use() -> None:
    raw = tree(materials=[{"material": "*", "use": "any"}])
    raw["materials"]["any"] = {"choice": [RED, LAMP]}
    with pytest.raises(ConfigError, match="the `use` of a spacecraft's materials may be a choice"):
        opened(raw)


def absent(rng: np.random.Generator) -> str:
    return "nowhere"


def test_a_hook_that_names_no_graph() -> None:
    use = {"hook": f"{__name__}:absent", "ideal": "red"}
    with pytest.raises(ConfigError, match=r"materials\[0\]\.use: no entry named 'nowhere'"):
        opened(tree(materials=[{"material": "*", "use": use}])).frame(0, ["depth"])
