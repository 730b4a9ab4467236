"""Drivers: values of the configuration that are random variables.

A driver is a mapping in the place of a value. Which distribution it is of, its keys say; the table
is `KINDS`, one module a distribution:

    {ideal, jitter_variance, clip_min, clip_max}    normal, clipped
    {uniform: [low, high]}                          uniform
    {median, log_variance, clip_min, clip_max}      log-normal, clipped
    {..., truncated: true}                          likewise, without tails, not clipped
    {choice: [a, b], weights: [1, 2]}               one of several values, of any type
    {hook: module:function, ideal, ...}             the user's own distribution

`interval` (steps of the timeline between draws), `strength` (factor on the variance; 0 gives the
ideal to the bit) and `group` (a name of `drivers.groups`) are optional keys of all. Mappings
{drivers, jitter_strength, step_interval} set both for all drivers below them, and may say `per`.

All draws are keyed by (seed, key path, step // interval): independent of order, worker and other
drivers, and the same for all sensors of a step. Without an interval, a value is drawn once a scene
(time.frames_per_scene steps).
"""

from perilune.drivers.common import Drawn, DriverError, KeyPath, path_text
from perilune.drivers.mapping import Driver
from perilune.drivers.plan import Defaults, Group, Plan, copied, factor
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
    "Plan",
    "copied",
    "factor",
    "find",
    "marked",
    "names",
    "path_text",
    "substitute",
    "without",
]
