"""Areas of bodies: rasters that name parts of their surface, against longitudes and latitudes."""

from __future__ import annotations

import math
import warnings

import numpy as np
import pytest
from PIL import Image

import perilune
from perilune.config import ConfigError
from perilune.document.loader import read_tree

ROWS, COLUMNS = 18, 36
NUMBERS = np.random.default_rng(5).integers(0, 4, (ROWS, COLUMNS), dtype=np.uint8)
CLASSES = {"sea": 1, "ice": [2, 3]}


@pytest.fixture
def scene(repo_dir, tmp_path):
    Image.fromarray(NUMBERS).save(tmp_path / "areas.png")
    tree = read_tree(repo_dir / "tests/python/scene.yaml")
    tree["spacecraft"]["sat"]["model"] = str(repo_dir / "assets/models/smallsat.glb")
    tree["bodies"]["earth"]["areas"] = [
        {
            "file": str(tmp_path / "areas.png"),
            "projection": {"kind": "cylindrical", "west_deg": -180},
            "classes": dict(CLASSES),
        }
    ]
    tree["camera"]["trajectory"] = {
        "kind": "hover", "target": "earth", "height_m": 20e6, "lon_deg": 170, "lat_deg": 60,
    }  # fmt: skip
    return tree


def lon_lat_deg(points, radii_m, geodetic):
    """Longitude and latitude of points on an ellipsoid of revolution, degrees."""
    x, y, z = np.moveaxis(points.astype(np.float64), -1, 0)
    stretch = (radii_m[0] / radii_m[2]) ** 2 if geodetic else 1.0
    return np.degrees(np.arctan2(y, x)), np.degrees(np.arctan2(z * stretch, np.hypot(x, y)))


def expected(points, radii_m, geodetic):
    """Names by the nearest post, and how near the border of a cell the point is, in cells."""
    lon, lat = lon_lat_deg(points, radii_m, geodetic)
    column, row = (lon + 180.0) * COLUMNS / 360.0, (90.0 - lat) * ROWS / 180.0
    number = NUMBERS[np.clip(row, 0, ROWS - 1).astype(int), column.astype(int) % COLUMNS]
    names = np.select([number == 1, number >= 2], ["sea", "ice"], "surface")
    border = np.minimum(abs(column - np.rint(column)), abs(row - np.rint(row)))
    return names, border


def assert_areas(sim, geodetic, level=0, named=lambda name: name):
    sample = sim.frame(0, ["semantic", "part", "object_coords", "instance"])
    there = sample["instance"] == sim.taxonomy.instances["earth"]
    radii_m = np.array([6378137.0, 6378137.0, 6356752.3])
    names, border = expected(sample["object_coords"][there], radii_m, geodetic)
    sure = border > 1e-4
    assert sure.sum() > 300
    of_class = {number: name for name, number in sim.taxonomy.classes["part"].items()}
    seen = [of_class[n] for n in sample["semantic"][there][:, level].tolist()]
    assert set(seen) >= {"sea", "ice", "surface"}
    wrong = (np.array(seen) != [named(name) for name in names]) & sure
    assert not wrong.any()
    parts = {part.id: part.name for part in sim.taxonomy.parts if part.owner == "earth"}
    assert [parts[n] for n in sample["part"][there].tolist()] == seen


@pytest.mark.parametrize("latitudes", ["geodetic", "geocentric"])
def test_a_pixel_has_the_area_of_the_nearest_post(scene, latitudes):
    scene["bodies"]["earth"]["latitudes"] = latitudes
    scene["labels"] = {"levels": ["part"]}
    assert_areas(perilune.open(scene), latitudes == "geodetic")


def test_a_terrain_has_areas(scene):
    scene["bodies"]["earth"] |= {"latitudes": "geocentric", "terrain": {"detail": {"seed": 1}}}
    scene["labels"] = {"levels": ["part"]}
    assert_areas(perilune.open(scene), False)


def test_a_shape_has_areas(scene, tmp_path):
    rows = ["v 0 0 7000", "v 0 0 -7000"]
    for k in range(12):
        lon = math.tau * k / 12
        rows.append(f"v {7000 * math.cos(lon)} {7000 * math.sin(lon)} 0")
    for k in range(12):
        a, b = 3 + k, 3 + (k + 1) % 12
        rows += [f"f {a} {b} 1", f"f {b} {a} 2"]
    (tmp_path / "double_cone.obj").write_text("\n".join(rows) + "\n")
    shape = {"file": str(tmp_path / "double_cone.obj"), "metres_per_unit": 1000.0}
    scene["bodies"]["earth"] |= {"latitudes": "geocentric", "shape": shape}
    scene["labels"] = {"levels": ["part"]}
    assert_areas(perilune.open(scene), False)


