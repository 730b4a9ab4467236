"""Surfaces of the gallery's bodies that are finer than their maps: see gallery.py.

The maps of small worlds have texels of 3 to 15 km, too few for a spacecraft's view. Craters and
grain of the sizes below them are drawn here by graphs; they are no survey.
"""

from __future__ import annotations

import math
from typing import Any

Nodes = dict[str, Any]


def _math(function: str, a: Any, b: Any = 0.0, c: Any = 0.0) -> Nodes:
    return {"type": "math", "function": function, "a": a, "b": b, "c": c}


def _craters(name: str, cell_m: float, share: float, seed: int) -> Nodes:
    """Bowls with rims about random sites, in a share of the cells: `name` is their height in m.

    Sites under and above the ground make smaller bowls.
    """
    bowl = [[0.0, -1.0], [0.16, -0.85], [0.26, -0.25], [0.31, 0.30], [0.37, 0.10], [0.48, 0.0]]
    cells, kept, profile = f"{name}_cells", f"{name}_kept", f"{name}_profile"
    return {
        cells: {"type": "voronoi", "vector": "where", "scale": 1.0 / cell_m, "seed": seed},
        profile: {
            "type": "ramp",
            "value": f"{cells}.distance",
            "stops": [[at, height, height, height] for at, height in bowl],
        },
        f"{name}_drawn": {"type": "vector_math", "function": "dot", "a": f"{cells}.color",
                          "b": [1.0, 0.0, 0.0]},
        kept: _math("less_than", f"{name}_drawn.value", share),
        f"{name}_some": _math("multiply", profile, kept),
        name: _math("multiply", f"{name}_some", 0.05 * cell_m),
    }  # fmt: skip


def cratered(
    cell_m: float, law: str, strength: float = 1.0, share: float = 0.6, contrast: float = 0.6
) -> Nodes:
    """Craters of four sizes from about a third of a cell down, and grain of the soil, on a map.

    strength: of the slopes; share: of the cells that have a crater; contrast: of the grain.
    """
    sizes = {"a": cell_m, "b": cell_m / 2.7, "c": cell_m / 7.3, "d": cell_m / 20.0}
    nodes: Nodes = {"where": {"type": "coordinates"}, "own": {"type": "model_material"}}
    heights = None
    for seed, (name, size) in enumerate(sizes.items(), 3):
        nodes |= _craters(name, size, share, seed)
        if heights is not None:
            nodes[f"{name}_sum"] = _math("add", heights, name)
        heights = name if heights is None else f"{name}_sum"
    grain = {"type": "noise", "vector": "where", "scale": 4.0 / cell_m, "octaves": 9.0, "seed": 1}
    nodes |= {
        "relief": {"type": "bump", "height": heights, "distance_m": 1.0, "strength": strength},
        "grain": grain | {"roughness": 0.62},
        "shade": _math("multiply_add", "grain", contrast, 1.0 - 0.5 * contrast),
        "soil": {"type": "vector_math", "function": "multiply", "a": "own", "b": "shade"},
        "skin": {"type": law, "base_color": "soil", "normal": "relief"},
    }
    return {"nodes": nodes}


def _lines(name: str, apart_m: float, across: tuple[float, float, float], seed: int) -> Nodes:
    """Arcs some way apart, across a direction, not quite straight or even: `name` is 1 on them."""
    size = 1.0 / (apart_m * math.hypot(*across))
    drift, turns = f"{name}_drift", f"{name}_turns"
    step = {"type": "vector_math", "function": "dot", "a": "where"}
    noise = {"type": "noise", "vector": "where", "scale": 0.16 / apart_m}
    return {
        f"{name}_along": step | {"b": [size * part for part in across]},
        drift: noise | {"octaves": 3.0, "roughness": 0.35, "seed": seed},
        turns: _math("multiply_add", f"{drift}.value", 5.0, f"{name}_along.value"),
        f"{name}_part": _math("fraction", turns),
        f"{name}_off": _math("subtract", f"{name}_part", 0.5),
        f"{name}_away": _math("absolute", f"{name}_off"),
        f"{name}_near": _math("smoothstep", f"{name}_away", 0.002, 0.022),
        f"{name}_line": _math("subtract", 1.0, f"{name}_near"),
        # They end where another noise is low.
        f"{name}_where": noise | {"octaves": 4.0, "seed": seed + 20},
        f"{name}_kept": _math("smoothstep", f"{name}_where.value", 0.42, 0.56),
        name: _math("multiply", f"{name}_line", f"{name}_kept"),
    }


def icy(cell_m: float) -> Nodes:
    """Ice from white to brown by the map's grey, with dark lines in three directions."""
    nodes: Nodes = {"where": {"type": "coordinates"}, "own": {"type": "model_material"}}
    nodes |= _lines("a", cell_m, (0.3, 0.2, 0.9), 5)
    nodes |= _lines("b", cell_m * 0.62, (0.8, -0.3, 0.5), 6)
    nodes |= _lines("c", cell_m * 0.37, (-0.5, 0.8, 0.6), 7)
    ice = [[0.12, 0.34, 0.23, 0.14], [0.26, 0.62, 0.55, 0.45], [0.4, 0.90, 0.90, 0.88]]
    hills = {"type": "noise", "vector": "where", "scale": 12.0 / cell_m, "octaves": 8.0, "seed": 2}
    nodes |= {
        "grey": {"type": "vector_math", "function": "dot", "a": "own.base_color", "b": [1, 0, 0]},
        "hills": hills | {"roughness": 0.6},
        "uneven": _math("subtract", "hills.value", 0.5),
        "patchy": _math("multiply_add", "uneven", 0.25, "grey.value"),
        "ice": {"type": "ramp", "value": "patchy", "stops": ice},
        "ab": _math("maximum", "a", "b"),
        "abc": _math("maximum", "ab", "c"),
        "dark": _math("multiply", "abc", 0.55),
        "tinted": {"type": "mix", "factor": "dark", "a": "ice", "b": [0.28, 0.17, 0.10]},
        "high": _math("multiply_add", "abc", 0.35, "hills.value"),
        "relief": {"type": "bump", "height": "high", "distance_m": cell_m * 0.02},
        "skin": {"type": "lambert", "base_color": "tinted", "normal": "relief"},
    }
    return {"nodes": nodes}


def lands() -> Nodes:
    """Land and sea of the Earth, by what of its map is bluer than red: the land gets grain."""
    nodes: Nodes = {"where": {"type": "coordinates"}, "own": {"type": "model_material"}}
    dot = {"type": "vector_math", "function": "dot", "a": "own.base_color"}
    grain = {"type": "noise", "vector": "where", "roughness": 0.65, "octaves": 10.0}
    nodes |= {
        "warm": dot | {"b": [1.0, 0.0, -0.75]},
        "land": _math("smoothstep", "warm.value", -0.02, 0.03),
        "grain": grain | {"scale": 1.0 / 60e3, "seed": 8},
        "uneven": _math("subtract", "grain.value", 0.5),
        "much": _math("multiply", "land", 1.6),
        "shade": _math("multiply_add", "uneven", "much", 1.0),
        "ground": {"type": "vector_math", "function": "multiply", "a": "own", "b": "shade"},
        "skin": {"type": "lambert", "base_color": "ground"},
    }
    return {"nodes": nodes}
