"""Counterparts of figures of the lunar simulator's paper: `python docs/figures/make_figures.py
lunar_02 lunar_03 lunar_04 lunar_photograph`. Needs the sample data.

Figure 2: ground under rising phase angles. Figure 3: from an orbiter at 200 km, from a lander at
500 m and from a rover. Figure 4: all labels. `lunar_photograph`: highlands as the metric camera of
Apollo 15 saw some, with histograms and spectra of both; other highlands, so statistics are
compared, not places.
"""

from __future__ import annotations

import os
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib import colormaps
from matplotlib.figure import Figure
from numpy.typing import NDArray
from PIL import Image, ImageDraw

import perilune

CONFIGS = Path(__file__).resolve().parents[2] / "configs"
PHOTOGRAPH = "photographs/AS15-M-0295_SML.png"
F64 = NDArray[np.float64]
U8 = NDArray[np.uint8]
PLACE = {"lon_deg": 20.0, "lat_deg": -20.0}
CUT = 12
"""Border of the photograph, with its marks, that is not compared, pixels."""
SIDE = 960


def _frame(name: str, changes: dict[str, Any]) -> U8:
    sim = perilune.open(CONFIGS / f"{name}.yaml", overrides=changes)
    return np.asarray(sim.frame(0, ["rgb"])["rgb"])


def _orbiter(height_m: float, fov_deg: float, sun_deg: float, side: int) -> U8:
    """Highlands straight down."""
    trajectory = {f"camera.trajectory.{key}": value for key, value in PLACE.items()}
    return _frame(
        "lunar_orbiter",
        trajectory
        | {"camera.width": side, "camera.height": side, "camera.fov_deg": fov_deg}
        | {"camera.trajectory.height_m": height_m, "bodies.moon.color_map": None}
        | {"bodies.moon.albedo": [0.705, 0.66, 0.61]}
        | {"sun": {"at": PLACE | {"azimuth_deg": 90.0, "elevation_deg": sun_deg}}},
    )


def figure_02() -> list[tuple[str, U8]]:
    """The phase angle of a camera that looks down is the Sun's zenith distance."""
    phases = (5.0, 30.0, 60.0, 80.0)
    return [(f"phase {p:g}\N{DEGREE SIGN}", _orbiter(100e3, 25.0, 90.0 - p, 300)) for p in phases]


def figure_03() -> list[tuple[str, U8]]:
    size = {"camera.width": 360, "camera.height": 360, "render.samples": 16}
    lander = size | {"sun.at.elevation_deg": 25.0}
    rover = size | {"sun.at.elevation_deg": 14.0, "camera.fov_deg": 50.0}
    return [
        ("orbiter, 200 km", _orbiter(200e3, 30.0, 25.0, 360)),
        ("lander, 500 m", _frame("paper2_slope", lander)),
        ("rover", _frame("lunar_rover", rover)),
    ]


def _linear(image: U8) -> F64:
    """Linear luminance over its median, without the border."""
    grey = np.asarray(Image.fromarray(image).convert("L"), dtype=np.float64) / 255.0
    grey = grey[CUT : CUT + SIDE, CUT : CUT + SIDE]
    linear = np.where(grey <= 0.04045, grey / 12.92, ((grey + 0.055) / 1.055) ** 2.4)
    return np.asarray(linear / np.median(linear))


def _spectrum(image: F64) -> tuple[F64, F64]:
    """Wavelengths, pixels, and the power about them in all directions."""
    window = np.hanning(SIDE)[:, None] * np.hanning(SIDE)
    power = np.abs(np.fft.fft2((image / image.mean() - 1.0) * window)) ** 2
    wave = np.hypot(*np.meshgrid(np.fft.fftfreq(SIDE), np.fft.fftfreq(SIDE)))
    edges = np.geomspace(1.0 / 200.0, 0.5, 20)
    bins = np.digitize(wave.ravel(), edges)
    mean = [power.ravel()[bins == k].mean() for k in range(1, len(edges))]
    return 1.0 / np.sqrt(edges[1:] * edges[:-1]), np.array(mean)


def photograph() -> Figure:
    """Our highlands, 110 km below a lens of 74 degrees, beside the statistics of a photograph."""
    ours = _orbiter(110e3, 74.0, 18.0, SIDE + 2 * CUT)
    with Image.open(Path(os.environ["PERILUNE_DATA"]) / PHOTOGRAPH) as image:
        theirs = np.asarray(image.convert("RGB"))
    figure = Figure(figsize=(11.0, 3.9), layout="constrained")
    shown, spread, spectrum = figure.subplots(1, 3)
    shown.imshow(ours[::2, ::2])
    shown.set(xticks=[], yticks=[])
    shown.set_title("Highlands, 110 km below, Sun 18\N{DEGREE SIGN}", fontsize=9)
    for label, color, image_ in (
        ("Perilune", "#d1495b", ours),
        ("Apollo 15, AS15-M-0295", "0.2", theirs),
    ):
        linear = _linear(image_)
        levels = np.linspace(0.0, 2.5, 126)
        spread.plot(levels, [(linear < x).mean() for x in levels], color=color, label=label)
        spectrum.loglog(*_spectrum(linear), color=color, label=label)
    spread.set(xlabel="luminance over its median", ylabel="share of pixels darker")
    spectrum.set(xlabel="wavelength, pixels", ylabel="power")
    spread.legend(fontsize=8)
    return figure


