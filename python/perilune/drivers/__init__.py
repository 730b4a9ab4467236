"""Drivers: values of the configuration that are random variables.

A driver is a mapping in place of a value. Its keys select the distribution; the table is `KINDS`,
with one module per distribution:

    {ideal, jitter_variance, clip_min, clip_max}    normal, clipped
    {uniform: [low, high]}                          uniform
    {median, log_variance, clip_min, clip_max}      log-normal, clipped
    {..., truncated: true}                          either one, truncated instead of clipped
    {choice: [a, b], weights: [1, 2]}               one of several values of any type
    {hook: module:function, ideal, ...}             a distribution of your own

All take the optional keys `interval` (steps of the timeline between draws), `strength` (factor on
the variance; 0 gives exactly the ideal) and `group` (a name of `drivers.groups`). A mapping
{drivers, jitter_strength, step_interval} sets both for all drivers below it, and may have `per`.

Draws are keyed by (seed, key path, step // interval): they do not depend on order, worker or other
drivers, and are the same for all sensors of a step. Without an interval, a value is drawn once a
scene (time.frames_per_scene steps)."""

from perilune.drivers.common import Drawn, DriverError, KeyPath, path_text
from perilune.drivers.mapping import Driver
from perilune.drivers.plan import Defaults, Group, Named, Plan, factor
from perilune.drivers.tree import KINDS, Found, find, marked, names, substitute, without

__all__ = [
    "KINDS",
    "Defaults",
    "Drawn",
    "Driver",
    "DriverError",
    "Found",
    "Group",
    "KeyPath",
    "Named",
    "Plan",
    "factor",
    "find",
    "marked",
    "names",
    "path_text",
    "substitute",
    "without",
]
