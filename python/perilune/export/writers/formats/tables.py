"""The table of formats: a format is its own file and a line here."""

from __future__ import annotations

from perilune.export.writers.formats.base import Format
from perilune.export.writers.formats.exr import Exr, ExrHalf
from perilune.export.writers.formats.npz import Npz
from perilune.export.writers.formats.png import Png

FORMATS: dict[str, Format] = {row.name: row for row in (Png(), Npz(), Exr(), ExrHalf())}
"""Every format but BOP's scene folders, which are their own."""
