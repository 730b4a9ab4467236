"""The limbs of the Earth and of Mars beside Monte Carlo of all orders in spherical geometry.

Prints what our light is off by, by view, and how bright the limb is beside the ground near it at
heights over it, now and by the preset of before, for comparison with photographs. `--figure` draws
profiles instead, into docs/images/limb.png (needs the extra `plot`); --paths is how many paths a
point has: the noise falls with their root.
"""

from __future__ import annotations

import argparse
import math
import sys
from pathlib import Path
from typing import Any, cast

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import NDArray

from perilune import _core
from perilune.bodies import atmospheres
from perilune.config.atmosphere import Atmosphere

sys.path.insert(0, str(Path(__file__).resolve().parent.parent / "tests" / "python"))
import air_monte_carlo as brute

ROOT = Path(__file__).resolve().parent.parent

F64 = NDArray[np.float64]

RADIUS_M = {"earth": 6371e3, "mars": 3389.5e3}
COLOURS = ("tab:red", "tab:green", "tab:blue")
EYE_M, SUN_RAD, STEPS = 400e3, 0.00465, 32
ZENITH_DEG, AZIMUTH_DEG = 60.0, 90.0
HEIGHTS_M = {"earth": (2e3, 10e3, 20e3, 30e3, 40e3, 55e3), "mars": (2e3, 10e3, 20e3, 35e3, 55e3)}


def settings_of(preset: str) -> _core.AirSettings:
    return atmospheres.settings(Atmosphere(preset=cast("Any", preset)))


def before() -> _core.AirSettings:
    """The Earth's preset until the limb was measured: one scale height of 8 km, little haze, and
    three wavelengths."""
    um = np.array([0.612, 0.549, 0.465])
    ozone = np.interp(um, atmospheres._OZONE_UM, atmospheres._OZONE_M2) * 5.374e18
    return cast(
        "_core.AirSettings",
        {
            **settings_of("earth"),
            "rayleigh_scattering": tuple(0.897 * 1.24062e-6 / um**4),
            "rayleigh_height_m": 8e3,
            "rayleigh_upper_m": (0.0, 0.0),
            "mie_scattering": (3.996e-6,) * 3,
            "mie_extinction": (4.44e-6,) * 3,
            "mie_height_m": 1.2e3,
            "mie_g": (0.8,) * 3,
            "ozone_absorption": tuple(ozone),
            "ozone_center_m": 25e3,
            "ozone_width_m": 15e3,
        },
    )


def view(
    radius_m: float, low_m: float, zenith_deg: float, azimuth_deg: float, eye_m: float = EYE_M
) -> tuple[F64, F64, F64]:
    """The eye, a ray past a lowest point, and the direction to a sun by its angles there."""
    point, along = brute.limb_ray(radius_m, eye_m, low_m)
    up = point - float(point @ along) * along
    up = up / np.linalg.norm(up)
    zenith, azimuth = math.radians(zenith_deg), math.radians(azimuth_deg)
    flat = math.cos(azimuth) * along + math.sin(azimuth) * np.cross(up, along)
    return point, along, math.cos(zenith) * up + math.sin(zenith) * flat


def ours(made: _core.Air, at: tuple[F64, F64, F64], multiple: bool) -> tuple[F64, F64]:
    """Radiance of the air and what comes through it."""
    point, along, sun = at
    x, y, z = (float(value) for value in sun)
    light, passed = made.scatter(
        point[None], along[None], (x, y, z), SUN_RAD, math.inf, STEPS, multiple
    )
    return light[0], passed[0]


def profile(air: _core.AirSettings, radius_m: float, lows_m: F64, multiple: bool = True) -> F64:
    made = _core.Air(air, radius_m)
    views = (view(radius_m, float(low), ZENITH_DEG, AZIMUTH_DEG) for low in lows_m)
    return np.array([ours(made, at, multiple)[0] for at in views])


def true_air(
    air: _core.AirSettings, radius_m: float, at: tuple[F64, F64, F64], paths: int
) -> brute.Radiance:
    return brute.radiance(air, radius_m, *at, np.array(air["ground_albedo"]), paths)


def draw(axes: Any, preset: str, paths: int) -> None:
    air, radius_m = settings_of(preset), RADIUS_M[preset]
    lows_m = np.linspace(0.5e3, 60e3, 60)
    all_of_it, once = (profile(air, radius_m, lows_m, multiple) for multiple in (True, False))
    old = profile(before(), radius_m, lows_m) if preset == "earth" else None
    for band, colour in enumerate(COLOURS):
        axes.semilogx(all_of_it[:, band], lows_m / 1e3, color=colour)
        axes.semilogx(once[:, band], lows_m / 1e3, color=colour, ls=":", lw=1)
        if old is not None:
            axes.semilogx(old[:, band], lows_m / 1e3, color=colour, ls="--", lw=0.8, alpha=0.6)
    for low_m in HEIGHTS_M[preset]:
        truth = true_air(air, radius_m, view(radius_m, low_m, ZENITH_DEG, AZIMUTH_DEG), paths)
        for band, colour in enumerate(COLOURS):
            axes.errorbar(truth.total[band], low_m / 1e3, xerr=2.0 * truth.noise[band],
                          fmt="o", ms=4, color=colour)  # fmt: skip
    axes.set(title=preset.capitalize(), xlabel="radiance over the sun's irradiance, 1/sr",
             ylabel="height of the ray's lowest point, km")  # fmt: skip
    axes.grid(alpha=0.3)


