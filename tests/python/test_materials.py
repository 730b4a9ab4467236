"""Material graphs from the configuration to the image: errors, patterns, drivers, wrapping."""

from __future__ import annotations

import copy
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st

import perilune
from perilune import _core
from perilune.config.errors import ConfigError
from perilune.config.materials import Material
from perilune.materials import build, values

SCENE = Path(__file__).parent / "scene.yaml"
STRIPES: dict[str, Any] = {
    "nodes": {
        "where": {"type": "coordinates"},
        "along": {"type": "vector_math", "function": "dot", "a": "where", "b": [0, 0, 12.0]},
        "wave": {"type": "math", "function": "sine", "a": "along.value"},
        "paint": {"type": "ramp", "value": "wave", "stops": [[-0.2, 0.9, 0, 0], [0.2, 0, 0, 0.9]]},
        "skin": {"type": "principled", "base_color": "paint", "roughness": 0.6},
    }
}
DRIVER = {"ideal": 0.5, "jitter_variance": 0.1, "clip_min": 0.0, "clip_max": 1.0}
HALF = {"min": [-1e3, -1e3, 0.0], "max": [1e3, 1e3, 1e3]}
FAR = {"min": [100, 100, 100], "max": [101, 101, 101]}
EVERYWHERE = [{"material": "*", "use": "m"}]


def opened(material: dict[str, Any], uses: Any = None, **more: Any) -> perilune.Simulation:
    changes = {"materials": {"m": material}, "spacecraft.sat.materials": uses or EVERYWHERE}
    return perilune.open(SCENE, overrides={**changes, **more})


def changed(node: str, **keys: Any) -> dict[str, Any]:
    material = copy.deepcopy(STRIPES)
    material["nodes"].setdefault(node, {}).update(keys)
    return material


def placed_on(sim: perilune.Simulation) -> Any:
    """The graphs of the spacecraft."""
    return sim._mine().assignments.of(sim.config).crafts["sat"]


def on_craft(sample: Any) -> Any:
    return sample["instance"] == sample["instance"].max()


def test_a_graph_paints_the_model_and_changes_no_label() -> None:
    plain, painted = perilune.open(SCENE)[0], opened(STRIPES)[0]
    craft = on_craft(plain)
    for name in ("depth", "semantic", "part", "instance"):
        assert np.array_equal(plain[name], painted[name])
    assert not np.array_equal(plain["rgb"][craft], painted["rgb"][craft])
    red, _, blue = painted["rgb"][craft].astype(int).T
    assert ((red > 3 * blue) & (red > 20)).any()
    assert ((blue > 3 * red) & (blue > 20)).any()


def test_a_graph_that_is_on_nothing_changes_no_bit() -> None:
    plain = perilune.open(SCENE)[0]
    unused = perilune.open(SCENE, overrides={"materials": {"m": STRIPES}})[0]
    assert np.array_equal(plain["rgb"], unused["rgb"])


def test_wrapping_without_inputs_changes_no_bit() -> None:
    """The materials of the model are all metallic-roughness, as the principled surface is."""
    bare = {"nodes": {"skin": {"type": "principled"}}}
    uses = [{"material": "*", "use": "m", "mode": "wrap"}]
    assert np.array_equal(perilune.open(SCENE)[0]["rgb"], opened(bare, uses)[0]["rgb"])


def test_the_first_pattern_that_fits_a_triangle_takes_it() -> None:
    sim = opened(
        STRIPES,
        [
            {"material": "MLI_*", "use": "m"},
            {"material": "*gold", "use": "m", "mode": "wrap"},
            {"part": "*", "material": "solar_cell", "use": "m", "mode": "wrap"},
        ],
    )
    placed = placed_on(sim)
    model = sim.models["sat"].model
    material = np.array([part["material"] for part in model.parts])[model.mesh()["triangle_part"]]
    expected = np.full(len(material), -1)
    expected[np.char.startswith(material, "mli_")] = 0
    expected[material == "solar_cell"] = 2
    assert np.array_equal(placed.triangle_graph, expected)


