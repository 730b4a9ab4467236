"""Error against time for the rows of sensor, light and lens: each left out, and its cheaper ways.

At 640x480. A frame is taken with all rows (`tolerance_dn: 0`), then again with one of them left
out or done in its cheaper way: the error is the root mean square and the largest difference of the
picture, in digital numbers of 255 (rounding alone makes 1), beside the bound of the row. The cost
is what CPU time on one thread the frame takes more than without the row, the least of some repeats
each, taken in turn; for rows of the sensor on a bare disc, whose light takes little time.

Rows of the sensor: `shot_noise`, `blooming` and `black_sun` are in their own lines alone. A changed
mean draws other noise of the same kind, what is full flows elsewhere, and more light may be less
charge, so that with them frames would differ by more than what the row changes; likewise
`compression`, whose artefacts are of the whole picture. The middle of a point spread is only chosen
where nothing mirrors the sun: it is tried on a bare disc. Rows of the sun and of lenses bend or
draw other rays: their errors are with the noise of the samples.
"""

from __future__ import annotations

import time
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import reflectance
import report

import perilune

SENSOR: dict[str, Any] = {
    "preset": "ccd47_20",
    "point_spread": {"core": "airy", "wings": 0.01},
    "cosmic_rays": {"flux_cm2_s": 100.0},
    "hot_pixels": 2e-4,
    "dead_pixels": 1e-4,
    "shift_us": 0.2,
    "lens_flare": {},
    "reset_us": 1.0,
    "compression": {"quality": 90.0},
    "row_noise_e": 4.0,
    "column_noise_e": 4.0,
    "temperature_c": 20.0,
}
STAGES = ("lens_flare", "vignetting", "point_spread", "fixed_pattern", "smear", "dark_current",
          "defects", "shot_noise", "cosmic_rays", "blooming", "black_sun", "read_noise",
          "compression")  # fmt: skip
NONLINEAR = ("shot_noise", "blooming", "black_sun", "compression")
DEAR = ("point_spread", "lens_flare")
"""Left out where another row is timed: what they take would drown it."""
SPREADS = {
    "narrow": {"core": "gauss", "sigma_px": 0.7},
    "with wings": {"core": "gauss", "sigma_px": 0.7, "wings": 0.01},
}
LENS = {"model": "brown_conrady", "k1": -0.1, "k2": 0.02}
GLOW = {"bodies.planet.emission_w_m2_sr": [3.0, 2.0, 1.0]}
LIGHTS = ("soft_sun", "limb_darkening", "cast_shadows", "emitted_light", "emitters", "distortion")
LABEL_AT = {"narrow spread": (-70, 3), "shot_noise": (-50, 3), "compression": (5, 5),
            "black_sun": (5, -8)}  # fmt: skip
"""Where names stand from their points, if not as the others."""
HEAD = ["row", "way", "rms, DN", "largest, DN", "bound, DN", "ms"]


Way = tuple[str, dict[str, Any]]
"""What a way is called, and its keys of `render`."""


class Bench:
    """Frames of one scene with rows left out."""

    def __init__(self, config: Any, channel: str, index: int, changes: dict[str, Any]) -> None:
        self.config, self.channel, self.index, self.changes = config, channel, index, changes

    def open(self, off: Sequence[str], render: dict[str, Any]) -> perilune.Simulation:
        keys = {"tolerance_dn": 0.0, "force_off": sorted(set(off))} | render
        named = {f"render.{name}": value for name, value in keys.items()}
        return perilune.open(self.config, overrides=self.changes | named)

    def sample(self, off: Sequence[str], **render: Any) -> perilune.Sample:
        return self.open(off, render).frame(self.index, channels=[self.channel], threads=1)

    def extra_ms(
        self, row: str, off: Sequence[str], ways: Sequence[Way], repeats: int
    ) -> list[float]:
        """CPU time that each way takes more than the first: all in turn, the least of each."""
        sims = [self.open([*off, *([row] if way[0] == "left out" else [])], way[1]) for way in ways]
        least = [float("inf")] * len(sims)
        for turn in range(repeats + 1):
            for k, sim in enumerate(sims):
                start = time.process_time()
                sim.frame(self.index, channels=[self.channel], threads=1)
                if turn > 0:  # what is loaded once
                    least[k] = min(least[k], 1e3 * (time.process_time() - start))
        return [ms - least[0] for ms in least]


def lines_of(
    row: str,
    errors: Bench,
    off: Sequence[str],
    times: Bench,
    idle: Sequence[str],
    repeats: int,
    cheap: Sequence[Way] = (),
    label: str = "",
) -> list[list[object]]:
    """A row left out, each cheaper way, and all of it. off: rows that the compared frames are
    without; idle: those that the timed ones are without."""
    ways: list[Way] = [("left out", {}), *cheap, ("all", {})]
    idle = [other for other in idle if other != row]
    ms = times.extra_ms(row, idle, ways, repeats)
    full = errors.sample(off)
    lines: list[list[object]] = []
    for (name, render), cost in zip(ways, ms, strict=True):
        out = [row] if name == "left out" else []
        sample = errors.sample([*off, *out], **render)
        plan = {line["name"]: line for line in sample.plan}[row]
        difference = sample[errors.channel].astype(float) - full[errors.channel]
        rms, most = float(np.sqrt(np.mean(difference**2))), float(np.abs(difference).max())
        bound = plan["bound_dn"] if out else plan["residual_dn"]
        lines.append([label or row, name, rms, most, float(bound), cost])
    return lines


