"""Drivers of nodes of material graphs by name: scopes, instances, replay, errors, statistics."""

from __future__ import annotations

import copy
import json
import random
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st
from scipy import stats

import perilune
from perilune import materials
from perilune.config import ConfigError
from perilune.document import load
from perilune.document.loader import read_tree

SCENE = Path(__file__).parent / "scene.yaml"
SCALE = {"ideal": 1.0, "jitter_variance": 0.25, "clip_min": 0.2, "clip_max": 4.0}
TINT = {"uniform": [[0.1, 0.1, 0.1], [0.9, 0.9, 0.9]]}
FOIL: dict[str, Any] = {
    "nodes": {
        "where": {"type": "coordinates"},
        "OAISYS_scale": {"type": "value", "value": 1.0},
        "driver:tint": {"type": "color", "color": [0.9, 0.5, 0.1]},
        "noise": {"type": "noise", "vector": "where", "scale": "OAISYS_scale"},
        "paint": {"type": "mix", "factor": "noise", "a": "driver:tint", "b": [0.0, 0.0, 0.9]},
        "skin": {"type": "principled", "base_color": "paint", "roughness": 0.6},
    }
}
OWN = "materials.foil.drivers.drivers.scale"


def tree(**changes: Any) -> dict[str, Any]:
    """The small scene with two spacecraft that are covered by one graph."""
    found = read_tree(SCENE)
    found["time"]["frames_per_scene"] = 2
    found["spacecraft"]["sat"]["materials"] = [{"material": "*", "use": "foil"}]
    found["spacecraft"]["other"] = copy.deepcopy(found["spacecraft"]["sat"])
    found["spacecraft"]["other"]["orbit"]["mean_anomaly_deg"] = 20.00005
    found["materials"] = {"foil": copy.deepcopy(FOIL)}
    for key, value in changes.items():
        node = found
        *way, last = key.split("__")
        for part in way:
            node = node.setdefault(part, {})
        node[last] = copy.deepcopy(value)
    return found


def opened(raw: dict[str, Any], **more: Any) -> perilune.Simulation:
    return perilune.open(raw, base=SCENE.parent, **more)


def drawn(raw: dict[str, Any], frame: int = 0, seed: int = 5) -> dict[str, Any]:
    return opened(raw, seed=seed).config_at(frame)[1]


def values_of(sim: perilune.Simulation, frame: int, craft: str) -> list[float]:
    """Scale, and the first component of the tint, that the core is given for a spacecraft."""
    material = materials.applied(sim.config_at(frame)[0], "foil", craft)
    scale, tint = material.nodes["OAISYS_scale"]["value"], material.nodes["driver:tint"]["color"]
    return [scale, tint[0]]


# --- what drives what ----------------------------------------------------------------------------


def test_a_driven_node_is_as_if_its_value_stood_in_the_graph() -> None:
    section = {"drivers": {"scale": SCALE, "tint": TINT}}
    sim = opened(tree(materials__foil__drivers=section), seed=5)
    for frame in (0, 2):
        values = sim[frame].meta["drivers"]
        assert set(values) == {OWN, "materials.foil.drivers.drivers.tint"}
        fixed = tree()
        nodes = fixed["materials"]["foil"]["nodes"]
        nodes["OAISYS_scale"]["value"] = values[OWN]
        nodes["driver:tint"]["color"] = values["materials.foil.drivers.drivers.tint"]
        assert np.array_equal(sim[frame]["rgb"], opened(fixed, seed=5)[frame]["rgb"])
        nodes["OAISYS_scale"]["value"] *= 2.0
        assert not np.array_equal(sim[frame]["rgb"], opened(fixed, seed=5)[frame]["rgb"])


def test_a_driver_whose_ideal_is_the_nodes_own_value() -> None:
    sim = opened(tree(materials__foil__drivers={"drivers": {"scale": SCALE}}), seed=5)
    assert SCALE["ideal"] == FOIL["nodes"]["OAISYS_scale"]["value"]
    for frame in (0, 2):
        parameters = sim.request(frame)["graph_parameters"]
        assert parameters.tolist() == [[sim.config_at(frame)[1][OWN]] * 3] * 2


