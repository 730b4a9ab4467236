"""Sunlight, its bands, and clouds: `perilune._core` has their names, for type checkers."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from perilune._core_records import BandLight, CloudSettings

F64 = NDArray[np.float64]

def cloud_cover(settings: CloudSettings, points: F64, width_m: float, detail: int) -> F64:
    """The part (n,) that clouds without a map cover of footprints of a width about points (n, 3),
    m, body axes, with so many octaves of the noise."""

def sunlight(
    points: F64, sun: F64, sun_radius: float, poses: F64, radii: F64, wavelengths_um: F64, nodes:
    int = 16
) -> tuple[F64, NDArray[np.bool_]]:
    """The fraction (n, bands) of the sun's irradiance, on a surface that faces it, that bodies let
    through to points, and which hide a part of the disc (n, bodies).

    Common axes, metres. points (n, 3); sun (n, 3): its centre; poses (n, bodies, 7): body to the
    common axes; radii (bodies, 3): semi-axes. wavelengths_um (bands,): by which the disc darkens
    towards its edge (Neckel 2005, cut off to 0.4226..1.1), 0 for a disc of even brightness. nodes:
    of the quadrature, 1 to 64: the error is below 1e-12 with 16 for an even disc. Any number of
    bodies at once, ellipsoids exactly; those whose centre is nearer than the sun's surface count.
    0 inside a body. ValueError inside the sun, and for numbers out of range."""

def band_gather(sun: F64 | None, responses: Sequence[F64], step_um: float) -> BandLight:
    """What a band gathers of sunlight that reflectances of a colour leave.

    responses: one to four curves, (n, 2) of wavelength, um, rising, and value: straight between,
    0 outside; the band is their product. sun: a curve in any scale; None: a black body of 5850 K
    with 0.7 of its light below 0.4 um. step_um: longest piece of the integration. ValueError for
    what is no curve, and a first response that reaches beyond the sun's."""
