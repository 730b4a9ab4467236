"""The knobs of a scene, from cheap to exact. A new knob is one line of the table KNOBS."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

from perilune import _core
from perilune.config.orbit import J2, Kepler, Numerical

if TYPE_CHECKING:
    from perilune.config import Config

IMAGE, ORBIT = "image", "orbit"
OF_CHANCE = frozenset({"shot_noise", "read_noise", "cosmic_rays"})
"""Noise of one exposure: it is the truth, not an error, and is left out of all pictures."""


@dataclass(frozen=True)
class Rung:
    """One setting of a knob: values by key path, and effects that are left out."""

    name: str
    changes: Mapping[str, Any] = field(default_factory=dict)
    off: tuple[str, ...] = ()


@dataclass(frozen=True)
class Scene:
    """What the rungs of knobs depend on."""

    config: Config
    present: frozenset[str]
    """Effects that can matter in the frame."""
    quick: bool = False

    def steps(self, values: Sequence[Any], own: Any = None) -> list[Any]:
        """All values with the scene's own, in order; every other one of a quick study, but for the
        first and the last."""
        found = sorted({*values, *([] if own is None else [own])})
        return found if not self.quick else [*found[:-1:2], found[-1]]


Rungs = Sequence[Rung]


@dataclass(frozen=True)
class Knob:
    """One knob of a scene: its rungs go from cheap to exact."""

    name: str
    doc: str
    rungs: Rungs
    noisy: bool = False
    """Whether it changes the noise of pictures, not only what they converge to."""
    of: str = IMAGE
    """What errs: the image, or an orbit."""


@dataclass(frozen=True)
class Row:
    """One line of the table: what it makes of a scene; no knob where rungs are fewer than two."""

    name: str
    doc: str
    rungs: Callable[[Scene], Iterator[tuple[str, Rungs]] | Rungs]
    noisy: bool = False
    of: str = IMAGE

    def knobs(self, scene: Scene) -> Iterator[Knob]:
        """The knobs of a scene: one, or one for each entity that has it."""
        made = self.rungs(scene)
        named = [(self.name, made)] if isinstance(made, Sequence) else list(made)
        for name, rungs in named:
            if len(rungs) > 1:
                yield Knob(name, self.doc, rungs, self.noisy, self.of)


def values(key: str, *steps: Any, needs: str | None = None) -> Callable[[Scene], Rungs]:
    """Rungs of one number of the section `render`, which has an effect that it needs."""

    def rungs(scene: Scene) -> Rungs:
        if needs is not None and needs not in scene.present:
            return []
        own = getattr(scene.config.render, key)
        return [Rung(f"{v:g}", {f"render.{key}": v}) for v in scene.steps(steps, own)]

    return rungs


def switches(*rungs: tuple[str, tuple[str, ...]]) -> Callable[[Scene], Rungs]:
    """Rungs that leave effects out; those that leave out nothing of the scene fall together."""

    def made(scene: Scene) -> Rungs:
        found: dict[tuple[str, ...], Rung] = {}
        for name, effects in rungs:
            off = tuple(effect for effect in effects if effect in scene.present)
            found[off] = Rung(name, off=off)
        return list(found.values())

    return made


def tolerances(scene: Scene) -> Rungs:
    """From a coarse tolerance to none."""
    own = scene.config.render.tolerance_dn
    steps = sorted({8.0, 4.0, 2.0, 1.0, 0.5, own, 0.0}, reverse=True)
    if scene.quick:
        steps = sorted({4.0, 1.0, own, 0.0}, reverse=True)
    return [Rung(f"{v:g} DN", {"render.tolerance_dn": v}) for v in steps]


def filters(scene: Scene) -> Rungs:
    """The filters of textures, where there are any."""
    if "texture_filter" not in scene.present or "surface_maps" not in scene.present:
        return []
    names = ("nearest", "bilinear", "trilinear", "anisotropic_4", "anisotropic_16")
    chosen = names[::2] if scene.quick else names
    return [Rung(name, {"render.texture_filter": name}) for name in chosen]


def of_terrain(
    name: str, key: str, steps: Sequence[float]
) -> Callable[[Scene], Iterator[tuple[str, Rungs]]]:
    """Rungs of one number of each body's `terrain`."""

    def rungs(scene: Scene) -> Iterator[tuple[str, Rungs]]:
        for body, entry in scene.config.bodies.items():
            if entry.terrain is not None and "terrain" in scene.present:
                path = f"bodies.{body}.terrain.{key}"
                found = scene.steps(steps, getattr(entry.terrain, key))
                yield f"{name}, {body}", [Rung(f"{v:g}", {path: v}) for v in found]

    return rungs


