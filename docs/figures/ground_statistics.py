"""The ground in numbers: `python docs/figures/make_figures.py ground`. Needs the sample data.

Slopes of detail by both methods, beside those of plain diamond-square by the same law; slopes of
three scenes over baselines of 1, 10 and 100 m, and their medians beside published ones; numbers of
rocks beside published laws.
"""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

import perilune
from perilune import _core
from perilune.bodies.rocks import rock_field

CONFIGS = Path(__file__).resolve().parents[2] / "configs"
RADIUS_M = 1737400.0
F64 = NDArray[np.float64]
LEVELS, SIDE, STEP_M = 9, 97, 1.0
COLORS = {"lunar_orbiter": "#30638e", "lunar_lander": "#d1495b", "lunar_rover": "#3a7d44"}
HURST = 0.95
COUNTED_M = 300.0
"""Radius of the discs on which rocks are counted."""
SCENES = {  # name: longitude, latitude, deg, radius m, label
    "lunar_orbiter": (30.0, 10.0, 30e3, "lunar_orbiter, highlands"),
    "lunar_lander": (23.5, 0.7, 1.5e3, "lunar_lander, a mare"),
    "lunar_rover": (10.0, 20.0, 30e3, "lunar_rover, no elevation model"),
}
PUBLISHED = (  # baseline m, median of bidirectional slopes deg, label
    (17.0, 7.5, "LOLA, highlands (Rosenburg et al. 2011)"),
    (17.0, 2.0, "LOLA, maria (Rosenburg et al. 2011)"),
    (0.007, 10.0, "Chang'E-4, from its rover (Guo et al. 2021)"),
)
ROCKS = (  # coefficient per m^2, exponent, label
    (0.00234, -2.11, "Surveyor I, near a blocky crater"),
    (3.0e-4, -2.482, "VIPER specification, polar plains"),
    (1.0e-4, -1.75457, "between craters, low"),
    (2.0e-3, -2.6607, "Haworth, high"),
)


def diamond_square(hurst: float, levels: int, seed: int) -> F64:
    """The plain algorithm: sigma falls by 2^-H a level, the same for squares and diamonds."""
    rng = np.random.default_rng(seed)
    n = 2**levels
    z = np.zeros((n + 1, n + 1))
    z[::n, ::n] = rng.normal(size=(2, 2))
    step, sigma = n, 1.0
    while step > 1:
        half = step // 2
        c = z[::step, ::step]
        mean = (c[1:, 1:] + c[1:, :-1] + c[:-1, 1:] + c[:-1, :-1]) / 4.0
        z[half::step, half::step] = mean + sigma * rng.normal(size=mean.shape)
        around = np.pad(z, half, mode="reflect")
        for a, b in ((0, half), (half, 0)):
            i, j = np.arange(a, n + 1, step) + half, np.arange(b, n + 1, step) + half
            sides = around[np.ix_(i - half, j)] + around[np.ix_(i + half, j)]
            sides = sides + around[np.ix_(i, j - half)] + around[np.ix_(i, j + half)]
            z[np.ix_(i - half, j - half)] = sides / 4.0 + sigma * rng.normal(size=sides.shape)
        step, sigma = half, sigma * 2.0**-hurst
    return z


def _around(lon_deg: float, lat_deg: float) -> tuple[F64, F64, F64]:
    """Directions up, east and north at a place."""
    lon, lat = math.radians(lon_deg), math.radians(lat_deg)
    up = np.array([math.cos(lat) * math.cos(lon), math.cos(lat) * math.sin(lon), math.sin(lat)])
    east = np.array([-math.sin(lon), math.cos(lon), 0.0])
    return up, east, np.cross(up, east)


POST_M = 16.0


