"""Makes our counterparts of figures of the Space OAISYS paper.

    python docs/figures/make_figures.py [NAME...]

Figure 5: a satellite around a planet, and one around a moon around a planet. Figure 7: sampled
orbits. Figure 13: camera trajectories, sketched, with frames taken along them. All from
configs/demo.yaml with the changes below. `moon`: see moon_figures.py. Figure 8: a noise of three
scales. Figure 10: foil under rising jitter. `materials`: a sheet of all ready materials.
`light_curve`: an eclipse in low orbit. `glare` and `moon_sensor`: see sensor_figures.py. `shutter`:
see shutter_figures.py. `shapes`: see shape_figures.py. `terrain`, `suns`, `apron`, `soil`,
`tracks`: see ground_figures.py. `ground`: see ground_statistics.py. `lunar_...`: see
lunar_paper.py. Needs the
extra `plot`.
"""

from __future__ import annotations

import io
import math
import sys
from pathlib import Path
from typing import Any

import ground_figures
import ground_statistics
import lunar_paper
import moon_figures
import numpy as np
import sensor_figures
import shape_figures
import shutter_figures
import yaml
from matplotlib.figure import Figure
from PIL import Image

import perilune
from perilune.show.plots import plot_light_curve, plot_orbits, plot_trajectory

ROOT = Path(__file__).resolve().parents[2]
DEMO = ROOT / "configs" / "demo.yaml"
IMAGES = ROOT / "docs" / "images"
STILL = {"drivers.strength": 0.0, "time.step_s": 60.0}
MOON = {
    "kind": "ellipsoid",
    "radii_km": 1200.0,
    "gm_km3_s2": 1500.0,
    "albedo": 0.5,
    "orbit": {
        "around": "planet",
        "semi_major_axis_km": 17000.0,
        "inclination_deg": 20.0,
        "mean_anomaly_deg": 285.0,
    },
}
LOOK = ROOT / "configs" / "material.yaml"
STATION = ROOT / "configs" / "iss_leo.yaml"
FOIL = ROOT / "configs" / "mli_randomised.yaml"
READY = sorted((ROOT / "assets" / "materials").glob("*.yaml"))
NOISE = {
    "nodes": {
        "where": {"type": "coordinates"},
        "OAISYS_scale": {"type": "value", "value": 3.0},
        "noise": {"type": "musgrave", "vector": "where", "scale": "OAISYS_scale", "octaves": 8},
        "paint": {
            "type": "ramp",
            "value": "noise",
            "stops": [[-0.4, 0.02, 0.02, 0.02], [0.4, 0.8, 0.8, 0.8]],
        },
        "skin": {"type": "principled", "base_color": "paint", "roughness": 0.6},
    }
}
FRAMES, BETWEEN = 3, 12
"""Frames shown of a trajectory, and steps from one to the next."""
TO_SUN = np.array([1.0, 0.0, 0.15]) / math.hypot(1.0, 0.15)  # as in the configuration


def save(figure: Figure, name: str) -> None:
    """As a PNG of all its colours: skies and shades have no steps."""
    buffer = io.BytesIO()
    figure.savefig(buffer, format="png", dpi=100)
    image = Image.open(buffer).convert("RGB")
    IMAGES.mkdir(exist_ok=True)
    image.save(IMAGES / name, optimize=True)


def figure_05() -> None:
    """A satellite around a planet; a satellite around a moon around the planet."""
    figure = Figure(figsize=(10.0, 5.2), layout="constrained")
    simple = perilune.open(DEMO, overrides=STILL | {"spacecraft.smallsat.orbit.altitude_km": 3000})
    plot_orbits(simple, [0], figure=figure, place=121, title="A satellite around a planet")
    orbit = {"around": "moon", "altitude_km": 900.0, "inclination_deg": 70.0, "raan_deg": 40.0}
    orbit |= {"frame": "icrf", "mean_anomaly_deg": 30.0}
    changes = {"bodies.moon": MOON, "spacecraft.smallsat.orbit": orbit}
    stacked = perilune.open(DEMO, overrides=STILL | changes)
    title = "A satellite around a moon around a planet"
    plot_orbits(stacked, [0], figure=figure, place=122, title=title)
    save(figure, "figure_05.png")


def figure_07() -> None:
    """Orbits of three classes, drawn at random."""
    figure = Figure(figsize=(12.0, 4.6), layout="constrained")
    for column, (name, title) in enumerate((("PO", "Polar"), ("LEO", "LEO"), ("MEO", "MEO"))):
        orbit = {"kind": "database", "class": name, "around": "planet"}
        sim = perilune.open(DEMO, overrides={"spacecraft.smallsat.orbit": orbit})
        title = f"{title}, eight draws"
        plot_orbits(sim, range(8), figure=figure, place=131 + column, title=title, legend=False)
    save(figure, "figure_07.png")


