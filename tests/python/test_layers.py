"""The layers of the core: who may include whom, as the table in csrc/README.md says."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

SOURCES = {".c", ".h", ".cpp", ".hpp"}
ROW = re.compile(r"^\|\s*(\d+)\s*\|([^|]*)\|")
FOLDER = re.compile(r"`(\w+)/`")
INCLUDE = re.compile(r"^\s*#\s*include\s*([<\"])([^>\"]+)[>\"]", re.MULTILINE)

# Headers of others that belong to one folder: a pattern, and the folders that may include it.
CONFINED = [
    (re.compile(r"^Python\.h$|^structmember\.h$|^numpy/"), {"pyext"}),
    (re.compile(r"^embree\d"), {"trace"}),
    (re.compile(r"^tiny_gltf\.h$|^json\.hpp$|^nlohmann/|^stb_|^draco/|^meshoptimizer"), {"io"}),
    (re.compile(r"^png\.h$|^jpeglib\.h$|^turbojpeg\.h$|^webp/"), {"io"}),
]


def read_layers(readme: Path) -> dict[str, int]:
    """Folder to layer, from the table."""
    layers: dict[str, int] = {}
    for line in readme.read_text().splitlines():
        if row := ROW.match(line):
            for folder in FOLDER.findall(row[2]):
                assert folder not in layers, f"{readme}: {folder}/ stands in the table twice"
                layers[folder] = int(row[1])
    return layers


def check_include(csrc: Path, path: Path, quote: str, name: str, layers: dict[str, int]) -> str:
    """What is wrong with one include; empty when it is allowed."""
    folder = path.relative_to(csrc).parts[0]
    for pattern, allowed in CONFINED:
        if pattern.search(name):
            return "" if folder in allowed else f"only {', '.join(allowed)}/ may include <{name}>"
    if not (csrc / name).exists():
        if quote == "<":
            return ""  # the system's
        return "" if (path.parent / name).exists() and "/" not in name else f'no file "{name}"'
    other = Path(name).parts[0]
    if other == folder:
        return ""
    if other not in layers:
        return f"{other}/ is in no row of the table"
    if layers[other] == layers[folder]:
        return f"{folder}/ and {other}/ stand on one line and do not see each other"
    return "" if layers[other] < layers[folder] else f"{other}/ is above {folder}/"


def violations(csrc: Path) -> list[str]:
    """Everything in csrc that breaks the table."""
    layers = read_layers(csrc / "README.md")
    found = []
    for path in sorted(csrc.rglob("*")):
        if path.suffix not in SOURCES:
            continue
        parts = path.relative_to(csrc).parts
        if len(parts) < 2 or parts[0] not in layers:
            found.append(f"{'/'.join(parts)}: its folder is in no row of the table")
            continue
        for quote, name in INCLUDE.findall(path.read_text()):
            if fault := check_include(csrc, path, quote, name, layers):
                found.append(f'{"/".join(parts)}: includes "{name}": {fault}')
    return found


def test_the_table_is_read(repo_dir: Path) -> None:
    layers = read_layers(repo_dir / "csrc" / "README.md")
    assert layers["base"] == 0
    assert layers["base"] < layers["geom"] == layers["orbit"] < layers["trace"] < layers["pyext"]


def test_every_include_goes_down(repo_dir: Path) -> None:
    assert violations(repo_dir / "csrc") == []


TABLE = """
| layer | folder | owns |
| --- | --- | --- |
| 0 | `base/` | status |
| 1 | `left/` `right/` | two that do not see each other |
| 2 | `trace/` | Embree |
| 3 | `pyext/` | Python |
"""


@pytest.mark.parametrize(
    ("file", "text", "fault"),
    [
        ("left/a.c", '#include "base/b.h"\n#include "left/a.h"\n#include <math.h>\n', ""),
        ("left/a.c", '#include "a.h"\n', ""),
        ("pyext/a.c", "#include <Python.h>\n#include <numpy/arrayobject.h>\n", ""),
        ("trace/a.c", "#include <embree4/rtcore.h>\n", ""),
        ("left/a.c", '#include "right/a.h"\n', "do not see each other"),
        ("base/a.c", '#include "left/a.h"\n', "left/ is above base/"),
        ("base/a.c", "#  include <left/a.h>\n", "left/ is above base/"),
        ("base/a.c", '#include "../left/a.h"\n', "no file"),
        ("left/a.c", '#include "nowhere.h"\n', "no file"),
        ("left/a.c", "#include <Python.h>\n", "only pyext/"),
        ("left/a.c", "#include <numpy/arrayobject.h>\n", "only pyext/"),
        ("left/a.c", "#include <embree3/rtcore.h>\n", "only trace/"),
        ("left/a.cpp", '#include "tiny_gltf.h"\n', "only io/"),
        ("other/a.c", "", "in no row"),
        ("a.c", "", "in no row"),
    ],
)
def test_the_check_sees(tmp_path: Path, file: str, text: str, fault: str) -> None:
    (tmp_path / "README.md").write_text(TABLE)
    for header in ("base/b.h", "left/a.h", "right/a.h"):
        (tmp_path / header).parent.mkdir(exist_ok=True)
        (tmp_path / header).touch()
    (tmp_path / file).parent.mkdir(exist_ok=True)
    (tmp_path / file).write_text(text)
    found = violations(tmp_path)
    assert len(found) == bool(fault)
    assert all(fault in line for line in found)
