"""Parts of models that move: what a configuration says against geometry worked out here."""

from __future__ import annotations

import json
import math
import pickle
import struct

import numpy as np
import pytest

import perilune
from perilune import _core
from perilune.cli import main
from perilune.config import ConfigError
from perilune.document.loader import read_tree
from perilune.export.check import check_bop
from perilune.export.writers import write_bop
from perilune.spacecraft.articulation import Rig

PANEL_AXIS, CELLS = [0, 1, 0], [1, 0, 0]
"""Of the satellite's panels: the drive, and the outward normal of the solar cells."""
TRACKING = [
    {"node": f"panel_{side}", "axis": PANEL_AXIS, "normal": CELLS, "towards": "sun"}
    for side in ("left", "right")
]


@pytest.fixture
def scene(repo_dir):
    tree = read_tree(repo_dir / "tests/python/scene.yaml")
    tree["spacecraft"]["sat"]["attitude"] = {"rotation_deg": [20, 30, 40], "spin_rate_deg_s": 0.5}
    tree["camera"] |= {"width": 96, "height": 64}
    return tree


def opened(repo_dir, scene, *joints, **craft):
    scene["spacecraft"]["sat"] |= {"articulation": list(joints)} | craft
    return perilune.open(scene, base=repo_dir / "tests/python")


def refused(repo_dir, scene, *joints, **craft):
    with pytest.raises(ConfigError) as error:
        opened(repo_dir, scene, *joints, **craft).frame(0, ["depth"])
    return str(error.value)


def sun_direction(sim, index):
    """In the object's frame, in the middle of the exposure."""
    world = sim.world(index)
    w, x, y, z = world.poses["sat"][0, 3:]
    axes = np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]
    )
    to_sun = axes.T @ (world.sun_position_m - world.poses["sat"][0, :3])
    return to_sun / np.linalg.norm(to_sun)


def test_solar_cells_face_the_sun_as_far_as_their_drive_lets_them(repo_dir, scene):
    """The cells are tilted from the Sun by its elevation over the plane across the drive, which is
    y of the model: that is the label `incidence` of what is seen of them, in every frame."""
    sim = opened(repo_dir, scene, *TRACKING)
    cells = {p.id for p in sim.taxonomy.parts if p.material == "solar_cell"}
    seen = 0
    for index in range(6):
        sample = sim.frame(index, ["part", "incidence"], threads=1)
        elevation = abs(math.asin(sun_direction(sim, index)[1]))
        found = sample["incidence"][np.isin(sample["part"], list(cells))]
        front = found[found < math.pi / 2]  # cells have no back, but edges show others
        seen += front.size
        assert np.abs(front - elevation).max(initial=0.0) < 1e-3
    assert seen > 100


def test_motions_are_told(repo_dir, scene):
    """meta holds the drive's angle and the motion about the hinge: science's formula."""
    sim = opened(repo_dir, scene, *TRACKING)
    for index in range(4):
        sample = sim.frame(index, ["depth"], threads=1)
        told = sample.meta["articulation"]["sat"]
        assert list(told) == ["panel_left", "panel_right"]
        u = sun_direction(sim, index)
        # At rest the cells look along (-0.9397, 0, -0.3420) in the model's axes.
        n0, d = np.array([-math.cos(math.radians(20)), 0, -math.sin(math.radians(20))]), [0, 1, 0]
        angle = math.atan2(u @ np.cross(d, n0), u @ n0)
        assert told["panel_left"]["joints"][0]["angle_deg"] == pytest.approx(
            math.degrees(angle), abs=1e-4
        )
        for node in told.values():
            motion = node["motion"]
            across = u - u[1] * np.array(d)
            assert motion[:3, :3] @ n0 == pytest.approx(across / np.linalg.norm(across), abs=1e-6)
            assert motion[:3, 3] == pytest.approx(
                motion[:3, :3] @ -hinge(sim) + hinge(sim), abs=1e-9
            )


