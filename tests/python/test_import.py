"""What an import loads, and what it leaves until it is asked for."""

from __future__ import annotations

import json
import subprocess
import sys

import pytest

import perilune
from perilune.config.lens_flare import GENERIC, Ghost
from perilune.config.types import Strict

HEAVY = {
    *("torch", "torchdata", "matplotlib", "PIL", "scipy", "IPython", "ipywidgets", "cv2"),
    *("tifffile", "sgp4", "spiceypy", "pandas", "tqdm", "pycocotools", "tabulate"),
}
"""Libraries that a frame of a common configuration needs none of."""


def loaded(code: str) -> set[str]:
    """Top names of the modules that a fresh process has after some code."""
    code = f"{code}\nimport json, sys\nprint(json.dumps(sorted(sys.modules)))"
    result = subprocess.run([sys.executable, "-c", code], capture_output=True, check=True)
    names: list[str] = json.loads(result.stdout)
    return {name for name in names if name.startswith("perilune")} | {
        name.split(".")[0] for name in names
    }


def test_import_alone_loads_nothing():
    found = loaded("import perilune")
    assert not found & {"numpy", "pydantic", "yaml", "erfa", *HEAVY}
    assert {name for name in found if name.startswith("perilune.")} <= {"perilune._core"}


def test_what_users_import_loads_no_extra():
    names = "open, Dataset, Stream, collate, Driver, look_at, write_bop, writers, check"
    found = loaded(f"from perilune import {names}")
    assert not found & HEAVY
    unused = ("perilune.show", "perilune.cli", "perilune.document.oaisys")
    assert not {name for name in found if name.startswith(unused)}


def test_names_of_a_training_loop_load_no_schema():
    """What a configuration needs is loaded by the first call of `perilune.open`."""
    found = loaded("from perilune import open, Dataset, Stream, collate, Sample")
    assert not found & {"pydantic", "yaml", "erfa", *HEAVY}
    assert not {name for name in found if name.startswith(("perilune.config", "perilune.orbits"))}


def sections() -> list[type[Strict]]:
    """Every section of the configuration."""
    found: list[type[Strict]] = []
    waiting = [Strict]
    while waiting:
        below = waiting.pop().__subclasses__()
        found += below
        waiting += below
    return found


def test_what_users_import_builds_no_validator_of_a_section():
    code = """
import perilune; perilune.Simulation
from perilune.config.types import Strict
waiting, built = [Strict], []
while waiting:
    below = waiting.pop().__subclasses__()
    built += [kind.__name__ for kind in below if kind.__pydantic_complete__]
    waiting += below
assert not built, built
"""
    loaded(code)


def test_defaults_that_are_sections_are_those_of_a_validated_section():
    count = 0
    for kind in sections():
        for name, field in kind.model_fields.items():
            if isinstance(field.default, Strict):
                made = type(field.default)()
                assert field.default == made, (kind, name)
                assert field.default.model_fields_set == made.model_fields_set == set()
                count += 1
    assert count > 10
    for ghost in GENERIC:
        assert ghost == Ghost.model_validate(ghost.model_dump())


def test_the_command_line_loads_what_a_command_needs():
    assert not loaded("import perilune.cli") & (HEAVY - {"tqdm"})


def test_all_names_are_there():
    for name in perilune.__all__:
        assert getattr(perilune, name) is not None
        assert name in dir(perilune)
    assert perilune.writers.write_bop is perilune.write_bop
    assert perilune.world.World.__module__ == "perilune.world"


def test_a_name_that_is_not_there():
    for name in ("opened", "numpy", "_cores"):
        with pytest.raises(AttributeError, match=f"module 'perilune' has no attribute '{name}'"):
            getattr(perilune, name)


def test_a_module_whose_library_is_missing_says_so():
    code = "import sys; sys.modules['torch'] = None\nimport perilune\nperilune.torch"
    result = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
    assert "ModuleNotFoundError: import of torch halted" in result.stderr
