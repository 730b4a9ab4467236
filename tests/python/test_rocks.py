"""Rocks of a body from Python: lists, frames, errors."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any, get_args

import numpy as np
import pytest
from numpy.typing import NDArray
from pydantic import ValidationError
from tests.python import moon

import perilune
from perilune import _core
from perilune.bodies.rocks import read_rock_model, rock_field
from perilune.config.rocks import FITTED_ABUNDANCE, RockFamilies, RockLaw, Rocks
from perilune.config.terrain import Terrain

PLACE = np.array([0.9, 0.35, 0.2]) / np.linalg.norm([0.9, 0.35, 0.2])
HEIGHT_M = 25.0


def field(**settings: object) -> _core.RockField:
    return _core.RockField({"radius_m": moon.RADIUS_M, "seed": 4, **settings})


def ground(rocks: _core.RockField | None) -> _core.Terrain:
    return _core.Terrain(np.full(3, moon.RADIUS_M), [], {"seed": 7}, None, rocks)


def test_counts() -> None:
    """3e-4 D^-2.482 rocks per m^2 (VIPER), of which few are left out on slopes."""
    rocks = field(law="viper", cutoff_m=0.0, max_diameter_m=50.0)
    listed = rocks.list(ground(None), PLACE, 100.0, 0.2)
    expected = math.pi * 1e4 * 3e-4 * (0.2**-2.482 - 50.0**-2.482)
    assert 0.85 * expected < len(listed) < expected + 4.5 * math.sqrt(expected)
    assert listed.dtype == np.dtype(list(_core.ROCK))
    assert len(set(listed["id"].tolist())) == len(listed)
    assert (listed["diameter_m"] >= 0.2).all()
    assert ((listed["burial"] >= 0.1) & (listed["burial"] <= 0.9)).all()
    assert (listed["direction"] @ PLACE >= math.cos(100.0 / moon.RADIUS_M) - 1e-12).all()
    turn = listed["rotation"]
    np.testing.assert_allclose(
        turn @ np.swapaxes(turn, 1, 2), np.eye(3)[None] + 0 * turn, atol=1e-9
    )
    assert set(listed["family"].tolist()) <= set(range(len(_core.ROCK_FAMILIES)))


def test_families_are_chosen() -> None:
    listed = field(law="haworth", families={"slab": 1.0, "cube": 0.0}).list(
        ground(None), PLACE, 30.0, 0.2
    )
    names = [row["name"] for row in _core.ROCK_FAMILIES]
    assert {names[k] for k in listed["family"].tolist()} == {"slab"}


def frame(rocks: _core.RockField | None, size: int, height_m: float) -> NDArray[np.float32]:
    """Straight down, the Sun 35 degrees high."""
    terrain = ground(rocks)
    scene = _core.Scene(1)
    scene.add_body(
        name="moon",
        map=None,
        map_center_lon_rad=0.0,
        reflectance="lambert",
        instance_id=1,
        part_id=1,
        class_ids=np.array([1], dtype=np.uint16),
        regolith_map=None,
        air=None,
        terrain=terrain,
    )
    up = PLACE
    right = np.cross([0.0, 0.0, 1.0], up)
    right /= np.linalg.norm(right)
    axes = np.stack([right, np.cross(-up, right), -up], axis=1)
    w = 0.5 * math.sqrt(1.0 + np.trace(axes))
    turn = np.array([axes[2, 1] - axes[1, 2], axes[0, 2] - axes[2, 0], axes[1, 0] - axes[0, 1]]) / (
        4.0 * w
    )
    eye = up * (moon.RADIUS_M + terrain.heights(up[None])[0] + height_m)
    pose = np.concatenate([eye, [w], turn])
    center = 0.5 * (size - 1)
    asked: dict[str, Any] = moon.request(size, 0.0)
    asked["K"] = np.array([[size, 0.0, center], [0.0, size, center], [0.0, 0.0, 1.0]])
    asked["camera_pose"] = np.stack([pose, pose])
    elevation = math.radians(35.0)
    asked["sun_position"] = moon.AU_M * (math.cos(elevation) * right + math.sin(elevation) * up)
    return moon.radiance(scene, asked)


def test_rocks_are_seen() -> None:
    """Rocks cast shadows: where they lie, and nowhere else, pixels change."""
    size = 96
    rocks = field(law="haworth", min_diameter_m=0.6, density=5.0)
    change = frame(rocks, size, HEIGHT_M) - frame(None, size, HEIGHT_M)
    changed = np.abs(change[..., 0]) > 0.02 * 25.0
    listed = rocks.list(ground(rocks), PLACE, 0.45 * HEIGHT_M, 0.6)
    assert len(listed) > 3
    right = np.cross([0.0, 0.0, 1.0], PLACE)
    right /= np.linalg.norm(right)
    down = np.cross(-PLACE, right)
    at = listed["center"] - PLACE * (listed["center"] @ PLACE)[:, None]
    columns = 0.5 * (size - 1) + size * (at @ right) / HEIGHT_M
    rows = 0.5 * (size - 1) + size * (at @ down) / HEIGHT_M
    near = np.zeros((size, size), dtype=bool)
    found = 0
    y, x = np.indices((size, size))
    for column, row, rock in zip(columns, rows, listed, strict=True):
        inside = np.hypot(x - column, y - row) < 2.5 * size * rock["diameter_m"] / HEIGHT_M + 2.0
        near |= inside
        found += bool(changed[inside].any())
    assert found >= 0.9 * len(listed)
    edge = size // 8
    inner = np.s_[edge:-edge, edge:-edge]
    assert changed[inner].any()
    assert changed[inner][~near[inner]].mean() < 0.01


@pytest.mark.parametrize("height_m", [15.0, 150.0])
def test_brightness_has_no_jump(height_m: float) -> None:
    """Rocks of ordinary plains, seen from near or far, whether drawn or below the cells, change the
    mean radiance by less than 2 %."""
    rocks = field(law="viper")
    with_rocks, without = frame(rocks, 64, height_m).mean(), frame(None, 64, height_m).mean()
    assert with_rocks / without == pytest.approx(1.0, abs=0.02)


@pytest.mark.parametrize(
    ("settings", "words"),
    [
        ({"law": "hawort"}, "law"),
        ({"law": "golombek", "abundance": 0.003}, "decay_per_m"),
        ({"density": 1e5}, "covers"),
        ({"families": {"pebble": 1.0}}, "pebble"),
        ({"seed": -1}, "seed"),
        ({"table": [[0.1, 1.0]], "law": "table"}, "2 entries"),
    ],
)
def test_errors(settings: dict[str, object], words: str) -> None:
    with pytest.raises(ValueError, match=words):
        field(**settings)


# -- the section ---------------------------------------------------------------------------------


def test_names_are_those_of_the_core() -> None:
    assert list(get_args(RockLaw)) == [row["name"] for row in _core.ROCK_LAWS]
    assert list(RockFamilies.model_fields) == [row["name"] for row in _core.ROCK_FAMILIES]


def test_defaults_are_those_of_the_core() -> None:
    ours = rock_field(Rocks(seed=4), moon.RADIUS_M).list(ground(None), PLACE, 40.0, 0.1)
    np.testing.assert_array_equal(ours, field().list(ground(None), PLACE, 40.0, 0.1))
    assert len(ours) > 100


def test_a_table_gives_the_sizes() -> None:
    given = Rocks(law="table", table=((0.2, 0.1), (2.0, 1e-4)), cutoff_m=0.0)
    listed = rock_field(given, moon.RADIUS_M).list(ground(None), PLACE, 60.0)
    assert listed["diameter_m"].min() >= 0.2
    assert listed["diameter_m"].max() <= 2.0
    expected = math.pi * 60.0**2 * 0.1
    assert 0.85 * expected < len(listed) < expected + 4.5 * math.sqrt(expected)


def test_slopes_of_repose() -> None:
    steep = rock_field(Rocks(law="haworth", repose_deg=8.0), moon.RADIUS_M)
    slopes = steep.list(ground(None), PLACE, 30.0, 0.2)["slope_rad"]
    assert len(slopes) > 0
    assert slopes.max() <= math.radians(8.0)


@pytest.mark.parametrize(
    ("keys", "text"),
    [
        ({"law": "gravel"}, "viper"),
        ({"law": "power", "coefficient": 1.0}, "exponent"),
        ({"coefficient": 1.0}, "power"),
        ({"law": "golombek"}, "abundance"),
        ({"law": "golombek", "abundance": 0.9 * FITTED_ABUNDANCE}, "decay_per_m"),
        ({"law": "table", "table": [[1.0, 1.0], [0.5, 0.1]]}, "diameters rise"),
        ({"law": "table", "table": [[1.0, 1.0], [2.0, 3.0]]}, "do not rise"),
        ({"min_diameter_m": 2.0, "max_diameter_m": 1.0}, "below max_diameter_m"),
        ({"least_burial": 0.6}, "most_burial"),
        ({"families": {"pebble": 1.0}}, "pebble"),
        ({"families": {"slab": 0.0}}, "above 0"),
        ({"repose_deg": 90.0}, "repose_deg"),
        ({"families": {"slab": 1.0}, "models": ["rock.glb"]}, "families.model"),
        ({"families": {"slab": 1.0, "model": 1.0}}, "needs models"),
        ({"models": ["rock.glb"] * 33}, "at most 32"),
    ],
)
def test_errors_of_the_section(keys: dict[str, object], text: str) -> None:
    with pytest.raises(ValidationError) as error:
        Rocks.model_validate(keys)
    assert text in f"{error.value} {error.value.errors()[0]}"


def test_more_about_young_craters() -> None:
    """As the configuration says it; needs craters, and names the key and its limits."""
    craters = {"law": "power", "coefficient": 0.02, "exponent": -2.0, "surface_age_ga": 0.01,
               "min_diameter_m": 60.0, "max_diameter_m": 200.0}  # fmt: skip
    relief = _core.CraterField({"radius_m": moon.RADIUS_M} | craters)
    counts = []
    for ejecta in (None, {}, {"at_rim": 60.0}, {"least_crater_m": 300.0}):
        rocks = rock_field(
            Rocks.model_validate({"min_diameter_m": 1.0, "ejecta": ejecta}), moon.RADIUS_M
        )
        terrain = _core.Terrain(np.full(3, moon.RADIUS_M), [], None, relief, rocks)
        counts.append(len(rocks.list(terrain, PLACE, 1200.0, 1.0)))
    assert counts[0] == counts[3]
    assert counts[0] + 4.0 * math.sqrt(counts[0]) < counts[1]
    assert counts[2] - counts[0] == pytest.approx(3.0 * (counts[1] - counts[0]), rel=0.15)
    Terrain.model_validate({"craters": {}, "rocks": {"ejecta": {}}})
    with pytest.raises(ValidationError, match="does nothing without craters"):
        Terrain.model_validate({"rocks": {"ejecta": {}}})
    with pytest.raises(ValidationError, match="at_rim"):
        Rocks.model_validate({"ejecta": {"at_rim": 0.0}})


def box(*sides: float) -> tuple[NDArray[np.float64], NDArray[np.uint32]]:
    """A closed box of 12 triangles, one corner at the origin."""
    corners = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)]) * sides
    quads = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    halves = [half for a, b, c, d in quads for half in ((a, b, c), (a, c, d))]
    return corners, np.array(halves, dtype=np.uint32)


def test_models_give_the_shapes() -> None:
    """A box is one from its middle on, with its longest side along x: distances of its faces, in
    the units of that of its corner."""
    scan = _core.RockScan(*box(3.0, 20.0, 10.0))
    axes, half = np.eye(3), np.array([10.0, 5.0, 1.5])
    unit = scan.radii(axes)[0] / half[0]
    assert abs(unit * np.linalg.norm(half) - 1.0) < 0.01  # no direction of the table is a corner
    np.testing.assert_allclose(scan.radii(axes), unit * half, rtol=1e-6)
    np.testing.assert_allclose(scan.radii(-axes), unit * half, rtol=1e-6)
    assert scan.folded == 0.0
    bent = np.concatenate([box(4.0, 4.0, 1.0)[0], box(1.0, 1.0, 3.0)[0]])
    triangles = box(1.0, 1.0, 1.0)[1]
    hook = _core.RockScan(bent, np.concatenate([triangles, triangles + 8]))
    assert 0.01 < hook.folded < 0.5


def test_rocks_of_models_lie_on_the_ground() -> None:
    """They are of their family, alone or by their weight, and flat ones lie flat."""
    scan = _core.RockScan(*box(3.0, 5.0, 1.5))
    names = [row["name"] for row in _core.ROCK_FAMILIES]
    only = field(law="haworth", families={"model": 1.0}, models=[scan])
    listed = only.list(ground(None), PLACE, 30.0, 0.2)
    assert {names[k] for k in listed["family"].tolist()} == {"model"}
    high = field(law="haworth", families={"model": 1.0}, models=[_core.RockScan(*box(3, 3, 3))])
    ratios = [
        np.median(rows["height_m"] / (1.0 - rows["burial"]) / rows["diameter_m"])
        for rows in (listed, high.list(ground(None), PLACE, 30.0, 0.2))
    ]
    assert 0.387 < ratios[0] < 0.75 * ratios[1]
    shared = field(law="haworth", families={"model": 3.0, "slab": 1.0}, models=[scan, scan])
    among = shared.list(ground(None), PLACE, 60.0, 0.2)
    fraction = np.mean(among["family"] == names.index("model"))
    assert abs(fraction - 0.75) < 4.5 * math.sqrt(0.75 * 0.25 / len(among))
    with pytest.raises(ValueError, match="no models"):
        field(families={"model": 1.0})
    with pytest.raises(ValueError, match="weight of the family 'model'"):
        field(models=[scan])
    with pytest.raises(TypeError, match="RockScan"):
        field(families={"model": 1.0}, models=["rock.glb"])


def test_files_of_models(tmp_path: Path, repo_dir: Path) -> None:
    """What is wrong with one names the file and the key."""
    model = repo_dir / "assets/models/test_object.glb"
    assert read_rock_model(model).scan.folded < 1.0
    config = repo_dir / "configs/lunar_rover.yaml"
    for bad, text in [("gone.glb", "no such file"), ("lunar_rover.yaml", "lunar_rover.yaml")]:
        tree = {"law": "haworth", "models": [str(model), bad]}
        with pytest.raises((ValueError, OSError), match=rf"rocks\.models\[1\].*{text}"):
            perilune.open(config, overrides={"bodies.moon.terrain.rocks": tree}).frame(0, ["depth"])


@pytest.mark.needs_data
def test_scans_of_samples(data_dir: Path) -> None:
    files = sorted((data_dir / "rocks").glob("*.glb"))
    assert len(files) == 9
    scans = [read_rock_model(path).scan for path in files]
    assert max(scan.folded for scan in scans) < 0.05
    rocks = field(law="haworth", families={"model": 1.0}, models=scans)
    listed = rocks.list(ground(None), PLACE, 50.0, 0.2)
    assert len(listed) > 100
    plain = field(law="haworth").list(ground(None), PLACE, 50.0, 0.2)
    assert len(listed) > 0.9 * len(plain)


def furthest(
    positions: NDArray[np.float64], triangles: NDArray[np.uint32], directions: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Distances of the furthest triangles along rays from the mean of the area, in the principal
    axes, the longest first."""
    a, b, c = (positions[triangles[:, k]] for k in range(3))
    area = 0.5 * np.linalg.norm(np.cross(b - a, c - a), axis=1)
    mean = np.average((a + b + c) / 3.0, axis=0, weights=area)
    a, b, c = a - mean, b - mean, c - mean
    moment = sum(np.einsum("t,ti,tj->ij", area / 12.0, p, p) for p in (a, b, c, a + b + c))
    axes = np.linalg.eigh(moment)[1][:, ::-1]
    a, b, c = a @ axes, b @ axes, c @ axes
    out = np.empty(len(directions))
    for k, d in enumerate(directions):
        weights = np.stack([np.cross(b, c) @ d, np.cross(c, a) @ d, np.cross(a, b) @ d])
        volume = np.einsum("ti,ti->t", a, np.cross(b, c))
        total = weights.sum(axis=0)
        met = (weights * np.sign(total) >= -1e-12).all(axis=0) & (volume * total > 0.0)
        out[k] = (volume[met] / total[met]).max()
    return out


@pytest.mark.needs_data
def test_a_scan_beside_rays_in_numpy(data_dir: Path) -> None:
    """Eigenvectors have no sign: the best of all four turns counts."""
    path = data_dir / "rocks" / "apollo_sample1.glb"
    mesh = _core.Model(str(path)).mesh()
    scan = _core.RockScan(mesh["positions"], mesh["indices"])
    directions = np.random.default_rng(3).normal(size=(300, 3))
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    exact = furthest(mesh["positions"], mesh["indices"], directions)
    found = []
    for signs in np.array(np.meshgrid([1, -1], [1, -1], [1, -1])).reshape(3, -1).T:
        ratio = scan.radii(directions * signs) / exact
        found.append(np.abs(ratio / np.median(ratio) - 1.0))
    best = min(found, key=np.median)
    print(np.sqrt(np.mean(best**2)), np.percentile(best, 99))
    assert np.sqrt(np.mean(best**2)) < 0.01
    assert np.percentile(best, 99) < 0.03