def hinge(sim):
    """A point of both drives, in the object's frame: the model's own axis y."""
    return -sim.models["sat"].offset * sim.models["sat"].metres_per_unit


def test_rates_angles_and_slides(repo_dir, scene):
    sim = opened(
        repo_dir,
        scene,
        {"node": "panel_left", "axis": PANEL_AXIS, "rate_deg_s": 0.25, "angle_deg": 10},
        {"node": "panel_right", "axis": [0, 0, 2], "axes": "object", "translation_m": 0.5},
    )
    exposure = sim.config.camera.exposure_time_s
    for index in (0, 3):
        told = sim.frame(index, ["depth"], threads=1).meta["articulation"]["sat"]
        grown = 10 + 0.25 * (60 * index + exposure / 2)
        assert told["panel_left"]["joints"] == [{"angle_deg": pytest.approx(grown)}]
        assert told["panel_right"]["motion"][:3, 3] == pytest.approx([0, 0, 0.5])


def test_drivers_and_neighbours(repo_dir, scene):
    """A driven angle is drawn by frame; joints of nested nodes act together; `towards` takes the
    name of a body."""
    driven = {"ideal": 0, "jitter_variance": 400, "clip_min": -90, "clip_max": 90}
    sim = opened(
        repo_dir,
        scene,
        {"node": "panel_left", "axis": PANEL_AXIS, "angle_deg": driven},
        {"node": "panel_left_3", "axis": [0, 1, 0], "normal": [1, 0, 0], "towards": "earth"},
    )
    told = [sim.frame(i, ["depth"], threads=1).meta["articulation"]["sat"] for i in (0, 1)]
    angles = [row["panel_left"]["joints"][0]["angle_deg"] for row in told]
    assert angles[0] != angles[1]
    for index, row in enumerate(told):
        world = sim.world(index)
        assert row["panel_left"]["joints"][0]["angle_deg"] == pytest.approx(
            world.drivers["spacecraft.sat.articulation[0].angle_deg"]
        )
        # The innermost panel looks at the Earth whatever its yoke does.
        R = row["panel_left_3"]["motion"][:3, :3]
        n = R @ [-math.cos(math.radians(20)), 0, -math.sin(math.radians(20))]
        assert n[1] == pytest.approx(0.0, abs=1e-6)


def test_order_processes_and_allocations(repo_dir, scene):
    sim = opened(repo_dir, scene, *TRACKING)
    names = ["rgb", "depth", "part", "objects", "masks"]
    first = sim.frame(2, names, threads=1)
    other = pickle.loads(pickle.dumps(sim))
    other.frame(0, names, threads=1)
    again = other.frame(2, names, threads=2)
    for name in ("rgb", "depth", "part", "masks"):
        assert np.array_equal(first[name], again[name])
    assert np.array_equal(first.objects, again.objects)
    before = _core.allocations()
    out = {name: first[name] for name in first}
    for index in range(2, 5):
        sim.frame(index, ["rgb", "depth", "part", "masks"], threads=1, out=out)
    assert _core.allocations() == before


def test_nothing_moves_without_a_word(repo_dir, scene):
    sim = opened(repo_dir, scene)
    sample = sim.frame(0, ["depth"], threads=1)
    assert sample.meta["articulation"] == {}
    assert sim.request(0)["object_movers"].shape == (0, 3, 4)


def points_of(rig: Rig, model, motions):
    """Every vertex where its piece has gone, less the offset."""
    parents = [row["parent"] for row in model.nodes]
    mesh = model.mesh()
    owner = []
    for part in model.parts:
        node = part["node"]
        while node >= 0 and node not in rig.core.nodes:
            node = parents[node]
        owner.append(node)
    points = []
    for part, node in enumerate(owner):
        used = mesh["positions"][np.unique(mesh["indices"][mesh["triangle_part"] == part])]
        if node >= 0:
            m = motions[rig.core.nodes.index(node)]
            used = used @ m[:, :3].T + m[:, 3]
        points.append(used - rig.offset)
    return np.concatenate(points)