def sensor_lines(options: Any, size: dict[str, int]) -> list[list[object]]:
    sensor = {**size, "camera.sensor": SENSOR, "render.samples": 1}
    errors = Bench(options.config, "sensor_rgb", options.frame, sensor)
    disc = reflectance.scene(("disc", 30.0, 380000e3, 0.6), "lambert", options.width)
    times = Bench(disc, "sensor_rgb", 0, sensor)
    lines = []
    for row in STAGES:
        off = [other for other in NONLINEAR if other != row]
        bright = row == "lens_flare"  # ghosts are of what is brighter than a disc
        timed = errors if bright else times
        lines += lines_of(row, errors, off, timed, [*off, *DEAR], options.repeats)
    for name, spread in SPREADS.items():
        spreading = {"mosaic": "mono", "point_spread": spread}
        bench = Bench(disc, "sensor_rgb", 0, {**sensor, "camera.sensor": spreading})
        # All others are kept by name; of this row some of the picture may be left.
        kept = [row["name"] for row in bench.sample(NONLINEAR).plan if row["value"] > 0]
        others = [other for other in kept if other != "point_spread"]
        middle = ("middle", {"tolerance_dn": 64.0, "force_on": others})
        lines += lines_of("point_spread", bench, NONLINEAR, bench, NONLINEAR, options.repeats,
                          [middle], f"{name} spread")  # fmt: skip
    return lines


def light_lines(options: Any, size: dict[str, int]) -> list[list[object]]:
    """Of a hard scene: a planet that glows, and a satellite with foil before it."""
    changes = {**size, **GLOW, "camera.lens": LENS, "render.samples": options.samples}
    bench = Bench(options.config, "rgb", options.frame, changes)
    repeats = max(1, options.repeats // 3)
    return [line for row in LIGHTS for line in lines_of(row, bench, [], bench, [], repeats)]


def plot(path: Path, lines: Sequence[Sequence[Any]]) -> None:
    """What leaving a row out makes wrong, against what it costs to keep it."""
    import matplotlib

    matplotlib.use("Agg")
    from matplotlib import pyplot

    figure, axes = pyplot.subplots(figsize=(7.5, 4.6), layout="constrained")
    rows: dict[str, dict[str, tuple[float, float]]] = {}
    for row, way, rms, _, _, ms in lines:
        rows.setdefault(row, {})[way] = (rms, max(ms, 0.5))
    for row, ways in rows.items():
        style = "C1s" if row in LIGHTS else "C0o"
        cost, error = ways["all"][1], max(ways["left out"][0], 1e-3)
        axes.loglog(cost, error, style, markersize=5)
        where = LABEL_AT.get(row, (5, 3))
        axes.annotate(row, (cost, error), fontsize=7.5, xytext=where, textcoords="offset points")
        if "middle" in ways:
            part = max(ways["middle"][0], 1e-3)
            axes.loglog([cost, ways["middle"][1]], [1e-3, part], ".:", color="C0", linewidth=0.8)
            axes.annotate("its middle alone", (ways["middle"][1], part), fontsize=6.5,
                          xytext=(5, 3), textcoords="offset points")  # fmt: skip
    axes.set_xlabel("CPU time of the row at 640x480, ms (one thread; 0.5: less than the noise)")
    axes.set_ylabel("RMS error without it, DN of 255")
    axes.set_title("What rows of sensor (round), light and lens (square) are worth, and cost")
    axes.set_xlim(right=axes.get_xlim()[1] * 3.0)
    axes.grid(alpha=0.3)
    figure.savefig(path, dpi=100)


def main() -> None:
    parser = report.arguments(__doc__)
    parser.add_argument("--config", default=str(report.ROOT / "configs" / "demo.yaml"))
    parser.add_argument("--frame", type=int, default=2)
    parser.add_argument("--width", type=int, default=640)
    parser.add_argument("--samples", type=int, default=2, help="for the rows of light and lens")
    parser.add_argument("--repeats", type=int, default=9)
    parser.add_argument("--plot", type=Path, help="draws errors against costs there (PNG)")
    options = parser.parse_args()
    size = {"camera.width": options.width, "camera.height": options.width * 3 // 4}
    lines = sensor_lines(options, size) + light_lines(options, size)
    if options.plot is not None:
        plot(options.plot, lines)
    result = {"rows": [dict(zip(HEAD, line, strict=True)) for line in lines]}
    report.publish(options.json, result, [report.table(HEAD, lines)])


if __name__ == "__main__":
    main()