def figure(paths: int) -> None:
    sheet = Figure(figsize=(9.0, 4.2), layout="constrained")
    for axes, preset in zip(sheet.subplots(1, 2), RADIUS_M, strict=True):
        draw(axes, preset, paths)
    lines = {"all orders": "-", "scattered once": ":", "the Earth's preset before": "--"}
    handles = [
        sheet.axes[0].plot([], [], color="k", ls=style, lw=1, label=text)[0]
        for text, style in lines.items()
    ]
    dots = sheet.axes[0].plot([], [], "ko", ms=4, label="Monte Carlo, 2 sigma")
    sheet.axes[0].legend(handles=[*handles, *dots], fontsize=7, loc="upper right")
    path = ROOT / "docs" / "images" / "limb.png"
    sheet.savefig(path, dpi=110)
    print(path.name)


def table(paths: int) -> None:
    """Ours over Monte Carlo, and the brightness above an edge of the ground."""
    for preset, radius_m in RADIUS_M.items():
        air = settings_of(preset)
        made = _core.Air(air, radius_m)
        for azimuth in (30.0, 90.0, 150.0):
            for low_m in (-20e3, 3e3, 20e3, 35e3):
                at = view(radius_m, low_m, ZENITH_DEG, azimuth)
                truth = true_air(air, radius_m, at, paths)
                air_alone = truth.once + truth.more
                off = 100.0 * (ours(made, at, True)[0] / air_alone - 1.0)
                noise = 100.0 * truth.noise / air_alone
                print(f"{preset}, sun {azimuth:.0f} degrees aside, {low_m / 1e3:.0f} km: off by",
                      off.round(1), "%, noise", noise.round(1))  # fmt: skip
    for name, air in (("before", before()), ("now", settings_of("earth"))):
        made = _core.Air(air, RADIUS_M["earth"])
        ground = ground_near(made, air)[1]
        for low_m in (5e3, 8e3, 10e3, 17e3, 25e3, 30e3, 35e3, 37.6e3, 40e3, 43.1e3, 45e3):
            at = view(RADIUS_M["earth"], low_m, 50.0, 100.0)
            light, once = (ours(made, at, multiple)[0] for multiple in (True, False))
            print(f"{name}: {low_m / 1e3:.1f} km, green {100 * light[1] / ground:.1f} % of the "
                  f"ground, blue over red {light[2] / light[0]:.2f}, "
                  f"scattered once {once[2] / once[0]:.2f}")  # fmt: skip
    glare()


def ground_near(made: _core.Air, air: _core.AirSettings) -> F64:
    """A ground of albedo 0.3 close to the limb."""
    radius_m = RADIUS_M["earth"]
    point, along, sun = at = view(radius_m, -25e3, 50.0, 100.0)
    light, passed = ours(made, at, True)
    b = float(point @ along)
    spot = point + along * (-b - math.sqrt(b * b - float(point @ point) + radius_m**2))
    height = float(spot @ sun) / radius_m
    direct = made.transmittance((spot * (1.0 + 1e-9))[None], sun[None])[0]
    sky = np.array(made.skylight(height, True))
    return np.asarray(light + passed * 0.3 / math.pi * (height * direct + sky))


def glare() -> None:
    """What a camera's stray light, given as a part of that of the ground near the limb, does to
    the limb, over a darker and a brighter Earth."""
    air = settings_of("earth")
    ground = ground_near(_core.Air(air, RADIUS_M["earth"]), air)
    lows_m = np.arange(36e3, 50e3, 100.0)
    for albedo in (0.1, 0.3):
        over = cast("_core.AirSettings", {**air, "ground_albedo": (albedo,) * 3})
        made = _core.Air(over, RADIUS_M["earth"])
        limb = np.array(
            [ours(made, view(RADIUS_M["earth"], low, 50.0, 100.0), True)[0] for low in lows_m]
        )
        for stray in (0.0, 0.001, 0.002, 0.003, 0.005, 0.01):
            seen = limb + stray * ground
            k = int(np.argmin(np.abs(seen[:, 1] / ground[1] - 0.02)))
            height, ratio = lows_m[k] / 1e3, seen[k, 2] / seen[k, 0]
            print(f"albedo {albedo}, {100 * stray:.1f} % of stray light: green is 2 % of the "
                  f"ground at {height:.1f} km, blue over red {ratio:.2f}")  # fmt: skip


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--paths", type=int, default=4000)
    parser.add_argument("--figure", action="store_true")
    arguments = parser.parse_args()
    (figure if arguments.figure else table)(arguments.paths)


if __name__ == "__main__":
    main()