def grains(
    name: str, section: str, default_m: float
) -> Callable[[Scene], Iterator[tuple[str, Rungs]]]:
    """Rungs of the least diameter of craters or rocks, from none to all."""

    def rungs(scene: Scene) -> Iterator[tuple[str, Rungs]]:
        for body, entry in scene.config.bodies.items():
            given = getattr(entry.terrain, section, None)
            if given is None or "terrain" not in scene.present:
                continue
            path = f"bodies.{body}.terrain.{section}"
            own = given.min_diameter_m or default_m
            least = [own * factor for factor in ((64, 8) if scene.quick else (64, 16, 4, 2))]
            most = given.max_diameter_m or float("inf")
            cheap = [Rung(f"{m:.3g} m", {f"{path}.min_diameter_m": m}) for m in least if m < most]
            exact = Rung(f"{own:.3g} m", {f"{path}.min_diameter_m": own})
            yield f"{name}, {body}", [Rung("none", {path: None}), *cheap, exact]

    return rungs


def propagators(scene: Scene) -> Iterator[tuple[str, Rungs]]:
    """From two bodies to integrated forces, for each spacecraft whose orbit has elements. Mean
    elements have no integrated orbit beside them: theirs end with their own drift."""
    for name, craft in scene.config.spacecraft.items():
        orbit, path = craft.orbit, f"spacecraft.{name}.orbit"
        if not isinstance(orbit, (Kepler, J2, Numerical)):
            continue
        if getattr(orbit, "position_km", None) is not None:
            continue
        mean = isinstance(orbit, J2) and not orbit.osculating
        osculating = {} if mean else {f"{path}.osculating": True}
        kinds = [
            Rung("kepler", {f"{path}.kind": "kepler"}),
            Rung("j2", {f"{path}.kind": "j2", **osculating}),
        ]
        yield f"orbit, {name}", kinds if mean else [*kinds, *_integrated(orbit, path, scene.quick)]


def _integrated(orbit: object, path: str, quick: bool) -> list[Rung]:
    """The scene's own forces, or the table's harmonics, at several tolerances of a step."""
    if isinstance(orbit, Numerical):
        given: dict[str, Any] = {}
    else:
        given = {f"{path}.kind": "numerical", f"{path}.forces": {"harmonics": {"degree": 6}}}
    return [
        Rung(f"numerical, {rtol:g}", {**given, f"{path}.rtol": rtol})
        for rtol in (_RTOL[::2] if quick else _RTOL)
    ]


_RTOL = (1e-6, 1e-9, 1e-13)

KNOBS: tuple[Row, ...] = (
    Row("samples", "colour samples a pixel", values("samples", 1, 2, 4, 8, 16, 32, 64), True),
    Row("tolerance", "what may be left out, smoothed and shared", tolerances, True),
    Row("bounces", "longest light path", values("max_bounces", 0, 1, 2, 4, 8, needs="bounces")),
    Row("sun", "a point, a disc, a disc with a dark limb", switches(
        ("point", ("soft_sun", "limb_darkening")), ("even disc", ("limb_darkening",)),
        ("disc", ()))),
    Row("reflectance law", "Lambert's in place of Hapke's", switches(
        ("lambert", ("regolith",)), ("own", ()))),
    Row("air", "none, light scattered once, and more than once", switches(
        ("none", ("atmosphere", "skylight", "multiple_scattering")),
        ("once, no skylight", ("skylight", "multiple_scattering")),
        ("once", ("multiple_scattering",)), ("all", ()))),
    Row("texture filter", "texels a lookup reads", filters),
    Row("volume steps", "steps along a ray through volumes",
        values("volume_steps", 4, 8, 16, 32, 64, 128, needs="volumes")),
    Row("ground mesh", "cells of the mesh along a pixel",
        of_terrain("ground mesh", "cells_per_pixel", (0.25, 0.5, 1.0, 2.0, 4.0))),
    Row("craters", "least crater that is drawn", grains("craters", "craters", 0.1)),
    Row("rocks", "least rock that is drawn", grains("rocks", "rocks", 0.05)),
    Row("point spread", "blur and glare of the lens", switches(
        ("none", ("point_spread",)), ("own", ()))),
    Row("orbit", "propagator", propagators, of=ORBIT),
)  # fmt: skip
"""The table. Every effect that no line names has a switch besides, by `rest`."""

_NAMED = frozenset({
    "soft_sun", "limb_darkening", "regolith", "atmosphere", "skylight", "multiple_scattering",
    "texture_filter", "volumes", "bounces", "antialiasing", "terrain", "point_spread",
})  # fmt: skip


def rest(scene: Scene) -> Iterator[Knob]:
    """A switch for each effect of the scene that has no line in the table."""
    for effect in _core.EFFECTS:
        name = effect["name"]
        if name in scene.present and name not in _NAMED | OF_CHANCE:
            rungs = (Rung("off", off=(name,)), Rung("on"))
            yield Knob(name, effect["doc"], rungs)


def knobs_of(scene: Scene) -> list[Knob]:
    """Every knob that the scene has."""
    return [knob for row in KNOBS for knob in row.knobs(scene)] + list(rest(scene))
