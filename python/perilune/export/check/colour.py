"""Compares pictures with renderings of the configuration: some to the byte, all with few samples.

A frame with few samples differs from the true one by noise, which a second one with other samples
estimates. If the written picture differs from the first by more than the noise explains, the frame
is rendered in full, and only that result counts. The coarse comparison can thus cost time, but
causes no false findings."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from perilune.export.check.coarse import Coarse
from perilune.export.check.findings import Report
from perilune.export.check.png import PngError, read_png
from perilune.export.check.reopened import Remake
from perilune.frame.passes import COLOURS
from perilune.sample import Sample

F32 = NDArray[np.float32]

_PART = 16
"""Divisor of the number of samples for the comparison of all frames."""
_BLOCK = 8
"""Side in pixels of the blocks whose means are compared."""
_FLOOR = 1.0
"""Rounding error in 8-bit digital numbers, below which the mean of a block is not tested."""
_EDGES = 0.2
"""Fraction of the contrast within a block by which few samples may miss its mean, because they see
all of a thin object or nothing."""
_FAR = 4.0
"""Standard deviations of the noise beyond which a block is suspicious."""
_FEW, _PART_OF_ALL = 2, 5e-4
"""Number and fraction of blocks that may be suspicious: glints that few samples miss."""
_WILD = 12.0
"""Levels by which a pixel is an outlier."""
_FEW_PIXELS, _PART_OF_PIXELS, _PART_OF_NOISY = 8, 1e-4, 0.15
"""Number, fraction of all and fraction of the noisy pixels that may be outliers: thin objects that
few samples miss."""
_OTHER_BUILD = 0.02
"""Fraction of the pixels in which another build of the core may differ."""


def coarse_samples(samples: int) -> int:
    """Number of samples for the comparison of all frames; all samples if fewer would save
    little."""
    few = max(1, samples // _PART)
    return few if 4 * few <= samples else samples


class ColourCheck:
    """Renders frames again and compares their pictures."""

    def __init__(self, report: Report, remake: Remake, exact: Collection[int] | None) -> None:
        """exact: indices of the frames to render in full; None: all."""
        self.report = report
        self.remake = remake
        sim = remake.sim
        self.samples = sim.config.render.samples
        self.few = coarse_samples(self.samples)
        self.exact = None if self.few == self.samples else exact
        self._coarse = Coarse.of(sim, self.few)
        self.in_full = 0
        self._full: Sample | None = None
        self._noise: Sample | None = None

    def _is_exact(self, index: int) -> bool:
        return self.exact is None or index in self.exact

    def sample(self, index: int, channels: Sequence[str]) -> Sample:
        """A frame with all its labels; its pictures are coarse or exact."""
        self._full = self._noise = None
        if self._is_exact(index):
            self.in_full += 1
            self._full = self.remake.sim.frame(index, channels=channels)
            return self._full
        return self._coarse.frame(index, channels=channels)

    def _rendered_in_full(self, index: int) -> Sample:
        if self._full is None:
            names = list(dict.fromkeys(self.remake.job.pictures.values()))
            self.in_full += 1
            self._full = self.remake.sim.frame(index, channels=names)
        return self._full

    def _noisy(self, sample: Sample) -> Sample:
        if self._noise is None:
            names = list(dict.fromkeys(self.remake.job.pictures.values()))
            self._noise = self._coarse.again(sample, names)
        return self._noise

    def holds(self, folder: str) -> bool:
        """Whether a folder of an additional channel can be compared with the frame rendered again:
        labels always, because they do not depend on samples; others only in a frame rendered in
        full."""
        if self._full is not None or folder not in COLOURS:
            return True
        self.report.note(f"{folder}/ was compared in the images alone that were rendered in full")
        return False

    def compare(self, path: Path, sample: Sample, folder: str) -> None:
        """Compares a picture of a dataset with the frame rendered again. folder: that of the
        scene."""
        try:
            found = read_png(path)
        except (OSError, PngError):
            return  # reported when it was read
        channel, index = self.remake.job.pictures[folder], sample.meta["index"]
        expected = sample[channel]
        if found.shape != expected.shape or found.dtype != expected.dtype:
            return  # likewise
        if self._full is None:
            noise = self._noisy(sample)[channel]
            if not is_suspicious(found, expected, noise):
                return
        expected = self._rendered_in_full(index)[channel]
        other = (found != expected).reshape(*found.shape[:2], -1).any(axis=2)
        count = int(np.count_nonzero(other))
        if count > (_OTHER_BUILD * other.size if self.remake.tolerance.relative else 0):
            self.report.add(path, picture_difference(found, expected, count, path))


def _blocks(image: NDArray[Any]) -> F32:
    """Means of blocks of pixels; the remainder at the right and bottom joins the last block."""
    planes: NDArray[Any] = image.reshape(*image.shape[:2], -1).astype(np.float32)
    for axis in (0, 1):
        size = planes.shape[axis]
        starts = np.arange(0, max(size - _BLOCK // 2, 1), _BLOCK)
        counts = np.diff(np.append(starts, size)).astype(np.float32)
        sums = np.add.reduceat(planes, starts, axis=axis)
        planes = sums / np.expand_dims(counts, tuple(k for k in range(3) if k != axis))
    return np.asarray(planes, dtype=np.float32)


def _spread(squares: F32) -> F32:
    """Mean square of a block and its neighbours."""
    padded = np.pad(squares, ((1, 1), (1, 1), (0, 0)), mode="edge")
    rows, columns = squares.shape[:2]
    total = sum(padded[i : i + rows, j : j + columns] for i in range(3) for j in range(3))
    return np.asarray(total / 9.0, dtype=np.float32)


def _in_levels(*images: NDArray[Any]) -> list[F32]:
    """Pictures in digital numbers of about 8 bits."""
    largest = max(float(image.max(initial=0)) for image in images)
    factor = np.float32(min(1.0, 255.0 / max(largest, 1.0)))
    return [image.reshape(*image.shape[:2], -1).astype(np.float32) * factor for image in images]


def distances(found: NDArray[Any], first: NDArray[Any], second: NDArray[Any]) -> F32:
    """(rows, columns): deviation of each block's mean in standard deviations of its noise.

    found: the picture; first, second: coarse renderings with different noise."""
    a, b, c = _in_levels(found, first, second)
    low = _blocks(b)
    contrast = np.maximum(_blocks(b**2) - low**2, 0.0)
    noise = _spread((low - _blocks(c)) ** 2) + _EDGES**2 * _spread(contrast)
    off = np.abs(_blocks(a) - low) / np.sqrt(noise + _FLOOR**2)
    return np.asarray(off.max(axis=2), dtype=np.float32)


def _highest(image: F32) -> F32:
    """Largest value of a pixel and its neighbours, in each band."""
    padded = np.pad(image, ((1, 1), (1, 1), (0, 0)), mode="edge")
    rows = np.maximum(np.maximum(padded[:-2], padded[1:-1]), padded[2:])
    return np.asarray(np.maximum(np.maximum(rows[:, :-2], rows[:, 1:-1]), rows[:, 2:]))


def wild_pixels(found: NDArray[Any], first: NDArray[Any], second: NDArray[Any]) -> tuple[int, int]:
    """Outliers, far beyond the range of the coarse renderings at a pixel and its neighbours; and
    pixels in which these differ as much by noise."""
    a, b, c = _in_levels(found, first, second)
    above = a - _highest(np.maximum(b, c))
    below = -_highest(-np.minimum(b, c)) - a
    wild = (np.maximum(above, below) > _WILD).any(axis=2)
    return int(wild.sum()), int((np.abs(b - c) > _WILD).any(axis=2).sum())


def is_suspicious(found: NDArray[Any], first: NDArray[Any], second: NDArray[Any]) -> bool:
    """Whether a picture is farther from a coarse rendering than another coarse rendering is."""
    far = distances(found, first, second) > _FAR
    if int(np.count_nonzero(far)) > _FEW + _PART_OF_ALL * far.size:
        return True
    wild, noisy = wild_pixels(found, first, second)
    return wild > _FEW_PIXELS + _PART_OF_PIXELS * far.size * _BLOCK**2 + _PART_OF_NOISY * noisy


def picture_difference(found: NDArray[Any], expected: NDArray[Any], count: int, path: Path) -> str:
    """Description of a difference, with its likeliest cause."""
    levels = int(np.abs(found.astype(np.int64) - expected.astype(np.int64)).max())
    text = (
        f"{count} of {found.shape[0] * found.shape[1]} pixels differ by up to {levels} from the "
        "frame rendered again"
    )
    cause = _cause(found, expected, path)
    return f"{text}: {cause}" if cause else text


def _cause(found: NDArray[Any], expected: NDArray[Any], path: Path) -> str | None:
    if not found.any():
        return "it is black"
    if not np.ptp(found):
        return "it has one colour"
    turned = {
        "it is mirrored left to right": expected[:, ::-1],
        "it is upside down": expected[::-1],
        "it is turned by 180 degrees": expected[::-1, ::-1],
        "its rows are its columns": np.swapaxes(expected, 0, 1),
        "red and blue are swapped": expected[..., ::-1],
    }
    for text, image in turned.items():
        if image.shape == found.shape and (image == found).all():
            return text
    data = path.read_bytes()
    for other in sorted(path.parent.glob("*.png")):
        same_size = other != path and other.stat().st_size == len(data)
        if same_size and other.read_bytes() == data:
            return f"it is that of {other.name}"
    return None
