"""Air and the Sun's glint on water against Mitsuba 3, through the benchmarks' exporter.

Gas is a medium there that its volumetric path tracer samples, water a rough boundary. Blocks of
pixels are compared by Welch's t-test with Sidak's correction; each test shows what it would see.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from benchmarks.reference import by_mitsuba, compare, export, gas, ours, scenes

FALSE_ALARM = 1e-3


def both(name, width, samples, runs, folder, **render):
    """Runs of each, and where light is."""
    sim = scenes.FRAMES[name].open(width, folder, **render)
    scene = export.export(sim, 0, 256)
    a = ours.render(sim, 0, samples[0], list(range(1, runs + 1)))
    b = by_mitsuba.render(scene, samples[1], list(range(1, runs + 1)), folder)
    return a, b


def test_gas_scatters_once_as_mitsubas(tmp_path: Path):
    """Day, terminator, the planet's shadow in the air, limb."""
    a, b = both("air_once", 48, (16, 16), 8, tmp_path)
    # Where air is thinner no path of Mitsuba's meets it in a block, and the runs know no noise.
    dense = compare.blocks(a).mean(0).min(-1) > 0.01 * a.max()
    apart = compare.differing(a, b, FALSE_ALARM) & dense
    ratio = a.mean((0, 1, 2)) / b.mean((0, 1, 2))
    print(f"blocks that differ {apart.sum()} of {dense.sum()}, ratios {ratio}")
    assert dense.mean() > 0.4
    assert not apart.any()
    np.testing.assert_allclose(ratio, 1.0, atol=0.012)
    assert (compare.differing(1.2 * a, b, FALSE_ALARM) & dense).any()


@pytest.mark.soak
def test_all_orders_are_close_to_mitsubas(tmp_path: Path):
    """Beyond the first, light counts as even to all sides: docs/air.md."""
    a, b = both("air", 48, (16, 16), 4, tmp_path)
    ratio = a.mean((0, 1, 2)) / b.mean((0, 1, 2))
    print(f"ratios {ratio}")
    np.testing.assert_allclose(ratio, 1.0, atol=0.02)


def test_the_glint_is_mitsubas(tmp_path: Path):
    a, b = both("glint", 64, (128, 64), 4, tmp_path)
    lit = compare.blocks(b).mean((0, 3)) > 1.0
    apart = compare.differing(a, b, FALSE_ALARM)
    ratio = a.mean() / b.mean()
    print(f"blocks that differ {apart.sum()} of {lit.sum()} lit, ratio {ratio:.5f}")
    assert lit.sum() > 10
    assert not apart.any()
    assert ratio == pytest.approx(1.0, abs=4e-3)
    assert compare.differing(1.1 * a, b, FALSE_ALARM).any()


def test_a_grid_holds_as_much_gas_as_the_air():
    """Read linearly, along a ray past the ball and straight down on it."""
    from scipy.ndimage import map_coordinates

    made = gas.Gas((0.0, 0.0, 1e7), 500e3, 250e3, 25e3, (1e-5,) * 3, 1)
    values, half = gas.grid(made)[..., 0], made.radius_m + made.top_m
    step = 2.0 * half / len(values)
    for low_m in (made.radius_m + 1.0, made.radius_m + 40e3):
        t = np.linspace(-half, half, 20001)
        points = np.stack([np.full_like(t, low_m * 0.6), np.full_like(t, low_m * 0.8), t])
        read = map_coordinates(values, (points + half) / step - 0.5, order=1, mode="nearest")
        true = np.exp(-(np.sqrt(low_m**2 + t**2) - made.radius_m) / made.height_m)
        assert read.sum() == pytest.approx(made.scattering_per_m[0] * true.sum(), rel=4e-3)


@pytest.mark.parametrize(
    ("key", "value", "named"),
    [
        ("mie_scattering_per_km", 0.01, "mie_extinction"),
        ("ozone_per_km", 0.01, "ozone_absorption"),
        ("ground_albedo", 0.1, "ground_albedo that is not"),
    ],
)
def test_other_air_is_refused(key: str, value: float, named: str, tmp_path: Path):
    config = scenes.air(multiple=True)
    config["bodies"]["planet"]["atmosphere"] |= {key: value}
    if key == "mie_scattering_per_km":
        config["bodies"]["planet"]["atmosphere"] |= {"mie_height_km": 20.0}
    with pytest.raises(ValueError, match=named):
        export.export(scenes.Frame(config).open(16, tmp_path), 0, 16)