def test_nodes_without_an_entry_keep_their_value() -> None:
    sim = opened(tree(materials__foil__drivers={"drivers": {"tint": TINT}}), seed=5)
    assert values_of(sim, 0, "sat")[0] == 1.0
    assert not np.array_equal(sim[0]["rgb"], opened(tree(), seed=5)[0]["rgb"])


def test_the_narrower_section_comes_first() -> None:
    """A material's own drivers, then the spacecraft's, then those of the top level."""
    raw = tree(
        material_drivers={"drivers": {"scale": 2.0, "tint": [0.25] * 3}},
        spacecraft__sat__material_drivers={"drivers": {"scale": 3.0}},
    )
    assert values_of(opened(raw), 0, "sat") == [3.0, 0.25]
    assert values_of(opened(raw), 0, "other") == [2.0, 0.25]
    raw["materials"]["foil"]["instances"] = {"other": {"drivers": {"scale": 5.0}}}
    raw["materials"]["foil"]["drivers"] = {"drivers": {"tint": [0.5] * 3}}
    del raw["material_drivers"]
    assert values_of(opened(raw), 0, "sat") == [3.0, 0.5]
    assert values_of(opened(raw), 0, "other") == [5.0, 0.5]


def test_one_name_in_several_graphs_has_one_value() -> None:
    raw = tree(material_drivers={"drivers": {"scale": SCALE}})
    raw["materials"]["second"] = copy.deepcopy(FOIL)
    raw["spacecraft"]["other"]["materials"][0]["use"] = "second"
    config = opened(raw).config_at(0)[0]
    values = {
        materials.applied(config, name).nodes["OAISYS_scale"]["value"]
        for name in ("foil", "second")
    }
    assert len(values) == 1
    assert drawn(raw).keys() == {"material_drivers.drivers.scale"}


@pytest.mark.parametrize("key", ["materials__foil__drivers", "material_drivers"])
def test_each_instance_draws_for_itself(key: str) -> None:
    raw = tree(**{key: {"drivers": {"scale": SCALE, "tint": TINT}, "per": "instance"}})
    sim = opened(raw, seed=5)
    sat, other = values_of(sim, 0, "sat"), values_of(sim, 0, "other")
    assert sat != other
    at = "materials.foil.instances.sat" if "foil" in key else "spacecraft.sat.material_drivers"
    values = sim.config_at(0)[1]
    assert values[f"{at}.drivers.scale"] == sat[0]
    assert len(values) == 4
    raw = tree(**{key: {"drivers": {"scale": SCALE, "tint": TINT}, "per": "material"}})
    sim = opened(raw, seed=5)
    assert values_of(sim, 0, "sat") == values_of(sim, 0, "other")


def test_instances_look_as_their_own_values_say() -> None:
    section = {"drivers": {"tint": TINT}, "per": "instance"}
    sim = opened(tree(materials__foil__drivers=section), seed=5)
    tints = {k.split(".")[3]: v for k, v in sim.config_at(0)[1].items()}
    fixed = tree()
    for craft, tint in tints.items():
        fixed["materials"][craft] = copy.deepcopy(FOIL)
        fixed["materials"][craft]["nodes"]["driver:tint"]["color"] = tint
        fixed["spacecraft"][craft]["materials"][0]["use"] = craft
    sample = sim[0]
    assert len(np.unique(sample["instance"])) >= 3
    assert np.array_equal(sample["rgb"], opened(fixed, seed=5)[0]["rgb"])