def trajectories() -> dict[str, dict[str, Any]]:
    """The four kinds of the paper, about the same satellite."""
    common = {"target": "smallsat", "positions": (FRAMES - 1) * BETWEEN + 1}
    across = np.array([0.0, 0.6, 0.8])
    return {
        "random sampling": {
            "kind": "orbit_object",
            "target": "smallsat",
            "distance_m": [9.0, 13.0],
            "sun_angle_deg": [0.0, 80.0],
            "roll_deg": 0.0,
        },
        "linear": {
            "kind": "linear",
            **common,
            "start": {"position_m": [18.0, 20.0, 8.0]},
            "end": {"position_m": [5.0, 6.5, 2.0]},
            "start_speed_m_s": 2.0,
            "end_speed_m_s": 0.5,
        },
        "spiral": {  # around the direction to the Sun, so that what is seen is lit
            "kind": "spiral",
            **common,
            "start_m": (12.0 * TO_SUN + 16.0 * across).tolist(),
            "r_end_m": 9.0,
            "normal": TO_SUN.tolist(),
            "rotations": 1.75,
        },
        "flyby": {
            "kind": "spiral",
            **common,
            "r_start_m": 26.0,
            "r_end_m": 7.5,
            "normal": [0.5, 0.0, 0.9],
            "start_angle_deg": -60.0,
            "rotations": 0.25,
        },
    }


def figure_13() -> None:
    """Sketches of four trajectories, and the frames that the sketched cameras take."""
    figure = Figure(figsize=(11.0, 9.0), layout="constrained")
    grid = figure.add_gridspec(1 + FRAMES, 4, height_ratios=[1.5, *([1.0] * FRAMES)])
    shown = range(0, (FRAMES - 1) * BETWEEN + 1, BETWEEN)
    for column, (name, trajectory) in enumerate(trajectories().items()):
        changes = {"camera.trajectory": trajectory, "camera.width": 256, "camera.height": 192}
        changes |= {"time.step_s": 5.0, "render.samples": 64}
        sim = perilune.open(DEMO, overrides=STILL | changes)
        options: dict[str, Any] = {"title": name.capitalize(), "legend": False}
        if name == "random sampling":
            options |= {"frames": shown, "path": False}
        else:
            options |= {"frames": range(shown[-1] + 1), "every": BETWEEN}
        plot_trajectory(sim, figure=figure, place=grid[0, column], **options)
        for row, index in enumerate(shown):
            axes = figure.add_subplot(grid[1 + row, column])
            axes.imshow(sim.frame(index, channels=["rgb"])["rgb"])
            axes.set(xticks=[], yticks=[])
    save(figure, "figure_13.png")


def figure_moon() -> None:
    """The Moon by Hapke's law."""
    save(moon_figures.figure_moon(), "moon.png")


def terrain() -> None:
    views = ground_figures.views()
    pictures("terrain.png", [views[:2], views[2:]], 9.6)


def suns() -> None:
    pictures("suns.png", ground_figures.suns(), 8.4)


def apron() -> None:
    pictures("apron.png", [ground_figures.apron()], 8.4)


def soil() -> None:
    pictures("soil.png", ground_figures.soil(), 8.4)


def tracks() -> None:
    pictures("tracks.png", [[ground_figures.tracks()]], 4.8)


def ground() -> None:
    """Slopes and rocks of scenes beside published ones."""
    save(ground_statistics.figure(), "ground.png")


def lunar_02() -> None:
    """The Moon's ground under rising phase angles."""
    pictures("lunar_02.png", [lunar_paper.figure_02()], 9.6)


def lunar_03() -> None:
    """From an orbiter, a lander and a rover."""
    pictures("lunar_03.png", [lunar_paper.figure_03()], 9.6)


def lunar_04() -> None:
    """All labels of a rover's picture, and craters from a lander and an orbiter."""
    pictures("lunar_04.png", lunar_paper.figure_04(), 11.0)


def lunar_photograph() -> None:
    """Histograms and spectra beside those of a photograph."""
    save(lunar_paper.photograph(), "lunar_photograph.png")


def pictures(name: str, rows: list[list[tuple[str, Any]]], width: float) -> None:
    """Rows of titled images, on black."""
    height, wide = rows[0][0][1].shape[:2]
    size = width / len(rows[0])
    figure = Figure(figsize=(width, len(rows) * (size * height / wide + 0.22)), facecolor="black")
    grid = figure.subplots(len(rows), len(rows[0]), squeeze=False)
    for line, axes_row in zip(rows, grid, strict=True):
        for (title, image), axes in zip(line, axes_row, strict=True):
            axes.imshow(image, interpolation="lanczos")
            axes.set_title(title, color="white", fontsize=9, pad=3)
            axes.axis("off")
    figure.subplots_adjust(0.004, 0.004, 0.996, 1 - 0.22 / figure.get_figheight(), 0.01, 0.1)
    save(figure, name)


def figure_08() -> None:
    """A ball with a Musgrave noise of three scales, by the node that a driver would drive."""
    shown = []
    for scale in (3.0, 5.0, 10.0):
        changes = {"materials.look": NOISE, "materials.look.nodes.OAISYS_scale.value": scale}
        changes |= {"camera.width": 320, "camera.height": 320, "camera.fov_deg": 15.0}
        changes |= {"camera.trajectory.aim_offset_m": [-0.58, 0.0, 0.0]}
        sim = perilune.open(LOOK, overrides=changes)
        shown.append((f"scale {scale:g}", sim.frame(0, channels=["rgb"])["rgb"]))
    pictures("figure_08.png", [shown], 9.0)


