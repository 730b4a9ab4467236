"""Textures of the ground: mean, variance, seams, repeats, footprints, and what pixels show."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from PIL import Image
from pydantic import ValidationError

import perilune
from perilune import _core
from perilune.bodies.ground_textures import clods_of, read_texture
from perilune.bodies.terrain import core_terrain
from perilune.config.body import Body
from perilune.config.errors import ConfigError
from perilune.config.terrain import Terrain
from perilune.cost import model

RADIUS_M = 1737400.0
RADII_M = np.full(3, RADIUS_M)
SIZE_M = 4.0
F64 = NDArray[np.float64]


def sample(side: int = 128) -> NDArray[np.float32]:
    """Smooth noise from 0 to 1, whose opposite edges do not fit."""
    random = np.random.default_rng(5)
    waves = np.fft.rfftfreq(side)[None, :] ** 2 + np.fft.fftfreq(side)[:, None] ** 2
    spectrum = np.fft.rfft2(random.normal(size=(side, side))) * np.exp(-waves * 100.0)
    noise = np.fft.irfft2(spectrum, s=(side, side)) + 2e-3 * np.arange(side)[:, None]
    return np.asarray((noise - noise.min()) / np.ptp(noise), dtype=np.float32)


@pytest.fixture(scope="module")
def image(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("textures") / "sample.npy"
    np.save(path, sample())
    return path


def ground(image: Path, seed: int = 0, high_m: float = 0.1) -> _core.Terrain:
    texture = {
        "size_m": SIZE_M,
        "seed": seed,
        "displacement": {"file": str(image), "high_m": high_m},
    }
    given = Terrain.model_validate({"detail": {"strength": 0.0}, "textures": [texture]})
    return core_terrain(
        given, RADII_M, [], textures=[(read_texture(image, 0.0, high_m), None, None)]
    )


def about(center: tuple[float, float, float], x_m: F64, y_m: F64) -> F64:
    """Directions of places (m) in the plane about a direction."""
    up = np.array(center) / np.linalg.norm(center)
    east = np.cross([0.3, 0.5, 0.8], up)
    east /= np.linalg.norm(east)
    to = up + (x_m[:, None] * east + y_m[:, None] * np.cross(up, east)) / RADIUS_M
    return np.asarray(to / np.linalg.norm(to, axis=1, keepdims=True))


PLACES = ((1.0, 0.0, 0.0), (1.0, 1.0, 0.0), (1.0, -1.0, 1.0), (0.0, 0.0, -1.0), (0.3, 0.2, 0.7))
"""Middles of faces of the cube, an edge, a corner, and elsewhere."""


def test_mean_and_variance_are_those_of_the_image(image: Path) -> None:
    made = ground(image)
    random = np.random.default_rng(1)
    for place in PLACES:
        x, y = random.uniform(-500.0, 500.0, (2, 20000))
        heights = made.heights(about(place, x, y))
        spread = 0.1 * sample().std()
        # Patches are about as wide as waves: some 250 000 of them are independent.
        assert abs(heights.mean()) < 0.03 * spread
        assert heights.std() == pytest.approx(spread, rel=0.12)
        low, high = made.bounds
        assert (heights > low).all()
        assert (heights < high).all()


def test_no_seams_and_no_repeats(image: Path) -> None:
    made = ground(image)
    for place in PLACES:
        x = np.arange(-8.0, 8.0, 2e-3)
        steps = np.diff(made.heights(about(place, x, 0.37 * x)))
        slope = np.abs(steps).max() / (2e-3 * np.hypot(1.0, 0.37))
        assert 0.02 < slope < 4.0 * 0.1 * np.abs(np.diff(sample(), axis=1)).max() / (SIZE_M / 128)
    # Correlations at the size of the image, and at its lattice's edge, are no more than elsewhere.
    side = np.arange(0.0, 160.0, 0.25)
    x, y = (grid.ravel() for grid in np.meshgrid(side, side))
    heights = made.heights(about((0.3, 0.2, 0.7), x, y)).reshape(len(side), -1)
    power = np.abs(np.fft.fft2(heights - heights.mean())) ** 2
    similar = np.real(np.fft.ifft2(power))[: len(side) // 2, : len(side) // 2] / power.mean()
    near = np.hypot(*np.meshgrid(side, side))[: len(side) // 2, : len(side) // 2] < 2.0 * SIZE_M
    assert np.abs(similar[~near] / similar[0, 0]).max() < 0.12


def test_footprints_are_means(image: Path) -> None:
    """Cells of a width show what a mean over as wide a square has, and wide ones nothing."""
    made = ground(image)
    cell = made.cell_m(made.level(0.25))
    random = np.random.default_rng(2)
    x, y = random.uniform(-50.0, 50.0, (2, 500))
    offsets = (np.arange(8) + 0.5) / 8.0 - 0.5
    square = [
        made.heights(about((0.3, 0.2, 0.7), x + cell * a, y + cell * b))
        for a in offsets
        for b in offsets
    ]
    shown = made.heights(about((0.3, 0.2, 0.7), x, y), cell)
    exact, alone = np.mean(square, axis=0), made.heights(about((0.3, 0.2, 0.7), x, y))
    assert np.std(shown - exact) < 0.8 * np.std(alone - exact)
    assert np.corrcoef(shown, exact)[0, 1] > 0.96  # the filter is somewhat wider than the cell
    assert 0.75 < np.std(shown) / np.std(exact) < 1.02
    assert np.abs(made.heights(about((0.3, 0.2, 0.7), x, y), 8.0)).max() == 0.0
    assert np.abs(ground(image, seed=1).heights(about(PLACES[0], x, y)) - shown).max() > 0.0


def scene(tmp_path: Path, cells: float, **texture: Any) -> dict[str, Any]:
    place = {"target": "moon", "lon_deg": 10.0, "lat_deg": 20.0}
    sun = {"azimuth_deg": 100.0, "elevation_deg": 20.0}
    terrain = {
        "detail": {"strength": 0.0},
        "cells_per_pixel": cells,
        "textures": [{"size_m": SIZE_M, **texture}],
    }
    return {
        "version": 1,
        "time": {"epoch": "2026-03-03T06:00:00Z", "step_s": 1.0},
        "root": "moon",
        "sun": {"at": {"lon_deg": 10.0, "lat_deg": 20.0, **sun}},
        "bodies": {"moon": {"kind": "moon", "reflectance": "hapke", "albedo": 0.3,
                            "terrain": terrain}},
        "camera": {
            "width": 40,
            "height": 30,
            "fov_deg": 20.0,
            "trajectory": {"kind": "hover", **place, "height_m": 50.0},
            "exposure": {"mode": "fixed", "white_radiance_w_m2_sr": 200.0},
        },
        "render": {"samples": 16, "max_bounces": 0, "channels": ["radiance"]},
    }  # fmt: skip


def mean(config: dict[str, Any]) -> float:
    return float(perilune.open(config)[0]["radiance"][..., 1].mean())


def test_brightness_does_not_depend_on_the_mesh(tmp_path: Path, image: Path) -> None:
    """As relief, as slopes of samples, and as variance: within 2 %. Roughness and albedo act."""
    heights = {"displacement": {"file": str(image), "high_m": 0.15}}
    fine, coarse = (mean(scene(tmp_path, cells, **heights)) for cells in (2.0, 0.0625))
    assert coarse == pytest.approx(fine, rel=0.02)
    grey = tmp_path / "grey.png"
    Image.fromarray(np.full((16, 16), 128, np.uint8)).save(grey)
    flat = mean(scene(tmp_path, 0.25, albedo={"file": str(grey), "high": 255.0 / 128.0}))
    dark = mean(scene(tmp_path, 0.25, albedo={"file": str(grey)}))
    assert 0.4 < dark / flat < 0.55  # multiple scattering falls faster than the albedo
    smooth = mean(scene(tmp_path, 0.25, roughness={"file": str(grey), "high": 0.0}))
    assert smooth > 1.02 * flat


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"displacement": None}, "needs displacement, clods, roughness, albedo or mottling"),
        ({"size_m": 0.0}, "greater than 0"),
        ({"displacement": {"file": "a.png"}}, "high_m"),
        ({"roughness": {"file": "a.png", "high": -1.0}}, "greater than or equal to 0"),
    ],
)
def test_errors(change: dict[str, Any], words: str) -> None:
    texture = {"size_m": 2.0, "displacement": {"file": "a.png", "high_m": 0.1}, **change}
    with pytest.raises(ValidationError, match=words):
        Terrain.model_validate({"textures": [texture]})


def test_errors_name_the_file(tmp_path: Path) -> None:
    config = scene(tmp_path, 1.0, displacement={"file": "none.png", "high_m": 0.1})
    with pytest.raises(FileNotFoundError, match=r"textures\[0\].displacement.*none.png"):
        perilune.open(config)[0]
    small = tmp_path / "small.npy"
    np.save(small, np.zeros((4, 4)))
    config = scene(tmp_path, 1.0, displacement={"file": str(small), "high_m": 0.1})
    with pytest.raises(ConfigError, match=r"textures\[0\].displacement.file: .*small"):
        perilune.open(config)[0]
    with pytest.raises(ValueError, match="8 by 8"):
        read_texture(small, 0.0, 1.0)
    path = tmp_path / "wide.npy"
    np.save(path, np.zeros((8, 8)))
    with pytest.raises(ValueError, match=r"textures?.*wide"):
        _core.Terrain(RADII_M, textures=[(read_texture(path, 0.0, 1.0), None, None, 1e6, 0)])


@pytest.mark.parametrize(
    ("body", "words"),
    [
        ({"reflectance": "lambert"}, "nothing without reflectance: hapke"),
        ({"material": "foil"}, "give it to 'foil'"),
        ({"material": "foil", "terrain": {"tracks": [{
            "lon_deg": 0.0, "lat_deg": 0.0, "waypoints_m": [[0.0, 0.0], [1.0, 0.0]],
        }]}}, "must be 1"),
    ],
)  # fmt: skip
def test_what_a_body_does_not_show_is_an_error(body: dict[str, Any], words: str) -> None:
    image = {"file": "a.png"}
    terrain = {"textures": [{"size_m": 2.0, "roughness": image, "albedo": image}]}
    with pytest.raises(ValidationError, match=words):
        Body.model_validate({"kind": "moon", "terrain": terrain, **body})


def made(size_m: float, **parts: Any) -> dict[str, Any]:
    """The rover's ground straight down, with a texture that the core makes."""
    return {
        "camera.width": 96,
        "camera.height": 96,
        "render.samples": 4,
        "sensors": {},
        "camera.trajectory": {
            "kind": "hover",
            "target": "moon",
            "lon_deg": 10.0,
            "lat_deg": 20.0,
            "height_m": 400.0,
        },
        "bodies.moon.terrain.rocks": None,
        "bodies.moon.terrain.textures": [{"size_m": size_m, "seed": 5, **parts}],
    }


