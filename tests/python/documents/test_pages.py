"""The README and the pages of docs/: short, reachable, and naming what is there."""

from __future__ import annotations

import re
from typing import Any

import pytest
import yaml
from tests.python.documents.pages import DOCS, PAGES, ROOT, text_of

from perilune import _core
from perilune.camera.trajectories import TRAJECTORIES


def navigation() -> list[str]:
    """The files that the site's navigation names, in its order."""
    tree: list[Any] = yaml.safe_load((DOCS / "site" / "mkdocs.yml").read_text())["nav"]
    found: list[str] = []
    while tree:
        entry = tree.pop(0)
        if isinstance(entry, dict):
            below = next(iter(entry.values()))
            tree = (below if isinstance(below, list) else [below]) + tree
        else:
            found.append(entry)
    return found


def links(page: str) -> list[str]:
    """Targets of links and pictures, without their anchors."""
    found = re.findall(r"\]\(([^)#]*)(?:#[^)]*)?\)", text_of(page))
    return [target for target in found if target and "://" not in target]


def test_the_readme_is_short() -> None:
    assert len(text_of("README").splitlines()) <= 150


def test_the_navigation_has_every_page_once() -> None:
    assert sorted(navigation()) == sorted(path.name for path in DOCS.glob("*.md"))


def test_the_index_lists_every_page_and_the_readme_most() -> None:
    pages = {path.name for path in DOCS.glob("*.md")}
    assert pages - set(links("index")) == {"index.md"}
    generated = {"api.md", "core.md", "changelog.md"}  # the last two are files of their own there
    assert pages - {link.removeprefix("docs/") for link in links("README")} == generated


@pytest.mark.parametrize("page", PAGES)
def test_links_lead_somewhere(page: str) -> None:
    folder = PAGES[page].parent
    assert [target for target in links(page) if not (folder / target).exists()] == []


@pytest.mark.parametrize("page", PAGES)
def test_named_files_exist(page: str) -> None:
    """Paths in backquotes."""
    kinds = "assets|benchmarks|configs|csrc|docs|python|script|tests"
    named = re.findall(rf"`((?:{kinds})/[\w./-]+)`", text_of(page))
    assert [name for name in named if not (ROOT / name).exists()] == []


def test_every_picture_is_shown() -> None:
    shown = {target.rsplit("/", 1)[-1] for page in PAGES for target in links(page)}
    assert {path.name for path in (DOCS / "images").iterdir()} - shown == set()


def rows(page: str, head: str) -> list[str]:
    """The names in the first column of the table under a head."""
    lines = text_of(page).split(head)[1].split("\n\n")[0].splitlines()
    return [name for line in lines[2:] for name in re.findall(r"`(\w+)`", line.split("|")[1])]


def test_tables_are_complete() -> None:
    assert rows("effects", "| effect | what | knob |") == [row["name"] for row in _core.EFFECTS]
    assert rows("trajectories", "| kind | the camera |") == list(TRAJECTORIES)
    channels = rows("labels", "| channel | shape and type | unit | what it is |")
    assert channels == [
        *(row["name"] for row in _core.CHANNELS),
        "objects",
        "masks",
        "keypoints",
        "hierarchy",
    ]
    scripts = {path.stem for path in (ROOT / "benchmarks").glob("*.py")}
    benchmarks = set(re.findall(r"^\| `benchmarks/(\w+)\.py` \|", text_of("benchmarks"), re.M))
    parts = {"report", "albedo_cycles", "terrain_frames", "terrain_numpy"}  # of others
    assert benchmarks == scripts - parts
