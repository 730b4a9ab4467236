"""Checks of written datasets."""

from perilune.export.check import RERENDERED, Finding, Report, check, check_bop

__all__ = ["RERENDERED", "Finding", "Report", "check", "check_bop"]
