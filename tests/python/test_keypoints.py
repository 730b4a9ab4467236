"""Keypoints and landmarks beside OpenCV's projection, and what hides them."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from tests.python.optics_scenes import at, ball, opened, tree
from tests.python.test_flow import BROWN, FISHEYE, opencv

import perilune
from perilune.base import rotations
from perilune.config.errors import ConfigError
from perilune.frame import shutter
from perilune.frame.keypoints import read_points

CONFIGS = Path(__file__).resolve().parents[2] / "configs"
CORNERS = {f"{x:+}{y:+}{z:+}": [0.5 * x, 0.5 * y, 0.5 * z]
           for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)}  # fmt: skip


def scene(**camera: Any) -> dict[str, Any]:
    """A cube of glass edges: the model of a satellite is a box of one metre."""
    made = tree((96, 72), 90.0, far=ball(at(30.0, -4.0, 2.0), 6.0, albedo=0.6))
    made["bodies"]["far"]["landmarks"] = {
        "front": {"lon_deg": 180.0, "lat_deg": 0.0},
        "Mare Émbrium": {"lon_deg": 170.0, "lat_deg": 25.0},
        "back": {"lon_deg": 0.0, "lat_deg": 10.0},
    }
    made["spacecraft"]["sat"] = {
        "model": "assets/models/smallsat.glb",
        "size_m": 3.0,
        "orbit": {"around": "anchor", "position_km": at(6.0, 0.5)},
        "attitude": {"rotation_deg": [20.0, 30.0, 40.0], "spin_rate_deg_s": 10.0},
        "keypoints": {"points": CORNERS | {"hook": [0.0, 0.0, 9.0], "höhe": [0.0, 0.0, 9.0]}},
    }
    made["camera"] |= camera
    return made


def in_camera(sim: perilune.Simulation, sample: perilune.Sample, name: str, own: Any) -> Any:
    pose = shutter.middle(sim.world(sample.meta["index"])).poses[name][0]
    root = np.asarray(own) @ rotations.to_matrix(pose[3:]).T + pose[:3]
    return root @ sample.camera.R_w2c.T + sample.camera.t_w2c


@pytest.mark.parametrize("lens", [None, BROWN, FISHEYE], ids=["pinhole", "brown", "fisheye"])
def test_places_beside_opencv(repo_dir: Path, lens: Any) -> None:
    sim = opened(scene(lens=lens), repo_dir)
    sample = sim.frame(2, ["keypoints", "instance"])
    rows = sample.keypoints
    assert list(rows["name"]) == [*CORNERS, "hook", "höhe", "front", "Mare Émbrium", "back"]
    assert list(rows["object"]) == ["sat"] * 10 + ["far"] * 3
    assert set(rows["instance_id"]) == {2, 3}
    sat = in_camera(sim, sample, "sat", [*CORNERS.values(), *[[0.0, 0.0, 9.0]] * 2])
    lon, lat = np.radians([[180.0, 170.0, 0.0], [0.0, 25.0, 10.0]])
    own = np.stack([np.cos(lat) * np.cos(lon), np.cos(lat) * np.sin(lon), np.sin(lat)], axis=1)
    expected = np.concatenate([sat, in_camera(sim, sample, "far", 6.0 * own)])
    assert rows["position_m"] == pytest.approx(expected, abs=1e-9)
    assert np.abs(rows["xy"] - opencv(expected, sample.camera)).max() < 1e-6
    height, width = sample["instance"].shape
    inside = ((rows["xy"] > -0.5) & (rows["xy"] < [width - 0.5, height - 0.5])).all(axis=1)
    assert np.array_equal(rows["visible"] > 0, inside)
    assert rows["occluded_by"][-1] == 2  # the back of the ball is behind itself


def test_what_is_seen_is_at_its_depth(repo_dir: Path) -> None:
    """Points of the surface itself, from an earlier look at it: seen, and beyond them hidden."""
    sim = opened(scene(), repo_dir)
    first = sim.frame(2, ["object_coords", "instance", "part"])
    ys, xs = np.nonzero(first["instance"] == 3)
    chosen = list(range(0, len(ys), 17))
    points = {f"{k}": [float(v) for v in first["object_coords"][ys[k], xs[k]]] for k in chosen}
    changes = {"spacecraft.sat.keypoints": {"points": points}}
    sample = sim.with_overrides(changes).frame(2, ["keypoints"])
    rows = sample.keypoints[: len(chosen)]
    assert np.abs(rows["xy"] - np.stack([xs, ys], axis=1)[chosen]).max() < 1e-3
    assert (rows["visible"] == 2).mean() > 0.99
    behind = {name: [place[0], place[1], place[2]] for name, place in points.items()}
    turn = rotations.to_matrix(shutter.middle(sim.world(2)).poses["sat"][0][3:])
    away = turn.T @ sample.camera.R_w2c.T @ np.array([0.0, 0.0, 0.4])
    for place in behind.values():
        place[:] = [float(a + b) for a, b in zip(place, away, strict=True)]
    hidden = sim.with_overrides({"spacecraft.sat.keypoints": {"points": behind}})
    rows = hidden.frame(2, ["keypoints"]).keypoints[: len(chosen)]
    assert (rows["visible"] == 1).mean() > 0.9
    assert set(rows["occluded_by"][rows["visible"] == 1]) == {3}
    deep = hidden.with_overrides({"spacecraft.sat.keypoints.depth_m": 9.0})
    assert (deep.frame(2, ["keypoints"]).keypoints["visible"][: len(chosen)] != 1).all()


def test_behind_the_camera_and_behind_another(repo_dir: Path) -> None:
    made = scene()
    made["spacecraft"]["sat"]["keypoints"] = {
        "points": {"behind": [-40.0, 0.0, 0.0], "far away": [60.0, 0.0, 0.0]}
    }
    made["spacecraft"]["sat"]["attitude"] = {"rotation_deg": [0.0, 0.0, 0.0]}
    made["spacecraft"]["sat"]["orbit"]["position_km"] = at(6.0, -1.6, 0.8)
    rows = opened(made, repo_dir).frame(0, ["keypoints"]).keypoints
    behind, far = rows[0], rows[1]
    assert np.isnan(behind["xy"]).all()
    assert behind["visible"] == 0
    assert behind["position_m"][2] < 0.0
    assert far["visible"] == 1
    assert far["occluded_by"] in (2, 3)


def test_nodes_move(repo_dir: Path) -> None:
    """Origins of nodes, carried by what they hang on."""
    joints = [{"node": "array_left", "axis": [0, 1, 0], "rate_deg_s": 0.3}]
    keys = {"nodes": ["array_left*", "dish_1"], "points": {"tip": {"position_m": [0, 5, 1],
            "node": "array_left"}}}  # fmt: skip
    changes = {"spacecraft.station.articulation": joints, "spacecraft.station.keypoints": keys,
               "time.step_s": 100.0, "camera.width": 64, "camera.height": 48}  # fmt: skip
    sim = perilune.open(CONFIGS / "articulated.yaml", overrides=changes)
    sample = sim.frame(1, ["keypoints"])
    rows = {row["name"]: row for row in sample.keypoints}
    motion = sample.meta["articulation"]["station"]["array_left"]["motion"]
    model = sim.models["station"]
    origins = {node["name"]: np.array(node["origin"]) for node in model.model.nodes}
    assert {"tip", "array_left", "dish_1"} <= set(rows)
    for name, rest, moves in (("tip", [0.0, 5.0, 1.0], True), ("dish_1", origins["dish_1"], False)):
        own = np.asarray(rest) if name == "tip" else (rest - model.offset) * model.metres_per_unit
        own = motion[:3, :3] @ own + motion[:3, 3] if moves else own
        place = in_camera(sim, sample, "station", own)
        assert rows[name]["position_m"] == pytest.approx(place, abs=1e-6)
    assert np.abs(motion[:3, :3] - np.eye(3)).max() > 0.1


def test_landmarks_on_terrain() -> None:
    """Landmarks at longitudes and latitudes of what pixels see: their images are these pixels."""
    changes = {"camera.width": 96, "camera.height": 72}
    sim = perilune.open(CONFIGS / "lunar_lander.yaml", overrides=changes)
    first = sim.frame(10, ["position", "instance", "rock_id"])
    pose = shutter.middle(sim.world(10)).poses["moon"][0]
    ground = (first["instance"] == sim.taxonomy.instances["moon"]) & (first["rock_id"] == 0)
    ys, xs = (axis[::97] for axis in np.nonzero(ground))
    own = (first["position"][ys, xs] - pose[:3]) @ rotations.to_matrix(pose[3:])
    lon = np.degrees(np.arctan2(own[:, 1], own[:, 0]))
    lat = np.degrees(np.arcsin(own[:, 2] / np.linalg.norm(own, axis=1)))
    marks = {f"{k}": {"lon_deg": float(lon[k]), "lat_deg": float(lat[k])} for k in range(len(ys))}
    rows = sim.with_overrides({"bodies.moon.landmarks": marks}).frame(10, ["keypoints"]).keypoints
    rows = rows[rows["object"] == "moon"][-len(ys) :]
    off = np.linalg.norm(rows["xy"] - np.stack([xs, ys], axis=1), axis=1)
    assert len(ys) > 20
    assert np.median(off) < 0.2
    assert off.max() < 2.0
    assert (rows["visible"] == 2).mean() > 0.9


def test_files(tmp_path: Path, data_dir: Path) -> None:
    places = [[0.0, 1.0, 2.0], [3.0, 4.0, 5.0]]
    (tmp_path / "a.json").write_text(json.dumps({"a": places[0], "b": places[1]}))
    (tmp_path / "b.json").write_text(json.dumps(places))
    (tmp_path / "c.csv").write_text("name,x,y,z\na,0,1,2\nb,3,4,5\n")
    np.save(tmp_path / "d.npy", np.array(places))
    for name in ("a.json", "b.json", "c.csv", "d.npy"):
        found = read_points(tmp_path / name)
        assert [key for key, _ in found] == (["1", "2"] if name[0] in "bd" else ["a", "b"])
        assert np.array_equal([place for _, place in found], places)
    (tmp_path / "e.json").write_text(json.dumps({"a": [1, 2]}))
    with pytest.raises(ValueError, match="point 'a'"):
        read_points(tmp_path / "e.json")
    with pytest.raises(ValueError, match=r"\.npy or \.mat"):
        read_points(tmp_path / "f.txt")
    tango = read_points(data_dir / "pose/speedplus/tangoPoints.mat")
    assert len(tango) == 11
    assert 0.3 < np.linalg.norm([place for _, place in tango], axis=1).max() < 1.5


def test_what_is_wrong_is_named(repo_dir: Path, tmp_path: Path) -> None:
    def frame(**keys: Any) -> Any:
        made = scene()
        made["spacecraft"]["sat"]["keypoints"] = keys
        return opened(made, repo_dir).frame(0, ["keypoints"])

    with pytest.raises(ConfigError, match=r"keypoints\.nodes\[0\]: no node fits 'panle_\*'"):
        frame(nodes=["panle_*"])
    with pytest.raises(ConfigError, match=r"points\.a\.node: no node 'panel_lft'.*panel_left"):
        frame(points={"a": {"position_m": [0, 0, 0], "node": "panel_lft"}})
    (tmp_path / "p.json").write_text("[[0, 0]]")
    with pytest.raises(ConfigError, match=r"keypoints\.file: .*three finite numbers"):
        frame(file=str(tmp_path / "p.json"))
    bare = tree((8, 8), 10.0)
    with pytest.raises(ConfigError, match="'keypoints': there are none"):
        opened(bare, repo_dir).frame(0, ["keypoints"])
    with pytest.raises(AttributeError, match="ask for the channel 'keypoints'"):
        _ = opened(bare, repo_dir).frame(0, ["depth"]).keypoints
