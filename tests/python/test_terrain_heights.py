"""Heights of the ground, by their statistics: law, spectrum, directions, creases, seams, poles."""

from __future__ import annotations

import functools
import math
from itertools import pairwise

import numpy as np
import pytest
from numpy.typing import NDArray

from perilune import _core

RADIUS_M = 1737400.0
RADII_M = np.full(3, RADIUS_M)
F64 = NDArray[np.float64]
FINE = 16  # nodes between posts
TILE = 64


def law(hurst: float, seed: int, finest_m: float = 0.5, method: str = "noise") -> dict[str, object]:
    """nu(L) = (L / 10 m)^H metres."""
    return {
        "method": method, "seed": seed, "ranges": [(0.0, hurst)], "baseline_m": 10.0,
        "deviation_m": 1.0, "longest_m": 2e4, "finest_m": finest_m,
    }  # fmt: skip


def patch(
    samples: F64, step_m: float, lon: float = 0.3, lat: float = 0.2, **more: float
) -> _core.Raster:
    height, width = samples.shape
    return _core.Raster(
        samples.astype(np.float32), "stereographic" if "map_scale" in more else "orthographic",
        -0.5 * step_m * (width - 1), 0.5 * step_m * (height - 1), step_m, -step_m,
        lon0_rad=lon, lat0_rad=lat, radius_m=RADIUS_M, **more,
    )  # fmt: skip


def nodes(raster: _core.Raster, first: float, last: float, count: int) -> F64:
    """(count^2, 3) directions of a square of columns and rows."""
    along = np.linspace(first, last, count)
    u, v = np.meshgrid(along, along)
    return raster.directions(np.stack([u.ravel(), v.ravel()], axis=1))


