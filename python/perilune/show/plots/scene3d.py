"""Bodies and lines in three dimensions with correct occlusion.

matplotlib sorts whole artists by depth, not points. Lines are therefore cut at the planes through
the bodies' centres that face the viewer, and drawn before or after each body. This is exact for
spheres as long as the view of the figure is unchanged."""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from perilune.base import rotations
from perilune.show.plots.figures import BODY_GREY, length_unit

F64 = NDArray[np.float64]
_LATITUDES, _LONGITUDES = 120, 240
_ZOOM = 0.82  # matplotlib leaves no room for the labels of the third axis
_NIGHT = 0.35
"""Brightness of a body's night side, so that it remains visible."""


@dataclass(frozen=True)
class _Ball:
    center_m: F64
    radii_m: F64
    q: F64
    image: NDArray[np.uint8] | None
    to_sun: F64 | None


class Scene3D:
    """Collects objects in metres, and draws them in a readable unit with the same scale on all
    axes."""

    def __init__(self, figure: Any, place: Any, elevation_deg: float, azimuth_deg: float) -> None:
        """place: position as for Figure.add_subplot, such as 111."""
        self.axes = figure.add_subplot(place, projection="3d", computed_zorder=False)
        self.axes.set_proj_type("ortho")
        self.axes.view_init(elev=elevation_deg, azim=azimuth_deg)
        elevation, azimuth = math.radians(elevation_deg), math.radians(azimuth_deg)
        flat = math.cos(elevation)
        self._towards = np.array(
            [flat * math.cos(azimuth), flat * math.sin(azimuth), math.sin(elevation)]
        )
        self._balls: list[_Ball] = []
        self._lines: list[tuple[F64, dict[str, Any]]] = []
        self._points: list[tuple[F64, dict[str, Any]]] = []
        self._meshes: list[tuple[F64, NDArray[Any]]] = []

    def add_ball(
        self,
        center_m: F64,
        radii_m: F64,
        q: F64,
        image: NDArray[np.uint8] | None = None,
        to_sun: F64 | None = None,
    ) -> None:
        """An ellipsoid with an equirectangular map, shaded by the direction of the Sun."""
        self._balls.append(_Ball(center_m, radii_m, q, image, to_sun))

    def add_line(self, points_m: F64, **style: Any) -> None:
        """A polyline (n, 3); style as matplotlib's."""
        self._lines.append((np.asarray(points_m, dtype=np.float64), style))

    def add_point(self, point_m: F64, **style: Any) -> None:
        """A marker; style as matplotlib's."""
        self._points.append((np.asarray(point_m, dtype=np.float64), style))

    def add_mesh(self, triangles_m: F64, colors: NDArray[Any]) -> None:
        """Triangles (n, 3, 3) with colours (n, 3) in 0..1."""
        self._meshes.append((triangles_m, colors))

    def draw(self, title: str, legend: bool = True) -> None:
        """Draws everything; call once."""
        corners = self._corners()
        low, high = corners.min(axis=0), corners.max(axis=0)
        half = 0.5 * float((high - low).max()) or 1.0
        unit, size = length_unit(2.0 * half)
        depths = sorted(float(ball.center_m @ self._towards) for ball in self._balls)
        for ball in self._balls:
            rank = depths.index(float(ball.center_m @ self._towards))
            self._draw_ball(ball, size, 2 * rank + 2)
        for line, style in self._lines:
            self._draw_line(line, style, depths, size)
        for point, style in self._points:
            rank = int(np.searchsorted(depths, float(point @ self._towards)))
            self.axes.plot(*(point / size)[:, None], zorder=2 * rank + 1.5, **style)
        for triangles, colors in self._meshes:
            self._draw_mesh(triangles, colors, depths, size)
        self._set_axes((low + high) / (2.0 * size), 1.04 * half / size, unit)
        self.axes.set_title(title, fontsize=10, y=0.98)
        handles, _ = self.axes.get_legend_handles_labels()
        if legend and handles:
            self.axes.legend(fontsize=8, loc="lower left", frameon=False)

    def _corners(self) -> F64:
        rows = [line for line, _ in self._lines if len(line)]
        rows += [point[None] for point, _ in self._points]
        rows += [triangles.reshape(-1, 3) for triangles, _ in self._meshes]
        for ball in self._balls:
            reach = float(ball.radii_m.max())
            rows.append(np.stack([ball.center_m - reach, ball.center_m + reach]))
        return np.concatenate(rows) if rows else np.zeros((1, 3))

    def _set_axes(self, center: F64, half: float, unit: str) -> None:
        axes = self.axes
        for name, middle in zip("xyz", center, strict=True):
            getattr(axes, f"set_{name}lim")(middle - half, middle + half)
            getattr(axes, f"set_{name}label")(f"{name} ({unit})", fontsize=8, labelpad=0)
            getattr(axes, f"{name}axis").set_major_locator(_locator())
            axes.tick_params(axis=name, labelsize=7, pad=0)
        axes.set_box_aspect((1.0, 1.0, 1.0), zoom=_ZOOM)

    def _draw_line(
        self, line: F64, style: dict[str, Any], depths: list[float], size: float
    ) -> None:
        """Draws pieces that lie between the same bodies; the label goes to the first."""
        ranks = np.searchsorted(depths, line @ self._towards)
        cuts = [0, *(np.flatnonzero(np.diff(ranks)) + 1), len(line)]
        rest = dict(style)
        for first, last in itertools.pairwise(cuts):
            piece = line[max(first - 1, 0) : last] / size
            self.axes.plot(*piece.T, zorder=2 * int(ranks[first]) + 1, **rest)
            rest.pop("label", None)

    def _draw_ball(self, ball: _Ball, size: float, zorder: float) -> None:
        latitude = np.linspace(-0.5 * math.pi, 0.5 * math.pi, _LATITUDES + 1)
        longitude = np.linspace(-math.pi, math.pi, _LONGITUDES + 1)
        lat, lon = np.meshgrid(latitude, longitude, indexing="ij")
        unit = np.stack([np.cos(lat) * np.cos(lon), np.cos(lat) * np.sin(lon), np.sin(lat)], axis=2)
        turn = rotations.to_matrix(ball.q)
        places = ((unit * ball.radii_m) @ turn.T + ball.center_m) / size
        middle = 0.25 * (unit[:-1, :-1] + unit[1:, :-1] + unit[:-1, 1:] + unit[1:, 1:])
        colors = np.ones((_LATITUDES, _LONGITUDES, 4))
        colors[..., :3] = BODY_GREY if ball.image is None else _sampled(ball.image)
        if ball.to_sun is not None:
            normals = middle / ball.radii_m @ turn.T
            normals /= np.linalg.norm(normals, axis=2, keepdims=True)
            light = np.clip(normals @ ball.to_sun, 0.0, 1.0) ** 0.5
            colors[..., :3] *= (_NIGHT + (1.0 - _NIGHT) * light)[..., None]
        self.axes.plot_surface(
            *np.moveaxis(places, 2, 0),
            facecolors=colors,
            rstride=1,
            cstride=1,
            shade=False,
            linewidth=0,
            antialiased=False,
            zorder=zorder,
        )

    def _draw_mesh(
        self, triangles: F64, colors: NDArray[Any], depths: list[float], size: float
    ) -> None:
        from mpl_toolkits.mplot3d.art3d import Poly3DCollection

        rank = int(np.searchsorted(depths, float(triangles.mean(axis=(0, 1)) @ self._towards)))
        self.axes.add_collection3d(
            Poly3DCollection(triangles / size, facecolors=colors, zorder=2 * rank + 1.2)
        )


def _sampled(image: NDArray[np.uint8]) -> F64:
    """Mean of the map over each quad, (latitudes from the south, longitudes from -180 deg, 3)."""
    height, width = image.shape[:2]
    rows = np.arange(_LATITUDES) * height // _LATITUDES
    columns = np.arange(_LONGITUDES) * width // _LONGITUDES
    sums = np.add.reduceat(np.add.reduceat(image.astype(np.float64), rows, 0), columns, 1)
    counts = np.diff([*rows, height])[:, None] * np.diff([*columns, width])
    # A quad of a small map may hold no pixel of its own; reduceat then gives the pixel it is in.
    return np.asarray(sums / np.maximum(counts, 1)[..., None] / 255.0)[::-1]


def _locator() -> Any:
    from matplotlib.ticker import MaxNLocator

    return MaxNLocator(nbins=4, steps=[1, 2, 2.5, 5, 10])
