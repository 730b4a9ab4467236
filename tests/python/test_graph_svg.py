"""Pictures of material graphs: what they show, that nothing overlaps, that links go rightwards."""

from __future__ import annotations

import copy
import itertools
import re
import xml.etree.ElementTree as ET
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given, settings, strategies as st

import perilune
from perilune.cli import main
from perilune.show.graphs import draw
from perilune.show.graphs.boxes import Box, Link, Row
from perilune.show.graphs.layout import HEADER, LINE, Picture, Placed, place, size_of
from perilune.show.graphs.write import write

SCENE = Path(__file__).parent / "scene.yaml"
SVG = "{http://www.w3.org/2000/svg}"
ORANGE = "#e0660b"
SCALE = {"ideal": 5.0, "jitter_variance": 4.5, "clip_min": 3.0, "clip_max": 10.0}
FOIL: dict[str, Any] = {
    "nodes": {
        "where": {"type": "coordinates"},
        "OAISYS_scale": {"type": "value", "value": 5.0},
        "noise": {"type": "musgrave", "vector": "where", "scale": "OAISYS_scale", "octaves": 6},
        "paint": {"type": "ramp", "value": "noise", "stops": [[0, 0, 0, 0], [1, 1, 0.5, 0]]},
        "driver:tint": {"type": "color", "color": 0.5},
        "both": {"type": "mix", "a": "paint", "b": "driver:tint", "factor": 0.25},
        "bits": {"type": "value"},
        "skin": {
            "type": "principled",
            "base_color": "both",
            "roughness": {"uniform": [0.25, 0.75]},
        },
    },
    "drivers": {"drivers": {"scale": SCALE}, "jitter_strength": 1.5, "step_interval": 3},
}


def opened(**changes: Any) -> perilune.Simulation:
    uses = [{"material": "*", "use": "foil"}]
    given_keys = {"materials": {"foil": copy.deepcopy(FOIL)}, "spacecraft.sat.materials": uses}
    return perilune.open(SCENE, overrides={**given_keys, **changes})


def texts(svg: str) -> list[str]:
    return [row.text or "" for row in ET.fromstring(svg).iter(f"{SVG}text")]


def test_it_shows_nodes_sockets_constants_and_links() -> None:
    picture = opened().graph("foil")
    root = ET.fromstring(picture.svg)
    shown = texts(picture.svg)
    assert shown[0] == "foil on sat"
    for node, raw in FOIL["nodes"].items():
        assert node in shown
        assert any(text.startswith(raw["type"]) for text in shown)
    for text in ("octaves", "6", "fractal", "fbm", "2 rows", "[1, 1, 0.5, 0]", "factor", "0.25"):
        assert text in shown
    lines = [row for row in root.iter(f"{SVG}path") if row.get("fill") == "none"]
    assert len(lines) == 6
    assert "value, not used by the surface" in shown  # `bits`
    dashed = [row for row in root.iter(f"{SVG}rect") if row.get("stroke-dasharray")]
    assert len(dashed) == 1
    assert picture._repr_svg_() == picture.svg
    assert picture.svg == opened().graph("foil").svg


def test_drivers_are_highlighted_with_their_numbers() -> None:
    svg = opened(material_drivers={"drivers": {"tint": {"choice": [0.5, 0.75]}}}).graph("foil").svg
    shown = texts(svg)
    at = shown.index("OAISYS_scale")
    told = shown[at + 3 : at + 13]
    assert told == ["ideal", "5", "variance", "4.5", "clip", "3 to 10", "jitter strength", "1.5",
                    "step interval", "3"]  # fmt: skip
    at = shown.index("driver:tint")
    assert shown[at + 3 : at + 6] == ["one of", "0.5, 0.75", "by material_drivers"]
    at = shown.index("roughness")
    assert shown[at + 1 : at + 4] == ["0.5", "uniform", "0.25 to 0.75"]
    boxes = [row for row in ET.fromstring(svg).iter(f"{SVG}rect") if row.get("stroke") == ORANGE]
    assert len(boxes) == 2
    plain = opened(**{"materials.foil.drivers": None}).graph("foil").svg
    assert ORANGE not in plain


def test_each_spacecraft_has_its_own_picture() -> None:
    sim = opened(**{"materials.foil.drivers.per": "instance"})
    assert "by materials.foil.instances.sat" in texts(sim.graph("foil").svg)
    fixed = opened(**{"spacecraft.sat.material_drivers": {"drivers": {"tint": [0.125, 0, 1]}}})
    shown = texts(fixed.graph("foil", "sat").svg)
    assert shown[shown.index("driver:tint") + 3 :][:2] == ["value", "[0.125, 0, 1]"]


