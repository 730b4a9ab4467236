"""The channel of craters, and classes of the ground, beside a search through all craters."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from tests.python.test_terrain_frames import LAT_DEG, LON_DEG, MOON_M, in_body_axes, moon, over

import perilune
from perilune import _core
from perilune.base import rotations
from perilune.config import ConfigError
from perilune.frame import shutter

ROUND = {"seed": 5, "min_diameter_m": 10.0, "diffusivity_m2_per_myr": 0.0, "irregularity": 0.0}
CAMERA = {"width": 96, "height": 72}
DENSE = ROUND | {"law": "trask", "density": 3.0}
KEPT = {"craters": {"least_kept": 0.5, "least_px": 6.0}}
ANY = {"craters": {"least_kept": 0.0, "least_px": 6.0}}
CHANNELS = ["crater_id", "position", "instance", "range"]


def seen(
    trajectory: dict[str, Any], labels: dict[str, Any], craters: dict[str, Any] = ROUND, **more: Any
) -> perilune.Simulation:
    terrain = {"detail": {"seed": 3, "strength": 0.3}, "craters": craters}
    return moon(terrain | more.pop("terrain", {}), {"trajectory": trajectory, **CAMERA},
                labels=labels, **more)  # fmt: skip


def about(sim: perilune.Simulation, sample: perilune.Sample, least_px: float) -> Any:
    """Craters about the ground that is seen whose diameter spans enough pixels, smallest first, and
    the directions of pixels, nan off the ground."""
    points = in_body_axes(sim, sample)
    ways = points / np.linalg.norm(points, axis=-1, keepdims=True)
    flat = ways[np.isfinite(ways).all(axis=-1)]
    middle = flat.mean(axis=0) / np.linalg.norm(flat.mean(axis=0))
    cap_m = MOON_M * float(np.linalg.norm(flat - middle, axis=1).max())
    terrain, _ = sim._mine().terrain_of(sim.config, "moon")
    focal = sample.camera.K[0, 0]
    pose = shutter.middle(sim.world(0)).poses["moon"][0]
    eye = (sample.camera.position_m - pose[:3]) @ rotations.to_matrix(pose[3:])
    least_m = 0.7 * least_px / focal * float(sample["range"][sample["range"] > 0.0].min())
    listed = [terrain.craters(middle, cap_m, least_m)]
    low = cap_m / 4.0  # those that reach into the picture from outside
    while low < 0.196 * MOON_M:
        listed.append(terrain.craters(middle, cap_m + 2.0 * low, low, 2.0 * low))
        low *= 2.0
    rows = np.concatenate(listed)
    rows = rows[np.unique(rows["id"], return_index=True)[1]]
    base = sim.with_overrides({"bodies.moon.terrain.craters": None})
    ground, _ = base._mine().terrain_of(base.config, "moon")
    radius = MOON_M + ground.heights(rows["direction"])
    away = np.linalg.norm(rows["direction"] * radius[:, None] - eye, axis=1)
    px = focal * rows["diameter_m"] / away
    sure = np.abs(px / least_px - 1.0) > 1e-3  # heights at the crater's scale, and at the finest
    rows, px, sure = (x[px > 0.99 * least_px] for x in (rows, px, sure))
    order = np.argsort(rows["diameter_m"])
    return rows[order], sure[order], ways


def enclosed(rows: Any, ways: Any) -> Any:
    """(craters, H, W) distances to the centre over the radius, along the ground."""
    chords = np.linalg.norm(ways[None] - rows["direction"][:, None, None, :], axis=-1)
    return 2.0 * np.arcsin(np.minimum(0.5 * chords, 1.0)) * MOON_M / (
        0.5 * rows["diameter_m"][:, None, None]
    )  # fmt: skip


PLACES = {
    "middle": over(300.0),
    "pole": over(300.0) | {"lat_deg": 90.0},
    "date_line": over(300.0) | {"lon_deg": 180.0},
    "limb": over(60e3, 76.0),
    "large": over(9.0, 40.0),
}


CRATERS = {
    "limb": ROUND | {"law": "trask", "min_diameter_m": 2e3},
    "large": ROUND | {"min_diameter_m": 0.4},
}


@pytest.mark.parametrize("place", PLACES)
def test_the_smallest_that_encloses_a_point(place: str) -> None:
    sim = seen(PLACES[place], ANY, CRATERS.get(place, ROUND))
    sample = sim.frame(0, CHANNELS, threads=1)
    rows, sure, ways = about(sim, sample, 6.0)
    at = enclosed(rows, ways)
    inside = at < 1.0
    expected = np.where(inside.any(axis=0), rows["id"][inside.argmax(axis=0)], 0).astype(np.int64)
    near = (np.abs(at - 1.0) < 1e-3).any(axis=0) | (inside & ~sure[:, None, None]).any(axis=0)
    assert (expected > 0)[~near].mean() > 0.03
    assert len(np.unique(expected)) > (3 if place == "large" else 10)
    np.testing.assert_array_equal(sample["crater_id"][~near], expected[~near])
    assert near.mean() < 0.1


def test_what_younger_ones_removed_is_left_out() -> None:
    """A crater is not labelled where a younger one of at least 1.42 times its diameter was; where
    none is younger, all are."""
    sim = seen(over(300.0), KEPT, DENSE)
    sample = sim.frame(0, CHANNELS)
    rows, _, ways = about(sim, sample, 6.0)
    inside = enclosed(rows, ways) < 0.999
    ids, every = sample["crater_id"], seen(over(300.0), ANY, DENSE).frame(0, CHANNELS)["crater_id"]
    by_id = {int(row["id"]): k for k, row in enumerate(rows)}
    for line, column in zip(*np.nonzero(ids), strict=True):
        k = by_id[int(ids[line, column])]
        over_it = inside[:, line, column] & (rows["diameter_m"] > 1.42 * rows["diameter_m"][k])
        assert (rows["age_ga"][over_it] > rows["age_ga"][k]).all()
    lost = every != ids
    assert lost.any()
    for line, column in zip(*np.nonzero(lost), strict=True):
        k = by_id[int(every[line, column])]
        beside = rows["diameter_m"] > 0.7 * rows["diameter_m"][k]
        assert (rows["age_ga"][beside] < rows["age_ga"][k]).any()


def test_the_table_has_all_that_are_labelled() -> None:
    sim = seen(over(300.0), KEPT)
    ids, rows = sim.frame(0, ["crater_id"])["crater_id"], sim.craters(0, least_px=6.0)
    shown = rows[rows["px_count_visib"] > 0]
    assert set(shown["id"].tolist()) == set(np.unique(ids).tolist()) - {0}
    for row in shown:
        lines, columns = np.nonzero(ids == row["id"])
        assert len(lines) == row["px_count_visib"]
        box = [columns.min(), lines.min(), np.ptp(columns) + 1, np.ptp(lines) + 1]
        np.testing.assert_array_equal(row["bbox_visib"], box)
        # The box of the ellipse bounds the mask, but for half a pixel and the relief of the rim.
        low = row["bbox"][:2] - 1.0 - 0.03 * row["bbox"][2:]
        high = row["bbox"][:2] + 1.03 * row["bbox"][2:] + 1.0
        assert (low <= box[:2]).all()
        assert (np.add(box[:2], box[2:]) - 1 <= high).all()
    assert rows["cut"][rows["px_count_visib"] > 0].any()


def test_a_camera_inside_a_crater_larger_than_the_frame() -> None:
    """From orbit it is in the picture; from above its floor it is all of the picture, but for
    smaller ones. Its id is the same."""
    craters = ROUND | {"min_diameter_m": 60.0}
    orbit = seen(over(3e3), ANY, craters)
    rows = orbit.craters(0, least_px=6.0)
    row = rows[rows["inside_fract"] == 1.0][0]
    place = {"lon_deg": float(row["lon_deg"]), "lat_deg": float(row["lat_deg"])}
    near = seen(over(0.2 * float(row["diameter_m"])) | place, ANY, craters)
    ids, table = near.frame(0, ["crater_id"])["crater_id"], near.craters(0)
    assert (ids == row["id"]).mean() > 0.5
    found = table[table["id"] == row["id"]]
    assert len(found) == 1
    assert found["cut"][0]
    assert found["px_count_visib"][0] == (ids == row["id"]).sum()
    np.testing.assert_array_equal(found["direction"][0], row["direction"])
    inner = set(np.unique(ids).tolist()) - {int(row["id"])}
    small = set(table["id"][table["diameter_m"] < row["diameter_m"]].tolist())
    assert inner - {0} <= small


def test_classes_are_a_partition(repo_dir: Path) -> None:
    """Sky, terrain, crater, rock, spacecraft: each pixel is of the one that the ids tell."""
    place = {"lon_deg": LON_DEG, "lat_deg": LAT_DEG, "heading_deg": 0.0}
    orbit = {"kind": "surface", "around": "moon", **place}
    model = str(repo_dir / "assets/models/smallsat.glb")
    rocks = {"law": "haworth", "min_diameter_m": 0.3, "seed": 2}
    sim = seen(
        over(4.0, 72.0) | {"lat_deg": LAT_DEG - 4e-4, "azimuth_deg": 0.0},
        {"levels": ["kind", "ground"], "craters": {"least_px": 5.0}},
        terrain={"rocks": rocks},
        spacecraft={"sat": {"model": model, "size_m": 4.0, "orbit": orbit}},
    )
    names = sim.taxonomy.names("ground")
    assert names == {0: "background", 1: "terrain", 2: "crater", 3: "rock", 4: "spacecraft",
                     5: "body"}  # fmt: skip
    sample = sim.frame(0, ["semantic", "rock_id", "crater_id", "instance", "depth"])
    kinds, ids = sample["semantic"][..., 1], sim.taxonomy.instances
    is_of = {
        0: sample["depth"] == 0.0,
        2: sample["crater_id"] != 0,
        3: sample["rock_id"] != 0,
        4: sample["instance"] == ids["sat"],
    }
    is_of[1] = (sample["instance"] == ids["moon"]) & ~is_of[2] & ~is_of[3]
    for number, mask in is_of.items():
        np.testing.assert_array_equal(kinds == number, mask)
        assert mask.any(), names[number]
    assert sum(mask.astype(int) for mask in is_of.values()).max() == 1
    assert not (sample["crater_id"] != 0)[is_of[3]].any()
    alone = sim.frame(0, ["semantic"], threads=1)["semantic"]  # craters are found for it alone, too
    np.testing.assert_array_equal(alone, sample["semantic"])


def test_limits() -> None:
    none = seen(over(300.0), ANY, ROUND | {"density": 0.0})
    assert not none.frame(0, ["crater_id"])["crater_id"].any()
    assert len(none.craters(0)) == 0
    worn = ROUND | {"diffusivity_m2_per_myr": 50.0}
    deep = seen(over(300.0), {"craters": {"least_px": 6.0, "least_depth": 0.9}}, worn)
    shown = np.unique(deep.frame(0, ["crater_id"])["crater_id"])
    every = seen(over(300.0), ANY | {"craters": {"least_px": 6.0, "least_depth": 0.0}}, worn)
    assert len(shown) < 0.5 * len(np.unique(every.frame(0, ["crater_id"])["crater_id"]))
    with pytest.raises(ConfigError, match=r"labels\.craters\.least_px"):
        seen(over(300.0), {"craters": {"least_px": 0.5}})
    with pytest.raises(
        ConfigError, match=r"labels\.levels\[0\]: no 'grund'; did you mean 'ground'"
    ):
        seen(over(300.0), {"levels": ["grund"]})
    assert all(row["name"] != "crater_id" or not row["colour"] for row in _core.CHANNELS)