def test_no_part_leaves_the_sphere_that_cameras_keep_off(repo_dir, scene):
    rng = np.random.default_rng(5)
    sim = opened(
        repo_dir,
        scene,
        {"node": "panel_left", "axis": [1, 0, 0], "angle_deg": 0},
        {"node": "panel_left_2", "axis": [0.5, 0.2, 1], "pivot_m": [0, 1, 0], "angle_deg": 0},
        {"node": "panel_left_2", "axis": [1, 0, 0], "angle_deg": 0},
        {"node": "high_gain_antenna", "axis": [1, 1, 1], "axes": "object", "angle_deg": 0},
    )
    rig, model = sim._mine().rigs["sat"], sim.models["sat"].model
    widest = 0.0
    for _ in range(100):
        _, motions = rig.core.pose(rng.uniform(-4, 4, 4), np.zeros((4, 3)))
        widest = max(widest, np.linalg.norm(points_of(rig, model, motions), axis=1).max())
    assert widest <= rig.reach_units < 2.5 * widest
    scale = sim.models["sat"].metres_per_unit
    assert sim.world(0).craft_radius_m["sat"] == pytest.approx(scale * rig.reach_units)


def animated_glb(path, interpolation="LINEAR"):
    """A triangle on node `flag`, which turns by 90 degrees about the file's y in 2 s."""
    h = math.sqrt(0.5)
    chunks = [
        struct.pack("<9f", 0, 0, 0, 1, 0, 0, 0, 1, 0),
        struct.pack("<2f", 0, 2),
        struct.pack("<8f", 0, 0, 0, 1, 0, h, 0, h),
    ]
    offsets = np.cumsum([0, *map(len, chunks)]).tolist()
    document = {
        "asset": {"version": "2.0"},
        "buffers": [{"byteLength": offsets[-1]}],
        "bufferViews": [
            {"buffer": 0, "byteOffset": at, "byteLength": len(chunk)}
            for at, chunk in zip(offsets, chunks, strict=False)
        ],
        "accessors": [
            {"bufferView": k, "componentType": 5126, "count": count, "type": kind}
            for k, (count, kind) in enumerate([(3, "VEC3"), (2, "SCALAR"), (2, "VEC4")])
        ],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
        "nodes": [
            {"name": "pole", "mesh": 0, "children": [1]},
            {"name": "flag", "mesh": 0, "translation": [2, 0, 0]},
        ],
        "scenes": [{"nodes": [0]}],
        "animations": [
            {
                "name": "wave",
                "channels": [{"sampler": 0, "target": {"node": 1, "path": "rotation"}}],
                "samplers": [{"input": 1, "output": 2, "interpolation": interpolation}],
            }
        ],
    }
    text = json.dumps(document).encode()
    text += b" " * (-len(text) % 4)
    body = b"".join(chunks)
    head = struct.pack("<4sII", b"glTF", 2, 28 + len(text) + len(body))
    path.write_bytes(
        head
        + struct.pack("<I4s", len(text), b"JSON")
        + text
        + struct.pack("<I4s", len(body), b"BIN\0")
        + body
    )
    return path


@pytest.mark.parametrize(
    ("loop", "expected"), [("repeat", [0, 45, 0, 45]), ("clamp", [0, 45, 90, 90])]
)
def test_animations_play_at_the_frames_time(repo_dir, scene, tmp_path, loop, expected):
    model = str(animated_glb(tmp_path / "flag.glb"))
    scene["camera"]["exposure_time_s"] = 1e-6
    animation = {"name": "wave", "speed": 1 / 60, "loop": loop}
    sim = opened(repo_dir, scene, model=model, animation=animation)
    for index, angle in enumerate(expected):
        told = sim.frame(index, ["depth"], threads=1).meta["articulation"]["sat"]
        # About the file's y, which is the model's z.
        c, s = math.cos(math.radians(angle)), math.sin(math.radians(angle))
        turn = told["flag"]["motion"][:3, :3]
        assert turn == pytest.approx(np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]]), abs=1e-5)
        assert told["flag"]["joints"] == []
    jump = {"index": 0, "start_s": 1.0, "speed": 0.0}
    told = opened(repo_dir, scene, model=model, animation=jump).frame(5, ["depth"], threads=1)
    assert told.meta["articulation"]["sat"]["flag"]["motion"][0, 0] == pytest.approx(
        math.sqrt(0.5), abs=1e-6
    )


