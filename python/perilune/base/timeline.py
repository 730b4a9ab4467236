"""The timeline: step, scene and sensor of a frame's index.

A step is an instant of the world, step_s * step after the epoch. A scene is a run of
`frames_per_scene` steps that share what is drawn once a scene. In a step every triggered sensor
takes a frame: frame indices count steps and, within a step, sensors in the order of the
configuration. Without sensors a frame is a step."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import lru_cache


@dataclass(frozen=True)
class Moment:
    """Step, scene and sensor of a frame.

    The world of a frame is drawn by its step or its scene, so that all sensors of a step see the
    same one. Only what belongs to the image alone (noise of the renderer) is drawn by its index."""

    index: int
    step: int
    scene: int
    sensor: str | None
    """Name of the sensor; None without a section `sensors`."""


@dataclass(frozen=True)
class Timeline:
    """The steps, scenes and sensors of a configuration."""

    frames_per_scene: int = 1
    """Steps from one scene to the next."""
    trigger_intervals: Mapping[str, int] = field(default_factory=dict)
    """Sensor -> steps between its frames, from step 0 on."""

    def at(self, index: int) -> Moment:
        """Step, scene and sensor of a frame; index >= 0."""
        if not self.trigger_intervals:
            return Moment(index, index, index // self.frames_per_scene, None)
        return _moment(self.frames_per_scene, tuple(self.trigger_intervals.items()), index)

    def frames_before(self, step: int) -> int:
        """Number of frames in the steps 0 to step - 1."""
        if not self.trigger_intervals:
            return step
        return sum(-(-step // interval) for interval in self.trigger_intervals.values())

    def sensors_of(self, step: int) -> tuple[str, ...]:
        """The sensors that take a frame at a step, in order; () without sensors."""
        return tuple(n for n, interval in self.trigger_intervals.items() if step % interval == 0)

    def index_of(self, step: int, sensor: str | None = None) -> int:
        """Index of the frame that a sensor takes at a step; ValueError if it takes none."""
        first = self.frames_before(step)
        if sensor is None and not self.trigger_intervals:
            return first
        names = self.sensors_of(step)
        if sensor not in names:
            raise ValueError(f"step {step}: sensor {sensor!r} takes no frame; {names} do")
        return first + names.index(sensor)

    def earlier(self, index: int, frames: int) -> int:
        """Index of the frame that the same sensor took this many of its frames before; its first in
        the scene if there are fewer."""
        moment = self.at(index)
        interval = 1 if moment.sensor is None else self.trigger_intervals[moment.sensor]
        first = -(-moment.scene * self.frames_per_scene // interval) * interval
        step = max(min(first, moment.step), moment.step - frames * interval)
        return self.index_of(step, moment.sensor)

    def beside(self, index: int, frames: int) -> int | None:
        """Index of the frame that the same sensor takes this many of its frames later (before, if
        negative); None if the scene has none."""
        moment = self.at(index)
        interval = 1 if moment.sensor is None else self.trigger_intervals[moment.sensor]
        step = moment.step + frames * interval
        if step < 0 or step // self.frames_per_scene != moment.scene:
            return None
        return self.index_of(step, moment.sensor)

    def _step_and_sensor(self, index: int) -> tuple[int, str]:
        # The last step with no more than `index` frames before it: it has the frame itself, as a
        # step without frames has as many before it as the next one. The sensor triggered most
        # often alone would have taken the frame at step `index * its interval`.
        low, high = 0, index * min(self.trigger_intervals.values())
        while low < high:
            middle = (low + high + 1) // 2
            if self.frames_before(middle) <= index:
                low = middle
            else:
                high = middle - 1
        return low, self.sensors_of(low)[index - self.frames_before(low)]


@lru_cache(maxsize=256, typed=True)
def _moment(frames_per_scene: int, intervals: tuple[tuple[str, int], ...], index: int) -> Moment:
    """Cached, as making a frame asks for its moment several times."""
    step, sensor = Timeline(frames_per_scene, dict(intervals))._step_and_sensor(index)
    return Moment(index, step, step // frames_per_scene, sensor)