def test_drivers_in_a_file_are_merged_with_those_beside_it(tmp_path: Path) -> None:
    section = {"drivers": {"scale": SCALE, "tint": TINT}, "jitter_strength": 0.0}
    (tmp_path / "foil.json").write_text(json.dumps({**FOIL, "drivers": section}))
    material = {"file": str(tmp_path / "foil.json"), "drivers": {"drivers": {"scale": 2.0}}}
    sim = opened(tree(materials__foil=material))
    assert values_of(sim, 0, "sat") == [2.0, 0.5]
    material["drivers"] = {"jitter_strength": 1.0, "per": "instance"}
    sim = opened(tree(materials__foil=material), seed=5)
    assert values_of(sim, 0, "sat") != values_of(sim, 0, "other")
    section["drivers"]["scale"] = {**SCALE, "clip_min": 9.0}
    (tmp_path / "foil.json").write_text(json.dumps({**FOIL, "drivers": section}))
    with pytest.raises(ConfigError, match=r"foil\.json: drivers\.drivers\.scale"):
        opened(tree(materials__foil={"file": str(tmp_path / "foil.json")}))


# --- draws ---------------------------------------------------------------------------------------


def test_the_values_follow_the_clipped_distribution() -> None:
    """Kolmogorov-Smirnov between the clips, where clipping changes no CDF; P(false) < 1e-6."""
    count, strength = 1500, 4.0
    section = {"drivers": {"scale": SCALE}, "jitter_strength": strength, "step_interval": 1}
    document = load(tree(materials__foil__drivers=section), base=SCENE.parent)
    values = np.sort([document._values(step)[*OWN.split("."),] for step in range(count)])
    law = stats.norm(1.0, np.sqrt(0.25 * strength))
    inside = (values > 0.2) & (values < 4.0)
    steps = np.arange(1, count + 1)[inside] / count
    expected = law.cdf(values[inside])
    distance = max(abs(expected - steps).max(), abs(expected - steps + 1.0 / count).max())
    assert distance * np.sqrt(count) < 2.7
    assert values[0] == 0.2
    share = law.cdf(0.2)
    assert abs((values == 0.2).mean() - share) < 5.0 * np.sqrt(share * (1 - share) / count)


def test_strength_0_gives_the_bits_of_the_ideal() -> None:
    ideal = 1.0 / 3.0
    section = {"drivers": {"scale": {**SCALE, "ideal": ideal}}, "jitter_strength": 0.0}
    fixed = tree()
    fixed["materials"]["foil"]["nodes"]["OAISYS_scale"]["value"] = ideal
    own = "spacecraft__sat__material_drivers"
    for key in ("materials__foil__drivers", "material_drivers", own):
        raw = tree(**{key: section})
        if key == own:
            raw["spacecraft"]["other"]["material_drivers"] = copy.deepcopy(section)
        sim = opened(raw, seed=5)
        assert set(sim.config_at(3)[1].values()) == {ideal}
        assert np.array_equal(sim[3]["rgb"], opened(fixed, seed=5)[3]["rgb"])


def test_intervals() -> None:
    """Once a scene of two steps unless the section says otherwise."""
    section: dict[str, Any] = {"drivers": {"scale": SCALE}}
    for interval, pattern in ((None, "aabbccdd"), (1, "abcdefgh"), (3, "aaabbbcc")):
        if interval is not None:
            section["step_interval"] = interval
        document = load(tree(materials__foil__drivers=section), base=SCENE.parent)
        found = [document.at(frame)[1][OWN] for frame in range(8)]
        names = dict(zip(dict.fromkeys(found), "abcdefgh", strict=False))
        assert "".join(names[value] for value in found) == pattern


@settings(max_examples=30, deadline=None)
@given(st.randoms(use_true_random=False), st.integers(0, 2**31), st.integers(0, 50))
def test_draws_do_not_depend_on_the_order_of_anything(
    rng: random.Random, seed: int, frame: int
) -> None:
    section = {"drivers": {"scale": SCALE, "tint": TINT}, "per": "instance"}
    raw = tree(materials__foil__drivers=section)
    raw["materials"]["second"] = copy.deepcopy(raw["materials"]["foil"])
    raw["spacecraft"]["sat"]["materials"].append({"part": "*", "use": "second"})

    def shuffled(node: Any) -> Any:
        if not isinstance(node, dict):
            return node
        keys = list(node)
        rng.shuffle(keys)
        return {key: shuffled(node[key]) for key in keys}

    assert drawn(shuffled(raw), frame, seed) == drawn(raw, frame, seed)


