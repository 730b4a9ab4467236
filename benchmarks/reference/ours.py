"""Perilune's own images of a frame, with other seeds for the samples alone."""

from __future__ import annotations

from typing import Any

import numpy as np

import perilune

from .scene import Array


def render(
    sim: perilune.Simulation,
    frame: int,
    samples: int,
    seeds: list[int],
    threads: int = 2,
    **quality: Any,
) -> Array:
    """(runs, H, W, 3) radiance; `quality`: keys of the request's section."""
    request = sim.request(frame)
    renderer = sim._mine().renderer_of(sim.world(frame).config)
    request["quality"] = {**request["quality"], "samples": samples, **quality}
    out = np.empty((len(seeds), request["height"], request["width"], 3), np.float32)
    for run, seed in enumerate(seeds):
        request["seed"] = seed
        renderer.render(request, {"radiance": out[run]}, threads)
    return out
