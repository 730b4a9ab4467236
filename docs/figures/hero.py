"""Makes the README's picture: one frame with four of its labels, `python docs/figures/hero.py`.

Needs PERILUNE_DATA. The scene is a cell of gallery.py.
"""

from __future__ import annotations

import argparse
from pathlib import Path

import numpy as np
from gallery import scene
from numpy.typing import NDArray
from PIL import Image, ImageDraw

import perilune
from perilune.base.colors import colored_ids

U8 = NDArray[np.uint8]
ROOT = Path(__file__).resolve().parents[2]
PANELS = 3
"""Labels beside the picture, one above the other."""


def depth_picture(depth: NDArray[np.float32]) -> U8:
    """Near is bright; the spacecraft and the ground each have half of the range."""
    seen = depth > 0
    craft = seen & (depth < 1e3)
    shown = np.zeros(depth.shape)
    for mask, low, high in ((craft, 0.55, 1.0), (seen & ~craft, 0.08, 0.4)):
        near, far = np.log(depth[mask].min()), np.log(depth[mask].max())
        shown[mask] = high - (high - low) * (np.log(depth[mask]) - near) / (far - near)
    return np.repeat((255 * shown)[..., None], 3, axis=2).astype(np.uint8)


def panels(sample: perilune.Sample) -> list[U8]:
    """Normals, parts and depth."""
    hit = sample["part"][..., None] > 0
    normal = np.where(hit, 127.5 * (sample["normal"] * [1, -1, -1] + 1), 0).astype(np.uint8)
    return [normal, colored_ids(sample["part"]), depth_picture(sample["depth"])]


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--body", default="earth")
    parser.add_argument("--craft", default="iss")
    parser.add_argument("--height", type=int, default=720)
    parser.add_argument("--samples", type=int, default=64)
    parser.add_argument("--out", type=Path, default=ROOT / "docs" / "images" / "hero.png")
    options = parser.parse_args()
    height, width = options.height, options.height * 4 // 3
    config = scene(options.body, options.craft, width, options.samples)
    config["camera"] |= {"width": width, "height": height}
    sim = perilune.open(config, base=ROOT / "configs")
    sample = sim.frame(0, channels=["rgb", "normal", "part", "depth", "objects"])
    small = (width // PANELS, height // PANELS)
    whole = Image.new("RGB", (width + small[0], height))
    main_picture = Image.fromarray(sample["rgb"])
    left, top, across, down = (float(x) for x in sample.objects["bbox_visib"][0])
    box = (left, top, left + across, top + down)
    ImageDraw.Draw(main_picture).rectangle(box, outline=(90, 230, 120), width=2)
    whole.paste(main_picture, (0, 0))
    for k, panel in enumerate(panels(sample)):
        picture = Image.fromarray(panel).resize(small, Image.Resampling.BOX)
        whole.paste(picture, (width, k * small[1]))
    whole.save(options.out, optimize=True)


if __name__ == "__main__":
    main()
