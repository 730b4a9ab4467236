"""The channels `coverage` and `coverage_instance`: parts of pixels, beside areas that are known."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from tests.python.optics_scenes import at, ball, opened, tree

import perilune
from perilune.config import ConfigError

DEMO = Path(__file__).resolve().parents[2] / "configs" / "demo.yaml"
BOTH = ["coverage", "coverage_instance", "instance"]


def part_of(sample: perilune.Sample, instance: int) -> NDArray[Any]:
    """(H, W): part of each pixel that an instance covers."""
    return np.where(sample["coverage_instance"] == instance, sample["coverage"], 0.0).sum(axis=2)


def images_area_px(focal_px: float, place: list[float], radius: float) -> float:
    """Area of the image of a sphere, whose outline is a conic: pi f^2 sin^2 a cos a /
    (cos^2 b - sin^2 a)^(3/2), for the angular radius a and the angle b to the axis."""
    depth, aside = place[0], np.hypot(*place[1:])
    distance = np.hypot(depth, aside)
    sine, cosine = radius / distance, depth / distance
    own = np.sqrt(1.0 - sine**2)
    return float(np.pi * focal_px**2 * sine**2 * own / (cosine**2 - sine**2) ** 1.5)


def test_the_area_of_a_ball(repo_dir: Path) -> None:
    """Sums of parts are areas: the error falls with samples."""
    scene = tree((64, 48), 60.0, ball=ball(at(10.0, 1.0, -0.7), 1.9))
    expected = images_area_px(60.0, [10.0, 1.0, -0.7], 1.9)
    sim = opened(scene, repo_dir)
    errors = []
    for samples in (1, 16, 256):
        sample = opened(scene | {"labels": {"coverage": {"samples": samples}}}, repo_dir).frame(
            0, BOTH
        )
        errors.append(abs(part_of(sample, sim.taxonomy.instances["ball"]).sum() / expected - 1.0))
    assert errors[0] < 0.03
    assert errors[1] < 2e-3
    assert errors[2] < 2e-4


def satellite(size: tuple[int, int], focal_px: float, samples: int = 16) -> dict[str, Any]:
    """The satellite before a ball."""
    scene = tree(size, focal_px, far=ball(at(40.0), 12.0))
    scene["spacecraft"]["sat"] = {
        "model": "assets/models/smallsat.glb",
        "size_m": 6.0,
        "orbit": {"around": "anchor", "position_km": at(12.0, 1.5)},
        "attitude": {"rotation_deg": [20.0, 30.0, 40.0]},
    }
    return scene | {"labels": {"coverage": {"samples": samples}}}


def test_parts_of_a_spacecraft_beside_a_finer_frame(repo_dir: Path) -> None:
    """The mean of `instance` over 16 x 16 smaller pixels, which have rays of their own."""
    sim = opened(satellite((640, 480), 800.0), repo_dir)
    number = sim.taxonomy.instances["sat"]
    fine = sim.frame(0, ["instance"])
    blocks = (fine["instance"] == number).reshape(30, 16, 40, 16)
    expected = blocks.mean(axis=(1, 3))
    edges = (expected > 0.0) & (expected < 1.0)
    assert edges.sum() > 30
    errors = []
    for samples in (4, 16, 64, 256):
        sample = opened(satellite((40, 30), 50.0, samples), repo_dir).frame(0, BOTH)
        wrong = (part_of(sample, number) - expected)[edges]
        errors.append(float(np.sqrt(np.mean(wrong**2))))
    slope = np.polyfit(np.log([4, 16, 64]), np.log(errors[:3]), 1)[0]
    assert slope < -0.5
    assert errors[-1] < 0.01


def test_layers_hold_what_is_seen(repo_dir: Path) -> None:
    scene = tree(
        (48, 32),
        60.0,
        far=ball(at(20.0), 4.0),
        near=ball(at(8.0, 1.0), 0.8),
        small=ball(at(6.0, -0.3, 0.2), 0.1),
    )
    scene["labels"] = {"coverage": {"samples": 64, "layers": 3}}
    sample = opened(scene, repo_dir).frame(0, BOTH)
    parts, ids = sample["coverage"], sample["coverage_instance"]
    assert parts.shape == ids.shape == (32, 48, 3)
    assert np.all(np.diff(parts, axis=2) <= 0.0), "the largest comes first"
    assert parts.sum(axis=2).max() <= 1.0
    assert np.array_equal(parts > 0.0, ids != 0)
    assert (np.any(ids == sample["instance"][..., None], axis=2) | (sample["instance"] == 0)).all()
    assert ((ids[..., 0] == ids[..., 1]) & (ids[..., 1] != 0)).sum() == 0
    assert (ids != 0).sum(axis=2).max() > 1


def test_what_has_no_layer_is_summed(repo_dir: Path) -> None:
    """Five balls in one pixel and the sky, in two layers: the largest, and the rest."""
    places = [(0.0, 0.0), (1.0, 1.0), (-1.0, 1.0), (1.0, -1.0), (-1.0, -1.0)]
    balls = {
        f"ball_{k}": ball(at(10.0, *place), 0.6 if k == 0 else 0.4)
        for k, place in enumerate(places)
    }
    scene = tree((1, 1), 3.0, **balls)
    found = {}
    for layers in (2, 8):
        scene["labels"] = {"coverage": {"samples": 256, "layers": layers}}
        found[layers] = opened(scene, repo_dir).frame(0, BOTH)
    ids = found[2]["coverage_instance"][0, 0]
    all_ids = found[8]["coverage_instance"][0, 0]
    assert ids[0] == all_ids[0] == found[8]["instance"][0, 0]
    assert ids[1] == -1
    assert (all_ids != 0).sum() == 5
    rest = found[8]["coverage"][0, 0, 1:].sum()
    assert found[2]["coverage"][0, 0, 1] == pytest.approx(rest, abs=1e-6)


def test_labels_of_it_know_no_colour_and_no_threads(repo_dir: Path) -> None:
    alone = opened(satellite((40, 30), 50.0), repo_dir).frame(0, ["coverage"], threads=1)[
        "coverage"
    ]
    scene = satellite((40, 30), 50.0)
    scene["render"]["samples"] = 2
    other = opened(scene, repo_dir).frame(0, ["rgb", *BOTH], threads=2)
    assert np.array_equal(alone, other["coverage"])


@pytest.mark.parametrize(("key", "value"), [("samples", 0), ("samples", 1025), ("layers", 17)])
def test_numbers_out_of_range_are_refused(key: str, value: int) -> None:
    with pytest.raises(ConfigError, match=f"labels.coverage.{key}"):
        perilune.open(DEMO, overrides={f"labels.coverage.{key}": value})
