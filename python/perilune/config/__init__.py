"""The configuration: schema, loader, overrides."""

from perilune.config.document import Document, load
from perilune.config.errors import ConfigError
from perilune.config.overrides import parse_override
from perilune.config.schema import Config

__all__ = ["Config", "ConfigError", "Document", "load", "parse_override"]
