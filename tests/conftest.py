"""What every Python test shares: where the real data is, and what happens without it."""

from __future__ import annotations

import functools
import gc
import os
import pickle
import signal
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from hypothesis import settings

from perilune import _core
from perilune.bodies import atmospheres
from perilune.frame import handles
from perilune.spacecraft import model_files

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


class _Shared:
    """The core, for one module: the few maps and atmospheres that most worlds of tests have are
    made once a process, not once a simulation. They are immutable, and what is not the same to the
    bit (file, its time and size, options) is made anew."""

    def __getattr__(self, name: str) -> Any:
        return getattr(_core, name)

    @staticmethod
    def Map(source: Any, **options: Any) -> _core.Map:  # noqa: N802
        if not isinstance(source, str) or not Path(source).is_file():
            return _core.Map(source, **options)
        return _map(source, *_stamp(source), *sorted(options.items()))

    @staticmethod
    def Air(given: dict[str, Any], radius_m: float) -> _core.Air:  # noqa: N802
        return _air(pickle.dumps((given, radius_m)))


def _stamp(path: str) -> tuple[int, int]:
    found = Path(path).stat()
    return found.st_mtime_ns, found.st_size


def _read_model(path: str, *options: Any) -> _core.Model:
    """The same for models, unless they consist of several files."""
    if not path.endswith(".glb") or not Path(path).is_file():
        return model_files.read_model(path, *options)
    return _model(path, *_stamp(path), pickle.dumps(options))


@functools.lru_cache(maxsize=8)
def _model(path: str, _time_ns: int, _size: int, options: bytes) -> _core.Model:
    return model_files.read_model(path, *pickle.loads(options))


@functools.lru_cache(maxsize=3)
def _map(source: str, _time_ns: int, _size: int, *options: tuple[str, Any]) -> _core.Map:
    return _core.Map(source, **dict(options))


@functools.lru_cache(maxsize=16)
def _air(given: bytes) -> _core.Air:
    return _core.Air(*pickle.loads(given))


@pytest.fixture(scope="session", autouse=True)
def shared_worlds() -> Iterator[None]:
    """Simulations of one process share models, maps and atmospheres."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(handles, "_core", _Shared())
        patch.setattr(atmospheres, "_core", _Shared())
        patch.setattr(handles, "shared_model", _read_model)
        yield
