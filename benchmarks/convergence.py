"""Error against samples: every configuration, with every sample in every pixel and adaptively.

The error is the root mean square over pixels and bands, in digital numbers of 255 before rounding,
of frame 0 at the exposure of the reference. That is two frames of `--reference` samples each at a
tolerance of 0, with seeds of the sampler of their own: the mean product of the differences to the
one and to the other is the square of the error, without the noise of the reference. The positions
of samples in a pixel are one sequence whatever the seed, of which the reference has many more.

`slope` is that of the error in logarithms from the first number of samples to the last, by least
squares; `last` the error at the last. A curve converges if its slope is -0.4 or less, or if it ends
below the tolerance.

`--keep` makes a run one that can be ended and taken up again: what is measured is kept a
configuration at a time, with how it was measured, and another run of the same measures goes on.
"""

from __future__ import annotations

import json
import os
from collections.abc import Mapping, Sequence
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
REFERENCE_SEEDS = (0x5EED, 0xFACADE)

F64 = NDArray[np.float64]


def shipped() -> dict[str, Path]:
    """Name -> file of every configuration, and of the night side that the tests have."""
    oaisys = {f"oaisys/{path.stem}": path for path in sorted((CONFIGS / "oaisys").glob("*.json"))}
    own = {path.stem: path for path in sorted(CONFIGS.glob("*.yaml"))}
    return own | oaisys | {"night_side": NIGHT}


def needs_data(path: Path) -> bool:
    return "data:" in path.read_text()


def encode(radiance: NDArray[np.float32], white: float) -> F64:
    """Display values of 255, sRGB (IEC 61966-2-1), not rounded."""
    x = np.clip(radiance.astype(float) / white, 0.0, 1.0)
    low = x <= 0.0031308
    return 255.0 * np.where(low, 12.92 * x, 1.055 * np.maximum(x, 1e-9) ** (1 / 2.4) - 0.055)


class Asked(Simulation):
    """Frames with another quality, noise and exposure; what they show stays."""

    quality: Mapping[str, float] = {}
    noise = 0
    white: float | None = None

    def _request(self, *args: Any) -> Any:
        request = super()._request(*args)
        request["quality"].update(self.quality)  # type: ignore[typeddict-item]
        request["seed"] ^= self.noise
        if self.white is not None:
            request["exposure"].update(mode="fixed", white_radiance=self.white)
        return request

    def _metered(self, *args: Any) -> Any:
        return None if self.white is not None else super()._metered(*args)


class Scene:
    """A frame of a configuration beside its reference."""

    def __init__(
        self,
        path: Path,
        size: tuple[int, int],
        reference: int,
        threads: int = 1,
        changes: Mapping[str, Any] | None = None,
    ) -> None:
        overrides = {"camera.width": size[0], "camera.height": size[1]} | dict(changes or {})
        opened = perilune.open(str(path), overrides=overrides)
        self._sim = Asked(*opened.__reduce__()[1])
        self._threads = threads
        first = self._sim.frame(0, channels=["rgb"], threads=threads)
        self._sim.white = first.meta["white_radiance"]
        self.reference = [self.picture(reference, 0.0, seed) for seed in REFERENCE_SEEDS]

    def picture(self, samples: int, tolerance_dn: float, noise: int = 0) -> F64:
        """(height, width, 3): display values."""
        self._sim.quality = {"samples": samples, "tolerance_dn": tolerance_dn}
        self._sim.noise = noise
        channels = ["rgb", "radiance"]
        sample = self._sim.frame(0, channels=channels, threads=self._threads)
        assert self._sim.white is not None
        return encode(sample["radiance"], self._sim.white)

    def error(self, picture: F64) -> float:
        """Root mean square error, digital numbers."""
        one, other = self.reference
        return float(np.sqrt(max(np.mean((picture - one) * (picture - other)), 0.0)))

    def curve(self, samples: Sequence[int], tolerance_dn: float, repeats: int = 1) -> list[float]:
        """Errors; root mean squares of so many frames that differ in their noise."""
        return [
            float(
                np.sqrt(
                    np.mean(
                        [
                            self.error(self.picture(count, tolerance_dn, noise)) ** 2
                            for noise in range(repeats)
                        ]
                    )
                )
            )
            for count in samples
        ]


def slope(samples: Sequence[int], errors: Sequence[float]) -> float:
    """Exponent of the error in the number of samples."""
    least = np.maximum(errors, 1e-3)
    return float(np.polyfit(np.log(samples), np.log(least), 1)[0])


