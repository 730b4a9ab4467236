"""Writers of datasets: those that come with Perilune, and the registry of others."""

from perilune.export.writers import *  # noqa: F403
from perilune.export.writers import __all__ as __all__
