"""A rendered frame: a mapping of channel names to arrays, with its labels, camera and plan."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from perilune import _core
from perilune.camera.label import CameraLabel
from perilune.frame.shown import Plan, object_rows
from perilune.sky.star import STAR

__all__ = ["STAR", "Array", "CameraLabel", "Description", "Sample"]

Array = NDArray[Any]


class Described(Protocol):
    """What a sample tells of its frame beside the arrays."""

    @property
    def camera(self) -> CameraLabel:
        """See Sample.camera."""

    def meta(self) -> dict[str, Any]:
        """A new copy of what Sample.meta has."""


@dataclass(frozen=True)
class Description:
    """A camera and metadata that are there already."""

    camera: CameraLabel
    keys: Mapping[str, Any]

    def meta(self) -> dict[str, Any]:
        """See Described."""
        return dict(self.keys)


class Sample(Mapping[str, Array]):
    """One frame: `sample["rgb"]` and so on are the pixel channels that were computed."""

    __slots__ = ("_channels", "_described", "_meta", "_objects", "_tables", "plan", "stars")

    def __init__(
        self,
        channels: Mapping[str, Array],
        objects: Array | None,
        described: Described,
        plan: list[_core.PlanRow],
        stars: Array | None = None,
        tables: Mapping[str, Array] | None = None,
    ) -> None:
        self._tables = dict(tables or {})
        self._channels = dict(channels)
        self._objects = None if objects is None else object_rows(objects)
        self._described = described
        self._meta: dict[str, Any] | None = None
        self.plan = Plan(plan)
        self.stars = np.empty(0, STAR) if stars is None else stars
        """Stars that the colours show, one row each, brightest first: number and magnitude of the
        catalogue, and the pixel position u, v of the centre, including the lens's distortion. Empty
        unless a colour channel was asked for. Stars that are hidden, or too faint for the exposure
        (row `stars` of the plan), are not included."""

    @property
    def camera(self) -> CameraLabel:
        """The camera in the middle of the exposure."""
        return self._described.camera

    @property
    def meta(self) -> dict[str, Any]:
        """Metadata of the frame, by key:

        seed, index, step, scene, sensor, time_utc
        t_s, jd_tdb     time of the opening shutter: seconds after the epoch; Julian date (TDB),
                        day and fraction
        sun             {"position_m": (3), root frame; "direction": (3), unit, from the camera
                        to the Sun, camera axes}
        states          body or spacecraft -> {"position_m", "velocity_m_s": (3), root frame;
                        "q_wxyz": rotation from its axes to the root's}, in the middle of the
                        exposure
        effects         names of the effects that are on, as in `plan`
        drivers         key path -> value
        scene_drivers   the same for the scene's first step, if it differs
        overrides       key path -> value: changes by with_overrides, Dataset.set, Stream.set
        quality         the word of render.quality whose samples, tolerance and filter the frame
                        has: draft, train (the defaults), reference; adaptive for other values
        lens            {"model", "coefficients"} of the picture's distortion, or None; labels
                        have that of `camera`
        shutter         {"exposure_s", "line_time_s"}: times of a row, and from row to row
        white_radiance  W m-2 sr-1 shown as 255; None if an automatic exposure was not measured,
                        because only labels were asked for
        timings_s       duration of each stage of the rendering
        exposure_s, gain_e_dn  of the sensor, if one of its channels was asked for
        bands           name, mean_um and sun_part of each band, if bands or planes were asked
                        for; see perilune.camera.bands.described
        articulation    spacecraft -> node -> {"motion": (4, 4), m, maps a point of the object's
                        frame from the rest pose to its present place; "joints": {"angle_deg"}
                        or {"translation_m"} for each of the node's joints}
        rows            under a rolling shutter: poses of some rows, see perilune.frame.rows;
                        `camera` and `objects` refer to the middle of the frame
        """
        if self._meta is None:
            self._meta = self._described.meta()
        return self._meta

    @property
    def keypoints(self) -> Array:
        """Keypoints of spacecraft and landmarks of bodies: a structured array, docs/labels.md."""
        return self._table("keypoints")

    @property
    def hierarchy(self) -> Array:
        """Spacecraft, the nodes of their models, and parts, each with a pose, boxes and visible
        fraction, and the row above it: a structured array, docs/labels.md."""
        return self._table("hierarchy")

    def _table(self, name: str) -> Array:
        if name not in self._tables:
            raise AttributeError(f"this sample has no {name}: ask for the channel '{name}'")
        return self._tables[name]

    @property
    def objects(self) -> Array:
        """Labels of the spacecraft, then of the bodies with `annotate`, as a structured array, one
        row each in the order of the configuration.

        The rows of `sample["masks"]` have the same order."""
        if self._objects is None:
            raise AttributeError("this sample has no object labels: ask for the channel 'objects'")
        return self._objects

    @property
    def has_objects(self) -> bool:
        """Whether object labels were asked for."""
        return self._objects is not None

    def __getitem__(self, name: str) -> Array:
        try:
            return self._channels[name]
        except KeyError:
            held = ", ".join(self._channels) or "no channel"
            raise KeyError(f"'{name}' was not asked for; this sample holds {held}") from None

    def __iter__(self) -> Iterator[str]:
        return iter(self._channels)

    def __len__(self) -> int:
        return len(self._channels)

    def _repr_html_(self) -> str:
        from perilune.show.display import sample_html

        return sample_html(self)

    def __reduce__(self) -> tuple[Any, ...]:
        described = Description(self.camera, self.meta)
        return Sample, (
            *(self._channels, self._objects, described, list(self.plan)),
            *(self.stars, self._tables),
        )

    def __repr__(self) -> str:
        arrays = ", ".join(f"{k}: {v.dtype} {v.shape}" for k, v in self._channels.items())
        count = len(self._objects) if self._objects is not None else 0
        noun = "object" if count == 1 else "objects"
        return f"<Sample {self.meta['index']}, {self.meta['time_utc']}, {count} {noun}: {arrays}>"
