"""Checks of written datasets."""

from perilune.export.check import *  # noqa: F403
from perilune.export.check import __all__ as __all__
