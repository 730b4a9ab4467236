"""Functions of the user's (hooks): loads them, passes their arguments, keeps them reproducible.

A hook receives those of its arguments that the caller offers by name (`rng`, `world`, `params`,
`body_radius_xyz` and so on), and the entries of `params` by their names. While it runs, the global
generators of NumPy and of `random` are seeded from (seed, key path, scene or step), and restored
afterwards. A hook that uses them thus gives the same values in any order and disturbs no other
code."""

from __future__ import annotations

import importlib
import importlib.util
import inspect
import random
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from difflib import get_close_matches
from functools import lru_cache
from pathlib import Path
from threading import RLock
from types import ModuleType
from typing import Any

import numpy as np

from perilune.base.random import generator

Hook = Callable[..., Any]
Offer = Callable[[], Any]
"""Makes an argument when a hook asks for it."""

_GLOBAL_STATE = RLock()
_BY_NAME = (inspect.Parameter.POSITIONAL_OR_KEYWORD, inspect.Parameter.KEYWORD_ONLY)


class HookError(ValueError):
    """A hook that cannot be found or called, or whose result cannot be used."""


@lru_cache(maxsize=64)
def _read(path: Path) -> ModuleType:
    """The module of a file, run once per process; not among those that `import` finds."""
    spec = importlib.util.spec_from_file_location(path.stem, path)
    assert spec is not None  # the path ends in .py
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def _module(name: str, key: str, find: Callable[[str, str], Path] | None) -> ModuleType:
    """An importable module; else the file of that name next to the configuration."""
    try:
        return importlib.import_module(name)
    except ModuleNotFoundError as error:
        if find is None or error.name is None or not f"{name}.".startswith(f"{error.name}."):
            raise  # it is there, and something that it imports is not
        try:
            path = find(name.replace(".", "/") + ".py", key)
        except FileNotFoundError:
            raise error from None
        if not path.is_file():
            raise
        return _read(path.resolve())


def _attribute(value: Any, part: str, what: str) -> Any:
    if hasattr(value, part):
        return getattr(value, part)
    public = [row for row in dir(value) if not row.startswith("_")]
    close = get_close_matches(part, public, n=1, cutoff=0.5)
    hint = f"; did you mean '{close[0]}'?" if close else ""
    raise HookError(f"{what}: no function '{part}' in {getattr(value, '__name__', 'it')}{hint}")


def load(name: str, key: str, find: Callable[[str, str], Path] | None = None) -> Hook:
    """The function named by `module:function`; `key` names the entry in errors.

    find: resolves a relative path of the configuration (or raises FileNotFoundError), for modules
    that cannot be imported."""
    module, _, path = name.partition(":")
    try:
        value: Any = _module(module, key, find)
        for part in path.split("."):
            value = _attribute(value, part, f"{key} = '{name}'")
    except ImportError as error:
        text = f"{key} = '{name}': {error}"
        how = "its module must be importable (see PYTHONPATH), or lie beside the configuration"
        raise HookError(f"{text} ({how})") from error
    if not callable(value):
        raise HookError(f"{key} = '{name}': not a function")
    return value  # type: ignore[no-any-return]


@contextmanager
def _global_generators(seed: int, what: str, index: int) -> Iterator[None]:
    """Seeds the process's generators within the context; one thread at a time."""
    words = generator(seed, f"global:{what}", index).integers(0, 2**32, 8, dtype=np.uint32)
    with _GLOBAL_STATE:
        numpy_state, python_state = np.random.get_state(), random.getstate()  # noqa: NPY002
        np.random.seed(words)  # noqa: NPY002 (hooks of others draw from it)
        random.seed(words.tobytes())
        try:
            yield
        finally:
            np.random.set_state(numpy_state)  # noqa: NPY002
            random.setstate(python_state)


def _parameters(function: Hook) -> list[inspect.Parameter] | None:
    try:
        return list(inspect.signature(function).parameters.values())
    except (TypeError, ValueError):  # some built-in functions have none
        return None


def _arguments(
    parameters: list[inspect.Parameter],
    offers: Mapping[str, Offer],
    params: Mapping[str, Any],
    key: str,
) -> dict[str, Any]:
    found: dict[str, Any] = {}
    takes_all = any(row.kind is inspect.Parameter.VAR_KEYWORD for row in parameters)
    names = {row.name for row in parameters if row.kind in _BY_NAME}
    for name in names:
        if name in params:
            found[name] = params[name]
        elif name in offers:
            found[name] = offers[name]()
    if takes_all:
        found.update({name: value for name, value in params.items() if name not in found})
    elif "params" not in names:
        unused = [name for name in params if name not in found]
        if unused:
            raise HookError(f"{key}: params.{unused[0]}: the function has no such argument")
    for row in parameters:
        if row.name not in found and row.default is row.empty and row.kind in _BY_NAME:
            allowed = ", ".join([*offers, *params])
            raise HookError(
                f"{key}: its argument '{row.name}' has no default and is none of what hooks get: "
                f"{allowed}"
            )
    return found


def call(
    function: Hook,
    key: str,
    *,
    seed: int,
    index: int,
    offers: Mapping[str, Offer],
    params: Mapping[str, Any] | None = None,
    first: str | None = None,
    draws: str | None = None,
) -> Any:
    """Calls a hook and returns its result.

    key: its path in the configuration, for errors and random numbers. index: the scene or step that
    it draws for. offers: arguments that it may ask for by name, besides `rng` and `params`. first:
    the offer that its first argument receives if it has a name of its own. draws: key of its random
    numbers (default: key)."""
    given = dict(params or {})
    what = f"hook:{draws or key}"
    all_offers: dict[str, Offer] = {
        **offers,
        "rng": lambda: generator(seed, what, index),
        "params": lambda: dict(given),
    }
    parameters = _parameters(function)
    positional: list[Any] = []
    if first is not None and (parameters is None or _is_own_name(parameters, all_offers, given)):
        positional = [all_offers[first]()]
        parameters = None if parameters is None else parameters[1:]
    keywords = {} if parameters is None else _arguments(parameters, all_offers, given, key)
    with _global_generators(seed, what, index):
        try:
            return function(*positional, **keywords)
        except Exception as error:
            error.add_note(f"raised by the hook of {key}")
            raise


def _is_own_name(
    parameters: list[inspect.Parameter], offers: Mapping[str, Offer], params: Mapping[str, Any]
) -> bool:
    """Whether the first argument is positional and its name is not among the offers."""
    if not parameters:
        return False
    row = parameters[0]
    if row.kind is inspect.Parameter.POSITIONAL_ONLY:
        return True
    if row.kind is inspect.Parameter.VAR_POSITIONAL:
        return True
    return row.kind in _BY_NAME[:1] and row.name not in offers and row.name not in params