def _scaled(values: F64, low: float, high: float) -> U8:
    """By a colour map; black where there is no ground."""
    shade = np.clip((values - low) / (high - low), 0.0, 1.0)
    image = np.asarray(colormaps["viridis"](np.nan_to_num(shade))[..., :3] * 255.0).astype(np.uint8)
    image[~np.isfinite(values)] = 0
    return image


def _instances(ids: NDArray[np.int64]) -> U8:
    """Each rock in a colour of its own."""
    known, index = np.unique(ids, return_inverse=True)
    colors = np.random.default_rng(3).integers(60, 256, (len(known), 3)).astype(np.uint8)
    colors[known == 0] = 40
    return np.asarray(colors[index.reshape(ids.shape)])


def _drawn(image: U8, draw: Callable[[ImageDraw.ImageDraw], None]) -> U8:
    picture = Image.fromarray(image)
    draw(ImageDraw.Draw(picture))
    return np.asarray(picture)


def _boxes(image: U8, rows: Any) -> U8:
    def draw(on: ImageDraw.ImageDraw) -> None:
        for x, y, width, height in rows["bbox_visib"]:
            on.rectangle((x, y, x + width, y + height), outline=(90, 255, 120))

    return _drawn(image, draw)


def _rims(image: U8, rows: Any) -> U8:
    """Ellipses of rims, those that are seen."""
    turn = np.linspace(0.0, 2.0 * np.pi, 73)

    def draw(on: ImageDraw.ImageDraw) -> None:
        for row in rows[rows["visib_fract"] > 0.3]:
            (a, b), angle = row["semi_axes"], row["angle_rad"]
            x, y = a * np.cos(turn), b * np.sin(turn)
            u = row["center"][0] + np.cos(angle) * x - np.sin(angle) * y
            v = row["center"][1] + np.sin(angle) * x + np.cos(angle) * y
            if np.isfinite(u).all():
                on.line([*zip(u.tolist(), v.tolist(), strict=True)], fill=(255, 150, 40))

    return _drawn(image, draw)


def _craters(name: str, changes: dict[str, Any], least_px: float) -> U8:
    sim = perilune.open(CONFIGS / f"{name}.yaml", overrides=changes)
    return _rims(np.asarray(sim.frame(0, ["rgb"])["rgb"]), sim.craters(0, least_px=least_px))


def figure_04() -> list[list[tuple[str, U8]]]:
    """All labels of a rover's picture, and craters from a lander and an orbiter."""
    size = {"camera.width": 320, "camera.height": 240, "render.samples": 16}
    rover = size | {"sun.at.elevation_deg": 20.0, "sensors": {}}
    sim = perilune.open(CONFIGS / "lunar_rover.yaml", overrides=rover)
    wanted = ["rgb", "rock_id", "depth", "elevation", "slope_sobel", "roughness_laplacian"]
    frame = sim.frame(0, wanted)
    rgb, ids, depth = frame["rgb"], frame["rock_id"], frame["depth"].astype(float)
    elevation = frame["elevation"].astype(float)
    low, high = np.nanpercentile(elevation, [2.0, 98.0])
    rocks = sim.rocks(0)
    orbiter = size | {"sun.at.elevation_deg": 40.0}
    return [
        [
            ("image", rgb),
            ("instances of rocks", _instances(ids)),
            ("boxes", _boxes(rgb, rocks[rocks["px_count_visib"] > 20])),
            ("craters from an orbiter", _craters("lunar_orbiter", orbiter, 10.0)),
            ("craters from a lander", _craters("lunar_lander", size, 8.0)),
        ],
        [
            ("depth", _scaled(-np.log(depth), -np.log(100.0), -np.log(2.0))),
            ("elevation", _scaled(elevation, float(low), float(high))),
            ("slope", _scaled(np.degrees(frame["slope_sobel"]), 0.0, 40.0)),
            ("roughness", _scaled(frame["roughness_laplacian"], 0.0, 0.3)),
            ("normals", np.asarray(sim.frame(0, ["normal"])["normal"] * 127.0 + 128.0, np.uint8)),
        ],
    ]
