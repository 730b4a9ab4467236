"""Graphs in the extras of glTF materials: used as those of the configuration, or not; errors."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from tests.python.model_files import SATELLITE, changed_glb, with_graphs

import perilune
from perilune import _core
from perilune.config.errors import ConfigError

SCENE = Path(__file__).parent / "scene.yaml"
RED: dict[str, Any] = {
    "nodes": {"skin": {"type": "lambert", "base_color": [0.9, 0.0, 0.0]}},
    "doc": "Red paint.",
}
DRIVER = {"ideal": 0.5, "jitter_variance": 0.1, "clip_min": 0.0, "clip_max": 1.0}


def opened(model: Path, **changes: Any) -> perilune.Simulation:
    return perilune.open(SCENE, overrides={"spacecraft.sat.model": str(model), **changes})


def test_a_graph_of_the_model_is_as_one_of_the_configuration(tmp_path: Path) -> None:
    held = opened(with_graphs(tmp_path / "sat.glb", mli_gold=RED))
    given = opened(
        SATELLITE,
        **{
            "materials": {"red": RED},
            "spacecraft.sat.materials": [{"material": "mli_gold", "use": "red"}],
        },
    )
    assert list(held.config.materials) == ["sat-mli_gold"]
    assert np.array_equal(held[0]["rgb"], given[0]["rgb"])
    assert not np.array_equal(held[0]["rgb"], opened(SATELLITE)[0]["rgb"])


def test_the_configuration_says_otherwise(tmp_path: Path) -> None:
    model = with_graphs(tmp_path / "sat.glb", mli_gold=RED)
    off = opened(model, **{"spacecraft.sat.model_graphs": False})
    assert not off.config.materials
    assert np.array_equal(off[0]["rgb"], opened(SATELLITE)[0]["rgb"])
    blue = {"nodes": {"skin": {"type": "lambert", "base_color": [0.0, 0.0, 0.9]}}}
    uses = {"spacecraft.sat.materials": [{"material": "mli_*", "use": "blue"}]}
    changes = {"materials": {"blue": blue}, **uses}
    images = [opened(path, **changes)[0]["rgb"] for path in (model, SATELLITE)]
    assert np.array_equal(*images)


def test_keys_beside_replace_the_models(tmp_path: Path) -> None:
    model = with_graphs(tmp_path / "sat.glb", mli_gold=RED)
    sim = opened(model, **{"materials.sat-mli_gold.nodes.skin.base_color": [0, 0.5, 0]})
    skin = {"type": "lambert", "base_color": [0, 0.5, 0]}
    assert sim.config.materials["sat-mli_gold"].nodes == {"skin": skin}


def test_drivers_of_the_models_graphs_are_drawn(tmp_path: Path) -> None:
    driven = {"nodes": {"skin": {"type": "lambert", "base_color": [DRIVER, 0.1, 0.1]}}}
    sim = opened(with_graphs(tmp_path / "sat.glb", mli_gold=driven))
    (key,) = sim.config_at(0)[1]
    assert key == "materials.sat-mli_gold.nodes.skin.base_color[0]"
    assert sim.config_at(0)[1] != sim.config_at(1)[1]


def test_two_spacecraft_share_the_graph_of_their_model(tmp_path: Path) -> None:
    model = with_graphs(tmp_path / "sat.glb", mli_gold=RED, white_paint=RED)
    sat = perilune.open(SCENE).document.tree["spacecraft"]["sat"]
    sim = opened(model, **{"spacecraft.other": {**sat, "model": str(model)}})
    assert sorted(sim.config.materials) == ["sat-mli_gold", "sat-white_paint"]
    uses = [[use.use for use in craft.materials] for craft in sim.config.spacecraft.values()]
    assert uses[0] == uses[1] == ["sat-mli_gold", "sat-white_paint"]


def test_graphs_of_materials_that_nothing_has_are_left_out(tmp_path: Path) -> None:
    def change(tree: dict[str, Any]) -> None:
        tree["materials"].append({"name": "spare", "extras": {"perilune_graph": RED}})

    assert not opened(changed_glb(tmp_path / "sat.glb", change)).config.materials


@pytest.mark.parametrize(
    ("graph", "text"),
    [
        (
            {"nodes": {"skin": {"type": "lambert", "base_colour": 1}}},
            "sat.glb: materials[0].extras.perilune_graph.nodes.skin.base_colour (here: materials.",
        ),
        (
            {"nodes": {**RED["nodes"], "x": {"type": "mth"}}},
            "nodes.x.type (here: materials.sat-mli_gold.nodes.x.type): no kind of node 'mth'; did",
        ),
        ({"nodes": {}}, "perilune_graph.nodes"),
        ({"node": {}}, "perilune_graph.node "),
        ([1], "perilune_graph: must be a mapping, not [1]"),
        ({"file": "x.yaml"}, "perilune_graph.file: a graph in a model names no other file"),
    ],
)
def test_errors_name_the_file_and_its_key(tmp_path: Path, graph: Any, text: str) -> None:
    with pytest.raises(ConfigError) as error:
        opened(with_graphs(tmp_path / "sat.glb", mli_gold=graph))
    assert text in str(error.value)


def test_a_model_without_graphs_is_not_parsed() -> None:
    assert _core.gltf_graphs(str(SATELLITE)) == "[]"
    assert _core.gltf_graphs("/nowhere.glb") == "[]"
