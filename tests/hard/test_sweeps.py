"""Short sweeps over sizes, distances and configurations; script/soak has the long ones."""

from __future__ import annotations

import numpy as np
import pytest
from tests.hard import sweeps


def test_a_ball_of_any_size_from_any_distance():
    """Radii of 1 m to 1e8 m from 1 cm to 1e9 m: depth, normals, limb and light by closed forms."""
    findings, most = sweeps.sizes(2)
    assert findings == []
    assert most["depth"] > 0.0  # single precision, at least: something was compared


@pytest.mark.parametrize("name", ["fictional", "lunar_rover"])
def test_frames_of_drivers_wide_open(name, repo_dir):
    sim = sweeps.opened(repo_dir / "configs" / f"{name}.yaml")
    assert sim is not None
    assert sim.config.camera.width == 12
    assert sweeps.faults(sim, 7) == []


def test_faults_are_found(monkeypatch, repo_dir):
    """Negative light and unknown ids are told."""
    sim = sweeps.opened(repo_dir / "configs" / "fictional.yaml")
    whole = sim.frame(7, sweeps.CHANNELS, threads=1)
    whole["radiance"][0, 0] = -1.0
    whole["instance"][0, 0] = 77
    whole["depth"][0, 0] = np.nan
    monkeypatch.setattr(type(sim), "frame", lambda *_, **__: whole)
    assert [text.split()[0] for text in sweeps.faults(sim, 7)] == ["radiance", "depth", "an"]
