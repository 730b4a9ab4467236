"""Makes the pictures of configs/demo.yaml and comet.yaml: `python docs/figures/make_images.py`."""

from __future__ import annotations

from pathlib import Path

import numpy as np

import perilune
from perilune import _core
from perilune.base.colors import colored_ids

ROOT = Path(__file__).resolve().parents[2]
FRAMES = (3, 0, 2)


def strip(index: int) -> np.ndarray:
    """One frame as seen, with its normals and its parts: (H, 3 W, 3)."""
    sim = perilune.open(
        ROOT / "configs" / "demo.yaml",
        overrides={"camera.width": 640, "camera.height": 480, "render.samples": 48},
    )
    sample = sim.frame(index, channels=["rgb", "normal", "part"])
    hit = sample["part"] > 0
    normals = np.where(hit[..., None], 127.5 * (sample["normal"] * [1, -1, -1] + 1), 0)
    return np.hstack([sample["rgb"], normals.astype(np.uint8), colored_ids(sample["part"])])


def comet() -> np.ndarray:
    """Dust about a comet and the plume of a probe: (H, W, 3)."""
    size = {"camera.width": 480, "camera.height": 360, "render.samples": 12}
    sim = perilune.open(ROOT / "configs" / "comet.yaml", overrides=size)
    return sim.frame(0, channels=["rgb"])["rgb"]


def main() -> None:
    target = ROOT / "docs" / "images"
    target.mkdir(exist_ok=True)
    demo = np.ascontiguousarray(np.vstack([strip(index) for index in FRAMES]))
    _core.png_write(str(target / "demo.png"), demo, level=9)
    _core.png_write(str(target / "comet.png"), comet(), level=9)


if __name__ == "__main__":
    main()
