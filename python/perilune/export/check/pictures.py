"""Compares pictures with labels if frames cannot be rendered again, by what no true picture
shows."""

from __future__ import annotations

import hashlib
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from perilune.export.check.findings import Report
from perilune.export.check.png import PngError, read_png
from perilune.export.writers.bop_files import GT_FILE, RGB_FOLDER
from perilune.export.writers.files import load_object

Mask = NDArray[np.bool_]
F32 = NDArray[np.float32]

_LEAST_OUTLINE = 40
"""Pixels of the shortest outline to test."""
_CLEAR, _BETTER = 4.0, 2.5
"""Least ratios of a picture's steepness on an outline that it shows: to that elsewhere, and to that
on the outline of its masks. Unmodified pictures are steepest on their own outlines."""

_TURNS: dict[str, tuple[slice, slice]] = {
    "mirrored left to right": np.s_[:, ::-1],
    "upside down": np.s_[::-1, :],
    "turned by 180 degrees": np.s_[::-1, ::-1],
}


def _steepness(image: NDArray[Any]) -> F32:
    """(height, width): differences from the pixels to the right and below."""
    grey: F32 = image.mean(axis=2, dtype=np.float32)
    steep: F32 = np.zeros(grey.shape, dtype=np.float32)
    across, down = np.abs(np.diff(grey, axis=1)), np.abs(np.diff(grey, axis=0))
    steep[:, :-1] += across
    steep[:, 1:] += across
    steep[:-1] += down
    steep[1:] += down
    return steep


def _outline(mask: Mask) -> Mask:
    """Pixels on either side of the edges of a mask."""
    edge = np.zeros_like(mask)
    across, down = mask[:, 1:] != mask[:, :-1], mask[1:] != mask[:-1]
    edge[:, 1:] |= across
    edge[:, :-1] |= across
    edge[1:] |= down
    edge[:-1] |= down
    return edge


def contrast(steep: F32, outline: Mask) -> float:
    """Ratio of a picture's steepness on an outline to that elsewhere."""
    return float(steep[outline].mean() / max(float(steep.mean()), 1e-3))


@dataclass
class _Seen:
    """Data kept of an image."""

    path: Path
    outline: Mask
    gt: Any


def _visible(folder: Path, im_id: int) -> Mask | None:
    paths = sorted((folder / "mask_visib").glob(f"{im_id:06d}_*.png"))
    masks = [read_png(path) != 0 for path in paths]
    return np.logical_or.reduce(masks) if masks else None


def _fits(steep: F32, outline: Mask, other: Mask) -> bool:
    """Whether the picture shows the other outline instead of its own."""
    if np.count_nonzero(other & outline) > 0.3 * np.count_nonzero(outline):
        return False
    return contrast(steep, other) > max(_CLEAR, _BETTER * contrast(steep, outline))


def _turned(steep: F32, outline: Mask) -> str | None:
    """The transformation of the picture that shows an outline which the picture itself does not
    show."""
    for text, index in _TURNS.items():
        if _fits(steep, outline, outline[index]):
            return f"edges are not those of the masks, but they would be if it were {text}"
    return None


class PictureCheck:
    """Compares the pictures of a dataset, one scene after another."""

    def __init__(self, report: Report) -> None:
        self.report = report
        self._pictures: dict[bytes, tuple[str, Any]] = {}

    def scene(self, folder: Path) -> None:
        """Compares the pictures of a scene with its masks, and with those of earlier scenes."""
        gts = load_object(folder / GT_FILE)
        seen: list[_Seen] = []
        lost: list[tuple[_Seen, F32]] = []
        for path in sorted((folder / RGB_FOLDER).glob("*.png")):
            try:
                image, mask = read_png(path), _visible(folder, int(path.stem))
            except (OSError, ValueError, PngError):
                continue  # reported when it was read
            gt = gts.get(str(int(path.stem)))
            self._twice(path, image, gt)
            if mask is None or image.ndim != 3 or mask.shape != image.shape[:2]:
                continue
            one = _Seen(path, _outline(mask), gt)
            if np.count_nonzero(one.outline) < _LEAST_OUTLINE:
                continue
            seen.append(one)
            steep = _steepness(image)
            if contrast(steep, one.outline) < _CLEAR:
                lost.append((one, steep))
        for one, steep in lost:
            self._lost(one, steep, seen)

    def _twice(self, path: Path, image: NDArray[Any], gt: Any) -> None:
        """Reports the same picture with different poses; uniform pictures may be alike."""
        if not np.ptp(image):
            return
        digest = hashlib.sha256(image.tobytes()).digest()
        name = path.relative_to(self.report.folder).as_posix()
        first, other = self._pictures.setdefault(digest, (name, gt))
        if first != name and gt and other != gt:
            self.report.add(path, f"is the same picture as {first}, where the poses are others")

    def _lost(self, one: _Seen, steep: F32, seen: list[_Seen]) -> None:
        text = _turned(steep, one.outline)
        for other in seen:
            if text is None and _fits(steep, one.outline, other.outline):
                text = f"edges are not those of the masks, but of those of image {other.path.stem}"
        if text is not None:
            self.report.add(one.path, text)