def _refined(law: dict[str, object], true: _core.Terrain) -> _core.Terrain:
    """Posts of a ground, POST_M apart, refined by diamond-square."""
    extent_m = 0.5 * POST_M * (SIDE // 8)
    place = {"lon0_rad": math.radians(40.0), "lat0_rad": math.radians(30.0), "radius_m": RADIUS_M}
    frame = ("orthographic", -extent_m, extent_m, POST_M, -POST_M)
    side = SIDE // 8 + 1
    columns, rows = np.meshgrid(np.arange(side), np.arange(side))
    posts = np.stack([columns.ravel(), rows.ravel()], axis=1).astype(float)
    flat = _core.Raster(np.zeros((side, side), dtype=np.float32), *frame, **place)
    heights = true.heights(flat.directions(posts)).reshape(side, side).astype(np.float32)
    raster = _core.Raster(heights, *frame, **place)
    more = {"method": "diamond_square", "seed": 3}
    return _core.Terrain(np.full(3, RADIUS_M), [(raster, "bilinear", 0.0, 0.0)], law | more)


def _detail(method: str) -> F64:
    """(SIDE, SIDE) heights of detail of one Hurst exponent over the whole square."""
    law: dict[str, object] = {
        "ranges": [(0.0, HURST)],
        "seed": 2,
        "longest_m": 2.0 * SIDE * STEP_M,
        "finest_m": 0.5 * STEP_M,
    }
    terrain = _core.Terrain(np.full(3, RADIUS_M), detail=law)
    if method == "diamond_square":
        terrain = _refined(law, terrain)
    up, east, north = _around(40.0, 30.0)
    x = (np.arange(SIDE) - SIDE // 2) * STEP_M / RADIUS_M
    at = up + x[None, :, None] * east - x[:, None, None] * north
    return terrain.heights(at.reshape(-1, 3)).reshape(SIDE, SIDE)


def _rise(heights: F64) -> F64:
    """Slopes to the right less their mean, in units of their standard deviation."""
    rise = np.diff(heights, axis=1)
    return np.asarray((rise - rise.mean()) / rise.std())


def _places(name: str, count: int) -> tuple[_core.Terrain, F64, perilune.Simulation]:
    lon_deg, lat_deg, radius_m, _ = SCENES[name]
    sim = perilune.open(CONFIGS / f"{name}.yaml", overrides={"drivers.strength": 0.0})
    up, east, north = _around(lon_deg, lat_deg)
    rng = np.random.default_rng(1)
    a, r = rng.uniform(0.0, 2.0 * math.pi, count), np.sqrt(rng.uniform(0.0, 1.0, count))
    r *= radius_m / RADIUS_M
    at = up + (r * np.cos(a))[:, None] * east + (r * np.sin(a))[:, None] * north
    return sim.terrain(0), at, sim


def _slopes_deg(terrain: _core.Terrain, at: F64, baseline_m: float) -> F64:
    return np.degrees(np.arctan(np.linalg.norm(terrain.slopes(at, baseline_m), axis=1)))


def _plain() -> F64:
    """(SIDE, SIDE) heights of diamond-square, from the middle of a square."""
    first = (2**LEVELS - SIDE) // 2
    return diamond_square(HURST, LEVELS, 1)[first : first + SIDE, first : first + SIDE]


def _slopes(axes: Axes) -> None:
    for name, color in COLORS.items():
        terrain, at, _ = _places(name, 4000)
        for style, baseline_m in (("-", 1.0), ("--", 10.0), (":", 100.0)):
            slopes = np.sort(_slopes_deg(terrain, at, baseline_m))
            share = 1.0 - np.arange(len(slopes)) / len(slopes)
            axes.plot(slopes, share, style, color=color, lw=1.2)
    axes.set(xlim=(0, 40), yscale="log", ylim=(1e-3, 1.0))
    axes.set(xlabel="slope, degrees", ylabel="share steeper")
    axes.set_title("Baselines 1 m (-), 10 m (--), 100 m (..)", fontsize=9)


def _medians(axes: Axes) -> None:
    baselines_m = np.geomspace(0.1, 3000.0, 16)
    for name, color in COLORS.items():
        terrain, at, _ = _places(name, 4000)
        medians = [np.median(_slopes_deg(terrain, at, b)) for b in baselines_m]
        axes.plot(baselines_m, medians, color=color, label=SCENES[name][3])
    for mark, (baseline_m, slope_deg, label) in zip("o^s", PUBLISHED, strict=True):
        axes.plot(baseline_m, slope_deg, f"k{mark}", label=label)
    axes.set(xscale="log", ylim=(0, None), xlabel="baseline, m", ylabel="median slope, degrees")
    axes.set_title("Medians of bidirectional slopes", fontsize=9)
    axes.legend(fontsize=7, loc="lower left")


def _rocks(axes: Axes) -> None:
    diameters_m = np.geomspace(0.1, 4.0, 25)
    for k, (coefficient, exponent, label) in enumerate(ROCKS):
        law = coefficient * diameters_m**exponent
        axes.loglog(diameters_m, law, color=str(0.15 + 0.2 * k), ls="--", label=label)
    for name in ("lunar_lander", "lunar_rover"):
        terrain, at, sim = _places(name, 1)
        ground = sim.config.bodies["moon"].terrain
        assert ground is not None
        assert ground.rocks is not None
        field = rock_field(ground.rocks, RADIUS_M)
        sizes_m = field.list(terrain, at[0], COUNTED_M, 0.1)["diameter_m"]
        counts = [(sizes_m >= d).sum() / (math.pi * COUNTED_M**2) for d in diameters_m]
        axes.loglog(diameters_m, counts, "o", ms=3, color=COLORS[name], label=f"drawn: {name}")
    axes.set(xlabel="diameter D, m", ylabel="rocks of D or more per m^2")
    axes.set_title("Rocks, counted on the ground", fontsize=9)
    axes.legend(fontsize=7)


def figure() -> Figure:
    """All of it."""
    made = Figure(figsize=(13.0, 7.6), layout="constrained")
    grid = made.add_gridspec(2, 8)
    squares = {
        "Slopes of noise, H 0.95": _detail("noise"),
        "diamond_square, posts of 16 m": _detail("diamond_square"),
        "Plain diamond-square: creases": _plain(),
    }
    for column, (title, heights) in enumerate(squares.items()):
        axes = made.add_subplot(grid[0, 2 * column : 2 * column + 2])
        axes.imshow(_rise(heights), cmap="gray", vmin=-2.5, vmax=2.5, interpolation="nearest")
        axes.set(xticks=[], yticks=[])
        axes.set_title(title, fontsize=9)
    _slopes(made.add_subplot(grid[0, 6:]))
    _medians(made.add_subplot(grid[1, :4]))
    _rocks(made.add_subplot(grid[1, 4:]))
    return made
