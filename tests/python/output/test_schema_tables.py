"""`perilune schema PATH`: sections as tables, and what the topics say."""

from __future__ import annotations

import json
import re

import pytest

from perilune import cli
from perilune.cli.json_schema import config_schema
from perilune.cli.schema_table import Tables, unit_of
from perilune.cli.schema_walk import Schema
from perilune.cli.topics import TOPICS


@pytest.fixture(scope="module")
def schema():
    return Schema(config_schema())


def told(capsys, *args):
    code = cli.main(["schema", *args])
    out, err = capsys.readouterr()
    return code, out, err


def test_a_section_has_units_limits_and_defaults(capsys, monkeypatch):
    monkeypatch.setenv("COLUMNS", "160")
    code, out, _ = told(capsys, "camera.trajectory.relative")
    assert code == 0
    assert out.startswith("camera.trajectory.relative: Free motion beside the target")
    rows = {line.split()[0]: line for line in out.splitlines() if re.match(r"\w", line)}
    assert re.search(r"number, or a driver +deg +>= 0, <= 90 +0\.0 ", rows["aim_jitter_deg"])
    assert re.search(r"text +required", rows["target"])
    assert "rsw | lvlh" in rows["frame"]
    assert len(out) < 6_000


@pytest.mark.parametrize("columns", ["60", "100", "200"])
def test_no_line_is_wider_than_the_terminal(capsys, monkeypatch, columns):
    monkeypatch.setenv("COLUMNS", columns)
    for path in ("camera.trajectory.relative", "camera.trajectory", "sun", "spacecraft"):
        code, out, _ = told(capsys, path)
        assert code == 0
        assert max(map(len, out.splitlines())) <= max(int(columns), 100)


def test_without_a_path_it_is_an_overview(capsys):
    code, out, _ = told(capsys)
    assert code == 0
    assert len(out) < 5_000
    for name in (*config_schema()["properties"], *TOPICS):
        assert re.search(rf"^..{name}\b", out, re.MULTILINE), name


@pytest.mark.parametrize(
    ("path", "expected"),
    [
        ("camera.trajectry", ["camera", "did you mean 'trajectory'"]),
        ("camra", ["did you mean 'camera'"]),
        ("camera.trajectory.spirl", ["camera.trajectory", "did you mean 'spiral'"]),
        ("bodies.earth.cloud", ["bodies.earth", "did you mean 'clouds'"]),
        ("seed.x", ["seed", "has no keys"]),
        ("tax", ["taxonomy"]),
        ("", ["allowed: version"]),
    ],
)
def test_a_wrong_path_names_the_nearest(capsys, path, expected):
    code, out, err = told(capsys, path)
    assert (code, out) == (1, "")
    for text in expected:
        assert text in err


@pytest.mark.parametrize(
    "path",
    [
        "spacecraft.sat.orbit.kepler.altitude_km",
        "spacecraft.orbit.kepler.altitude_km",
        "spacecraft.NAME.attitude.nadir",
        "camera.K[4]",
        "spacecraft.sat.articulation[0].rate_deg_s",
        "bodies.earth.rings.ringlets",
        "drivers.groups.optics.correlation",
        "volumes.jet.cone",
    ],
)
def test_paths_go_through_names_kinds_and_lists(capsys, path):
    code, out, err = told(capsys, path)
    assert (code, err) == (0, "")
    assert out.strip()


def _paths(schema, found, path):
    for kind, section in found.sections:
        here = f"{path}.{kind}".strip(".") if kind else path
        for key in section["properties"]:
            yield f"{here}.{key}".strip(".")


def test_every_section_can_be_shown(schema):
    """From the top, through all kinds and entries, each section once."""
    todo, seen, shown = list(config_schema()["properties"]), set(), 0
    tables = Tables(schema)
    while todo:
        path = todo.pop()
        found = schema.find(path)
        text = tables.describe(found, 120)
        assert text.strip(), path
        shown += 1
        entry = schema.entries(found.value) if not found.sections else None
        if entry is not None:
            todo += [f"{path}.NAME"] if id(entry) not in seen else []
            seen.add(id(entry))
        for below in _paths(schema, found, path):
            if below.count(".") < 12 and (key := tuple(below.split(".")[-2:])) not in seen:
                seen.add(key)
                todo.append(below)
    assert shown > 400


def test_every_key_that_ends_in_a_unit_has_one(schema):
    assert unit_of("altitude_km") == "km"
    assert unit_of("emission_w_m2_sr") == "W m-2 sr-1"
    assert unit_of("gm_km3_s2") == "km3 s-2"
    assert unit_of("rotation_deg_step_v") == "deg a step"
    assert unit_of("h_s") == unit_of("f_number") == unit_of("mie_g") == ""


@pytest.mark.parametrize("topic", TOPICS)
def test_topics_say_something(capsys, topic):
    code, out, _ = told(capsys, topic)
    assert code == 0
    assert len(out) > 200


def test_one_section_as_json(capsys):
    code, out, _ = told(capsys, "camera.trajectory.relative", "--json")
    assert code == 0
    assert json.loads(out)["properties"]["kind"]["const"] == "relative"