def converges(samples: Sequence[int], errors: Sequence[float], tolerance_dn: float) -> bool:
    return slope(samples, errors) <= SLOPE or errors[-1] < max(tolerance_dn, 0.1)


def draw(results: Mapping[str, Mapping[str, list[float]]], samples: Sequence[int], to: str) -> None:
    """One panel a configuration: both tolerances, and n^-0.4 through the first error. Those without
    an error at any number of samples, whose frame no sampled light is in, have none."""
    from matplotlib.figure import Figure

    results = {name: curves for name, curves in results.items() if max(map(max, curves.values()))}
    columns = 6
    rows = -(-len(results) // columns)
    figure = Figure(figsize=(2.1 * columns, 1.75 * rows), layout="constrained")
    axes = np.atleast_1d(figure.subplots(rows, columns, sharex=True)).ravel()
    for axis, (name, curves) in zip(axes, results.items(), strict=False):
        for (key, errors), colour in zip(curves.items(), ("0.55", "C0"), strict=True):
            axis.loglog(samples, np.maximum(errors, 0.01), color=colour, marker=".", label=key)
        first = max(curves["1"][0], 0.01)
        axis.loglog(samples, first * (np.array(samples) / samples[0]) ** SLOPE, "k:", lw=0.8)
        axis.axhline(1.0, color="C3", lw=0.6)
        axis.set_title(name, fontsize=8)
        axis.tick_params(labelsize=7)
        axis.set_ylim(0.05, 60.0)
    for axis in axes[len(results) :]:
        axis.set_visible(False)
    axes[0].legend(title="tolerance_dn", fontsize=6, title_fontsize=6)
    figure.supxlabel("samples a pixel", fontsize=9)
    figure.supylabel("RMS error, digital numbers", fontsize=9)
    figure.savefig(to, dpi=110)


class Kept:
    """Curves of configurations by name, in a file if there is one."""

    def __init__(self, path: str | None, measured: Mapping[str, Any]) -> None:
        self._path = Path(path) if path else None
        self._measured = json.loads(json.dumps(measured))
        self.curves: dict[str, dict[str, list[float]]] = {}
        if self._path is None or not self._path.exists():
            return
        stored = json.loads(self._path.read_text())
        if stored["measured"] != self._measured:
            raise SystemExit(f"{path}: measured with {stored['measured']}, not {self._measured}")
        self.curves = stored["curves"]

    def add(self, name: str, curves: dict[str, list[float]]) -> None:
        self.curves[name] = curves
        if self._path is not None:
            text = json.dumps({"measured": self._measured, "curves": self.curves})
            part = self._path.with_suffix(".part")
            part.write_text(text)
            part.replace(self._path)


def main() -> None:
    parser = report.arguments(__doc__)
    parser.add_argument("--only", nargs="*", help="names of configurations; all without")
    parser.add_argument("--width", type=int, default=40)
    parser.add_argument("--reference", type=int, default=1024, help="samples, twice")
    parser.add_argument("--samples", type=int, nargs="+", default=SAMPLES)
    parser.add_argument("--figure", help="file to draw the curves to; needs the extra `plot`")
    parser.add_argument("--keep", help="file of JSON that results are added to, and taken from")
    options = parser.parse_args()
    samples = list(options.samples)
    size = (options.width, options.width * 3 // 4)
    kept = Kept(options.keep, {"samples": samples, "size": size, "reference": options.reference})
    results = kept.curves
    for name, path in shipped().items():
        skipped = needs_data(path) and "PERILUNE_DATA" not in os.environ
        if name in results or skipped or (options.only and name not in options.only):
            continue
        scene = Scene(path, size, options.reference, options.threads)
        kept.add(name, {f"{dn:g}": scene.curve(samples, dn) for dn in TOLERANCES})
    rows = [
        [name, key, curve[0], slope(samples, curve), curve[-1],
         "yes" if converges(samples, curve, float(key)) else "NO"]
        for name, curves in results.items()
        for key, curve in curves.items()
    ]  # fmt: skip
    if options.figure:
        draw(results, samples, options.figure)
    first, last = f"at {samples[0]}", f"at {samples[-1]}"
    head = ["configuration", "tolerance", first, "slope", last, "converges"]
    report.publish(
        options.json, {"samples": samples, "rms_dn": results}, [report.table(head, rows)]
    )


if __name__ == "__main__":
    main()