# --- replay --------------------------------------------------------------------------------------

SECTIONS = {
    "materials__foil__drivers": {"drivers": {"scale": SCALE}, "per": "instance"},
    "material_drivers": {"drivers": {"tint": TINT}, "step_interval": 1},
}


def test_replay_from_a_sample_has_the_same_bits() -> None:
    raw = tree(**SECTIONS)
    sample = opened(raw, seed=5)[3]
    assert len(sample.meta["drivers"]) == 3
    meta = json.loads(json.dumps({key: sample.meta[key] for key in ("index", "drivers", "seed")}))
    for again in (
        opened(raw, replay=meta),
        opened(raw, seed=5, overrides=meta["drivers"]),
        opened(raw, seed=6, replay=meta),
    ):
        assert again.config_at(3)[1] in ({}, sample.meta["drivers"])
        if again.config.seed == 5:
            assert np.array_equal(again[3]["rgb"], sample["rgb"])


def test_replay_from_a_dataset_has_the_same_bits(tmp_path: Path) -> None:
    raw = tree(**SECTIONS)
    sim = opened(raw, seed=5)
    perilune.write_bop(sim, range(2), tmp_path / "out", threads=1)
    cameras = json.loads((tmp_path / "out/train/000000/scene_camera.json").read_text())
    replay = cameras["1"]["frame"]
    assert replay["drivers"] == sim.config_at(1)[1]
    again = opened(raw, seed=5, replay=replay)
    assert np.array_equal(again[replay["index"]]["rgb"], sim[1]["rgb"])


# --- errors --------------------------------------------------------------------------------------

_AT = "materials.foil.drivers.drivers"


@pytest.mark.parametrize(
    ("driver", "text"),
    [
        ({"scal": SCALE}, f"{_AT}.scal: drives nothing: no node 'OAISYS_scal' or 'driver:scal'; d"),
        ({"OAISYS_scale": SCALE}, f"{_AT}.OAISYS_scale: drives nothing: no node"),
        ({"noise": SCALE}, f"{_AT}.noise: drives nothing: no node"),
        ({"scale": TINT}, f"{_AT}.scale: must be one number: 'OAISYS_scale' is a node 'value'"),
        ({"scale": "fine"}, f"{_AT}.scale = 'fine': must be a driver, a number or three numbers"),
        ({"tint": {"choice": [0.5, [1, 0]]}}, f"{_AT}.tint"),
        ({"scale": {**SCALE, "jitter_variance": -1.0}}, f"{_AT}.scale.jitter_variance: must not b"),
        ({"scale": {**SCALE, "clip_min": 5.0}}, f"{_AT}.scale.clip_min: 5 is above clip_max = 4"),
        ({"scale": {**SCALE, "ideal": 5.0}}, f"{_AT}.scale.ideal: 5 is outside [clip_min, clip_ma"),
        ({"scale": {**SCALE, "jitter": 1.0}}, f"{_AT}.scale.jitter: unknown key of a driver; did"),
        ({"scale": {"ideal": 1.0}}, f"{_AT}.scale: a driver needs"),
        ({}, "materials.foil.drivers.drivers"),
    ],
)
def test_faulty_entries_are_named(driver: dict[str, Any], text: str) -> None:
    with pytest.raises(ConfigError) as error:
        opened(tree(materials__foil__drivers={"drivers": driver}))
    assert text in str(error.value)


ONE = {"drivers": {"scale": SCALE}}


