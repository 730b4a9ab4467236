"""Classes of `semantic` by values of material graphs, beside where the points are."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from tests.python.optics_scenes import at, ball, opened, tree
from tests.python.shape_scenes import ball as shape_ball, write_obj

import perilune
from perilune.config import ConfigError

OWN_LIGHT = ("albedo", "emission_w_m2_sr")  # which the material replaces
LEVELS = ["kind", "object", "part", "side"]


def sided(axis: list[float], **labels: Any) -> dict[str, Any]:
    """A material whose points have a class by a coordinate along an axis, m."""
    return {
        "nodes": {
            "where": {"type": "coordinates"},
            "along": {"type": "vector_math", "function": "dot", "a": "where", "b": axis},
            "skin": {"type": "principled", "base_color": [0.5, 0.5, 0.5]},
        },
        "labels": {
            "side": {"value": "along.value", "classes": {"far": [0.1, 1e9], "middle": [-0.1, 0.1]}}
            | labels
        },
    }


def scene(**labels: Any) -> dict[str, Any]:
    moon = ball(at(30.0, -6.0), 8.0, material="land")
    found = tree((64, 48), 60.0, moon={k: v for k, v in moon.items() if k not in OWN_LIGHT})
    found["materials"] = {"skin": sided([0.0, 1.0, 0.0], **labels), "land": sided([0.0, 0.0, 0.1])}
    found["spacecraft"]["sat"] = {
        "model": "assets/models/smallsat.glb",
        "size_m": 6.0,
        "orbit": {"around": "anchor", "position_km": at(12.0, 1.5)},
        "attitude": {"rotation_deg": [20.0, 30.0, 40.0]},
        "materials": [{"material": "*", "use": "skin"}],
    }
    found["labels"] = {"levels": LEVELS}
    return found


def named(sim: perilune.Simulation, sample: perilune.Sample) -> NDArray[Any]:
    """(H, W): names of classes at the level `side`."""
    names = sim.taxonomy.names("side")
    table = np.array([names.get(k, "") for k in range(max(names) + 1)])
    found: NDArray[Any] = table[sample["semantic"][..., LEVELS.index("side")]]
    return found


def expected(along: NDArray[Any]) -> NDArray[Any]:
    sides = np.where(along >= 0.1, "far", np.where(along >= -0.1, "middle", "background"))
    return np.asarray(sides)


@pytest.mark.parametrize(("name", "axis", "scale"), [("sat", 1, 1.0), ("moon", 2, 0.1)])
def test_the_class_is_that_of_the_point(repo_dir: Path, name: str, axis: int, scale: float) -> None:
    """On a spacecraft in metres along its model's axes, on a body along its own."""
    sim = opened(scene(), repo_dir)
    sample = sim.frame(0, ["semantic", "instance", "object_coords"], threads=1)
    on = sample["instance"] == sim.taxonomy.instances[name]
    along = scale * sample["object_coords"][..., axis][on]
    clear = np.abs(np.abs(along) - 0.1) > 1e-4  # not within rounding of a border
    found = named(sim, sample)[on]
    assert on.sum() > 100
    assert set(found) == {"far", "middle", "background"}
    assert np.array_equal(found[clear], expected(along)[clear])


@pytest.mark.parametrize("kind", ["shape", "terrain"])
def test_the_class_on_meshes_of_bodies(repo_dir: Path, tmp_path: Path, kind: str) -> None:
    """Heights and facets are those of the surface that is seen."""
    moved = scene()
    moon = moved["bodies"]["moon"]
    if kind == "shape":
        corners, faces = shape_ball(12)  # of 8 m, in km
        moon["shape"] = str(write_obj(tmp_path / "ball.obj", 8e-3 * corners, faces))
    else:
        moon["terrain"] = {"detail": {"deviation_m": 0.2, "baseline_m": 1.0, "hurst": 0.8}}
    sim = opened(moved, repo_dir)
    sample = sim.frame(0, ["semantic", "instance", "object_coords"])
    on = sample["instance"] == sim.taxonomy.instances["moon"]
    along = 0.1 * sample["object_coords"][..., 2][on]
    clear = np.abs(np.abs(along) - 0.1) > 1e-4
    assert on.sum() > 100
    assert np.array_equal(named(sim, sample)[on][clear], expected(along)[clear])
    assert len(set(named(sim, sample)[on])) == 3


