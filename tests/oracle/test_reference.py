"""Converged frames against Mitsuba's, through the exporter that the benchmarks use.

Materials on which the two agree: metals of one roughness, Lambert's law. Differences are free of
noise (products of independent halves); bounds are in digital numbers of 255.
"""

from __future__ import annotations

from pathlib import Path

import mitsuba
import numpy as np
import pytest
from benchmarks.reference import by_mitsuba, compare, export, models, ours, scenes
from benchmarks.reference.scene import Scene, load

import perilune

WIDTH = 64


def both(sim, samples, folder, frame=0, rows=128):
    """Two runs of each, and the radiance of white."""
    scene = export.export(sim, frame, rows)
    a = ours.render(sim, frame, samples[0], [1, 2])
    b = by_mitsuba.render(scene, samples[1], [1, 2], folder)
    return a, b, scene.white_radiance


@pytest.fixture(scope="module")
def foil(tmp_path_factory):
    folder = tmp_path_factory.mktemp("foil")
    return both(scenes.FRAMES["foil"].open(WIDTH, folder), (128, 128), folder)


def test_metal_in_metal_is_not_roughened(foil):
    """At a tolerance of 0; with reflections roughened it is 29 DN, and half as bright again."""
    apart = compare.rms(*foil)
    print(f"foil: {apart:.2f} DN, mean ratio {foil[0].mean() / foil[1].mean():.4f}")
    assert apart < 17.0


def test_metal_in_metal_is_as_bright(foil):
    """Brighter by what Mitsuba's metals lose from facet to facet, a fifth here. Random walks send a
    half of that back broadly at these roughnesses (tests/c/test_microfacets.c); all of it sent back
    as from a diffuse surface makes 14.4 DN, and a ratio of 1.28."""
    ratio = foil[0].mean() / foil[1].mean()
    print(f"foil: {compare.rms(*foil):.2f} DN, mean ratio {ratio:.4f}")
    assert compare.rms(*foil) < 11.5
    assert 1.1 < ratio < 1.25


def oblate(latitudes: str) -> dict:
    config = scenes.alone()
    del config["spacecraft"]
    config["bodies"]["planet"] = {
        "kind": "ellipsoid",
        "radii_km": [6000.0, 6000.0, 4500.0],
        "gm_km3_s2": 4e5,
        "color_map": str(scenes.ROOT / "assets/maps/earth_like.jpg"),
        "map_center_lon_deg": 30.0,
        "latitudes": latitudes,
    }
    config["camera"]["trajectory"] = {
        "kind": "fixed",
        "target": "planet",
        "position_m": [8e6, -9e6, 9e6],
    }
    return config


@pytest.mark.parametrize(
    "latitudes", [pytest.param("geocentric", marks=pytest.mark.soak), "geodetic"]
)
def test_maps_lie_as_their_latitudes_say(latitudes: str, tmp_path: Path):
    frame = scenes.Frame(oblate(latitudes))
    a, b, white = both(frame.open(WIDTH, tmp_path), (64, 64), tmp_path)
    wrong = {"geocentric": "geodetic", "geodetic": "geocentric"}[latitudes]
    other = ours.render(scenes.Frame(oblate(wrong)).open(WIDTH, tmp_path), 0, 16, [1, 2])
    apart, misread = compare.rms(a, b, white), compare.rms(other, b, white)
    print(f"{latitudes}: {apart:.2f} DN, with the other latitudes {misread:.2f}")
    assert apart < 1.0
    assert misread > 3.0


def test_sheets_back_to_back_are_no_stripes(tmp_path: Path):
    """A bright and a dark one that rounding has left in the wrong order; each is seen from where it
    looks. Seen by others as they are in the file, the dark one is before the bright one."""
    sheets = [((0.0, 0.0, -5e-5), 1.0, (0.8, 0.8, 0.8)), ((0.0, 0.0, 5e-5), -1.0, (0.05, 0.1, 0.4))]
    pieces = []
    for centre, side, color in sheets:
        corners = models.rectangle(centre, (side * 0.9, 0.0, 0.0), (0.0, 0.9, 0.0))
        row = models.metal(color, 0.9)
        row["pbrMetallicRoughness"]["metallicFactor"] = 0.0
        row["extensions"] = {"KHR_materials_specular": {"specularFactor": 0.0}}
        pieces.append((corners, None, {**row, "doubleSided": False}))
    model = models.write_glb(tmp_path / "sheets.glb", pieces)
    frame = scenes.Frame(scenes.alone(), 0, {"spacecraft.object.model": str(model)})
    a, b, white = both(frame.open(WIDTH, tmp_path), (64, 64), tmp_path)
    apart, ratio = compare.rms(a, b, white), a.mean() / b.mean()
    print(f"sheets: {apart:.2f} DN, mean ratio {ratio:.4f}")
    assert apart < 1.0
    assert abs(ratio - 1.0) < 5e-3


