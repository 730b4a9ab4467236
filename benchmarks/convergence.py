"""Error against samples: every configuration, with every sample in every pixel and adaptively.

The error is the root mean square over pixels and bands, in digital numbers of 255 before rounding,
of frame 0 at the exposure of the reference. The reference is `--seeds` frames of `--reference`
samples each at a tolerance of 0, in two halves whose radiances are averaged: the mean product of
the differences to the one and to the other is the square of the error, without the noise of the
reference. Its pixels are means of 3 x 3 smaller ones, of 5 x 5, 7 x 7 and 9 x 9: samples have the
same places in all pixels and for all seeds, so that frames of equal pixels have errors in common.
Stars, which frames spread over four pixels to keep their centroids, are spread as wide there.

Every point is the mean square of several frames whose samplers have seeds of their own, more where
samples are few, and has a standard error: a few pixels that meet the sun by chance hold most of the
error of a frame, so one frame alone says little.

Without `--windows` the frame has `--width` pixels, each with as much in it as many pixels of the
frame at its own size. With it, so many windows of that width are measured, at random places of the
frame at its own size.

`slope` is that of the error in logarithms from the first number of samples to the last, by least
squares, with its standard error; `last step` that from the last number but one. A curve converges
if its slope is -0.4 or less, or if it ends below the tolerance (0.1 at a tolerance of 0). `late`
are those whose last step alone is so steep: light that fewer than one sample in some hundreds
finds, so bright that one is enough for white, is an error that does not fall until it is found.
`open` are those within two standard errors of any of this.

`--keep` makes a run one that can be ended and taken up again: what is measured is kept a
configuration at a time, with how it was measured, and another run of the same measures goes on.
"""

from __future__ import annotations

import json
import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import report
from numpy.typing import NDArray

import perilune
from perilune.simulation import Simulation

CONFIGS = report.ROOT / "configs"
NIGHT = report.ROOT / "tests" / "python" / "night_side.yaml"
SAMPLES = (4, 16, 64, 256, 1024)
TOLERANCES = (0.0, 1.0)
SLOPE = -0.4
REFERENCE_SEED = 0x5EED0000
SEEDS_MOST = 4
"""Frames of few samples are so many times as many as those of the most."""
LEAST_DN = 1e-3
PARTS = (3, 5, 7, 9)
"""Frames of the reference divide pixels into so many parts along both axes."""

F64 = NDArray[np.float64]
Radiance = NDArray[np.float32]


def shipped() -> dict[str, Path]:
    """Name -> file of every configuration, and of the night side that the tests have."""
    oaisys = {f"oaisys/{path.stem}": path for path in sorted((CONFIGS / "oaisys").glob("*.json"))}
    own = {path.stem: path for path in sorted(CONFIGS.glob("*.yaml"))}
    return own | oaisys | {"night_side": NIGHT}


def needs_data(path: Path) -> bool:
    return "data:" in path.read_text()