def test_mottling_keeps_the_mean_albedo_and_has_its_contrast() -> None:
    """The mean over many patches is that of the body; both kinds differ by the contrast."""
    given = made(100.0, mottling={"contrast": 0.4, "border": 0.1, "hurst": 0.8})
    albedo = perilune.open("configs/lunar_rover.yaml", overrides=given).frame(0, ["albedo"])
    values = albedo["albedo"][..., 0].ravel() / 0.33
    low, high = np.percentile(values, [5, 95])
    assert abs(values.mean() - 1.0) < 0.03
    assert 0.3 < high - low < 0.5


def test_mottling_is_a_part_of_the_row_of_maps(tmp_path: Path) -> None:
    """Without the row ground has the mean albedo; the bound holds what that changes."""
    parts = {"mottling": {"contrast": 0.4, "border": 0.1}}
    shown = perilune.open(scene(tmp_path, 1.0, **parts))
    hidden = shown.with_overrides({"render.force_off": ["surface_maps"]})
    plain = shown.with_overrides({"bodies.moon.terrain.textures": []})
    light, even, smooth = (sim[0]["radiance"][..., 1] for sim in (shown, hidden, plain))
    assert even.mean() == pytest.approx(light.mean(), rel=0.05)
    assert even == pytest.approx(smooth, rel=1e-6)
    assert np.std(light) > 2.0 * np.std(even)
    row = {row["name"]: row for row in shown.plan(0)}["surface_maps"]
    assert row["on"]
    assert row["bound_dn"] >= 255.0 * np.abs(light - even).max() / 200.0


