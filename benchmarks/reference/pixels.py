"""What each pixel shows, to name what remains between two images."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from .by_mitsuba import describe
from .scene import Array, Material, Scene

SAMPLES = 16


def first_hits(scene: Scene, folder: Path) -> dict[str, Array]:
    """owner (H, W): index of the mesh that fills the pixel, -1 for the sky, -2 where several do;
    back (H, W): its triangles are seen from behind; uses Mitsuba."""
    import mitsuba

    mitsuba.set_variant("scalar_rgb")
    described = describe(mitsuba, scene, SAMPLES, folder)
    names = [f"mesh{i}" for i in range(len(scene.meshes))]
    for i, name in enumerate(names):
        described[name].pop("emitter", None)
        described[name]["bsdf"] = {"type": "diffuse"}
        described[name]["id"] = str(i)
    kept = {key: described[key] for key in ("type", "sensor", *names)}
    kept["integrator"] = {"type": "aov", "aovs": "index:shape_index,ng:geo_normal,p:position"}
    loaded = mitsuba.load_dict(kept, optimize=False)  # which would join meshes
    order = np.array([int(shape.id()) for shape in loaded.shapes()])
    runs = [np.array(mitsuba.render(loaded, seed=seed)) for seed in range(2)]
    index = np.stack([run[..., 0] for run in runs])
    normal, place = runs[0][..., 1:4], runs[0][..., 4:7]
    whole = np.isclose(index[0], np.round(index[0]), atol=1e-4) & np.isclose(*index, atol=1e-4)
    # Shapes count from 1; the sky is 0.
    owner = np.where(whole, np.append(-1, order)[np.round(index[0]).astype(int)], -2)
    return {"owner": owner, "back": (normal * place).sum(-1) > 0.0}


def kind(material: Material) -> str:
    """In a word."""
    if material.lambert:
        return "Lambert"
    if material.waves is not None:
        return "water"
    if material.metallic == (0.0,):
        word = "dielectric"
    elif material.metallic == (1.0,):
        word = "metal"
    else:
        word = "mixture"
    return word + (", bumps" if material.normal is not None else "")


def classes(scene: Scene, hits: dict[str, Array]) -> Array:
    """(H, W) of words."""
    kinds = [kind(scene.materials[mesh.material]) for mesh in scene.meshes]
    table = np.array([*kinds, "outlines", "sky"], dtype=object)
    out = table[hits["owner"]]
    single = [not scene.materials[mesh.material].double_sided for mesh in scene.meshes]
    single += [False, False]
    behind = hits["back"] & np.array(single)[hits["owner"]] & (hits["owner"] >= 0)
    out[behind] = "back of single-sided"
    if scene.air:
        out[out == "sky"] = "air and sky"
    return np.asarray(out)


def shares(scene: Scene, hits: dict[str, Array], square: dict[str, Array]) -> list[list[Any]]:
    """Rows of class, part of the pixels, and for each pair RMS there, DN, and its part of the
    whole; square: mean square differences (H, W) by pair."""
    words = classes(scene, hits)
    rows: list[list[Any]] = []
    for word in sorted(set(words.reshape(-1))):
        here = words == word
        row: list[Any] = [word, float(here.mean())]
        for values in square.values():
            if np.isnan(values).any():  # not rendered
                row += ["-", "-"]
                continue
            row.append(float(np.sqrt(max(0.0, values[here].mean()))))
            row.append(float(values[here].sum() / max(values.sum(), 1e-12)))
        rows.append(row)
    return rows