def corners(depth: Radiance, size: tuple[int, int], count: int) -> list[tuple[int, int]]:
    """Column and row of windows at random places of the frame in which anything is seen."""
    rows, columns = np.nonzero(np.isfinite(depth) & (depth > 0.0))
    most = depth.shape[1] - size[0], depth.shape[0] - size[1]
    seen = np.stack((columns - size[0] // 2, rows - size[1] // 2), axis=1)
    chosen = seen[np.random.default_rng(1).integers(len(seen), size=count)]
    return [(int(x), int(y)) for x, y in np.clip(chosen, 0, most)]


def starlight(
    whole: Simulation, dark: Simulation, size: tuple[int, int], parts: int, corner: tuple[int, int]
) -> F64:
    """(rows, columns, 3) radiance of the stars that `whole` has and `dark` has not, from pixels in
    so many parts. A frame shares out a star to the four pixels about it by bilinear weights, so
    that parts of a pixel count by their distance from its centre, and those around it, too."""
    wide = size[0] + 2, size[1] + 2
    light = []
    for kind in (whole, dark):
        sim = Asked.of(kind, wide, parts)
        sim.white, sim.corner = 1.0, (corner[0] - 1, corner[1] - 1)
        sim.quality = {"samples": 1, "tolerance_dn": 0.0}
        light.append(sim.frame(0, channels=["radiance"])["radiance"].astype(float))
    across, down = (
        np.maximum(0.0, 1.0 - np.abs((np.arange((n + 2) * parts) + 0.5) / parts
                                     - (np.arange(n)[:, None] + 1.5)))
        for n in size
    )  # fmt: skip
    return np.einsum("yv,vuc,xu->yxc", down, light[0] - light[1], across) / parts**2


def encode(radiance: Radiance, white: float) -> F64:
    """Display values of 255, sRGB (IEC 61966-2-1), not rounded."""
    x = np.clip(radiance.astype(float) / white, 0.0, 1.0)
    low = x <= 0.0031308
    return 255.0 * np.where(low, 12.92 * x, 1.055 * np.maximum(x, 1e-9) ** (1 / 2.4) - 0.055)


class Asked(Simulation):
    """Frames of `whole`, with another quality, noise and exposure, or windows of them: as many
    pixels as this simulation's camera has, `parts` of them in a row for each pixel of `whole`."""

    whole: Simulation
    parts = 1
    corner: tuple[int, int] = (0, 0)
    """Of the window, in pixels of `whole`: column, row."""
    quality: Mapping[str, float] = {}
    noise = 0
    white: float

    @classmethod
    def of(cls, whole: Simulation, size: tuple[int, int], parts: int) -> Asked:
        """size: of the window, in pixels of `whole`: columns, rows."""
        width, height = parts * size[0], parts * size[1]
        overrides: dict[str, Any] = {"camera.width": width, "camera.height": height}
        for name, body in whole.config.bodies.items():
            if body.terrain is not None and parts > 1:  # the same cells
                cells = body.terrain.cells_per_pixel / parts
                overrides[f"bodies.{name}.terrain.cells_per_pixel"] = cells
        sized = whole.with_overrides(overrides)
        out = cls(*sized.__reduce__()[1])
        out.whole, out.parts = whole, parts
        return out

    def _request(self, *args: Any) -> Any:
        request = self.whole._request(self.whole.world(0))
        camera = self.config.camera
        request["width"], request["height"] = camera.width, camera.height
        request["K"] = request["K"].copy()
        request["K"][:2, 2] -= self.corner
        request["K"][:2] *= self.parts
        request["K"][:2, 2] += 0.5 * (self.parts - 1)
        request["quality"].update(self.quality)  # type: ignore[typeddict-item]
        request["seed"] ^= self.noise
        request["exposure"].update(mode="fixed", white_radiance=self.white)
        return request

    def _metered(self, *args: Any) -> Any:
        return None


@dataclass(frozen=True)
class Curve:
    """Squared errors of frames that differ in their seeds, by number of samples."""

    samples: Sequence[int]
    squares: Sequence[Sequence[float]]

    @property
    def errors(self) -> F64:
        """(samples,): root mean square error, digital numbers."""
        return np.sqrt(np.maximum([np.mean(s) for s in self.squares], LEAST_DN**2))

    @property
    def deviations(self) -> F64:
        """(samples,): standard errors of `errors`, digital numbers; NaN for single frames."""
        means = [np.std(s, ddof=1) / np.sqrt(len(s)) if len(s) > 1 else np.nan
                 for s in self.squares]  # fmt: skip
        return np.asarray(means) / (2.0 * self.errors)

    def slope(self, last: int = 0) -> tuple[float, float]:
        """Exponent of the error in the number of samples, and its standard error; of so many points
        at the end, or of all."""
        errors, deviations = self.errors[-last:], self.deviations[-last:]
        x = np.log(self.samples[-last:])
        weights = (x - x.mean()) / np.sum((x - x.mean()) ** 2)
        deviation = np.sqrt(np.sum((weights * deviations / errors) ** 2))
        return float(weights @ np.log(errors)), float(deviation)

    def verdict(self, tolerance_dn: float) -> str:
        if self.slope()[0] <= SLOPE or self.errors[-1] < max(tolerance_dn, 0.1):
            return "yes"
        if self.slope(2)[0] <= SLOPE:
            return "late"
        least = min(slope - 2.0 * deviation for slope, deviation in (self.slope(), self.slope(2)))
        return "open" if least <= SLOPE else "NO"


class Scene:
    """A frame of a configuration beside its reference."""

    def __init__(
        self,
        path: Path,
        size: tuple[int, int],
        reference: int,
        threads: int = 1,
        changes: Mapping[str, Any] | None = None,
        seeds: int = 2,
        windows: int | Sequence[tuple[int, int]] = 0,
    ) -> None:
        """windows: how many, or their corners (column, row); none: the frame is of that size."""
        whole = perilune.open(str(path), overrides=dict(changes or {}))
        if not windows:
            whole = whole.with_overrides({"camera.width": size[0], "camera.height": size[1]})
        self._sim = Asked.of(whole, size, 1)
        self._threads = threads
        first = whole.frame(0, channels=["rgb", "depth"], threads=threads)
        self._sim.white = first.meta["white_radiance"]
        if isinstance(windows, int):
            windows = corners(first["depth"], size, windows) if windows else [(0, 0)]
        self._corners = windows
        starry = whole.config.sky is not None and whole.config.sky.stars is not None
        dark = whole.with_overrides({"sky.stars": None}) if starry else whole
        frames = []
        for k in range(seeds):
            fine = Asked.of(dark, size, PARTS[k % len(PARTS)])
            fine.white = self._sim.white
            frames.append(self._averaged(fine, reference, REFERENCE_SEED + k))
            if starry:
                stars = [starlight(whole, dark, size, fine.parts, at) for at in windows]
                frames[k] = (frames[k] + np.concatenate(stars)).astype(np.float32)
        self.reference = self._halves(frames)

    def _halves(self, frames: Sequence[Radiance]) -> tuple[F64, F64]:
        one, other = (np.mean(frames[k::2], axis=0) for k in range(2))
        return encode(one, self._sim.white), encode(other, self._sim.white)

    def _windows(self, sim: Asked, quality: Mapping[str, float], noise: int) -> list[Radiance]:
        sim.quality, sim.noise = quality, noise
        seen = []
        for sim.corner in self._corners:
            # rgb too, as sampling serves the pictures that are asked for
            sample = sim.frame(0, channels=["rgb", "radiance"], threads=self._threads)
            seen.append(sample["radiance"])
        return seen

    def _averaged(self, fine: Asked, samples: int, noise: int) -> Radiance:
        """Of so many samples a pixel at a tolerance of 0, from frames of smaller pixels."""
        quality = {"samples": -(-samples // fine.parts**2), "tolerance_dn": 0.0}
        shown = np.concatenate(self._windows(fine, quality, noise))
        rows, columns = shown.shape[0] // fine.parts, shown.shape[1] // fine.parts
        return shown.reshape(rows, fine.parts, columns, fine.parts, 3).mean(axis=(1, 3))

    def shown(self, quality: Mapping[str, float], noise: int = 0) -> F64:
        """(height, width, 3): display values at what `quality` of the request says."""
        light = np.concatenate(self._windows(self._sim, quality, noise))
        return encode(light, self._sim.white)

    def radiance(self, samples: int, tolerance_dn: float, noise: int = 0) -> Radiance:
        """(height, width, 3), W m-2 sr-1; windows below each other."""
        quality = {"samples": samples, "tolerance_dn": tolerance_dn}
        return np.concatenate(self._windows(self._sim, quality, noise))

    def picture(self, samples: int, tolerance_dn: float, noise: int = 0) -> F64:
        """(height, width, 3): display values."""
        return encode(self.radiance(samples, tolerance_dn, noise), self._sim.white)

    def square(self, picture: F64, reference: tuple[F64, F64] | None = None) -> float:
        """Mean square error; its expectation is free of the reference's noise, so that small ones
        may be negative."""
        one, other = reference or self.reference
        return float(np.mean((picture - one) * (picture - other)))

    def error(self, picture: F64) -> float:
        """Root mean square error, digital numbers."""
        return float(np.sqrt(max(self.square(picture), 0.0)))

    def squares(self, samples: int, tolerance_dn: float, seeds: int) -> list[float]:
        """Square errors of so many frames, each with a seed of its own."""
        noises = (samples * 1000 + k for k in range(seeds))
        return [self.square(self.picture(samples, tolerance_dn, noise)) for noise in noises]

    def curve(self, samples: Sequence[int], tolerance_dn: float, seeds: int = 1) -> Curve:
        """Of so many frames at the most samples, of up to four times as many at fewer."""
        counts = [seeds * min(SEEDS_MOST, int(np.sqrt(max(samples) / n))) for n in samples]
        squares = [
            self.squares(n, tolerance_dn, count) for n, count in zip(samples, counts, strict=True)
        ]
        return Curve(samples, squares)


def draw(results: Mapping[str, Mapping[str, Curve]], to: str) -> None:
    """One panel a configuration: both tolerances, and n^-0.4 through the first error. Those without
    an error at any number of samples, whose frame no sampled light is in, have none."""
    from matplotlib.figure import Figure

    results = {name: curves for name, curves in results.items() if has_error(curves)}
    columns = 6
    rows = -(-len(results) // columns)
    figure = Figure(figsize=(2.1 * columns, 1.75 * rows), layout="constrained")
    axes = np.atleast_1d(figure.subplots(rows, columns, sharex=True)).ravel()
    for axis, (name, curves) in zip(axes, results.items(), strict=False):
        for (key, curve), colour in zip(curves.items(), ("0.55", "C0"), strict=True):
            shown = np.maximum(curve.errors, 0.01)
            bars = np.minimum(2.0 * np.nan_to_num(curve.deviations), 0.9 * shown)
            axis.errorbar(curve.samples, shown, bars, color=colour, marker=".", lw=1, label=key)
        samples = np.asarray(curves["1"].samples)
        first = max(curves["1"].errors[0], 0.01)
        axis.loglog(samples, first * (samples / samples[0]) ** SLOPE, "k:", lw=0.8)
        axis.axhline(1.0, color="C3", lw=0.6)
        axis.set_title(name, fontsize=8)
        axis.tick_params(labelsize=7)
        axis.set_ylim(0.05, 60.0)
    for axis in axes[len(results) :]:
        axis.set_visible(False)
    axes[0].legend(title="tolerance_dn", fontsize=6, title_fontsize=6)
    figure.supxlabel("samples a pixel", fontsize=9)
    figure.supylabel("RMS error, digital numbers; bars: two standard errors", fontsize=9)
    figure.savefig(to, dpi=110)


def has_error(curves: Mapping[str, Curve]) -> bool:
    return any(float(curve.errors.max()) > LEAST_DN for curve in curves.values())


class Kept:
    """Curves of configurations by name, in a file if there is one."""

    def __init__(self, path: str | None, measured: Mapping[str, Any]) -> None:
        self._path = Path(path) if path else None
        self._measured = json.loads(json.dumps(measured))
        self.curves: dict[str, dict[str, Curve]] = {}
        if self._path is None or not self._path.exists():
            return
        stored = json.loads(self._path.read_text())
        if stored["measured"] != self._measured:
            raise SystemExit(f"{path}: measured with {stored['measured']}, not {self._measured}")
        samples = self._measured["samples"]
        for name, curves in stored["curves"].items():
            self.curves[name] = {key: Curve(samples, squares) for key, squares in curves.items()}

    def squares(self) -> dict[str, dict[str, Any]]:
        return {
            name: {key: curve.squares for key, curve in curves.items()}
            for name, curves in self.curves.items()
        }

    def add(self, name: str, curves: dict[str, Curve]) -> None:
        self.curves[name] = curves
        if self._path is not None:
            text = json.dumps({"measured": self._measured, "curves": self.squares()})
            part = self._path.with_suffix(".part")
            part.write_text(text)
            part.replace(self._path)


def row(name: str, key: str, curve: Curve) -> list[object]:
    errors, deviations = curve.errors, curve.deviations
    points = (0, len(errors) // 2, -1)
    slopes = (curve.slope(), curve.slope(2))
    return [name, key, *(f"{errors[k]:.2f} +- {deviations[k]:.2f}" for k in points),
            *(f"{slope:.2f} +- {deviation:.2f}" for slope, deviation in slopes),
            curve.verdict(float(key))]  # fmt: skip


def main() -> None:
    parser = report.arguments(__doc__)
    parser.add_argument("--only", nargs="*", help="names of configurations; all without")
    parser.add_argument("--width", type=int, default=20)
    parser.add_argument("--reference", type=int, default=1024, help="samples of each of its frames")
    parser.add_argument("--seeds", type=int, default=6, help="frames of the reference")
    parser.add_argument("--samples", type=int, nargs="+", default=SAMPLES)
    parser.add_argument(
        "--windows",
        type=int,
        default=0,
        help="measure this many windows of "
        "--width in the frame at its own size, not the frame at that width",
    )
    parser.add_argument("--figure", help="file to draw the curves to; needs the extra `plot`")
    parser.add_argument("--keep", help="file of JSON that results are added to, and taken from")
    options = parser.parse_args()
    samples, seeds = list(options.samples), options.seeds
    size = (options.width, options.width * 3 // 4)
    how = {"samples": samples, "size": size, "reference": options.reference, "seeds": seeds}
    how |= {"windows": options.windows} if options.windows else {}
    kept = Kept(options.keep, how)
    found = shipped()
    for name in options.only or found:
        skipped = needs_data(found[name]) and "PERILUNE_DATA" not in os.environ
        if name in kept.curves or skipped:
            continue
        scene = Scene(found[name], size, options.reference, options.threads, seeds=seeds,
                      windows=options.windows)  # fmt: skip
        kept.add(name, {f"{dn:g}": scene.curve(samples, dn, seeds) for dn in TOLERANCES})
    results = {name: kept.curves[name] for name in found if name in kept.curves}
    rows = [row(name, key, curve) for name, curves in results.items()
            for key, curve in curves.items() if has_error(curves)]  # fmt: skip
    if options.figure:
        draw(results, options.figure)
    points = (samples[0], samples[len(samples) // 2], samples[-1])
    head = [
        "configuration",
        "tolerance",
        *(f"at {n}" for n in points),
        "slope",
        "last step",
        "converges",
    ]
    report.publish(options.json, how | {"squares_dn": kept.squares()}, [report.table(head, rows)])


if __name__ == "__main__":
    main()