def test_errors() -> None:
    sim = opened()
    with pytest.raises(ValueError, match="no entry named 'foli'; did you mean 'foil'"):
        sim.graph("foli")
    with pytest.raises(ValueError, match="is not on 'earth'"):
        sim.graph("foil", "earth")
    with pytest.raises(ValueError, match=r"must end in \.svg"):
        sim.graph("foil").save("foil.png")


def test_the_command_writes_it(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    out = tmp_path / "foil.svg"
    graph = '{"foil": {"nodes": {"skin": {"type": "lambert"}}}}'
    more = ["--set", f"materials={graph}", "--out", str(out)]
    assert main(["graph", str(SCENE), "foil", *more]) == 0
    assert capsys.readouterr().out.strip() == str(out)
    shown = texts(out.read_text(encoding="utf-8"))
    assert shown[:3] == ["foil", "skin", "lambert"]
    assert main(["graph", str(SCENE), "foil", "--out", str(out)]) == 1


def test_text_is_escaped() -> None:
    sim = opened()
    svg = draw(sim.document, "foil").svg
    title = "<a> & b"
    root = ET.fromstring(write(title, place([Box(title, '"k"', "scalar", False, True)], [])))
    assert title in [row.text for row in root.iter(f"{SVG}text")]
    assert not re.search(r"<(style|script)", svg)


# --- layout --------------------------------------------------------------------------------------


@st.composite
def graphs(draw_: st.DrawFn) -> tuple[list[Box], list[Link]]:
    """Boxes of several rows, links from earlier to later ones only: no cycle."""
    count = draw_(st.integers(1, 12))
    boxes = []
    for k in range(count):
        rows = [Row(f"r{i}", "x" * draw_(st.integers(0, 9)), "scalar") for i in range(4)]
        boxes.append(Box(f"b{k}", "kind", "scalar", False, True, rows[: draw_(st.integers(1, 4))]))
    links = []
    for _ in range(draw_(st.integers(0, 2 * count)) if count > 1 else 0):
        source = draw_(st.integers(0, count - 2))
        target = draw_(st.integers(source + 1, count - 1))
        start = draw_(st.integers(0, len(boxes[source].rows) - 1))
        end = draw_(st.integers(0, len(boxes[target].rows) - 1))
        links.append(Link(f"b{source}", start, f"b{target}", end, "scalar"))
    return boxes, links


def overlaps(picture: Picture) -> int:
    def apart(a: Placed, b: Placed) -> bool:
        beside = a.x + a.width <= b.x or b.x + b.width <= a.x
        return beside or a.y + a.height <= b.y or b.y + b.height <= a.y

    return sum(not apart(a, b) for a, b in itertools.combinations(picture.boxes, 2))


@settings(max_examples=100, deadline=None)
@given(graphs())
def test_nothing_overlaps_and_links_go_rightwards(graph: tuple[list[Box], list[Link]]) -> None:
    picture = place(*graph)
    assert overlaps(picture) == 0
    at = {item.box.name: item for item in picture.boxes if item.box is not None}
    assert len(at) == len(graph[0])
    for item in picture.boxes:
        assert item.box is not None
        assert (item.width, item.height) == size_of(item.box)
        assert -1e-6 <= item.x <= item.x + item.width <= picture.width + 1e-6
        assert -1e-6 <= item.y <= item.y + item.height <= picture.height + 1e-6
    for link, points in picture.links:
        source, target = at[link.source], at[link.target]
        start = source.y + HEADER + LINE * (link.source_row + 0.5)
        end = target.y + HEADER + LINE * (link.target_row + 0.5)
        assert points[0] == pytest.approx((source.x + source.width, start))
        assert points[-1] == pytest.approx((target.x, end))
        assert all(a[0] < b[0] for a, b in itertools.pairwise(points))
        for (x, y), (_, after) in zip(points[1:-1:2], points[2:-1:2], strict=True):
            assert y == after  # straight through a column, and through no box of it
            crossed = [b for b in picture.boxes if b.x <= x + 0.1 < b.x + b.width]
            assert not any(b.y < y < b.y + b.height for b in crossed)


def test_links_do_not_cross_where_they_need_not() -> None:
    """Two sources that stand in the other order than the rows that they feed."""
    row = [Row("out", socket="scalar", output=True)]
    boxes = [Box(name, "k", "scalar", False, True, list(row)) for name in ("a", "b")]
    boxes.append(Box("c", "k", "scalar", False, True, row * 2))
    picture = place(boxes, [Link("a", 0, "c", 1, "scalar"), Link("b", 0, "c", 0, "scalar")])
    top = {item.box.name: item.y for item in picture.boxes if item.box is not None}
    assert top["b"] < top["a"]
