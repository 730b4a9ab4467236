"""Translating OAISYS trees in tests."""

from __future__ import annotations

import warnings
from pathlib import Path

import pytest

from perilune import document as cfg
from perilune.config import ConfigError
from perilune.document import oaisys
from perilune.document.oaisys import OaisysWarning

FOLDER = Path(__file__).resolve().parents[3] / "configs" / "oaisys"
EARTH_M = 6.378e6
SENSOR = "SENSOR_SETUP.SENSORS[0].sensorParams"


def translated(tree, base=FOLDER):
    """Our tree, and the warnings as one text."""
    with warnings.catch_warnings(record=True) as told:
        warnings.simplefilter("always")
        found = oaisys.translate(tree, base, "f.json")
    assert all(issubclass(row.category, OaisysWarning) for row in told)
    return found.tree, "\n".join(str(row.message) for row in told)


def failure(tree) -> str:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        with pytest.raises(ConfigError) as error:
            cfg.load(tree, base=FOLDER)
    return str(error.value)
