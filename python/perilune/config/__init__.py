"""The schema of the configuration, and the errors of its files."""

from perilune.config.errors import ConfigError
from perilune.config.schema import Config

__all__ = ["Config", "ConfigError"]
