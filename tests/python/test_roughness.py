"""The roughness of elevation models: known fractals, and what breaks the assumption."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

from perilune import _core
from perilune.bodies.elevation import ElevationRaster
from perilune.bodies.elevation_files import read
from perilune.bodies.places import Place
from perilune.bodies.roughness import BEND, Roughness, of_elevation, roughness
from perilune.bodies.terrain import core_terrain, remarks_of
from perilune.config.terrain import Terrain

RADIUS_M = 1737400.0
F64 = NDArray[np.float64]


def fractal(hurst: float, seed: int, posts: int = 200, step_m: float = 8.0) -> F64:
    """Heights of nu(L) = (L / 10 m)^H metres, at posts step_m apart."""
    detail = {
        "seed": seed, "ranges": [(0.0, hurst)], "baseline_m": 10.0, "deviation_m": 1.0,
        "longest_m": 2e4, "finest_m": 1.0,
    }  # fmt: skip
    terrain = _core.Terrain(np.full(3, RADIUS_M), detail=detail)
    along = (np.arange(posts) - 0.5 * posts) * step_m / RADIUS_M
    y, z = np.meshgrid(along, along)
    d = np.stack([np.ones(y.size), y.ravel(), z.ravel()], axis=1)
    return terrain.heights(d).reshape(posts, posts)


def law(heights: list[F64], step_m: float = 8.0) -> Roughness:
    found = roughness(heights, step_m, step_m)
    assert found is not None
    return found


@pytest.mark.parametrize("hurst", [0.3, 0.5, 0.76, 0.95])
def test_known_fractals(hurst: float) -> None:
    found = law([fractal(hurst, seed) for seed in range(4)])
    assert found.hurst == pytest.approx(hurst, abs=0.05)
    assert found.deviation_m == pytest.approx((found.baseline_m / 10.0) ** hurst, rel=0.15)
    assert abs(found.bend) < 0.5 * BEND


def test_what_breaks_the_assumption() -> None:
    """A smoothed model seems smoother than it is, a noisy one rougher; the bend tells."""
    true = fractal(0.7, 1)
    kernel = np.exp(-0.5 * (np.arange(-6, 7) / 2.0) ** 2)
    kernel /= kernel.sum()
    smooth = np.apply_along_axis(lambda row: np.convolve(row, kernel, "valid"), 0, true)
    smooth = np.apply_along_axis(lambda row: np.convolve(row, kernel, "valid"), 1, smooth)
    found = law([smooth])
    assert found.hurst > 0.85
    assert found.bend > BEND
    noisy = law([true + np.random.default_rng(2).normal(0.0, 1.5, true.shape)])
    assert noisy.hurst < 0.5
    assert noisy.bend < -BEND


def test_without_a_law() -> None:
    assert roughness([np.zeros((50, 50))], 1.0, 1.0) is None
    assert roughness([np.ones((4, 4)) * np.arange(4)], 1.0, 1.0) is None
    tilted = law([np.ones((20, 20)) * np.arange(20.0)[:, None] + 2.0 * np.arange(20.0)], 1.0)
    assert tilted.hurst == pytest.approx(1.0)


def model(heights: F64, place: Place, scale_m: float, offset_m: float) -> ElevationRaster:
    samples = np.rint((heights - offset_m) / scale_m).astype(np.int16)
    return ElevationRaster(samples, place, scale_m, offset_m, "here.img")


def test_elevation_models() -> None:
    """Local and cylindrical ones, large ones by parts of them."""
    heights = fractal(0.8, 3, posts=700)
    local = Place("orthographic", -2796.0, 2796.0, 8.0, -8.0, radius_m=RADIUS_M)
    found = of_elevation(model(heights, local, 0.01, 5.0), RADIUS_M)
    assert found is not None
    assert found.hurst == pytest.approx(0.8, abs=0.08)
    step = 8.0 / RADIUS_M
    drawn = Place("cylindrical", 0.0, 1.0, 3.0 * step, -step)
    along = of_elevation(model(heights, drawn, 0.01, 5.0), RADIUS_M)
    assert along is not None
    assert along.hurst == pytest.approx(found.hurst, abs=0.08)
    assert along.deviation_m == pytest.approx(
        found.deviation_m * (along.baseline_m / found.baseline_m) ** 0.8, rel=0.15
    )


def section(**detail: object) -> Terrain:
    rows = [{"file": "here.img", "interpolation": "cubic"}]
    return Terrain.model_validate({"elevation": rows, "detail": {"from_elevation": True, **detail}})


def test_the_law_of_a_section() -> None:
    """Detail takes its law from the last model; of one that follows none, the user is told."""
    local = Place("orthographic", -796.0, 796.0, 8.0, -8.0, radius_m=RADIUS_M)
    coarse = model(np.zeros((200, 200)), local, 0.01, 5.0)
    true = model(fractal(0.8, 3), local, 0.01, 5.0)
    radii_m = np.full(3, RADIUS_M)
    terrain = core_terrain(section(seed=4), radii_m, [coarse, true])
    law = of_elevation(true, RADIUS_M)
    assert law is not None
    keys = {"seed": 4, "ranges": [(0.0, law.hurst)], "baseline_m": law.baseline_m}
    same = _core.Terrain(radii_m, detail=keys | {"deviation_m": law.deviation_m})
    away = np.array([[0.0, 1.0, 0.0]])  # no model is there
    assert terrain.heights(away) == same.heights(away)
    assert remarks_of(section(), radii_m, [coarse, true]) == []
    noise = np.random.default_rng(2).normal(0.0, 1.5, (200, 200))
    noisy = model(fractal(0.8, 3) + noise, local, 0.01, 5.0)
    (remark,) = remarks_of(section(), radii_m, [coarse, noisy])
    assert "here.img is noisy or has steps; the Hurst exponent of 0." in remark
    assert remarks_of(section(from_elevation=False), radii_m, [noisy]) == []
    with pytest.raises(ValueError, match=r"here\.img: is flat, or has too few posts"):
        core_terrain(section(), radii_m, [true, coarse])


@pytest.mark.parametrize("detail", [{"hurst": 0.5}, {"deviation_m": 1.0, "baseline_m": 5.0}])
def test_no_two_laws(detail: dict[str, object]) -> None:
    with pytest.raises(ValueError, match=f"from the model; leave out {next(iter(detail))}"):
        section(**detail)
    with pytest.raises(ValueError, match="there is no elevation"):
        Terrain.model_validate({"detail": {"from_elevation": True}})
    with pytest.raises(
        ValueError, match="diamond_square: refines elevation models, and there is no"
    ):
        Terrain.model_validate({"detail": {"method": "diamond_square"}})


def test_the_moon(data_dir: Path) -> None:
    """The model of Apollo 15 follows the published law of highlands; the whole Moon is flatter over
    tens of km. The default law of detail is within a third of both."""
    (path,) = (data_dir / "lunar_dem" / "apollo15").glob("*.png")
    values = read(path, None).values.astype(float) * 49.0 / 255.0
    found = law([values], 2.0)
    assert found.hurst == pytest.approx(0.88, abs=0.05)
    assert found.deviation_m == pytest.approx(0.1288 * found.baseline_m**0.95, rel=0.1)
    whole = np.fromfile(data_dir / "lunar_dem" / "ldem_4.img", "<i2").reshape(720, 1440) * 0.5
    step_m = math.pi * RADIUS_M / 720
    coarse = roughness([whole[90:-90]], None, step_m)
    assert coarse is not None
    terrain = _core.Terrain(np.full(3, RADIUS_M), detail={})
    rng = np.random.default_rng(1)
    d = rng.normal(size=(3000, 3))
    d /= np.linalg.norm(d, axis=1, keepdims=True)
    across = np.cross(d, rng.normal(size=d.shape))
    across /= np.linalg.norm(across, axis=1, keepdims=True)
    for lag_m, wanted_m in ((20.0, 2.2), (step_m, 524.0), (4.0 * step_m, 1144.0)):
        e = d + lag_m / RADIUS_M * across
        rise = terrain.heights(e, lag_m / 8.0) - terrain.heights(d, lag_m / 8.0)
        assert math.sqrt((rise**2).mean()) == pytest.approx(wanted_m, rel=0.33)
