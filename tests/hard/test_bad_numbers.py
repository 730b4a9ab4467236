"""Numbers that nobody means: not finite, zero, negative, tiny, huge, in the configuration and in
requests to the core. Each is an error or a frame without nan where none may be."""

from __future__ import annotations

import json
import math

import numpy as np
import pytest
from tests.hard.glb import cube, write_glb

import perilune
from perilune.config import ConfigError
from perilune.document.loader import read_tree

LABELS = ["depth", "range", "normal", "semantic", "part", "instance", "rgb", "objects"]


@pytest.fixture
def tree(repo_dir):
    return read_tree(repo_dir / "tests/python/scene.yaml")


@pytest.fixture
def base(repo_dir):
    return repo_dir / "tests/python"


def numbers(node, path=()):
    """Paths of every number of a tree."""
    if isinstance(node, dict):
        for key, value in node.items():
            yield from numbers(value, (*path, key))
    elif isinstance(node, list):
        for k, value in enumerate(node):
            yield from numbers(value, (*path, k))
    elif isinstance(node, (int, float)) and not isinstance(node, bool):
        yield path


FULL = {
    "bodies": {
        "earth": {"kind": "earth", "albedo": [0.3, 0.3, 0.3],
                  "emission_w_m2_sr": [0.0, 0.0, 0.0]},
        "rock": {"kind": "ellipsoid", "radii_km": [1.0, 2.0, 3.0], "gm_km3_s2": 1e-3,
                 "albedo": 0.1, "orbit": {"around": "earth", "position_km": [8000.0, 0.0, 0.0]},
                 "rotation": {"rotation_deg": [0.0, 0.0, 0.0], "spin_axis": [0.0, 0.0, 1.0],
                              "spin_rate_deg_s": 0.1}},
    },
    "sun": {"radius_km": 695700.0, "irradiance_w_m2": 1361.0, "direction": [1.0, 0.5, 0.2],
            "distance_au": 1.0},
    "camera": {"width": 24, "height": 16, "fov_deg": 40.0, "exposure_time_s": 0.01,
               "trajectory": {"kind": "orbit_object", "target": "sat", "distance_m": [12.0, 20.0],
                              "sun_angle_deg": [0.0, 90.0], "aim_jitter_deg": 1.0},
               "exposure": {"mode": "auto", "percentile": 99.0, "key": 0.8}},
    "render": {"samples": 2, "max_bounces": 1, "tolerance_dn": 1.0},
}  # fmt: skip
JOINTS = [
    {"node": "panel_left", "axis": [0.0, 1.0, 0.0], "normal": [1.0, 0.0, 0.0], "towards": "sun",
     "angle_deg": 3.0},
    {"node": "panel_left_3", "axis": [0.0, 1.0, 0.1], "pivot_m": [0.1, 0.2, 0.3],
     "rate_deg_s": 2.0},
    {"node": "panel_right", "axis": [0.0, 0.0, 1.0], "axes": "object", "translation_m": 0.5},
]  # fmt: skip


def full(tree):
    tree.update(json.loads(json.dumps(FULL)))
    tree["spacecraft"]["sat"]["articulation"] = json.loads(json.dumps(JOINTS))
    return tree


def cubes(path):
    """A model of four cubes with the nodes of JOINTS, which is read in no time."""
    nodes = [
        {"mesh": 0, "name": "bus", "children": [1, 3]},
        {"mesh": 0, "name": "panel_left", "translation": [1.2, 0.0, 0.0], "children": [2]},
        {"mesh": 0, "name": "panel_left_3", "translation": [1.2, 0.0, 0.0]},
        {"mesh": 0, "name": "panel_right", "translation": [-1.2, 0.0, 0.0]},
    ]
    return write_glb(path, *cube(0.5), nodes=nodes)


def put(tree, path, value):
    for part in path[:-1]:
        tree = tree[part]
    tree[path[-1]] = value


def test_numbers_that_are_not_finite(tree, base):
    """Every number of the configuration, one at a time; the error names its key."""
    good = full(tree)
    perilune.open(good, base=base)
    paths = list(numbers(good))
    assert len(paths) > 45
    for path in paths:
        for value in (math.nan, math.inf, -math.inf):
            bad = json.loads(json.dumps(good))
            put(bad, path, value)
            with pytest.raises(ConfigError) as caught:
                perilune.open(bad, base=base)
            assert str(path[-1] if isinstance(path[-1], str) else path[-2]) in str(caught.value)