def test_drivers_draw_other_samples() -> None:
    """Each value has a ground of its own; the same frame has the same again."""
    change = made(2.0, clods={"density_per_m2": {"uniform": [5.0, 300.0]}, "pixels": 64})
    sim = perilune.open("configs/lunar_rover.yaml", overrides=change)
    d = about((0.6, 0.3, 0.4), 0.02 * np.arange(400), np.zeros(400))
    heights = [sim.terrain(k).heights(d) for k in (0, 1, 0)]
    assert np.array_equal(heights[0], heights[2])
    assert np.abs(heights[1] - heights[0]).max() > 1e-3


def test_clods_are_relief_of_the_ground() -> None:
    """Their share of the ground is that of their law, and no height is beyond theirs."""
    texture = {"size_m": 2.0, "clods": {"min_diameter_m": 0.02, "density_per_m2": 300.0}}
    given = Terrain.model_validate({"detail": {"strength": 0.0}, "textures": [texture]})
    row = given.textures[0]
    assert row.clods is not None
    raster = clods_of(row, row.clods)
    laid = core_terrain(given, RADII_M, [], textures=[(raster, None, None)])
    random = np.random.default_rng(3)
    places = about((0.3, -0.6, 0.4), random.uniform(-20, 20, 8000), random.uniform(-20, 20, 8000))
    heights = laid.heights(places, 0.0)
    # 65 a square metre of 2 to 6 cm; patches that overlap show some of both, less high.
    assert 0.03 < (heights > 0.002).mean() < 0.12
    assert heights.max() < 0.03


