"""Draws docs/images/labels.png: labels of an orbit, an asteroid, a landing and a rover's scene."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import matplotlib.pyplot as plt
import numpy as np

import perilune
from perilune.show.preview.panels import Context, Panel, channel_panels

ROOT = Path(__file__).resolve().parents[2]
SIZE = {"camera.width": 320, "camera.height": 240}
SCENES: dict[str, tuple[str, int, dict[str, Any], list[str]]] = {
    "orbit": ("demo", 0, {},
              ["rgb", "depth", "part", "cloud_opacity", "coverage/1", "shadow_cause"]),
    "asteroid": ("phobos", 1, {"time.frames_per_scene": 5},
                 ["rgb", "depth", "normal", "instance", "flow", "shadow_cause"]),
    "landing": ("lunar_lander", 40, {},
                ["rgb", "depth", "normal", "slope_baseline/0", "hazard", "crater_id"]),
    "rover": ("lunar_rover", 2, {},
              ["rgb", "depth", "normal", "rock_id", "crater_id", "shadow_cause"]),
}  # fmt: skip


def panels(config: str, index: int, changes: dict[str, Any], asked: list[str]) -> list[Panel]:
    sim = perilune.open(ROOT / "configs" / f"{config}.yaml", overrides=SIZE | changes)
    names = list(dict.fromkeys(title.partition("/")[0] for title in asked))
    sample = sim.frame(index, list(dict.fromkeys([*names, "depth", "instance"])))
    units = {row["name"]: row["unit"] for row in perilune._core.CHANNELS}
    context = Context(sample["depth"] > 0.0, sample["instance"], sim.taxonomy.channel_names, units)
    shown = [panel for name in names for panel in channel_panels(name, sample[name], context)]
    titled = {panel.title.removesuffix(" (log)"): panel for panel in shown}
    return [titled[title] for title in asked]


def main() -> None:
    rows = {name: panels(*row) for name, row in SCENES.items()}
    figure, axes = plt.subplots(len(rows), 6, figsize=(13.2, 7.4), dpi=100, facecolor="#121318")
    for line, (name, row) in zip(axes, rows.items(), strict=True):
        for axis, panel in zip(line, row, strict=True):
            axis.imshow(np.asarray(panel.image))
            axis.set_title(panel.title, color="0.8", fontsize=9, loc="left")
            axis.set_xticks([])
            axis.set_yticks([])
        line[0].set_ylabel(name, color="0.8", fontsize=10)
    figure.tight_layout()
    figure.savefig(ROOT / "docs" / "images" / "labels.png")


if __name__ == "__main__":
    main()