def square(terrain: _core.Terrain, directions: F64, cell_m: float = 0.0) -> F64:
    """Square by square of TILE nodes, as tiles of a mesh do."""
    side = math.isqrt(len(directions))
    row, column = np.divmod(np.arange(len(directions)), side)
    order = np.lexsort((column // TILE, row // TILE))
    heights = np.empty(len(directions))
    heights[order] = terrain.heights(directions[order], cell_m)
    return heights.reshape(side, side)


@functools.cache
def fractal(hurst: float, posts: int, step_m: float) -> tuple[F64, _core.Raster, F64]:
    """Heights of nodes, the raster of its posts, and directions of the nodes."""
    true = _core.Terrain(RADII_M, detail=law(hurst, 1))
    frame = patch(np.zeros((posts, posts)), step_m)
    raster = patch(square(true, nodes(frame, 0, posts - 1, posts)), step_m)
    fine = nodes(raster, 3, posts - 4, (posts - 7) * FINE + 1)
    return square(true, fine), raster, fine


def continued(
    hurst: float, interpolation: str, method: str = "noise", posts: int = 40, step_m: float = 16.0
) -> tuple[F64, F64, _core.Raster]:
    """A fractal, and another one laid over its posts: FINE nodes a post, but for 3 posts a side.
    Nodes of diamond-square never move, so finer ones than those are not asked of it."""
    true, raster, fine = fractal(hurst, posts, step_m)
    given = law(hurst, 2, 0.5 if method == "noise" else 1.3 * step_m / FINE, method)
    over = _core.Terrain(RADII_M, [(raster, interpolation, 0.0, 0.0)], given)
    return true, square(over, fine), raster


def deviation(h: F64, lag: int) -> float:
    rise = (h[:, lag:] - h[:, :-lag]) ** 2, (h[lag:] - h[:-lag]) ** 2
    return math.sqrt(0.5 * (rise[0].mean() + rise[1].mean()))


def power_of_rows(h: F64) -> F64:
    n = h.shape[1]
    x = np.linspace(-1.0, 1.0, n)
    rows = h - h.mean(axis=1, keepdims=True)
    rows = rows - np.outer(rows @ x / (x @ x), x)
    return np.asarray((np.abs(np.fft.rfft(rows * np.hanning(n))) ** 2).mean(axis=0))


def sampled_power(hurst: float, n: int) -> F64:
    """Of a fractal without an end, sampled at n nodes: finer waves are seen as coarser ones."""
    f = np.maximum(np.arange(n // 2 + 1), 1)[:, None] + n * np.arange(-50, 51)
    return np.asarray((np.abs(f) ** (-2.0 * hurst - 1.0)).sum(axis=1))


def spectrum_slope(power: F64, first: int, last: int) -> float:
    """Exponent of a power between two numbers of waves, by octave-like bands."""
    edges = np.geomspace(first, last, 13).astype(int)
    bands = [slice(a, b) for a, b in pairwise(edges) if b > a]
    waves = [np.log(np.arange(b.start, b.stop)).mean() for b in bands]
    return float(np.polyfit(waves, [np.log(power[b].mean()) for b in bands], 1)[0])


def along_over_across(h: F64, low: float, high: float) -> float:
    """Energy of curvature of waves along the axes of the grid, over that along its diagonals."""
    n = len(h)
    window = np.hanning(n)
    power = np.abs(np.fft.fft2((h - h.mean()) * np.outer(window, window))) ** 2
    return energy_along_over_across(power, low, high)


def energy_along_over_across(power: F64, low: float, high: float) -> float:
    n = len(power)
    fx, fy = np.meshgrid(np.fft.fftfreq(n), np.fft.fftfreq(n))
    f = np.hypot(fx, fy)
    turn = np.degrees(np.arctan2(fy, fx)) % 90.0
    band = (f > low) & (f < high)
    energy = power * f**4
    axes = energy[band & (np.abs((turn + 45.0) % 90.0 - 45.0) < 10.0)].mean()
    return float(axes / energy[band & (np.abs(turn - 45.0) < 10.0)].mean())


def crease(h: F64) -> float:
    """Mean square of second differences over the lines of posts, over that between them."""
    bend = (h[1:-1, 2:] - 2.0 * h[1:-1, 1:-1] + h[1:-1, :-2]) ** 2
    column = np.arange(1, h.shape[1] - 1) % FINE
    return float(bend[:, column == 0].mean() / bend[:, (column > 2) & (column < FINE - 2)].mean())


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


@pytest.mark.parametrize("hurst", [0.3, 0.5, 0.76, 0.95])
def test_structure_function(hurst: float) -> None:
    """Of detail alone, over 1 to 64 nodes, in a random direction at places all over the body."""
    terrain = _core.Terrain(RADII_M, detail=law(hurst, 3))
    rng = np.random.default_rng(4)
    d = rng.normal(size=(6000, 3))
    d /= np.linalg.norm(d, axis=1, keepdims=True)
    across = np.cross(d, rng.normal(size=d.shape))
    across /= np.linalg.norm(across, axis=1, keepdims=True)
    h = terrain.heights(d)
    for lag_m in 2.0 ** np.arange(7):
        rise = terrain.heights(d + lag_m / RADIUS_M * across) - h
        nu = math.sqrt((rise**2).mean())
        assert nu == pytest.approx((lag_m / 10.0) ** hurst, rel=0.15), lag_m


@pytest.mark.parametrize(
    ("hurst", "interpolation", "method"),
    [
        (0.3, "bilinear", "noise"), (0.5, "bilinear", "noise"),
        (0.76, "cubic", "noise"), (0.95, "cubic", "noise"),
        (0.3, "bilinear", "diamond_square"), (0.5, "cubic", "diamond_square"),
        (0.76, "bilinear", "diamond_square"), (0.95, "bilinear", "diamond_square"),
    ],
)  # fmt: skip
def test_an_elevation_model_is_continued(hurst: float, interpolation: str, method: str) -> None:
    """Between the posts of a fractal: its structure function and spectrum; posts and means stay."""
    true, over, raster = continued(hurst, interpolation, method)
    assert np.array_equal(true[::FINE, ::FINE].astype(np.float32), over[::FINE, ::FINE])
    assert np.std(over - true) > 0.03
    for lag in (1, 2, 4, 8, 16, 32, 64):
        assert deviation(over, lag) == pytest.approx(deviation(true, lag), rel=0.15), lag
    slope, expected = spectrum_slope(power_of_rows(over), 7, 90), -2.0 * hurst - 1.0
    if method == "diamond_square":  # its nodes are samples, those of noise end at their spacing
        expected = spectrum_slope(sampled_power(hurst, len(over)), 7, 90)
    assert slope == pytest.approx(expected, abs=0.1)
    plain = _core.Terrain(RADII_M, [(raster, interpolation, 0.0, 0.0)])
    fine = nodes(raster, 3, 36, 33 * FINE + 1)
    added = (over - square(plain, fine))[:-1, :-1]
    cells = added.reshape(33, FINE, 33, FINE).mean(axis=(1, 3))
    assert abs(cells.mean()) < 3.0 * cells.std() / math.sqrt(cells.size)
    assert cells.std() < added.std()


def test_no_directions_and_no_creases() -> None:
    """Energy along the lines of posts equals that along diagonals, and no line is creased: neither
    by detail nor by its continuation of a raster; bilinear interpolation and diamond-square are."""
    true, over, _ = continued(0.95, "cubic")
    *_, refined, _ = continued(0.95, "bilinear", "diamond_square")
    for h in (true, over, refined):
        for low, high in ((0.02, 0.1), (0.1, 0.25)):
            assert along_over_across(h, low, high) == pytest.approx(1.0, abs=0.1)
        assert crease(h) == pytest.approx(1.0, abs=0.1)
    _, folded, _ = continued(0.95, "bilinear")
    assert along_over_across(folded, 0.02, 0.1) > 1.3
    assert crease(folded) > 1.5
    plain = np.mean([crease(diamond_square(0.95, 9, seed)) for seed in range(3)])
    assert plain > 1.5


def sampled_along_over_across(hurst: float, n: int, low: float, high: float) -> float:
    """Of an isotropic fractal without an end, sampled at n x n nodes: what is finer folds back,
    more along the axes than along diagonals."""
    fx, fy = np.meshgrid(np.fft.fftfreq(n), np.fft.fftfreq(n))
    shift = np.arange(-6, 7)
    away = np.hypot(fx[..., None, None] + shift[:, None], fy[..., None, None] + shift)
    power = (np.maximum(away, 0.5 / n) ** (-2.0 * hurst - 2.0)).sum(axis=(2, 3))
    return energy_along_over_across(power, low, high)


@pytest.mark.parametrize("hurst", [0.0, 0.25, 0.5, 0.76, 0.95])
def test_no_direction_has_more_energy_at_any_hurst_exponent(hurst: float) -> None:
    """Of waves of 2 to 4 and of 4 to 8 nodes, as of an isotropic fractal that is sampled there, at
    distances of nodes of 0.5, 4 and 64 m; over 12 places, whose mean is uncertain by 3 %."""
    n, bands = 129, ((0.125, 0.25), (0.25, 0.5))
    expected = [sampled_along_over_across(hurst, n, *band) for band in bands]
    found = []
    for k in range(12):
        terrain = _core.Terrain(RADII_M, detail=law(hurst, k, 0.01))
        frame = patch(np.zeros((n, n)), (0.5, 4.0, 64.0)[k % 3], lon=0.3 + 0.5 * k)
        h = square(terrain, nodes(frame, 0, n - 1, n))
        found.append([along_over_across(h, *band) for band in bands])
    np.testing.assert_allclose(np.mean(found, axis=0) / expected, 1.0, atol=0.1)


@pytest.mark.parametrize("method", ["noise", "diamond_square"])
@pytest.mark.parametrize("interpolation", ["bilinear", "cubic"])
@pytest.mark.parametrize(
    ("projection", "x0", "y0", "step", "middle"),
    [
        ("orthographic", -252.0, 252.0, 8.0, (0.3, 0.2)),
        ("orthographic", -1e4 / 3.0, 2e4 / 7.0, 100.0 / 3.0, (-2.0, -1.1)),
        ("stereographic", 1e5 + 0.25, -7e4, 20.0, (1.0, 1.5707963267948966)),
        ("cylindrical", math.radians(160.125), math.radians(70.125), math.radians(0.25), ()),
        ("cylindrical", math.radians(169.1), math.radians(-40.7), 2.0 * math.pi / 1087.0, ()),
    ],
)
def test_a_part_of_a_raster_has_the_bits_of_the_whole(
    method: str,
    interpolation: str,
    projection: str,
    x0: float,
    y0: float,
    step: float,
    middle: tuple[float, ...],
) -> None:
    """Away from its border, over the date line too, wherever its first post is."""
    rng = np.random.default_rng(3)
    samples = rng.normal(0.0, 5.0, (64, 128)).astype(np.float32)
    frame = dict(zip(("lon0_rad", "lat0_rad"), middle, strict=False))
    frame |= {"radius_m": RADIUS_M} if middle else {}
    whole = _core.Raster(samples, projection, x0, y0, step, -step, **frame)
    detail = law(0.8, 5, 0.05, method)
    large = _core.Terrain(RADII_M, [(whole, interpolation, 0.0, 0.0)], detail)
    for left, top in ((1, 2), (60, 13), (87, 24)):
        cut = np.ascontiguousarray(samples[top : top + 40, left : left + 41])
        start = (x0 + left * step, y0 - top * step)
        part = _core.Raster(cut, projection, *start, step, -step, **frame)
        small = _core.Terrain(RADII_M, [(part, interpolation, 0.0, 0.0)], detail)
        posts = rng.integers(13, 26, (9, 2)).astype(float)
        at = part.directions(np.concatenate([rng.uniform(13.0, 26.0, (25, 2)), posts]))
        for cell_m in (0.01, 0.3 * whole.spacing_m(RADIUS_M)):
            assert np.array_equal(small.heights(at, cell_m), large.heights(at, cell_m))


def test_diamond_square_in_any_order() -> None:
    """The same bits alone or beside others; those of another seed are others."""
    whole = patch(np.random.default_rng(3).normal(0.0, 5.0, (64, 64)), 8.0)
    rng = np.random.default_rng(4)
    at = whole.directions(rng.uniform(23.0, 36.0, (400, 2)))
    given = law(0.8, 5, 0.05, "diamond_square")
    large, other = (
        _core.Terrain(RADII_M, [(whole, "cubic", 0.0, 0.0)], detail)
        for detail in (given, given | {"seed": 6})
    )
    h = large.heights(at)
    assert np.abs(other.heights(at) - h).max() > 0.1
    order = rng.permutation(len(at))
    assert np.array_equal(large.heights(at[order]), h[order])
    assert [large.heights(at[k : k + 1])[0] for k in order[:20]] == list(h[order[:20]])
    low, high = large.bounds
    assert low < h.min() < h.max() < high


def test_cube_edges_are_nowhere() -> None:
    """Heights and slopes across edges and a corner of the cube: the same size as elsewhere."""
    terrain = _core.Terrain(RADII_M, detail=law(0.7, 5) | {"longest_m": 500.0})
    rng = np.random.default_rng(6)
    places = {"face": (1.0, 0.1, -0.2), "edge": (1.0, 1.0, 0.2), "corner": (1.0, 1.0, 1.0)}
    spread, rise = {}, {}
    for name, place in places.items():
        middle = np.array(place) / np.linalg.norm(place)
        scatter = middle + rng.normal(size=(4000, 3)) * 0.05
        # Pairs on both sides of the plane x = y, which contains the edge, 0.5 m apart.
        if name != "face":
            scatter[:, :2] = scatter[:, :2].mean(axis=1, keepdims=True)
        d = scatter / np.linalg.norm(scatter, axis=1, keepdims=True)
        east = np.stack([-d[:, 1], d[:, 0], np.zeros(len(d))], axis=1)
        step = east / np.linalg.norm(east, axis=1, keepdims=True) * 0.25 / RADIUS_M
        h = terrain.heights(np.concatenate([d - step, d + step])).reshape(2, -1)
        spread[name], rise[name] = h.std(), (h[1] - h[0]).std()
        assert np.abs(h[1] - h[0]).max() < 6.0 * rise[name]
    for name in ("edge", "corner"):
        assert spread[name] == pytest.approx(spread["face"], rel=0.1)
        assert rise[name] == pytest.approx(rise["face"], rel=0.1)


def test_overlapping_patches_have_no_seam() -> None:
    """Two models of one ground, of other spacing and projection, over a third: across their borders
    neighbouring nodes differ as anywhere."""
    true = _core.Terrain(RADII_M, detail=law(0.95, 7))
    layers = []
    for step_m, count, lon, more in (
        (64.0, 40, 0.3, {}), (16.0, 60, 0.3, {}), (8.0, 60, 0.3001, {"map_scale": 1.0}),
    ):  # fmt: skip
        frame = patch(np.zeros((count, count)), step_m, lon=lon, **more)
        posts = square(true, nodes(frame, 0, count - 1, count))
        layers.append((patch(posts, step_m, lon=lon, **more), "cubic", 8.0, 0.0))
    over = _core.Terrain(RADII_M, layers, law(0.95, 8))
    fine = nodes(layers[1][0], -10, 69, 640)
    bend = np.abs(np.diff(square(over, fine), n=2, axis=1))
    # The borders of both patches lie within the columns that are looked at.
    columns = layers[1][0].posts(nodes(layers[2][0], 0, 59, 2))[:, 0]
    assert columns.min() > 0.0
    assert columns.max() < 59.0
    assert bend.max() < 8.0 * bend.mean()
    by_column = bend.mean(axis=0)
    assert by_column.max() < 2.0 * np.median(by_column)


def test_poles_and_date_line() -> None:
    """Around a pole heights close up, and across the date line nothing jumps."""
    rng = np.random.default_rng(9)
    samples = rng.normal(0.0, 1000.0, (90, 180)).astype(np.float32)
    step = math.radians(2.0)
    raster = _core.Raster(
        samples, "cylindrical", -math.pi + step / 2, math.pi / 2 - step / 2, step, -step
    )
    for interpolation, method in (
        ("bilinear", "noise"), ("cubic", "noise"), ("cubic", "diamond_square"),
    ):  # fmt: skip
        detail = {"seed": 10, "method": method}
        terrain = _core.Terrain(RADII_M, [(raster, interpolation, 0.0, 0.0)], detail)
        lat = rng.uniform(-1.5, 1.5, 100)
        sides = [
            np.stack([-np.cos(lat), np.full_like(lat, y), np.sin(lat)], axis=1)
            for y in (-1e-9, 1e-9)
        ]
        jump = terrain.heights(sides[1]) - terrain.heights(sides[0])
        assert np.abs(jump).max() < 0.05  # 3.5 mm apart
        for pole in (-1.0, 1.0):
            turn = np.linspace(0.0, 2.0 * math.pi, 721)
            ring = np.stack(
                [1e-9 * np.cos(turn), 1e-9 * np.sin(turn), np.full_like(turn, pole)], axis=1
            )
            detail_free = _core.Terrain(RADII_M, [(raster, interpolation, 0.0, 0.0)])
            for ground in (terrain, detail_free):
                h = ground.heights(ring)
                assert np.all(np.isfinite(h))
                assert h[0] == pytest.approx(h[-1], abs=1e-6)


def test_a_vertical_step_stays_between_its_sides() -> None:
    """Bilinear heights do not pass the posts; cubic ones by 1/8 of the step at most."""
    samples = np.where(np.arange(20) < 10, 0.0, 1e5) * np.ones((20, 1))
    raster = patch(samples, 10.0)
    h = square(_core.Terrain(RADII_M, [(raster, "bilinear", 0.0, 0.0)]), nodes(raster, 0, 19, 96))
    assert h.min() == 0.0
    assert h.max() == 1e5
    h = square(_core.Terrain(RADII_M, [(raster, "cubic", 0.0, 0.0)]), nodes(raster, 0, 19, 96))
    assert -12500.0 < h.min() < 0.0
    assert 1e5 < h.max() < 112500.0
