"""No key does nothing, and none does what it should not: where it stands alone, beside what its
section requires, it changes what key_changes.py says of frames, or is refused by name."""

from __future__ import annotations

import copy
import re
from collections import defaultdict
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import pytest
from tests.python import key_changes
from tests.python.key_cameras import CAMERAS
from tests.python.key_sections import GREY_MAP, LAMBERT, MAP, THINGS, Section, Tree, base, put
from tests.python.model_files import melted_box, with_graphs
from tests.python.output.retrace import write_sheets

import perilune
from perilune import _core
from perilune.config.types import Strict
from perilune.document.references import has_keypoints

FRAMES = (0, 3, 4)
"""The start of a scene, its end, and the start of another."""
SECTIONS = [*THINGS, *CAMERAS]


PART_OF = {channel: part for part, names in key_changes.PARTS.items() for channel in names}


class Seen(NamedTuple):
    """All that a few frames hold."""

    parts: dict[str, list[bytes]]
    radiance: float
    """The sum of all."""
    raw: float
    """The sum of the means; 0 without an image sensor."""


def seen(tree: Tree, folder: Path) -> Seen:
    sim = perilune.open(tree, base=folder)
    with_sensor = next(iter(sim.config.cameras.values())).sensor is not None
    channels = [name for part, names in key_changes.PARTS.items() for name in names
                if part != "sensor" or with_sensor]  # fmt: skip
    parts: dict[str, list[bytes]] = defaultdict(list)
    radiance = raw = 0.0
    for index in FRAMES:
        sample = sim.frame(index, channels=[*channels, "objects"], threads=1)
        for name, array in sample.items():
            parts[PART_OF[name]].append(np.asarray(array).tobytes())
        parts["objects"].append(sample.objects.tobytes())
        parts["stars"].append(sample.stars.tobytes())
        if has_keypoints(sim.config):
            parts["keypoints"].append(sim.frame(index, ["keypoints"]).keypoints.tobytes())
        camera = sample.camera
        for array in (camera.K, camera.R_w2c, camera.t_w2c):
            parts["camera"].append(np.asarray(array).tobytes())
        for part, keys in (("exposure", ("white_radiance", "exposure_s", "gain_e_dn")),
                           ("meta", ("articulation", "sensor", "bands"))):  # fmt: skip
            parts[part].append(repr([sample.meta.get(key) for key in keys]).encode())
        radiance += float(sample["radiance"].sum(dtype=float))
        raw += float(sample["raw"].mean(dtype=float)) if with_sensor else 0.0
    models = [(m.obj_id, m.class_name, m.symmetries) for m in sim.models.values()]
    parts["names"] += [repr(sim.taxonomy).encode(), repr(models).encode()]
    return Seen(dict(parts), radiance, raw)


def outcome(section: Section, folder: Path, **changes: Any) -> Seen | str:
    """What frames hold, or the error."""
    tree = base()
    for dotted, value in section.around.items():
        put(tree, dotted, copy.deepcopy(value))
    put(tree, ".".join(section.at), copy.deepcopy({**section.required, **changes}))
    try:
        return seen(tree, folder)
    except (ValueError, FileNotFoundError) as error:
        return str(error)


def name_of(section: Section) -> str:
    given = section.required
    kind = [str(given[key]) for key in ("kind", "core", "mode") if key in given]
    return "-".join([section.model.__name__, *kind])


