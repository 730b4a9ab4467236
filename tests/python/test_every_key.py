"""No key does nothing: where it stands alone, beside what its section requires, it changes what
frames hold or is refused by name."""

from __future__ import annotations

import copy
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from tests.python.key_cameras import CAMERAS
from tests.python.key_sections import LAMBERT, MAP, THINGS, Section, Tree, base, put
from tests.python.model_files import with_graphs

import perilune
from perilune import _core
from perilune.config.types import Strict

FRAMES = (0, 3, 4)
"""The start of a scene, its end, and the start of another."""
SECTIONS = [*THINGS, *CAMERAS]


def seen(tree: Tree, folder: Path) -> Iterator[bytes]:
    """All that a few frames hold."""
    sim = perilune.open(tree, base=folder)
    with_sensor = next(iter(sim.config.cameras.values())).sensor is not None
    channels = ["rgb", "radiance", "depth", "semantic", "instance", "part", "objects", "bands"]
    for index in FRAMES:
        sensors = ["raw", "sensor_rgb"] if with_sensor else []
        sample = sim.frame(index, channels=channels + sensors, threads=1)
        for array in (*sample.values(), sample.objects, sample.stars):
            yield np.asarray(array).tobytes()
        camera = sample.camera
        yield b"".join(np.asarray(a).tobytes() for a in (camera.K, camera.R_w2c, camera.t_w2c))
        kept = ("white_radiance", "exposure_s", "gain_e_dn", "articulation", "sensor", "bands")
        yield repr([sample.meta.get(key) for key in kept]).encode()
    yield repr(sim.taxonomy).encode()
    yield repr([(m.obj_id, m.class_name, m.symmetries) for m in sim.models.values()]).encode()


def outcome(section: Section, folder: Path, **changes: Any) -> list[bytes] | str:
    """What frames hold, or the error."""
    tree = base()
    for dotted, value in section.around.items():
        put(tree, dotted, copy.deepcopy(value))
    put(tree, ".".join(section.at), copy.deepcopy({**section.required, **changes}))
    try:
        return list(seen(tree, folder))
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
    with_graphs(path / "graphs.glb", mli_gold=LAMBERT, panel_back=LAMBERT, solar_cell=LAMBERT)
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
def bare() -> dict[int, list[bytes] | str]:
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
    else:
        assert shown != bare[which], f"{key} changes nothing"


def test_the_table_is_whole() -> None:
    """All keys of each section are in one of its entries."""
    keys: dict[type[Strict], set[str]] = {}
    for section in SECTIONS:
        keys.setdefault(section.model, set()).update(section.keys, section.required)
    for model, given in keys.items():
        fields = {field.alias or name for name, field in model.model_fields.items()}
        assert given == fields, model.__name__