def test_the_uppermost_raster_that_says_something_counts(scene, tmp_path):
    patch = np.zeros((4, 4), np.uint8)
    patch[:2] = 9
    np.save(tmp_path / "patch.npy", patch)
    place = {
        "kind": "cylindrical",
        "west_deg": 160,
        "east_deg": 200,
        "south_deg": 40,
        "north_deg": 80,
    }
    row = {"file": str(tmp_path / "patch.npy"), "projection": place, "classes": {"shelf": 9}}
    scene["bodies"]["earth"]["areas"].append(row)
    scene["bodies"]["earth"]["latitudes"] = "geocentric"
    scene["labels"] = {"levels": ["part"]}
    sim = perilune.open(scene)
    sample = sim.frame(0, ["semantic", "object_coords", "instance"])
    there = sample["instance"] == sim.taxonomy.instances["earth"]
    lon, lat = lon_lat_deg(sample["object_coords"][there], np.ones(3), False)
    shelf = sim.taxonomy.classes["part"]["shelf"]
    found = sample["semantic"][there][:, 0] == shelf
    inside = (lon % 360 > 160) & (lon % 360 < 200) & (lat > 60) & (lat < 80)
    edge = np.minimum.reduce(
        [abs(lon % 360 - 160), abs(lon % 360 - 200), abs(lat - 60), abs(lat - 80)]
    )
    sure = edge > 1e-3
    assert inside.sum() > 20
    assert np.array_equal(found[sure], inside[sure])


def test_classes_of_areas_by_patterns(scene):
    scene["labels"] = {"levels": ["medium", "object"]}
    scene["bodies"]["earth"]["classes"] = {"medium": {"water": ["sea", "i*"], "dry": ["surface"]}}
    sim = perilune.open(scene)
    sample = sim.frame(0, ["semantic", "part"])
    names = {part.id: part.name for part in sim.taxonomy.parts if part.owner == "earth"}
    for number, name in names.items():
        ids = np.unique(sample["semantic"][sample["part"] == number][:, 0])
        assert [sim.taxonomy.names("medium")[n] for n in ids.tolist()] == [
            "dry" if name == "surface" else "water"
        ]
    scene["bodies"]["earth"]["classes"]["medium"]["water"].append("see")
    found = dict(perilune.open(scene).unmatched_part_classes())
    assert "did you mean 'sea'" in found["bodies.earth.classes.medium.water"]


def test_craters_and_rocks_keep_the_area_below_them(repo_dir, tmp_path):
    np.save(tmp_path / "mare.npy", np.ones((2, 4), np.uint8))
    tree = read_tree(repo_dir / "configs/paper2_segmentation.yaml")
    body = next(iter(tree["bodies"]))
    place = {"kind": "cylindrical", "west_deg": 0}
    row = {"file": str(tmp_path / "mare.npy"), "projection": place, "classes": {"mare": 1}}
    tree["bodies"][body]["areas"] = [row]
    tree["labels"] = {"levels": ["ground", "part"]}
    tree["camera"] |= {"width": 64, "height": 48}
    sample = perilune.open(tree, base=repo_dir / "configs").frame(0, ["semantic", "instance"])
    sim = perilune.open(tree, base=repo_dir / "configs")
    on_body = sample["semantic"][sample["instance"] == sim.taxonomy.instances[body]]
    assert len(np.unique(on_body[:, 0])) >= 2  # terrain and craters, or rocks
    assert np.unique(on_body[:, 1]).tolist() == [sim.taxonomy.classes["part"]["mare"]]


def test_an_area_without_a_number_is_told(scene):
    scene["bodies"]["earth"]["areas"][0]["classes"]["lava"] = [200, 210]
    with warnings.catch_warnings(record=True) as told:
        warnings.simplefilter("always")
        perilune.open(scene).frame(0, ["part"])
    assert any("classes.lava: no number of the file is in it" in str(row.message) for row in told)


@pytest.mark.parametrize(
    ("change", "expected"),
    [
        (
            {"classes": {"sea": [3, 1]}},
            r"areas\[0\]\.classes\.sea: \[3, 1\]: the least comes first",
        ),
        (
            {"classes": {"surface": 1}},
            r"areas\[0\]\.classes\.surface: is the name of what is in no",
        ),
        ({"classes": {}}, r"areas\[0\]\.classes"),
        ({"projection": None}, r"areas\[0\]\.projection: .*areas\.png.*give projection"),
    ],
)
def test_wrong_areas(scene, change, expected):
    scene["bodies"]["earth"]["areas"][0] |= change
    with pytest.raises(ConfigError, match=expected):
        perilune.open(scene).frame(0, ["part"])


def test_threads_do_not_matter(scene):
    sim = perilune.open(scene)
    one, two = (sim.frame(0, ["part"], threads=n)["part"] for n in (1, 2))
    assert np.array_equal(one, two)