def depth(scene: Scene, folder: Path) -> np.ndarray:
    """(H, W) metres along the optical axis, of the pixels' centres by the mean of samples."""
    mitsuba.set_variant("scalar_rgb")
    described = by_mitsuba.describe(mitsuba, scene, 16, folder)
    del described["sun"]
    described["integrator"] = {"type": "aov", "aovs": "p:position"}
    image = np.array(mitsuba.render(mitsuba.load_dict(described), seed=0))
    return image[..., 2]


def test_everything_is_in_its_place(tmp_path: Path):
    """Depths of a model whose parts are turned, and of the body behind."""
    config = "articulated.yaml"
    extras = ("atmosphere", "clouds", "ocean", "night_lights", "relief", "rings")
    opened = perilune.open(str(scenes.ROOT / "configs" / config))
    document = opened.config
    plain: dict = {"camera.width": 96, "camera.height": 72, **scenes.PLAIN}
    for name, body in document.bodies.items():
        plain |= {f"bodies.{name}.{k}": None for k in extras if getattr(body, k) is not None}
    for name, craft in document.spacecraft.items():
        plain[f"spacecraft.{name}.model_graphs"] = False
        if craft.materials:
            plain[f"spacecraft.{name}.materials"] = None
    sim = perilune.open(str(scenes.ROOT / "configs" / config), overrides=plain)
    theirs = depth(export.export(sim, 2, 256), tmp_path)
    mine = np.nan_to_num(sim.frame(2, channels=["depth"])["depth"], posinf=0.0)
    off = np.abs(theirs - mine) / np.maximum(mine, 1e-3)
    near, far = (mine > 0.0) & (mine < 1e3), mine >= 1e3
    shares = [float((off[near] < 2e-3).mean()), float((off[far] < 1e-2).mean())]
    print(f"{config}: {near.sum()} pixels of models, {shares} agree")
    assert near.sum() > 500
    assert shares[0] > 0.6  # outlines are means of several things there
    assert shares[1] > 0.9


def test_a_scene_is_read_as_it_was_written(tmp_path: Path):
    sim = scenes.FRAMES["satellite"].open(WIDTH, tmp_path)
    scene = export.export(sim, 2, 16)
    scene.save(tmp_path)
    again = load(tmp_path)
    assert again.camera == {**scene.camera}
    assert [row.name for row in again.materials] == [row.name for row in scene.materials]
    for a, b in zip(again.meshes, scene.meshes, strict=True):
        assert np.array_equal(a.positions, b.positions)
        assert np.array_equal(a.indices, b.indices)


def test_what_others_cannot_show_is_named(tmp_path: Path):
    sim = perilune.open(str(scenes.ROOT / "configs" / "demo.yaml"))
    with pytest.raises(ValueError, match=r"bodies\.planet\.atmosphere.*spacecraft\.smallsat\.mat"):
        export.export(sim, 0)


def test_noise_counts_for_nothing():
    rng = np.random.default_rng(5)
    truth = rng.uniform(20.0, 60.0, (1, 60, 80, 3))
    a, b = (truth + rng.normal(0.0, 4.0, (4, 60, 80, 3)) for _ in range(2))
    assert compare.rms(a, b, 100.0) < 0.6
    assert compare.rms(a + 10.0, b, 100.0) > 5.0
    assert not compare.differing(a, b).any()
    assert compare.differing(a + 40.0, b).mean() > 0.9


def test_phobos_is_cut_into_half_a_million():
    points = np.array([[1.0, 0, 0], [0, 1, 0], [0, 0, 1], [-1, -1, -1]])
    corners = np.array([[0, 1, 2], [0, 2, 3], [0, 3, 1], [1, 3, 2]])
    for _ in range(2):
        points, corners = models.halved(points, corners)
    assert len(corners) == 64
    assert len(points) == 34  # closed: V - E + F = 2
