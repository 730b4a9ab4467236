"""Normals as labels: on the viewer's side, and the facets' own."""

from __future__ import annotations

import numpy as np
import pytest

import perilune


def rays(sample):
    """(H, W, 3): unit directions of the pixels, camera axes; the lens is a pinhole."""
    K = sample.camera.K
    v, u = np.indices((sample.camera.height, sample.camera.width))
    d = np.stack([(u - K[0, 2]) / K[0, 0], (v - K[1, 2]) / K[1, 1], np.ones(u.shape)], axis=-1)
    return d / np.linalg.norm(d, axis=-1, keepdims=True)


@pytest.fixture(scope="module")
def samples(repo_dir):
    """A satellite with rounded parts; 20 of 43 000 pixels had normals beyond 90 degrees."""
    size = {"camera.width": 192, "camera.height": 128}
    sim = perilune.open(repo_dir / "tests/python/scene.yaml", overrides=size)
    names = ["normal", "geometric_normal", "emission", "position", "instance", "part"]
    return [sim.frame(index, names) for index in range(6)]


def test_no_normal_points_away_from_the_viewer(samples):
    for sample in samples:
        hit = sample["instance"] > 0
        for name in ("normal", "geometric_normal"):
            cosine = -(sample[name] * rays(sample)).sum(axis=-1)[hit]
            assert cosine.min() > -1e-6, name
            assert np.abs(np.linalg.norm(sample[name][hit], axis=-1) - 1.0).max() < 1e-6
            assert not sample[name][~hit].any()
        # The angle that is given is that of the normal that is given.
        cosine = -(sample["normal"] * rays(sample)).sum(axis=-1)[hit]
        assert np.abs(np.cos(sample["emission"][hit]) - cosine).max() < 1e-5
        assert sample["emission"][hit].max() <= 0.5 * np.pi + 1e-6


def test_geometric_normals_are_of_the_surface_that_is_seen(samples):
    """Neighbouring positions on one facet lie across its normal; interpolated normals do not."""
    facing, leaning = [], []
    for sample in samples:
        flat = np.abs(np.diff(sample["geometric_normal"], axis=1)).max(axis=-1) < 1e-6
        same = flat & (np.diff(sample["part"], axis=1) == 0) & (sample["instance"][:, 1:] == 2)
        camera = np.diff(sample["position"], axis=1) @ sample.camera.R_w2c.T
        step = camera[same] / np.linalg.norm(camera[same], axis=-1, keepdims=True)
        facing.append(np.abs((step * sample["geometric_normal"][:, 1:][same]).sum(axis=-1)))
        leaning.append(np.abs((step * sample["normal"][:, 1:][same]).sum(axis=-1)))
    facing, leaning = np.concatenate(facing), np.concatenate(leaning)
    assert len(facing) > 3000
    # Parallel facets one behind the other are the exception.
    assert np.quantile(facing, 0.97) < 1e-4
    assert np.quantile(leaning, 0.97) > np.quantile(facing, 0.97)