def test_bop_holds_the_motions_and_passes_its_check(repo_dir, scene, tmp_path):
    scene["camera"] |= {"width": 64, "height": 48}
    sim = opened(repo_dir, scene, *TRACKING)
    write_bop(sim, range(2), tmp_path / "out")
    report = check_bop(tmp_path / "out")
    assert report.findings == []
    (path,) = (tmp_path / "out").rglob("scene_gt.json")
    rows = json.loads(path.read_text())
    for index in range(2):
        told = rows[str(index)][0]["articulation"]
        node = sim.frame(index, ["depth"], threads=1).meta["articulation"]["sat"]["panel_left"]
        assert np.reshape(told["panel_left"], (4, 4))[:3, :3] == pytest.approx(
            node["motion"][:3, :3]
        )


def test_what_is_wrong_is_named(repo_dir, scene):
    turn = {"axis": [0, 0, 1], "angle_deg": 5}

    def text(*joints, **craft):
        return refused(repo_dir, scene, *joints, **craft)

    key = "spacecraft.sat.articulation[0]"
    said = text({"node": "panel_lft"} | turn)
    assert f"{key}.node: no node matches 'panel_lft'; did you mean 'panel_left'?" in said
    said = text({"node": "panel_*"} | turn)
    assert f"{key}.node: 'panel_*' matches 10 nodes, must match one: panel_left, " in said
    said = text({"node": "bus", "axis": [0, 0, 1], "normal": [1, 0, 0], "towards": "son"})
    assert f"{key}.towards: no 'son'; did you mean 'sun'?" in said
    for joint, fault in (
        ({"node": "bus", "axis": [0, 0, 1]}, "give translation_m, or some of"),
        ({"node": "bus", "translation_m": 1} | turn, "give translation_m, or some of"),
        ({"node": "bus", "towards": "sun"} | turn, "normal: goes with towards"),
        ({"node": "bus", "axis": [0, 0, 0], "angle_deg": 1}, "axis: a direction must not be zero"),
        (
            {"node": "bus", "axis": [0, 0, 1], "normal": [0, 0, 2], "towards": "sun"},
            "node 'bus': normal must not lie along the axis",
        ),
    ):
        assert fault in text(joint)
    driven = {"ideal": 0, "jitter_variance": 1, "clip_min": -1, "clip_max": 1}
    assert "takes no driver" in text({"node": "bus", "axis": [driven, 0, 1], "angle_deg": 1})
    assert "no animation matches 'walk'; allowed: (none)" in text(animation={"name": "walk"})
    assert "animation.index = 0: the model has 0" in text(animation={"index": 0})
    assert "give exactly one of name, index" in text(animation={})


def test_the_command_that_lists_nodes(tmp_path, capsys):
    model = str(animated_glb(tmp_path / "flag.glb"))
    assert main(["parts", model, "--nodes", "--json"]) == 0
    assert json.loads(capsys.readouterr().out)[model] == [
        {"node": "pole", "below": None, "triangles": 1, "animations": []},
        {"node": "flag", "below": "pole", "triangles": 1, "animations": ["wave"]},
    ]
    assert main(["parts", model, "--nodes"]) == 0
    shown = capsys.readouterr().out.splitlines()
    assert shown[0] == f"{model}: 2 nodes"
    assert shown[3].split() == ["flag", "pole", "1", "wave"]