def test_numbers_that_are_finite_but_absurd(tree, base, tmp_path):
    """Every number, one at a time, set to zero, to minus one, to the tiny and to the huge: an error
    of one of the stated kinds, or a frame without a single nan where none may be."""
    good = full(tree)
    good["spacecraft"]["sat"]["model"] = str(cubes(tmp_path / "cubes.glb"))
    results = {"error": 0, "frame": 0}
    for path in numbers(good):
        whole = {"width", "height", "samples", "max_bounces", "version", "seed"} & set(path)
        for value in (0, -1) if whole else (0.0, -1.0, 1e-300, 1e-30, 1e30, 1e300):
            bad = json.loads(json.dumps(good))
            put(bad, path, value)
            where = f"{'.'.join(map(str, path))} = {value:g}"
            try:
                sample = perilune.open(bad, base=base).frame(0, channels=LABELS, threads=1)
            except (ValueError, OSError, MemoryError):
                results["error"] += 1
                continue
            results["frame"] += 1
            for name in ("depth", "range", "normal"):
                assert np.isfinite(sample[name]).all(), (where, name)
            norm = np.linalg.norm(sample["normal"], axis=2)[sample["instance"] > 0]
            assert not norm.size or np.abs(norm - 1).max() < 1e-3, where
            assert math.isfinite(sample.meta["white_radiance"]), where
            for name in ("R_m2c", "t_m2c"):
                assert np.isfinite(sample.objects[name]).all(), (where, name)
    assert min(results.values()) > 30


def fields(request):
    """Every number of a request to the core, as (key, index or inner key or None)."""
    for key, value in request.items():
        if isinstance(value, np.ndarray):
            yield from ((key, k) for k in range(value.size))
        elif isinstance(value, dict):
            yield from ((key, inner) for inner in value if isinstance(value[inner], (int, float)))
        elif key in ("width", "height"):
            continue  # sizes fix the arrays
        elif isinstance(value, (int, float)) and not isinstance(value, bool):
            yield key, None


def changed(request, field, value):
    key, inner = field
    result = {k: dict(v) if isinstance(v, dict) else v for k, v in request.items()}
    if isinstance(inner, int):
        result[key] = np.array(request[key], dtype=np.float64)
        result[key].flat[inner] = value
    elif inner is None:
        result[key] = value if isinstance(request[key], float) else int(value)
    else:
        result[key][inner] = value if isinstance(request[key][inner], float) else int(value)
    return result


def test_requests_to_the_core(tree, base):
    """Every number of a request, one at a time: an error or a frame without nan, and the renderer
    renders the good request as before."""
    sim = perilune.open(full(tree), base=base)
    request, renderer = sim.request(0), sim._mine().renderer
    first = sim.frame(0, channels=LABELS, threads=1)
    good = {**first, "objects": first.objects}
    out = {name: np.empty_like(array) for name, array in good.items()}
    count = {"error": 0, "frame": 0}
    for field in fields(request):
        for value in (math.nan, math.inf, 0.0, -1.0, 1e-300, 1e-12, 1e12, 1e30, -1e300):
            try:
                renderer.render(changed(request, field, value), out, 1)
            except (ValueError, OverflowError, MemoryError):
                count["error"] += 1
                continue
            count["frame"] += 1
            for name in ("depth", "range", "normal"):
                assert np.isfinite(out[name]).all(), (field, value, name)
            assert np.isfinite(out["objects"]["t_m2c"]).all(), (field, value)
    assert min(count.values()) > 100
    renderer.render(request, out, 1)
    for name, array in good.items():
        assert out[name].tobytes() == array.tobytes()


def test_unknown_keys_at_every_level(tree, base):
    good = full(tree)

    def sections(node, path=()):
        if isinstance(node, dict):
            yield path
            for key, value in node.items():
                yield from sections(value, (*path, key))

    for path in sections(good):
        bad = json.loads(json.dumps(good))
        node = bad
        for part in path:
            node = node[part]
        node["qqqq"] = 1
        with pytest.raises(ConfigError, match="qqqq"):
            perilune.open(bad, base=base)
