"""Labels of nodes and parts: against the channel `part`, against the model cut to one part, and
against the model's own tree."""

from __future__ import annotations

import numpy as np
import pytest
from tests.python.output.conftest import small_configuration, write_probe

import perilune

WIDTH, HEIGHT = 64, 48
CHANNELS = ["part", "instance", "objects", "hierarchy"]


@pytest.fixture(scope="module")
def sim(repo_dir):
    """The station, part of which is cut by the frame."""
    changes = {"camera.width": WIDTH, "camera.height": HEIGHT, "render.samples": 1}
    return perilune.open(repo_dir / "configs/articulated.yaml", overrides=changes)


@pytest.fixture(scope="module")
def sample(sim):
    return sim.frame(0, CHANNELS)


def box(mask):
    y, x = np.nonzero(mask)
    return [x.min(), y.min(), np.ptp(x), np.ptp(y)] if y.size else [-1] * 4


def test_rows_follow_the_tree_of_the_model(sim, sample):
    """Each row is below one before it, a node below the node that the file says, and the first is
    the spacecraft with the label of `objects`."""
    rows = sample.hierarchy
    assert rows["id"].tolist() == list(range(1, len(rows) + 1))
    assert (rows["parent"] < rows["id"]).all()
    root, label = rows[0], sample.objects[0]
    assert (root["parent"], root["kind"], root["name"]) == (0, "spacecraft", "station")
    for field in ("R_m2c", "t_m2c", "bbox_visib", "bbox_obj", "px_count_visib", "px_count_all"):
        np.testing.assert_array_equal(root[field], label[field])
    nodes = {row["name"]: row for row in rows if row["kind"] == "node"}
    tree = sim.models["station"].model.nodes
    for node in tree:
        if node["name"] in nodes and node["parent"] >= 0:
            above = rows[nodes[node["name"]]["parent"] - 1]
            assert above["name"] == tree[node["parent"]]["name"]
    array, panel = nodes["array_left"], nodes["array_left_panel_3"]
    assert panel["parent"] == array["id"]
    parts = rows[rows["kind"] == "part"]
    assert parts["part_id"].tolist() == [part.id for part in sim.taxonomy.parts_of("station")]


def test_what_is_seen_is_that_of_the_channel_part(sample):
    rows = sample.hierarchy
    below = {row["id"]: {row["part_id"]} - {0} for row in rows}
    for row in rows[::-1]:
        if row["parent"]:
            below[row["parent"]] |= below[row["id"]]
    seen = 0
    for row in rows:
        mask = np.isin(sample["part"], sorted(below[row["id"]]))
        assert row["px_count_visib"] == np.count_nonzero(mask), row["name"]
        assert row["bbox_visib"].tolist() == box(mask)
        assert row["px_count_all"] >= row["px_count_valid"] >= row["px_count_visib"]
        share = row["px_count_visib"] / max(row["px_count_all"], 1)
        assert row["visib_fract"] == pytest.approx(share, abs=1e-15)
        seen += mask.any()
    assert seen > 10
    assert (rows["visib_fract"][rows["px_count_visib"] > 0] < 1.0).any()


def test_boxes_of_what_is_seen_hold_those_below(sample):
    """The whole box of a row holds those of the rows below it that are seen."""
    rows = sample.hierarchy
    for row in rows[rows["px_count_visib"] > 0]:
        if not row["parent"]:
            continue
        x, y, w, h = row["bbox_obj"]
        X, Y, W, H = rows[row["parent"] - 1]["bbox_obj"]
        assert x >= X
        assert y >= Y
        assert x + w <= X + W
        assert y + h <= Y + H
        assert rows[row["parent"] - 1]["px_count_all"] >= row["px_count_all"]


def test_a_part_alone_has_the_silhouette_of_its_row(small_probe, tmp_path):
    """The wing of the probe without the bus, in the same pose, has all the pixels of its row."""
    sim, _ = small_probe
    checked = 0
    for index in range(4):
        rows = sim.frame(index, CHANNELS).hierarchy
        for part, row in enumerate(rows[rows["kind"] == "part"]):
            hidden = {1 - part: True}
            canvas = lone(sim, index, hidden)
            assert row["px_count_all"] == np.count_nonzero(canvas)
            checked += np.count_nonzero(canvas) > row["px_count_visib"] > 0
    assert checked > 0


@pytest.fixture(scope="module")
def small_probe(tmp_path_factory):
    folder = tmp_path_factory.mktemp("probe")
    write_probe(folder / "probe.glb")
    return perilune.open(world(folder / "probe.glb")), folder


def world(model):
    """The probe alone, some of whose frames cut it."""
    config = small_configuration()
    config["spacecraft"]["probe"]["model"] = str(model)
    trajectory = {
        **config["camera"]["trajectory"],
        "distance_m": [6.0, 9.0],
        "aim_jitter_deg": 12.0,
    }
    config["camera"] = {"width": WIDTH, "height": HEIGHT, "fov_deg": 30.0, "trajectory": trajectory}
    return config


def lone(sim, index, hidden):
    """(3 H, 3 W): pixels of a canvas that show one part of the probe, by casting rays of a camera
    of three times the size at a probe of which a graph leaves nothing of the other part."""
    K = np.array(sim.frame(index, ["instance"]).camera.K)
    K[:2, 2] += WIDTH, HEIGHT
    names = [part.material for part in sim.taxonomy.parts_of("probe")]
    gone = {"nodes": {"s": {"type": "principled", "alpha": 0.0}}}
    changes = {
        "camera.width": 3 * WIDTH,
        "camera.height": 3 * HEIGHT,
        "camera.fov_deg": None,
        "camera.K": K.ravel().tolist(),
        "materials.gone": gone,
        "spacecraft.probe.materials": [{"material": names[part], "use": "gone"} for part in hidden],
    }
    wide = sim.with_overrides(changes)
    shown = wide.frame(index, ["instance"])["instance"]
    return shown == sim.taxonomy.instances["probe"]


def test_poses_of_nodes_move_with_them(sim):
    """The origin of a panel turns about the joint of its array."""
    found = [sim.frame(index, CHANNELS) for index in (0, 3)]
    for sample in found:
        rows = {row["name"]: row for row in sample.hierarchy if row["kind"] == "node"}
        label = sample.objects[0]
        model = sim.models["station"]
        nodes = {row["name"]: row for row in model.model.nodes}
        moved = sample.meta["articulation"]["station"]
        for name in ("array_left", "array_left_panel_10", "halo", "dish_1"):
            origin = (np.array(nodes[name]["origin"]) - model.offset) * model.metres_per_unit
            above = [key for key in moved if name.startswith(key)]
            motion = np.array(moved[above[0]]["motion"]) if above else np.eye(4)
            place = motion[:3, :3] @ origin + motion[:3, 3]
            there = label["R_m2c"] @ place + label["t_m2c"]
            np.testing.assert_allclose(rows[name]["t_m2c"], there, atol=1e-9)
            turned = label["R_m2c"] @ motion[:3, :3]
            np.testing.assert_allclose(rows[name]["R_m2c"], turned, atol=1e-12)


def test_no_hierarchy_without_asking(sim):
    with pytest.raises(AttributeError, match="ask for the channel 'hierarchy'"):
        _ = sim.frame(0, ["instance"]).hierarchy
