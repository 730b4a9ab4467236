"""Draws docs/images/lidar.png and events.png: scans of a lander's site and of a space station, and
events of a satellite that turns."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import matplotlib.pyplot as plt
import numpy as np

import perilune

ROOT = Path(__file__).resolve().parents[2]
IMAGES = ROOT / "docs" / "images"


def scanned(config: str, width_deg: float, columns: int, rows: int, **keys: Any) -> Any:
    """A raster scan along the camera's axis."""
    pattern = {"kind": "raster", "columns": columns, "rows": rows, "width_deg": width_deg,
               "height_deg": width_deg * rows / columns}  # fmt: skip
    sim = perilune.open(ROOT / config, overrides={"lidars": {"top": {"pattern": pattern, **keys}}})
    return sim.lidar(0)


def show(axes: Any, scan: Any, values: Any, title: str, label: str) -> None:
    """Returns by the direction of their beams, as the sensor sees them."""
    x, y, z = scan["sensor_direction"].T
    most = float(np.quantile(values, 0.99))
    place = np.degrees(x / z), -np.degrees(y / z)
    dots = axes.scatter(*place, c=values, s=9, marker="s", linewidths=0, vmax=most)
    axes.set(title=title, aspect="equal", facecolor="black")
    plt.colorbar(dots, ax=axes, label=label, shrink=0.8)


def lidar_picture() -> None:
    ground = scanned("configs/lunar_lander.yaml", 40.0, 220, 165, divergence_deg=0.05)
    station = scanned("configs/iss_leo.yaml", 24.0, 240, 180, range_m=[0.1, 1e4])
    figure, axes = plt.subplots(2, 2, figsize=(11, 8.5), dpi=90)
    show(axes[0, 0], ground, ground["range_m"], "Landing site", "range, m")
    show(axes[0, 1], ground, np.degrees(ground["incidence_rad"]), "Its incidence", "degrees")
    show(axes[1, 0], station, station["range_m"], "Station", "range, m")
    parts = np.unique(station["part"], return_inverse=True)[1] % 20
    show(axes[1, 1], station, parts, "Its parts", "part")
    figure.tight_layout()
    figure.savefig(IMAGES / "lidar.png")


def events_picture() -> None:
    changes = {
        "camera.width": 160, "camera.height": 120, "camera.fov_deg": 35, "time.step_s": 0.1,
        "spacecraft.smallsat.attitude.spin_rate_deg_s": 40, "render.samples": 16,
        "camera.trajectory.background": None,
        "events": {"dark_radiance_w_m2_sr": 2.0, "instants": 8, "max_halvings": 1},
    }  # fmt: skip
    sim = perilune.open(ROOT / "configs/demo.yaml", overrides=changes)
    events, sample = sim.events(0), sim.frame(0, ["rgb"])
    counts = np.zeros((120, 160, 2))
    np.add.at(counts, (events["y"], events["x"], (events["polarity"] < 0).astype(int)), 1)
    figure, axes = plt.subplots(1, 2, figsize=(11, 4.2), dpi=90)
    axes[0].imshow(sample["rgb"])
    shown = np.zeros((120, 160, 3))
    shown[..., 0], shown[..., 2] = (
        np.minimum(counts[..., 0] / 6, 1),
        np.minimum(counts[..., 1] / 6, 1),
    )
    axes[1].imshow(shown)
    axes[0].set(title="Frame")
    axes[1].set(title=f"{len(events)} events in 0.1 s: brighter red, darker blue")
    figure.tight_layout()
    figure.savefig(IMAGES / "events.png")


if __name__ == "__main__":
    events_picture()
    lidar_picture()