def test_boxes_of_parts_place_a_graph() -> None:
    box = {"boxes": {"half": HALF}}
    sim = opened(STRIPES, [{"part": "half", "use": "m"}], **{"spacecraft.sat.parts": box})
    mesh = sim.models["sat"].model.mesh()
    height = mesh["positions"][mesh["indices"]].astype(float).mean(axis=1)[:, 2]
    assert np.array_equal(placed_on(sim).triangle_graph == 0, height >= 0.0)


def test_a_box_and_a_component_place_a_graph_as_parts_of_their_names_do() -> None:
    """The same triangles, however the parts themselves are cut."""
    ways: list[tuple[dict[str, Any], dict[str, Any], dict[str, Any]]] = [
        ({"box": HALF}, {"part": "half"}, {"boxes": {"half": HALF}}),
        ({"component": "component-1*"}, {"part": "component-1*"}, {"split": "component"}),
    ]
    for direct, by_part, parts in ways:
        direct_sim = opened(STRIPES, [{**direct, "use": "m"}])
        part_sim = opened(STRIPES, [{**by_part, "use": "m"}], **{"spacecraft.sat.parts": parts})
        placed = [placed_on(sim).triangle_graph for sim in (direct_sim, part_sim)]
        assert np.array_equal(*placed)
        assert (placed[0] == 0).any()
        assert (placed[0] < 0).any()


def test_all_patterns_of_a_use_must_fit() -> None:
    uses = [{"box": HALF, "material": "mli_*", "use": "m"}, {"box": HALF, "use": "m"}]
    both, half = (placed_on(opened(STRIPES, uses[k:])) for k in (0, 1))
    assert np.array_equal(both.triangle_graph >= 0, half.triangle_graph >= 0)
    model = perilune.open(SCENE).models["sat"].model
    material = np.array([part["material"] for part in model.parts])[model.mesh()["triangle_part"]]
    foil = np.char.startswith(material, "mli_")
    assert np.array_equal(both.triangle_graph == 0, foil & (half.triangle_graph >= 0))


def test_drivers_of_a_graph_are_drawn_for_each_frame() -> None:
    material = changed("skin", base_color=[DRIVER, 0.25, 0.25])
    sim = opened(material)
    key = "materials.m.nodes.skin.base_color[0]"
    drawn = [sim.config_at(index)[1][key] for index in range(2)]
    assert drawn[0] != drawn[1]
    for index in range(2):
        fixed = opened(changed("skin", base_color=[drawn[index], 0.25, 0.25]))
        assert np.array_equal(sim[index]["rgb"], fixed[index]["rgb"])
        config = sim.config_at(index)[0]
        (graph,) = placed_on(sim).graphs
        assert values(graph, config.materials["m"]).tolist() == [[drawn[index], 0.25, 0.25]]


def test_graphs_stay_on_parts_that_move() -> None:
    """A hinge at rest sorts the model's triangles anew, but moves nothing."""
    uses = [{"material": "mli_*", "use": "m"}, {"material": "panel_back", "use": "m"}]
    hinge = [{"node": "panel_left", "axis": [0, 1, 0], "angle_deg": 0.0}]
    still = opened(STRIPES, uses)[0]["rgb"].astype(int)
    hinged = opened(STRIPES, uses, **{"spacecraft.sat.articulation": hinge})[0]["rgb"].astype(int)
    bare = perilune.open(SCENE)[0]["rgb"].astype(int)
    assert (abs(hinged - still).max(axis=2) > 2).mean() < 0.02  # rays graze other edges
    assert (abs(bare - still).max(axis=2) > 2).sum() > 20


HOLES: dict[str, Any] = {
    "nodes": {
        "where": {"type": "coordinates"},
        "net": {"type": "checker", "vector": "where", "scale": 2.5, "a": 0.0, "b": 1.0},
        "skin": {"type": "lambert", "base_color": 0.7, "alpha": "net"},
    }
}