def test_other_levels_and_surfaces_stay(repo_dir: Path) -> None:
    sim = opened(scene(), repo_dir)
    bare = scene()
    for row in bare["materials"].values():
        del row["labels"]
    bare["labels"]["levels"] = LEVELS[:3]
    plain = opened(bare, repo_dir).frame(0, ["semantic", "part"])
    sample = sim.frame(0, ["semantic", "part"])
    assert np.array_equal(sample["semantic"][..., :3], plain["semantic"])
    assert np.array_equal(sample["part"], plain["part"])
    assert not sample["semantic"][sample["part"] == 0].any()


def test_a_graph_takes_the_place_of_a_part(repo_dir: Path) -> None:
    """Where the graph has no class, a class by pattern does not come back: it says all."""
    both = scene()
    both["labels"]["classes"] = {"side": {"hull": ["*"]}}
    sim = opened(both, repo_dir)
    sample = sim.frame(0, ["semantic", "instance"])
    on = sample["instance"] == sim.taxonomy.instances["sat"]
    assert set(named(sim, sample)[on]) == {"far", "middle", "background"}
    both["spacecraft"]["sat"]["materials"] = []
    del both["bodies"]["moon"]["material"]
    both["bodies"]["moon"]["albedo"] = 0.5
    sim = opened(both, repo_dir)
    sample = sim.frame(0, ["semantic", "instance"])
    on = sample["instance"] == sim.taxonomy.instances["sat"]
    assert set(named(sim, sample)[on]) == {"hull"}


def test_a_driver_moves_the_border(repo_dir: Path) -> None:
    """Parameters of the material are those of the value."""
    drawn = scene()
    shift = {"uniform": [-1.0, 1.0]}
    drawn["materials"]["skin"]["nodes"]["moved"] = {
        "type": "math", "function": "add", "a": "along.value", "b": shift,
    }  # fmt: skip
    drawn["materials"]["skin"]["labels"]["side"]["value"] = "moved"
    drawn["materials"]["skin"]["nodes"]["skin"]["roughness"] = {"uniform": [0.2, 0.6]}
    sim = opened(drawn, repo_dir)
    borders = set()
    for index in range(3):
        world = sim.world(index)
        by = world.config.materials["skin"].nodes["moved"]["b"]
        sample = sim.frame(index, ["semantic", "instance", "object_coords"])
        on = sample["instance"] == sim.taxonomy.instances["sat"]
        along = sample["object_coords"][..., 1][on] + by
        clear = np.abs(np.abs(along) - 0.1) > 1e-4
        assert np.array_equal(named(sim, sample)[on][clear], expected(along)[clear])
        borders.add(round(by, 6))
    assert len(borders) > 1


def test_fixed_ids_and_lidars_know_them(repo_dir: Path) -> None:
    fixed = scene()
    fixed["labels"]["ids"] = {"side": {"far": 7}}
    fixed["lidars"] = {"top": {"pattern": {"kind": "flash", "columns": 30, "rows": 20,
                               "width_deg": 40.0, "height_deg": 30.0}}}  # fmt: skip
    sim = opened(fixed, repo_dir)
    assert sim.taxonomy.classes["side"]["far"] == 7
    sample = sim.frame(0, ["semantic"])
    assert 7 in sample["semantic"][..., 3]
    assert 7 in sim.lidar(0)["semantic"][:, 3]


@pytest.mark.parametrize(
    ("change", "told"),
    [
        ({"value": "alng.value"}, "labels.side.value: no node 'alng'; did you mean 'along'"),
        ({"value": "along.valu"}, "labels.side.value: 'along' has no output 'valu'"),
        ({"value": "skin"}, "labels.side.value: 'skin' is a surface, which has no output"),
        ({"classes": {"far": [1.0, 0.0]}}, "the least comes first"),
        ({"classes": {}}, "labels.side.classes"),
    ],
)
def test_faults_are_named(repo_dir: Path, change: dict[str, Any], told: str) -> None:
    wrong = scene()
    wrong["materials"]["skin"]["labels"]["side"] |= change
    with pytest.raises(ConfigError) as error:
        opened(wrong, repo_dir)
    assert told in str(error.value)


@pytest.mark.parametrize(
    ("level", "told"),
    [("sides", "none of labels.levels; did you mean 'side'"), ("part", "the key `part_classes`")],
)
def test_levels_must_be_ones_own(repo_dir: Path, level: str, told: str) -> None:
    wrong = scene()
    labels = wrong["materials"]["skin"]["labels"]
    labels[level] = labels["side"]
    with pytest.raises(ConfigError) as error:
        opened(wrong, repo_dir)
    assert f"materials.skin.labels.{level}" in str(error.value)
    assert told in str(error.value)
