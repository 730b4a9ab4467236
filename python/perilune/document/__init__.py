"""Configuration files: reading, includes, overrides, files of OAISYS, checks across sections."""

from perilune.document.document import Document, load
from perilune.document.overrides import parse_override

__all__ = ["Document", "load", "parse_override"]