def test_holes_are_in_sight_and_in_all_labels() -> None:
    plain, net = perilune.open(SCENE)[0], opened(HOLES)[0]
    craft = plain["instance"].max()
    through = (plain["instance"] == craft) & (net["instance"] != craft)
    seen = (net["instance"] == craft).sum()
    assert 0.2 < seen / (plain["instance"] == craft).sum() < 0.9
    assert ((net["depth"] == 0.0) | (net["depth"] > plain["depth"]))[through].all()
    whole, row = (frame.objects[frame.objects["instance_id"] == craft][0] for frame in (plain, net))
    assert row["px_count_visib"] == seen
    assert row["px_count_all"] < whole["px_count_all"]


def test_bodies_have_no_holes() -> None:
    with pytest.raises(ConfigError, match=r"bodies\.earth\.material: 'm' has an alpha, "):
        perilune.open(SCENE, overrides={"materials": {"m": HOLES}, "bodies.earth.material": "m"})


def test_holes_stay_on_parts_that_move() -> None:
    hinge = [{"node": "panel_left", "axis": [0, 1, 0], "angle_deg": 0.0}]
    still = opened(HOLES)[0]
    hinged = opened(HOLES, **{"spacecraft.sat.articulation": hinge})[0]
    assert (still["instance"] != hinged["instance"]).mean() < 0.005  # rays graze other edges
    assert abs(still.objects["px_count_all"] - hinged.objects["px_count_all"]).max() <= 8


def test_emission_of_a_graph_is_seen() -> None:
    lamp = {
        "nodes": {
            "skin": {
                "type": "lambert",
                "base_color": 0.0,
                "emission_color": [0.0, 1.0, 0.0],
                "emission_strength": 200.0,
            }
        }
    }
    exposure = {"mode": "fixed", "white_radiance_w_m2_sr": 200}
    sample = opened(lamp, **{"camera.exposure": exposure})[0]
    inside = sample["rgb"][on_craft(sample)].reshape(-1, 3)
    assert (inside == [0, 255, 0]).all(axis=1).mean() > 0.3  # the others are at the outline


@pytest.mark.parametrize(
    ("node", "keys", "text"),
    [
        ("skin", {"roughness": "wav"}, "nodes.skin.roughness: no node 'wav'; did you mean 'wave'?"),
        ("skin", {"rough": 1.0}, "nodes.skin.rough: unknown key of a node 'principled'; did you"),
        ("skin", {"roughness": "wave.colour"}, "'wave' has no output 'colour'; allowed: value"),
        ("skin", {"roughness": [1, 2, 3]}, "nodes.skin.roughness: must be a number or the name"),
        ("skin", {"base_color": [1, 2]}, "nodes.skin.base_color: must be a number, three numbers"),
        ("skin", {"base_color": True}, "nodes.skin.base_color: must be a number, three numbers"),
        ("skin", {"base_color": "skin"}, "'skin' is a surface, which has no output"),
        ("wave", {"function": "sinus"}, "nodes.wave.function: no 'sinus'; did you mean 'sine'?"),
        ("wave", {"clamp": 2}, "nodes.wave.clamp: must be a number from 0 to 1, not 2"),
        ("wave", {"type": "meth"}, "nodes.wave.type: no kind of node 'meth'; did you mean 'math'?"),
        ("new", {"value": 1.0}, "nodes.new.type: required, but missing"),
        ("new", {"type": "lambert"}, "materials.m: must have one surface (lambert, metallic_rou"),
        ("where", {"space": DRIVER}, "nodes.where.space: takes no driver: it is fixed"),
        ("paint", {"stops": [[0, 1, 1, 1], [0, 1]]}, "nodes.paint.stops[1]: must be 4 numbers"),
        ("paint", {"stops": [[1, 0, 0, 0], [0, 1, 1, 1]]}, "nodes.paint.stops: positions must ris"),
        ("along", {"b": "wave"}, "materials.m: nodes form a cycle: along -> wave -> along"),
        ("skin", {"roughness": {"choice": ["wave", 0.5]}}, "nodes.skin.roughness: takes no driver"),
        ("wave", {"function": {"choice": ["sine", "cosine"]}}, "nodes.wave.function: takes no dri"),
        ("1x", {"type": "value"}, "materials.m.nodes.1x: a node's name is letters"),
    ],
)
def test_errors_name_the_key(node: str, keys: dict[str, Any], text: str) -> None:
    with pytest.raises(ConfigError) as error:
        opened(changed(node, **keys))
    assert text in str(error.value)
    assert "materials.m" in str(error.value)


