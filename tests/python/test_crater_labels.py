"""The table of craters in a frame, beside the ground that is seen and all that are drawn."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from tests.python.test_terrain_frames import LAT_DEG, LON_DEG, MOON_M, in_body_axes, moon, over

import perilune
from perilune.frame.craters import CRATER_LABEL

FRESH = {"seed": 5, "min_diameter_m": 2.0, "diffusivity_m2_per_myr": 0.0}
TERRAIN = {"detail": None, "craters": FRESH}
HEIGHT_M = 300.0


def looking(
    trajectory: dict[str, Any],
    lens: dict[str, Any] | None = None,
    spacecraft: dict[str, Any] | None = None,
) -> perilune.Simulation:
    camera = {"trajectory": trajectory, "width": 128, "height": 96, "lens": lens}
    return moon(TERRAIN, camera, spacecraft=spacecraft or {})


def rim_pixels(row: Any) -> np.ndarray:
    """(60, 2) pixels of the ellipse of a row."""
    turn = np.linspace(0.0, 2.0 * np.pi, 60, endpoint=False)
    x, y = row["semi_axes"][:, None] * np.stack([np.cos(turn), np.sin(turn)])
    cos, sin = np.cos(row["angle_rad"]), np.sin(row["angle_rad"])
    return row["center"] + np.stack([cos * x - sin * y, sin * x + cos * y], axis=1)


def test_ellipses_lie_on_rims() -> None:
    """Straight down: rims are as high over floors as the table says, of craters that no younger
    one changed; ellipses are as large as the diameter at the distance of the ground."""
    sim = looking(over(HEIGHT_M))
    rows = sim.craters(0, least_px=5.0)
    sample = sim.frame(0, ["elevation", "depth"])
    assert rows.dtype == CRATER_LABEL
    assert (np.diff(rows["diameter_m"]) <= 0.0).all()
    whole = rows[(rows["kept"] > 0.9) & ~rows["cut"]]
    assert len(whole) >= 3
    focal = sample.camera.K[0, 0]
    deep = []
    for row in whole:
        u, v = np.clip(np.rint(rim_pixels(row)).astype(int), 0, (127, 95)).T
        column, line = np.rint(row["center"]).astype(int)
        away = sample["depth"][v, u].mean()
        assert row["semi_axes"].mean() == pytest.approx(
            0.5 * focal * row["diameter_m"] / away, rel=0.08
        )
        rise = sample["elevation"][v, u].mean() - sample["elevation"][line, column]
        deep.append(rise / row["depth_m"])
        assert row["visib_fract"] == 1.0
        assert row["center_visible"]
        np.testing.assert_allclose(row["bbox"][:2] + 0.5 * row["bbox"][2:], row["center"], atol=0.1)
    assert np.median(deep) == pytest.approx(1.0, abs=0.15)


def test_all_that_are_drawn_are_listed() -> None:
    """Those of the ground whose centre is seen and that are large enough; cut ones, too."""
    sim = looking(over(HEIGHT_M))
    least_px = 6.0
    rows = sim.craters(0, least_px=least_px)
    sample = sim.frame(0, ["position"])
    places = in_body_axes(sim, sample).reshape(-1, 3)
    terrain, _ = sim._mine().terrain_of(sim.config, "moon")
    focal = sample.camera.K[0, 0]
    least_m = 1.3 * least_px * HEIGHT_M / focal
    drawn = terrain.craters(places[64 + 128 * 48], HEIGHT_M, least_m)
    pixel_m = HEIGHT_M / focal
    ways = places / np.linalg.norm(places, axis=1, keepdims=True)
    near = [MOON_M * np.linalg.norm(ways - d, axis=1).min() for d in drawn["direction"]]
    seen = set(drawn["id"][np.array(near) < pixel_m].tolist())
    assert len(seen) > 5
    assert seen <= set(rows["id"].tolist())
    np.testing.assert_array_equal(rows["cut"], rows["inside_fract"] < 1.0)
    assert rows["cut"].any()
    assert not rows["cut"].all()


def test_what_is_hidden_is_told() -> None:
    """Rims near the limb may be hidden, of others most is seen."""
    sim = looking(over(100e3, 75.0))
    rows = sim.craters(0, least_px=2.0)
    assert len(rows) > 8
    assert (rows["visib_fract"] <= rows["inside_fract"]).all()
    beyond = rows["facing"] < np.sin(np.radians(1.0))
    assert (rows["visib_fract"][~beyond & ~rows["cut"]] > 0.5).mean() > 0.9
    lon, lat = np.radians(rows["lon_deg"]), np.radians(rows["lat_deg"])
    d = np.stack([np.cos(lat) * np.cos(lon), np.cos(lat) * np.sin(lon), np.sin(lat)], axis=1)
    np.testing.assert_allclose(d, rows["direction"], atol=1e-12)
    np.testing.assert_allclose(np.linalg.norm(rows["center_m"], axis=1), MOON_M, rtol=0.005)


def test_arcs_are_what_is_seen_of_rims() -> None:
    """Points of rims lie on the image of the ellipse, those in the picture where it is not cut, and
    their shares are those of the table. A point that is hidden has something nearer before it."""
    sim = looking(over(HEIGHT_M, 30.0))
    rows, sample = sim.craters(0, least_px=5.0), sim.frame(0, ["range", "position"])
    np.testing.assert_allclose(rows["rim_inside"].mean(axis=1), rows["inside_fract"])
    np.testing.assert_allclose(rows["rim_visib"].mean(axis=1), rows["visib_fract"])
    assert not (rows["rim_visib"] & ~rows["rim_inside"]).any()
    u, v = rows["rim_px"][..., 0], rows["rim_px"][..., 1]
    within = (u >= -0.5) & (u < 127.5) & (v >= -0.5) & (v < 95.5)
    np.testing.assert_array_equal(rows["rim_inside"], within)
    assert (rows["rim_inside"].any(axis=1) & ~rows["rim_inside"].all(axis=1)).any()
    whole = np.isfinite(rows["semi_axes"]).all(axis=1)
    off = rows["rim_px"][whole] - rows["center"][whole, None]
    cos, sin = np.cos(rows["angle_rad"][whole]), np.sin(rows["angle_rad"][whole])
    x = off[..., 0] * cos[:, None] + off[..., 1] * sin[:, None]
    y = off[..., 1] * cos[:, None] - off[..., 0] * sin[:, None]
    axes = rows["semi_axes"][whole]
    assert np.median(np.abs(np.hypot(x / axes[:, :1], y / axes[:, 1:]) - 1.0)) < 0.05
    shown = np.rint(np.stack([v, u], axis=-1))[rows["rim_visib"]].astype(int)
    assert np.isfinite(sample["range"][np.clip(shown[:, 0], 0, 95), shown[:, 1]]).mean() > 0.97


def test_a_spacecraft_hides_them(repo_dir: Path) -> None:
    """Where the picture shows it in place of the middle of a crater, that is not seen."""
    plain = looking(over(HEIGHT_M))
    bare = plain.craters(0, least_px=2.0)
    place = {"lon_deg": LON_DEG, "lat_deg": LAT_DEG, "heading_deg": 0.0}
    craft = {
        "model": str(repo_dir / "assets/models/smallsat.glb"),
        "size_m": 300.0,
        "orbit": {"kind": "surface", "around": "moon", **place},
    }
    sim = looking(over(HEIGHT_M), spacecraft={"sat": craft})
    rows, before = sim.craters(0, least_px=2.0), bare["center_visible"]
    _, a, b = np.intersect1d(bare["id"], rows["id"], return_indices=True)
    column, line = np.clip(np.rint(bare["center"][a]).astype(int), 0, (127, 95)).T
    ranges = [scene.frame(0, ["range"])["range"][line, column] for scene in (sim, plain)]
    covered = (ranges[0] < ranges[1] - 10.0) & before[a]  # beyond what is taken for the ground
    assert covered.sum() >= 2
    assert not rows["center_visible"][b][covered].any()
    free = ranges[0] == ranges[1]
    np.testing.assert_array_equal(rows["center_visible"][b][free], before[a][free])
    assert (rows["visib_fract"][b] <= bare["visib_fract"][a]).all()
    np.testing.assert_array_equal(rows["semi_axes"][b], bare["semi_axes"][a])


def test_boxes_follow_the_lens() -> None:
    """Ellipses are those of the camera without its lens, boxes those of the picture."""
    bent = {"model": "brown_conrady", "k1": -0.2}
    plain = looking(over(HEIGHT_M)).craters(0, least_px=5.0)
    rows = looking(over(HEIGHT_M), bent).craters(0, least_px=5.0)
    both, a, b = np.intersect1d(plain["id"], rows["id"], return_indices=True)
    assert len(both) > 5
    np.testing.assert_allclose(rows["center"][b], plain["center"][a], atol=1e-9)
    middle = np.array([63.5, 47.5])
    straight = plain["bbox"][a, :2] + 0.5 * plain["bbox"][a, 2:] - middle
    pulled = rows["bbox"][b, :2] + 0.5 * rows["bbox"][b, 2:] - middle
    far = np.linalg.norm(straight, axis=1) > 24.0
    assert far.any()
    assert (np.linalg.norm(pulled, axis=1) < np.linalg.norm(straight, axis=1))[far].all()


def test_errors() -> None:
    sim = looking(over(HEIGHT_M))
    with pytest.raises(ValueError, match="least_px: must be above 0"):
        sim.craters(0, least_px=0.0)
    with pytest.raises(ValueError, match=r"more than 3 craters .* raise least_px"):
        sim.craters(0, least_px=5.0, most=3)
    with pytest.raises(ValueError, match=r"'mars' has no craters; .* moon"):
        sim.craters(0, "mars")
    bare = moon({}, {"trajectory": over(HEIGHT_M)})
    with pytest.raises(ValueError, match="no body has"):
        bare.craters(0)
