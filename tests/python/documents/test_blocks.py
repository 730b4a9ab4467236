"""Every block of code in the README and in docs/ is what Perilune takes."""

from __future__ import annotations

import re
import shlex
import tomllib
import warnings
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import pytest
from tests.python.documents.page_process import Pages
from tests.python.documents.pages import PAGES, ROOT, Block, all_blocks, blocks, text_of

import perilune
from perilune.cli import COMMANDS
from perilune.document.loader import parse_yaml

NOT_RUN = {
    "bands": ["spectra of yours"],
    "cost": ["half a minute"],
    "time_and_ephemerides": ["kernels of yours"],
}
"""Page -> the reasons of its blocks that cannot run; a block says so in a comment before it."""

DRIVER_KEYS = {"ideal", "uniform", "median", "choice", "hook"}
DEMO = ROOT / "configs" / "demo.yaml"
PYTHON_PAGES = [
    page
    for page in PAGES
    if any(block.language == "python" and not block.not_run for block in blocks(page))
]
YAML = [b for b in all_blocks("yaml") if not b.not_run]
SHELL = [
    (b.page, line.split("#")[0].strip())
    for b in all_blocks("sh")
    for line in b.code.splitlines()
    if line.startswith("perilune ")
]


def test_blocks_that_cannot_run_are_listed() -> None:
    marked: dict[str, list[str]] = {}
    for page in PAGES:
        for block in blocks(page):
            if block.not_run:
                marked.setdefault(page, []).append(block.not_run)
    assert marked == NOT_RUN


def test_languages_are_known() -> None:
    """A block without a language, or in one that nothing here runs, would be unchecked."""
    for page in PAGES:
        fences = re.findall(r"^```(.*)$", text_of(page), re.M)
        assert len(fences) % 2 == 0, page
        languages = {fence.split(" ")[0] for fence in fences[::2]}
        assert languages <= {"python", "yaml", "sh", "toml", "c"}, page


@pytest.mark.parametrize("page", PAGES)
def test_blocks_are_fenced(page: str) -> None:
    """An indented block has no language, so that nothing would check it."""
    outside = re.sub(r"^```.*?^```", "", text_of(page), flags=re.DOTALL | re.M)
    indented = re.findall(r"\n\n    (.*)", outside)
    assert indented == []


@pytest.fixture(scope="module")
def pages() -> Iterator[Pages]:
    """Starts on demand: most tests of this file run no page."""
    processes = Pages(ROOT)
    yield processes
    processes.close()


def test_a_page_that_fails_is_told(pages: Pages, tmp_path: Path) -> None:
    """By its exception, by its exit status or by a signal; and the next one starts anew."""
    script = tmp_path / "page.py"
    ends = {
        "raise ValueError('no such key')": (1, "ValueError: no such key"),
        "import sys; sys.exit(3)": (3, ""),
        "import os; os.kill(os.getpid(), 9)": (-9, ""),
        "import other; assert other.HERE": (0, ""),
        "import sys; assert 'torch' not in sys.modules": (0, ""),
    }
    (tmp_path / "other.py").write_text("HERE = True")
    for code, (expected, text) in ends.items():
        script.write_text(code)
        status, errors = pages.run(script, tmp_path)
        assert (status, text in errors) == (expected, True), errors


@pytest.mark.parametrize("page", PYTHON_PAGES)
def test_python_runs(page: str, pages: Pages, tmp_path: Path) -> None:
    """The blocks of a page one after the other, in a process of their own, from the repository's
    root.

    A block that begins with the name of a file is that file."""
    run = []
    for block in blocks(page):
        if block.language != "python" or block.not_run:
            continue
        file = re.match(r"# (\w+\.py)\n", block.code)
        if file:
            (tmp_path / file[1]).write_text(block.code)
        else:
            run.append(block.code.replace("/tmp/", f"{tmp_path}/"))
    assert run
    script = tmp_path / "blocks.py"
    script.write_text("\n".join(run))
    status, errors = pages.run(script, tmp_path)
    assert status == 0, errors


def merged(whole: Any, part: Any) -> Any:
    """A fragment put into a configuration; drivers and sections of another kind are replaced."""
    if not isinstance(whole, Mapping) or not isinstance(part, Mapping):
        return part
    if DRIVER_KEYS & (whole.keys() | part.keys()) or any(
        part.get(key, whole.get(key)) != whole.get(key) for key in ("kind", "pointing")
    ):
        return part
    return {**whole, **{key: merged(whole.get(key), value) for key, value in part.items()}}


def configuration(block: Block) -> Any:
    """A block that is whole, or a fragment in configs/demo.yaml or in the file that it names."""
    part = parse_yaml(block.code, block.page)
    assert isinstance(part, dict)
    if "version" in part:
        return part
    file, _, path = block.title.rpartition(": ") if ":" in block.title else ("", "", block.title)
    if path.endswith(".yaml"):
        file, path = path, ""
    for key in reversed(path.split(".") if path else []):
        part = {key: part}
    return merged(parse_yaml((ROOT / file if file else DEMO).read_text(), file), part)


def yaml_cases() -> list[Any]:
    """Fragments of gravity fields and the like read files of the sample data."""
    data = pytest.mark.needs_data
    return [
        pytest.param(b, id=f"{b.page}-{k}", marks=[data] if "data:" in b.code else [])
        for k, b in enumerate(YAML)
    ]


@pytest.mark.parametrize("block", yaml_cases())
def test_yaml_is_a_configuration(block: Block) -> None:
    """Checked as a whole file is: keys, types, limits, names of other entries."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        sim = perilune.open(configuration(block), base=ROOT / "configs")
    assert sim.config.version == 1


def test_there_is_enough_to_check() -> None:
    assert (len(YAML) > 15, len(SHELL) > 10, len(PYTHON_PAGES) > 4) == (True, True, True)


@pytest.mark.parametrize(("page", "line"), SHELL, ids=lambda text: text[:40])
def test_commands_have_these_options(page: str, line: str, capsys: Any) -> None:
    del page
    words = shlex.split(re.sub(r"[\[\]|]", " ", line))
    with pytest.raises(SystemExit) as ended:
        perilune_main([words[1], "--help"])
    assert ended.value.code == 0
    known = capsys.readouterr().out
    options = [word for word in words if word.startswith("--")]
    assert [option for option in options if f"{option} " not in known.replace(",", " ")] == []


def test_scripts_exist() -> None:
    """And the stages and benchmarks that they are asked for."""
    lines = [line for b in all_blocks("sh") for line in b.code.splitlines()]
    calls = [shlex.split(line, comments=True) for line in lines if line.startswith("script/")]
    assert len(calls) > 4
    for script, *words in calls:
        assert (ROOT / script).is_file(), script
        names = words[: words.index("--")] if "--" in words else words
        known = (ROOT / script).read_text()
        for name in names:
            assert (ROOT / "benchmarks" / f"{name}.py").is_file() or f"stage_{name}()" in known


def perilune_main(arguments: list[str]) -> None:
    from perilune.cli import main

    raise SystemExit(main(arguments))


def test_every_command_is_explained() -> None:
    listed = re.findall(r"^\| `perilune (\w+)` \|", text_of("commands"), re.M)
    assert sorted(listed) == sorted(command.name for command in COMMANDS)


@pytest.mark.parametrize("block", all_blocks("toml"), ids=lambda b: b.page)
def test_toml_parses(block: Block) -> None:
    assert tomllib.loads(block.code)
