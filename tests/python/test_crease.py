"""Normals that a file smooths over hard edges: what is seen of them, and who is told."""

from __future__ import annotations

import math

import numpy as np
import pytest
from tests.python.model_files import SATELLITE, melted_box

import perilune
from perilune import _core
from perilune.config.errors import ConfigError
from perilune.document.loader import read_tree


def opened(repo_dir, model, **craft):
    tree = read_tree(repo_dir / "tests/python/scene.yaml")
    tree["spacecraft"]["sat"].update(model=str(model), **craft)
    return perilune.open(tree, base=repo_dir)


def lean_deg(sample):
    """Largest angle between the shading normals of the spacecraft and its facets' own."""
    here = sample["instance"] == sample["instance"].max()
    cosine = (sample["normal"] * sample["geometric_normal"]).sum(axis=-1)[here]
    return math.degrees(math.acos(cosine.min()))


CHANNELS = ["rgb", "normal", "geometric_normal", "instance"]


def test_flat_faces_are_shaded_flat(repo_dir, tmp_path):
    """Up to 54.7 degrees were between a box and its shading; warned of, and off at 180."""
    box = melted_box(tmp_path / "box.glb")
    with pytest.warns(UserWarning, match="8 vertices have one normal for faces"):
        sharp = opened(repo_dir, box).frame(0, CHANNELS)
    melted = opened(repo_dir, box, crease_angle_deg=180.0).frame(0, CHANNELS)
    assert lean_deg(sharp) < 0.1
    assert lean_deg(melted) > 40.0
    assert np.array_equal(sharp["geometric_normal"], melted["geometric_normal"])


def test_well_made_models_stay_to_the_bit():
    plain = _core.Model(str(SATELLITE)).mesh()
    creased = _core.Model(str(SATELLITE), math.radians(65.0))
    assert creased.warnings == _core.Model(str(SATELLITE)).warnings
    for name, values in creased.mesh().items():
        assert np.array_equal(values, plain[name]), name


@pytest.mark.parametrize("angle", [0.0, 65.0, 89.9, 90.1, 180.0])
def test_the_angle_is_that_between_faces(tmp_path, angle):
    model = _core.Model(str(melted_box(tmp_path / "box.glb")), math.radians(angle))
    assert model.vertex_count == (24 if angle < 90.0 else 8)
    assert len(model.warnings) == (angle < 90.0)


def test_angles_that_are_none(repo_dir, tmp_path):
    box = melted_box(tmp_path / "box.glb")
    for angle in (-1.0, 181.0, float("nan")):
        with pytest.raises(ConfigError, match="crease_angle_deg"):
            opened(repo_dir, box, crease_angle_deg=angle)
    with pytest.raises(ValueError, match="crease_angle_rad"):
        _core.Model(str(box), float("nan"))


def test_panels_of_a_published_model(data_dir):
    """TDRS: 44 % of its area leaned by more than 44 degrees from its shading."""
    path = str(data_dir / "spacecraft/plain/tdrs_a.glb")

    def leaning(model):
        mesh = model.mesh()
        corners = mesh["positions"].astype(float)[mesh["indices"]]
        face = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        area = np.linalg.norm(face, axis=1)
        normal = mesh["normals"].astype(float)[mesh["indices"]]
        with np.errstate(invalid="ignore"):
            cosine = np.abs((normal * (face / area[:, None])[:, None]).sum(-1)).min(-1)
        return area[cosine < math.cos(math.radians(44.0))].sum() / area.sum()

    assert leaning(_core.Model(path)) > 0.4
    assert leaning(_core.Model(path, math.radians(65.0))) < 0.02
