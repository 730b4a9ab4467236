"""The node `model_material`: graphs that are the model's material as it is, or build upon it."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import perilune
from perilune.config.errors import ConfigError

SCENE = Path(__file__).parent / "scene.yaml"
MAP = "../../assets/maps/earth_like.jpg"
AS_IS: dict[str, Any] = {
    "own": {"type": "model_material"},
    "skin": {
        "type": "metallic_roughness",
        "base_color": "own.base_color",
        "metallic": "own.metallic",
        "roughness": "own.roughness",
        "emission_color": "own.emission",
        "emission_strength": 1,
        "normal": "own.normal",
    },
}


def opened(nodes: dict[str, Any], **more: Any) -> perilune.Simulation:
    changes = {
        "materials": {"m": {"nodes": nodes}},
        "spacecraft.sat.materials": [{"material": "*", "use": "m"}],
    }
    return perilune.open(SCENE, overrides={**changes, **more})


def on_body(nodes: dict[str, Any], **body: Any) -> perilune.Simulation:
    material = {"materials": {"m": {"nodes": nodes}}}
    earth = {"kind": "earth", "material": "m", **body}
    return perilune.open(SCENE, overrides={**material, "bodies.earth": earth})


def test_a_material_as_it_is() -> None:
    """The model's materials are metallic-roughness without maps: within rounding of a root."""
    plain, graph = perilune.open(SCENE), opened(AS_IS)
    close = np.abs(plain[0]["rgb"].astype(int) - graph[0]["rgb"])
    assert close.max() <= 1
    bounds = [{row["name"]: row["bound_dn"] for row in sim.plan(0)} for sim in (plain, graph)]
    for name in ("emitted_light", "emitters", "body_bounces", "bump_detail"):
        assert bounds[0][name] == bounds[1][name]


def test_a_graph_builds_upon_the_models_colours() -> None:
    """Half the colour of Lambert surfaces is half the light."""

    def light(*factor: float) -> Any:
        nodes = {
            "own": {"type": "model_material"},
            "c": {"type": "vector_math", "function": "multiply", "a": "own", "b": list(factor)},
            "skin": {"type": "lambert", "base_color": "c"},
        }
        sim = opened(nodes, **{"render.max_bounces": 0, "render.samples": 8})
        sample = sim.frame(0, ["radiance", "instance"])
        return sample["radiance"][sample["instance"] == sample["instance"].max()]

    whole, part = light(1.0, 1.0, 1.0), light(0.5, 1.0, 0.25)
    inside = whole.min(axis=1) > 1.0
    assert inside.sum() > 50
    ratio = np.median(part[inside] / whole[inside], axis=0)
    assert np.allclose(ratio, [0.5, 1.0, 0.25], rtol=1e-3)


def test_a_bodys_own_map() -> None:
    nodes = {"own": {"type": "model_material"}, "skin": {"type": "lambert", "base_color": "own"}}
    above = {
        "spacecraft": {},
        "camera.trajectory": {"kind": "orbit_object", "target": "earth", "distance_m": 2e7},
        "camera.fov_deg": 30,
        "camera.exposure": {"mode": "fixed", "white_radiance_w_m2_sr": 400},
        "render.samples": 32,
    }
    images = []
    for sim in (
        perilune.open(SCENE, overrides={"bodies.earth.color_map": MAP, **above}),
        perilune.open(
            SCENE,
            overrides={
                "materials": {"m": {"nodes": nodes}},
                "bodies.earth": {"kind": "earth", "material": "m", "color_map": MAP},
                **above,
            },
        ),
    ):
        images.append(sim.frame(0, ["radiance"])["radiance"].astype(float))
    # Sampled, not in closed form: pixels have noise, their mean has little.
    assert images[0].mean() > 5.0
    assert np.abs(images[1] - images[0]).mean() < 0.05 * images[0].mean()
    # Samples read a fine map more softly than the closed form does.
    assert images[1].mean() == pytest.approx(images[0].mean(), rel=1e-2)


def test_keys_of_a_body_that_its_graph_does_not_use_are_errors() -> None:
    own = {"own": {"type": "model_material"}, "skin": {"type": "lambert", "base_color": "own"}}
    on_body(own, albedo=[0.3, 0.3, 0.3], color_map=MAP)
    with pytest.raises(ConfigError, match=r"bodies\.earth\.reflectance: the material 'm' replaces"):
        on_body(own, reflectance="lambert")
    with pytest.raises(ConfigError, match=r"bodies\.earth\.color_map: the material 'm' replaces"):
        on_body({"skin": {"type": "lambert"}}, color_map=MAP)