CASES = [
    pytest.param(section, key, id=f"{name_of(section)}-{k}-{key}")
    for k, section in enumerate(SECTIONS)
    for key in section.keys
]


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """What the sections' files are."""
    path = tmp_path_factory.mktemp("keys")
    rng = np.random.default_rng(1)
    _core.png_write(str(path / MAP), rng.integers(0, 256, (8, 16, 4), np.uint8))
    _core.png_write(str(path / GREY_MAP), np.arange(128, dtype=np.uint8).reshape(8, 16))
    melted_box(path / "melted.glb")
    write_sheets(path / "sheet.gltf", away={"place": [0, 0, 0]}, here={"place": [2, 0, 0]})
    with_graphs(path / "graphs.glb", mli_gold=LAMBERT, panel_back=LAMBERT, solar_cell=LAMBERT)
    craters = [f"{lat},{lon},600" for lat in (-60, 0, 60) for lon in range(0, 360, 40)]
    (path / "craters.csv").write_text("\n".join(["lat,lon,diam_km", *craters]))
    (path / "points.csv").write_text("name,x,y,z\na,0,0,1\n")
    np.save(path / "kernel.npy", rng.random((5, 5)) + 0.1)
    wavelengths = np.linspace(300.0, 1100.0, 9)
    rows = [f"{w:g},{1.0 + k}" for k, w in enumerate(wavelengths)]
    (path / "sun.csv").write_text("\n".join(rows))
    places = [(ra, dec) for ra in range(0, 360, 8) for dec in (-20, 0, 20)]
    stars = [f"{ra},{dec},{-9.0 + 0.01 * ra},1000000,0" for ra, dec in places]
    head = "ra_deg,dec_deg,vmag,pm_ra_mas_yr,pm_dec_mas_yr"
    (path / "stars.csv").write_text("\n".join([head, *stars]))
    poses = ["frame,x,y,z,qw,qx,qy,qz", "0,0,-3e6,0,1,-1,0,0", "1,1e5,-3e6,0,1,-1,0,0.1"]
    (path / "poses.csv").write_text("\n".join(poses))
    corners = [(x, y, z) for x in (-600, 600) for y in (-600, 600) for z in (-600, 600)]
    faces = [(1, 2, 4, 3), (5, 7, 8, 6), (1, 5, 6, 2), (3, 4, 8, 7), (1, 3, 7, 5), (2, 6, 8, 4)]
    lines = [f"v {x} {y} {z}" for x, y, z in corners]
    (path / "ball.obj").write_text("\n".join(lines + ["f " + " ".join(map(str, f)) for f in faces]))
    return path


@pytest.fixture(scope="module")
def bare() -> dict[int, Seen | str]:
    """What a section shows by itself, by its identity."""
    return {}


@pytest.mark.parametrize(("section", "key"), CASES)
def test_a_key_does_something_or_is_refused(
    section: Section, key: str, folder: Path, bare: dict[int, Any]
) -> None:
    which = id(section)
    if which not in bare:
        bare[which] = outcome(section, folder)
    shown = outcome(section, folder, **{key: section.keys[key]})
    if isinstance(shown, str):
        place = ".".join(section.at)
        assert f"{place}.{key}" in shown or (place in shown and re.search(rf"\b{key}\b", shown))
        return
    before = bare[which]
    if isinstance(before, str):
        return  # the section alone is refused: the key makes it one
    model = section.model.__name__
    names = before.parts.keys() | shown.parts.keys()
    changed = {part for part in names if before.parts.get(part) != shown.parts.get(part)}
    expected = key_changes.rule_of(model, key)
    assert changed, f"{key} changes nothing"
    assert expected.must <= changed <= expected.may, f"{key} changes {sorted(changed)}"
    for table, old, new in (
        (key_changes.RATIOS, before.radiance, shown.radiance),
        (key_changes.RAW_RATIOS, before.raw, shown.raw),
    ):
        if (model, key) in table:
            low, high = table[model, key]
            assert low * old < new < high * old, f"{key}: {old} -> {new}"


def test_every_rule_is_used() -> None:
    """A rule for a key that is no more, or of no section here, would be read as a promise."""
    keys = {(section.model.__name__, key) for section in SECTIONS for key in section.keys}
    for table in (key_changes.KEYS, key_changes.RATIOS, key_changes.RAW_RATIOS):
        assert sorted(table.keys() - keys) == []
    assert sorted(key_changes.MODELS.keys() - {model for model, _ in keys}) == []


def test_the_table_is_whole() -> None:
    """All keys of each section are in one of its entries."""
    keys: dict[type[Strict], set[str]] = {}
    for section in SECTIONS:
        keys.setdefault(section.model, set()).update(section.keys, section.required)
    for model, given in keys.items():
        fields = {field.alias or name for name, field in model.model_fields.items()}
        assert given == fields, model.__name__
