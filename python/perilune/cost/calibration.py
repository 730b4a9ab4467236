"""Costs of units of work on this machine: measured by `perilune calibrate`, kept in a file.

Frames never depend on it: what is left out of them, and `render.time_budget_ms`, follow the table
that ships. It changes what `perilune plan` and `--budget-ms` tell."""

from __future__ import annotations

import json
import math
import os
import platform
import time
import warnings
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

import numpy as np
from numpy.typing import NDArray

from perilune import _core
from perilune.base import files
from perilune.config.errors import ConfigError

if TYPE_CHECKING:
    from perilune.simulation import Simulation

F64 = NDArray[np.float64]
SCENES: Final = (
    "demo",
    "iss_leo",
    "voyager_phobos",
    "articulated",
    "material",
    "mli_randomised",
    "phobos",
    "moonlet",
    "comet",
    "fictional",
    "clouds",
    "cassini_saturn",
    "lro_moon",
    "mro_mars",
    "rendezvous",
    "star_tracker",
    "lunar_lander",
    "lunar_rover",
    "mars_descent",
)
"""Configurations that are timed: together they have every unit of work that ground, meshes, bodies,
air, clouds and volumes take. Those with large elevation models take long to open."""
WIDTH: Final = 80
"""Pixels in a row of the pictures that are timed."""
SETTINGS: Final[Sequence[Mapping[str, Any]]] = (
    {},
    {"render.samples": 4},
    {"render.samples": 4, "render.tolerance_dn": 0.0},
)
"""Overrides of each configuration: the ratios of units of work differ between them."""
PRIOR: Final = 0.1
"""Weight of the shipped table, scaled to the machine, against one picture: it decides between units
that the pictures do not tell apart."""
_ROUNDS: Final = 12
_REPEATS: Final = 2


class CostsError(ValueError):
    """A file of costs that cannot be read, which it names; or nothing that can be timed."""


@dataclass(frozen=True)
class Costs:
    """Nanoseconds of one thread by unit of work."""

    ns: Mapping[str, float]
    source: str
    """Whose they are, for people."""


@dataclass(frozen=True)
class Timed:
    """A picture that was timed: counts of its work, and its CPU time."""

    name: str
    counts: Mapping[str, int]
    ms: float


def path() -> Path:
    """The file of this user's costs."""
    home = os.environ.get("XDG_CONFIG_HOME") or Path.home() / ".config"
    return Path(home) / "perilune" / "costs.json"


def of_table() -> Costs:
    """The costs that ship."""
    return Costs({row["name"]: row["ns"] for row in _core.COSTS}, "the table that ships")


def machine() -> str:
    """Name of this machine's processor."""
    try:
        lines = files.text(Path("/proc/cpuinfo")).splitlines()
    except OSError:
        lines = []
    named = [line.split(":", 1)[1].strip() for line in lines if line.startswith("model name")]
    return named[0] if named else platform.processor() or platform.machine()


def kept(file: Path | None = None) -> dict[str, Any] | None:
    """What the last calibration found; None if there was none. CostsError for a file that is not
    one."""
    file = file or path()
    if not file.exists():
        return None
    try:
        found = json.loads(file.read_text(encoding="utf-8"))
        ns = {name: float(found["ns"][name]) for name in of_table().ns}
        if not all(math.isfinite(value) and value >= 0.0 for value in ns.values()):
            raise ValueError("a cost is not a number of at least 0")
        return {**found, "ns": ns, "machine": str(found["machine"]), "made": float(found["made"])}
    except (OSError, ValueError, KeyError, TypeError) as error:
        raise CostsError(
            f"{file}: is no file of costs of this version ({error}): `perilune calibrate` makes"
            " one, `perilune calibrate --reset` removes it"
        ) from None


def current() -> Costs:
    """The user's costs, or those that ship."""
    found = kept()
    if found is None:
        return of_table()
    days = (time.time() - found["made"]) / 86400.0
    other = "" if found["machine"] == machine() else f" of another machine, {found['machine']}"
    return Costs(found["ns"], f"the calibration{other} of {days:.0f} days ago")


