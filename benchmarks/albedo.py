"""Albedos of painted surfaces under an even sky: Perilune's, Mitsuba's and Cycles'.

A dielectric of index 1.5 over a Lambert base, by colour and roughness, at angles from the normal:
the principled surface of material graphs, Mitsuba's `roughplastic` with `nonlinear` off and
`principled` (if `mitsuba` is installed), and, with `--python`, a Python that has `bpy`, Cycles'
Principled. A surface that keeps all light has an albedo of 1 if it is white.
"""

from __future__ import annotations

import json
import subprocess
import tempfile
from pathlib import Path
from typing import Any

import numpy as np
import report

from perilune import _core

COLORS = (0.0, 0.2, 0.8, 1.0)
ROUGHNESSES = (0.1, 0.3, 0.5, 0.7, 1.0)
ANGLES_DEG = (0, 40, 60, 70)
DRAWS = 1 << 14
THEIR_DRAWS = 4096

Albedos = list[list[float]]


def directions() -> np.ndarray:
    angles = np.radians(np.array(ANGLES_DEG, dtype=float))
    return np.stack([np.sin(angles), np.zeros(len(angles)), np.cos(angles)], -1)


def own(paints: list[tuple[float, float]]) -> Albedos:
    names = [socket["name"] for socket in _core.NODES["principled"]["inputs"]]
    none = np.empty((0, 4), np.float32)
    out = []
    for color, roughness in paints:
        given = {"base_color": color, "roughness": roughness, "ior": 1.5}
        inputs = tuple(
            ("constant", 0, 0, *3 * (given[name],)) if name in given else ("unset", 0, 0, 0, 0, 0)
            for name in names
        )
        graph = _core.Graph((("paint", "principled", inputs, ()),), 0, 0, False)
        out.append(graph.albedo(directions(), DRAWS, none)[:, 0].tolist())
    return out


def mitsuba_albedo(bsdf: Any, rng: np.random.Generator) -> list[float]:
    import mitsuba as mi

    si, context, out = mi.SurfaceInteraction3f(), mi.BSDFContext(), []
    for wo in directions():
        si.wi = mi.Vector3f(*wo.tolist())
        total = 0.0
        for choice, u, v in rng.random((THEIR_DRAWS, 3)).tolist():
            total += float(bsdf.sample(context, si, choice, mi.Point2f(u, v))[1][0])
        out.append(total / THEIR_DRAWS)
    return out


def mitsubas(paints: list[tuple[float, float]], kind: str) -> Albedos:
    import mitsuba as mi

    mi.set_variant("scalar_rgb")
    out = []
    for color, roughness in paints:
        rgb = {"type": "rgb", "value": color}
        plastic = {
            "type": "roughplastic",
            "distribution": "ggx",
            "alpha": roughness**2,
            "int_ior": 1.5,
            "ext_ior": 1.0,
            "nonlinear": False,
            "diffuse_reflectance": rgb,
        }
        principled = {
            "type": "principled",
            "base_color": rgb,
            "roughness": roughness,
            "eta": 1.5,
        }
        bsdf = mi.load_dict(plastic if kind == "roughplastic" else principled)
        out.append(mitsuba_albedo(bsdf, np.random.default_rng(1)))
    return out


def cycles(paints: list[tuple[float, float]], python: str) -> Albedos:
    script = Path(__file__).with_name("albedo_cycles.py")
    with tempfile.TemporaryDirectory() as folder:
        (Path(folder) / "paints.json").write_text(json.dumps(paints))
        words = [python, str(script), folder, *map(str, ANGLES_DEG)]
        subprocess.run(words, check=True, stdout=subprocess.DEVNULL)
        found: Albedos = json.loads((Path(folder) / "albedo.json").read_text())
    return found


def main() -> None:
    parser = report.arguments(__doc__)
    parser.add_argument("--python", help="a Python that has bpy; without it no Cycles")
    options = parser.parse_args()
    paints = [(color, roughness) for color in COLORS for roughness in ROUGHNESSES]
    found = {"perilune": own(paints)}
    try:
        for kind in ("roughplastic", "principled"):
            found[f"mitsuba {kind}"] = mitsubas(paints, kind)
    except ImportError:
        print("mitsuba is not installed: left out")
    if options.python:
        found["cycles principled"] = cycles(paints, options.python)
    rows: list[list[object]] = [
        [*paint, name, *albedos[i]]
        for i, paint in enumerate(paints)
        for name, albedos in found.items()
    ]
    ours = np.array(found["perilune"])
    off = [
        [name, *np.abs(np.array(albedos) - ours).max(0).tolist()]
        for name, albedos in found.items()
        if name != "perilune"
    ]
    angles = [f"{degrees} deg" for degrees in ANGLES_DEG]
    report.publish(
        options.json,
        {"angles_deg": ANGLES_DEG, "paints": paints, "albedos": found},
        [
            report.table(["colour", "roughness", "by", *angles], rows),
            report.table(["largest difference from ours", *angles], off),
        ],
    )


if __name__ == "__main__":
    main()