def figure_10() -> None:
    """The foil of a satellite, drawn with rising strength."""
    changes = {"camera.width": 300, "camera.height": 340, "camera.fov_deg": 20.0}
    changes |= {"render.samples": 24}
    sim = perilune.open(FOIL, overrides=changes)
    strengths = sim.config.materials["gold"].drivers.jitter_strength
    shown = [
        (f"jitter strength {strength:g}", sim.frame(k, channels=["rgb"])["rgb"])
        for k, strength in enumerate(strengths)
    ]
    pictures("figure_10.png", [shown], 12.0)


def materials() -> None:
    """All ready materials on a ball and a panel, under a hard sun."""
    shown = []
    for path in READY:
        changes: dict[str, Any] = {"materials.look.file": str(path), "render.samples": 48}
        nodes = yaml.safe_load(path.read_text())["nodes"]
        if nodes["where"].get("space") == "face":  # for flat panels: a ball has too many faces
            ball = {"file": str(path), "nodes": {"where": {"space": "box"}}}
            uses = [{"part": "ball", "use": "ball"}, {"part": "panel", "use": "look"}]
            changes |= {"materials.ball": ball, "spacecraft.object.materials": uses}
        sim = perilune.open(LOOK, overrides=changes | {"camera.width": 480, "camera.height": 256})
        shown.append((path.stem.replace("_", " "), sim.frame(0, channels=["rgb"])["rgb"]))
    pictures("materials.png", [shown[k : k + 3] for k in range(0, len(shown), 3)], 12.0)


def light_curve() -> None:
    """The sunlight on the station through a revolution, and its penumbra by band."""
    figure = Figure(figsize=(10.0, 3.4), layout="constrained")
    still = {"drivers.strength": 0.0}
    slow = perilune.open(STATION, overrides=still | {"time.step_s": 10.0})
    title = "Sunlight on the station, one revolution"
    plot_light_curve(slow, ["iss"], range(558), figure=figure, place=121, title=title, legend=False)
    dark = slow.light_curve("iss", range(558)).fraction[:, 1] < 1.0
    begin = 1000 * (int(np.argmax(dark)) - 1)
    fast = perilune.open(STATION, overrides=still | {"time.step_s": 0.01})
    frames = range(begin, begin + 1500, 5)
    curve = fast.light_curve("iss", frames)
    even = fast.light_curve("iss", frames, limb_darkening=False).fraction[:, 1]
    partial = np.flatnonzero((even > 0.0) & (even < 1.0))
    time_s = curve.t_s - curve.t_s[partial[0]]
    axes = figure.add_subplot(122)
    for band, color in enumerate(("#d1495b", "#3a7d44", "#30638e")):
        label = ("red", "green", "blue")[band]
        axes.plot(time_s, curve.fraction[:, band] - even, color=color, label=label)
    axes.set(xlim=(-0.5, time_s[partial[-1]] + 0.5), xlabel="seconds into the penumbra")
    axes.set_ylabel("fraction less that of an even disc")
    axes.plot([], [], color="0.4", linestyle="--", label="even disc (right scale)")
    axes.legend(fontsize=8, loc="lower left")
    axes.set_title("Sunset: the darkened disc against an even one")
    right = axes.twinx()
    right.plot(time_s, even, color="0.4", linestyle="--")
    right.set_ylabel("fraction of an even disc")
    save(figure, "light_curve.png")


def glare() -> None:
    """Foil and a wing in hard light, clean and by sensors."""
    pictures("glare.png", [sensor_figures.foil(), sensor_figures.panel()], 7.8)


def moon_sensor() -> None:
    """Phases of the Moon as a CCD has them."""
    pictures("moon_sensor.png", [sensor_figures.moon_sensor()], 10.0)


def shutter() -> None:
    """A satellite that turns, by lens and shutter."""
    pictures("shutter.png", shutter_figures.rows(), 7.8)


def shapes() -> None:
    """Bodies that are no ellipsoids, and some that are nowhere."""
    pictures("shapes.png", shape_figures.rows(), 7.8)


FIGURES = {
    "light_curve": light_curve,
    "05": figure_05,
    "07": figure_07,
    "08": figure_08,
    "10": figure_10,
    "13": figure_13,
    "glare": glare,
    "ground": ground,
    "soil": soil,
    "suns": suns,
    "apron": apron,
    "lunar_02": lunar_02,
    "lunar_03": lunar_03,
    "lunar_04": lunar_04,
    "lunar_photograph": lunar_photograph,
    "materials": materials,
    "moon": figure_moon,
    "moon_sensor": moon_sensor,
    "shapes": shapes,
    "shutter": shutter,
    "terrain": terrain,
    "tracks": tracks,
}


def main() -> None:
    for number in sys.argv[1:] or FIGURES:
        FIGURES[number]()


if __name__ == "__main__":
    main()
