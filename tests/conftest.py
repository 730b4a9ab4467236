"""What every Python test shares: where the real data is, and what happens without it."""

from __future__ import annotations

import gc
import os
import signal
from collections.abc import Iterator
from pathlib import Path

import pytest
from hypothesis import settings

# A timing is never a test; the blob reproduces a failure found elsewhere.
settings.register_profile("perilune", deadline=None, print_blob=True)
settings.load_profile("perilune")


# What runs in the background is deaf to ctrl-C, and would hand that down to what tests start.
if signal.getsignal(signal.SIGINT) == signal.SIG_IGN:
    signal.signal(signal.SIGINT, signal.default_int_handler)


def data_folder() -> Path | None:
    """The folder of real models and maps, or None when there is none."""
    text = os.environ.get("PERILUNE_DATA", "")
    return Path(text) if text and Path(text).is_dir() else None


@pytest.hookimpl(hookwrapper=True)
def pytest_collection() -> Iterator[None]:
    """Modules and tests stay until the end: looking for garbage among them takes a third of their
    collection, and as much again of each test that makes the collector look at everything."""
    gc.disable()
    yield
    gc.collect()
    gc.freeze()
    gc.enable()


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    for item in items:
        if "data_dir" in getattr(item, "fixturenames", ()):
            item.add_marker(pytest.mark.needs_data)


def pytest_runtest_setup(item: pytest.Item) -> None:
    if item.get_closest_marker("soak") is not None and not os.environ.get("PERILUNE_SOAK"):
        pytest.skip(f"{item.name} is long: script/soak runs it")
    if item.get_closest_marker("needs_data") is None or data_folder() is not None:
        return
    # With its name, so that the report lists every test that was skipped, not how many.
    why = f"{item.name} needs the real data: set PERILUNE_DATA"
    if os.environ.get("CI") == "true":
        pytest.fail(why, pytrace=False)
    pytest.skip(why)


@pytest.fixture(scope="session")
def data_dir() -> Path:
    """The folder of real models and maps; a test that uses it is marked `needs_data`."""
    folder = data_folder()
    assert folder is not None  # pytest_runtest_setup has seen to it
    return folder


@pytest.fixture(scope="session")
def repo_dir() -> Path:
    """The root of the repository."""
    return Path(__file__).resolve().parent.parent