def test_slopes_of_textures_are_a_row_of_the_plan(tmp_path: Path) -> None:
    """Without them pixels are alike and as bright; absent where no sample resolves them."""
    config = scene(tmp_path, 0.25, clods={"density_per_m2": 300.0, "pixels": 128})
    near = perilune.open(config, overrides={"camera.trajectory.height_m": 5.0})
    off = near.with_overrides({"render.force_off": ["texture_slopes"]})
    shown, hidden = (sim[0]["radiance"][..., 1] for sim in (near, off))
    assert hidden.mean() == pytest.approx(shown.mean(), rel=0.02)
    assert np.std(np.diff(hidden)) < 0.6 * np.std(np.diff(shown))
    far = near.with_overrides({"camera.trajectory.height_m": 3e6})
    rows = [{row["name"]: row for row in sim.plan(0)}["texture_slopes"] for sim in (near, far)]
    assert rows[0]["on"]
    assert rows[0]["bound_dn"] >= 255.0
    assert not rows[1]["on"]
    assert "resolve" in rows[1]["reason"]


def test_counts_of_work_do_not_depend_on_what_is_kept(tmp_path: Path) -> None:
    """The making of tiles looks textures up, too: frames within a time would depend on those that
    were rendered before."""
    sim = perilune.open(scene(tmp_path, 0.25, clods={"density_per_m2": 300.0, "pixels": 128}))
    first, again = model.expect(sim, 0).counts, model.expect(sim, 0).counts
    assert first == again
    assert first["texture_patches"] > 0


@pytest.mark.parametrize(
    ("texture", "message"),
    [
        ({"clods": {}, "size_m": 0.2}, "clods.max_diameter_m: 0.06 must be at most 0.025"),
        ({"clods": {"density_per_m2": 1e5}}, "clods.density_per_m2: clods would cover"),
        ({"clods": {"min_diameter_m": 0.1}}, "clods.min_diameter_m"),
        ({"mottling": {}}, "mottling.contrast"),
        ({"mottling": {"contrast": 0.2}, "albedo": {"file": "a.png"}}, "not beside albedo"),
        ({"clods": {}, "displacement": {"file": "a.png", "high_m": 1.0}}, "not beside displ"),
    ],
)
def test_textures_that_cannot_be_made_are_refused(texture: dict[str, Any], message: str) -> None:
    rows = {"bodies.moon.terrain.textures": [{"size_m": 2.0, **texture}]}
    with pytest.raises(ConfigError, match=message):
        perilune.open("configs/lunar_rover.yaml", overrides=rows).terrain(0)


CLODS = {"seed": 3, "pixels": 64, "size_m": 2.0, "min_diameter_m": 0.008, "max_diameter_m": 0.04,
         "density_per_m2": 200.0, "exponent": 2.3}  # fmt: skip
MOTTLING = {"seed": 1, "pixels": 64, "cover": 0.5, "border": 1.0, "hurst": 0.5}
ODD = (math.nan, math.inf, -1.0, 0.0, 1e300, 1e-300, -1, 2**40, 2**64, 2**70, "8", None)


@pytest.mark.parametrize(("name", "good"), [("clods", CLODS), ("mottling", MOTTLING)])
def test_the_core_refuses_samples_or_makes_finite_ones(name, good):
    """Whatever one of the settings is, and for what is no mapping."""
    make = getattr(_core, name)
    assert np.isfinite(make(good)).all()
    refused = 0
    for key in good:
        for value in ODD:
            try:
                assert np.isfinite(make({**good, key: value})).all(), (key, value)
            except (TypeError, ValueError, OverflowError):
                refused += 1
    assert refused > 6 * len(good)
    for odd in (5, None, {}):
        with pytest.raises((TypeError, KeyError, ValueError)):
            make(odd)