def fit(pictures: Sequence[Timed], prior: Mapping[str, float]) -> tuple[dict[str, float], F64]:
    """Costs by unit of work that explain the times of pictures, and expected over measured time of
    each.

    Least squares of relative errors. The prior, times the median of its own errors, counts as
    PRIOR pictures for each unit; no cost is below a hundredth of it."""
    names = list(prior)
    counts = np.array([[p.counts.get(name, 0) for name in names] for p in pictures], dtype=float)
    a = 1e-6 * counts / np.array([p.ms for p in pictures])[:, None]
    guess = np.array([prior[name] for name in names])
    guess = guess / np.median(a @ guess)
    weights, found = np.ones(len(pictures)), guess
    for _ in range(_ROUNDS):
        scaled = a * guess * weights[:, None]
        matrix = np.vstack([scaled, math.sqrt(PRIOR) * np.eye(len(names))])
        wanted = np.concatenate([weights, math.sqrt(PRIOR) * np.ones(len(names))])
        found = guess * np.maximum(np.linalg.lstsq(matrix, wanted, rcond=None)[0], 0.01)
        # Absolute errors rather than squares: one odd picture must not move the others.
        weights = 1.0 / np.sqrt(np.maximum(np.abs(a @ found - 1.0), 0.05))
    return {name: float(cost) for name, cost in zip(names, found, strict=True)}, a @ found


def timed(sim: Simulation, name: str, index: int = 0) -> Timed:
    """Counts and CPU time of a frame's colour on one thread, the least of two after a first one,
    which makes what is kept."""
    from perilune.frame.request import arrays_of

    scene, handles = sim.world(index), sim._mine()
    request = sim._request(scene)
    request["sensor"] = None
    took, counts = [], {}
    with handles.lock:
        renderer = handles.renderer_of(scene.config)
        arrays = arrays_of(scene.config, ["rgb"], {}, handles.pool)
        for _ in range(1 + _REPEATS):
            begin = time.process_time()
            counts = renderer.render(request, arrays, 1)["work"]
            took.append(1e3 * (time.process_time() - begin))
    return Timed(name, counts, min(took[1:]))


def _pictures(
    opened: Callable[..., Simulation], progress: Callable[[int, int], object] | None
) -> tuple[list[Timed], dict[str, str]]:
    """Pictures, and by configuration why it has none: its maps are not here, say."""
    names = [f"configs/{name}.yaml" for name in SCENES]
    found: list[Timed] = []
    left_out: dict[str, str] = {}
    for done, name in enumerate(names, 1):
        for setting in SETTINGS:
            word = {"render.quality": "adaptive"} if setting else {}
            try:
                size = opened(name).config.camera
                changes = {
                    "camera.width": min(WIDTH, size.width),
                    "camera.height": max(1, round(min(1.0, WIDTH / size.width) * size.height)),
                }
                sim = opened(name, overrides={**changes, **word, **setting})
                found.append(timed(sim, name))
            except (ConfigError, OSError) as error:
                left_out[name] = str(error)
                break
        if progress is not None:
            progress(done, len(names))
    if not found:
        raise CostsError(f"nothing can be timed: {'; '.join(left_out.values())}")
    return found, left_out


def calibrate(
    opened: Callable[..., Simulation], progress: Callable[[int, int], object] | None = None
) -> dict[str, Any]:
    """Times the configurations that come with Perilune, small, at several settings, and fits the
    costs of units of work to them; returns what is to be kept. opened: perilune.open. CostsError if
    none of them can be opened."""
    begin = time.perf_counter()
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", UserWarning)
        pictures, left_out = _pictures(opened, progress)
    ns, ratios = fit(pictures, of_table().ns)
    return {
        "ns": ns,
        "machine": machine(),
        "made": time.time(),
        "took_s": time.perf_counter() - begin,
        "left_out": left_out,
        "pictures": [
            {"name": picture.name, "ms": picture.ms, "expected_over_measured": ratio}
            for picture, ratio in zip(pictures, ratios.tolist(), strict=True)
        ],
    }


def save(found: Mapping[str, Any], file: Path | None = None) -> Path:
    """Writes what `calibrate` found: all of it, or nothing."""
    file = file or path()
    file.parent.mkdir(parents=True, exist_ok=True)
    temporary = file.with_name(f"{file.name}.{os.getpid()}")
    try:
        temporary.write_text(json.dumps(found, indent=1) + "\n", encoding="utf-8")
        temporary.replace(file)
    finally:
        temporary.unlink(missing_ok=True)
    return file
