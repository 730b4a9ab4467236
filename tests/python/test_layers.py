"""Who may include or import whom: the tables in csrc/README.md and python/README.md."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator
from graphlib import CycleError, TopologicalSorter
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
    (re.compile(r"^png\.h$|^jpeglib\.h$|^turbojpeg\.h$|^webp/|^OpenEXR/"), {"io"}),
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


PLACE = re.compile(r"`([\w.]+)/?`")


def read_places(readme: Path) -> dict[str, int]:
    """Folder or module of the package to layer, from the table."""
    layers: dict[str, int] = {}
    for line in readme.read_text().splitlines():
        if row := ROW.match(line):
            for name in PLACE.findall(row[2]):
                assert name not in layers, f"{readme}: {name} stands in the table twice"
                layers[name] = int(row[1])
    return layers


def module_name(package: Path, path: Path) -> str:
    parts = path.relative_to(package.parent).with_suffix("").parts
    return ".".join(parts[:-1] if parts[-1] == "__init__" else parts)


def running(tree: ast.AST) -> Iterator[ast.AST]:
    """All nodes but those that only a type checker reads."""
    for node in ast.iter_child_nodes(tree):
        if isinstance(node, ast.If) and "TYPE_CHECKING" in ast.dump(node.test):
            continue
        yield node
        yield from running(node)


def imported(path: Path, known: set[str]) -> Iterator[str]:
    """Modules of the package that a module imports anywhere, in functions too."""
    for node in running(ast.parse(path.read_text())):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names if alias.name in known)
        elif isinstance(node, ast.ImportFrom):
            assert not node.level, f"{path}: relative import"
            for alias in node.names:
                full = f"{node.module}.{alias.name}"
                if full in known:
                    yield full
                elif node.module in known:
                    yield str(node.module)


def place_of(package: Path, path: Path) -> str:
    parts = path.relative_to(package).parts
    return parts[0]


def import_faults(package: Path) -> list[str]:
    """Everything in the package that breaks the table, and any cycle of modules."""
    layers = read_places(package.parent / "README.md")
    paths = {module_name(package, path): path for path in sorted(package.rglob("*.py"))}
    extension = f"{package.name}._core"
    graph: dict[str, set[str]] = {}
    found = []
    for name, path in paths.items():
        place = place_of(package, path)
        if place not in layers:
            found.append(f"{name}: {place} is in no row of the table")
            continue
        graph[name] = set(imported(path, {*paths, extension})) - {name, extension}
        for other in graph[name]:
            target = place_of(package, paths[other])
            if target != place and layers.get(target, -1) >= layers[place]:
                found.append(f"{name}: imports {other}: {target} is not above {place}")
    try:
        TopologicalSorter(graph).prepare()
    except CycleError as error:
        found.append(f"a cycle: {' -> '.join(error.args[1])}")
    return found


def test_every_import_goes_up_the_table(repo_dir: Path) -> None:
    places = read_places(repo_dir / "python" / "README.md")
    assert places["base"] == 0
    assert places["config"] < places["orbits"] < places["frame"] < places["simulation.py"]
    assert import_faults(repo_dir / "python" / "perilune") == []


PACKAGE = """
| 0 | `base/` | what all use |
| 1 | `left/` `right/` | two that do not see each other |
| 2 | `top.py` | what users import |
| 3 | `__init__.py` | names |
"""


@pytest.mark.parametrize(
    ("file", "text", "fault"),
    [
        ("left/a.py", "from p.base import b\nfrom p import _core\nimport json\n", ""),
        (
            "left/a.py",
            "from typing import TYPE_CHECKING\nif TYPE_CHECKING:\n    import p.top\n",
            "",
        ),
        ("left/a.py", "from p.right import c\n", "right is not above left"),
        ("base/b.py", "def f():\n    from p.left import a\n", "left is not above base"),
        ("base/b.py", "import p.top\n", "top.py is not above base"),
        ("base/b.py", "class A:\n    def f(self):\n        import p.base.d\n", "a cycle"),
        ("other/a.py", "", "in no row"),
    ],
)
def test_the_check_of_imports_sees(tmp_path: Path, file: str, text: str, fault: str) -> None:
    (tmp_path / "README.md").write_text(PACKAGE)
    package = tmp_path / "p"
    files = {"base/b.py": "", "base/d.py": "from p.base import b\n", "left/a.py": ""}
    files |= {"right/c.py": "", "top.py": "", "__init__.py": "from p import top\n", file: text}
    for name, content in files.items():
        (package / name).parent.mkdir(parents=True, exist_ok=True)
        (package / name).write_text(content)
    found = import_faults(package)
    assert bool(found) == bool(fault)
    assert all(fault in line for line in found)