@pytest.mark.parametrize(
    ("use", "text"),
    [
        ({"use": "m"}, "materials[0]: say where: material, part, component, box"),
        ({"component": "small", "use": "m"}, "materials[0].component: no component fits 'small'"),
        ({"box": FAR, "use": "m"}, "materials[0].box: no triangle is in it (none has its centroid"),
        ({"box": HALF, "material": "x", "use": "m"}, "materials[0].material: no material fits 'x'"),
        ({"box": {**FAR, "max": [0, 0, 0]}, "use": "m"}, "materials[0].box.max: x: must be above"),
        ({"part": "*", "use": "mm"}, "materials[0].use: no entry named 'mm'; did you mean 'm'?"),
        ({"material": "mli_gol", "use": "m"}, "no material fits 'mli_gol'; did you mean"),
        ({"material": "*", "use": "m", "mode": "over"}, "mode"),
    ],
)
def test_errors_of_uses_name_the_key(use: dict[str, Any], text: str) -> None:
    with pytest.raises(ConfigError) as error:
        opened(STRIPES, [use])[0]
    assert text in str(error.value)


# --- random graphs -------------------------------------------------------------------------------

FEW = [name for name, kind in _core.NODES.items() if not kind["surface"] and name != "ramp"]
NUMBER = st.floats(-1e6, 1e6, width=32)


@st.composite
def materials(draw: st.DrawFn) -> Material:
    """A chain of nodes of any kind; each input is a number or an output before it."""
    nodes: dict[str, dict[str, Any]] = {}
    outputs: list[str] = []
    for k in range(draw(st.integers(1, 8))):
        kind_name = draw(st.sampled_from(FEW))
        kind = _core.NODES[kind_name]
        node: dict[str, Any] = {"type": kind_name}
        for socket in kind["inputs"]:
            if outputs and draw(st.booleans()):
                node[socket["name"]] = draw(st.sampled_from(outputs))
            elif draw(st.booleans()):
                node[socket["name"]] = draw(NUMBER)
        for row in kind["constants"]:
            if row["type"] == "choice":
                node[row["name"]] = draw(st.sampled_from(row["choices"]))
            elif row["type"] == "image":
                node[row["name"]] = "white.png"
        nodes[f"n{k}"] = node
        outputs += [f"n{k}.{row['name']}" for row in kind["outputs"]]
    surface: dict[str, Any] = {"type": "principled"}
    for socket in _core.NODES["principled"]["inputs"]:
        surface[socket["name"]] = draw(st.sampled_from(outputs))
    nodes["skin"] = surface
    return Material(nodes=nodes)


@settings(max_examples=150, deadline=None)
@given(materials(), st.floats(0.0, 1e3), st.integers(0, 2**32 - 1))
def test_every_graph_gives_a_surface_within_limits(
    material: Material, radius: float, seed: int
) -> None:
    graph = build("m", material, False, None)
    points = np.random.default_rng(seed).normal(size=(16, 3)) * 10.0 ** np.arange(-8, 8)[:, None]
    for width in (radius, np.inf):
        out = graph.core.evaluate(points, width, np.empty((0, 4), dtype=np.float32))
        assert np.isfinite(out).all()
        assert ((out[:, :5] >= 0.0) & (out[:, :5] <= 1.0)).all()
        assert (out[:, 5:] >= 0.0).all()