@pytest.mark.parametrize(
    ("changes", "text"),
    [
        ({"material_drivers": {"drivers": {"scal": SCALE}}}, "material_drivers.drivers.scal: driv"),
        (
            {"material_drivers": {"drivers": {"scal": SCALE}, "per": "instance"}},
            "material_drivers.drivers.scal: drives nothing: no node",
        ),
        (
            {"material_drivers": ONE, "materials__foil__drivers": ONE},
            "material_drivers.drivers.scale: drives nothing: other drivers come before it",
        ),
        (
            {"materials__foil__instances": {"moon": ONE}},
            "materials.foil.instances.moon.drivers.scale: drives nothing",
        ),
        (
            {"materials__foil__nodes__noise__scale": 2.0, "material_drivers": ONE},
            "material_drivers.drivers.scale: drives nothing: no surface depends on the node",
        ),
        (
            {"materials__foil__nodes__OAISYS_scale__value": "where", "material_drivers": ONE},
            "drives nothing: value of the node 'OAISYS_scale' is linked to 'where'",
        ),
        (
            {"materials__foil__nodes__OAISYS_scale__value": SCALE, "material_drivers": ONE},
            "drives nothing: value of the node 'OAISYS_scale' has a driver of its own",
        ),
        ({"material_drivers": {**ONE, "per": "craft"}}, "material_drivers.per"),
        ({"material_drivers": {**ONE, "jitter_strength": -1.0}}, "material_drivers.jitter_strengt"),
        ({"material_drivers": {**ONE, "step_interval": 0}}, "material_drivers.step_interval"),
        (
            {"material_drivers": {"choice": [{"drivers": {"scale": 1.0}}]}},
            "material_drivers: takes no driver",
        ),
        (
            {"spacecraft__sat__material_drivers": {**ONE, "per": "instance"}},
            "spacecraft.sat.material_drivers.per: unknown key",
        ),
    ],
)
def test_faulty_sections_are_named(changes: dict[str, Any], text: str) -> None:
    with pytest.raises(ConfigError) as error:
        opened(tree(**changes))
    assert text in str(error.value)


def test_no_variance_and_limits_that_meet() -> None:
    still = {**SCALE, "jitter_variance": 0.0}
    tight = {**SCALE, "jitter_variance": 1e300, "clip_min": 1.0, "clip_max": 1.0}
    for driver in (still, tight):
        raw = tree(materials__foil__drivers={"drivers": {"scale": driver}, "step_interval": 1})
        assert {drawn(raw, frame)[OWN] for frame in range(5)} == {1.0}
    clips = {**SCALE, "jitter_variance": 1e300}
    raw = tree(materials__foil__drivers={"drivers": {"scale": clips}, "step_interval": 1})
    assert {drawn(raw, frame)[OWN] for frame in range(20)} == {0.2, 4.0}


def test_strengths_can_rise_from_draw_to_draw() -> None:
    """One a draw, here of two steps; the last stays. Each is as if it were alone."""
    section = {"drivers": {"scale": SCALE}, "jitter_strength": [0.0, 0.5, 4.0]}
    rising = opened(tree(materials__foil__drivers=section), seed=5)
    for frame in range(10):
        alone = section | {"jitter_strength": (0.0, 0.5, 4.0)[min(frame // 2, 2)]}
        expected = drawn(tree(materials__foil__drivers=alone), frame)
        assert rising.config_at(frame)[1] == expected
        assert frame >= 2 or expected[OWN] == SCALE["ideal"]


@pytest.mark.parametrize(
    ("strength", "text"),
    [
        ([], "drivers.jitter_strength: must be a number, or a list of them, one a draw"),
        ([0.5, -1.0], "drivers.jitter_strength[1]: must not be negative: -1"),
        ([None], "drivers.jitter_strength[0]: must be a finite number, not None"),
    ],
)
def test_lists_of_strengths_that_are_wrong(strength: list[Any], text: str) -> None:
    section = {"drivers": {"scale": SCALE}, "jitter_strength": strength}
    with pytest.raises(ConfigError) as caught:
        opened(tree(materials__foil__drivers=section))
    assert text in str(caught.value)
