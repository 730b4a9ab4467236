"""The key `areas` of a body: rasters that name parts of its surface, for labels."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field, model_validator

from perilune.config.elevation import Place, RawSamples
from perilune.config.errors import fail
from perilune.config.labels import ClassName, NumberRange
from perilune.config.types import FileName, Strict

SURFACE = "surface"
"""Part and class of a body where no area is."""
AREAS_MAX = 255


class AreaRaster(Strict):
    """Areas of a body's surface from one file: a whole body, or a patch that is laid over what
    comes before it. Each area is a part of the body, in the channel `part` and at the level `part`
    of `semantic`. A point has the number of the nearest post; where that is in no area, the raster
    before says."""

    file: FileName
    """As of terrain.elevation: PDS image, TIFF, NumPy array, grey PNG, or what rasterio reads.
    Relative to this file, or data:... under PERILUNE_DATA."""
    projection: Place | None = None
    """Where the raster lies. Default: what the file's label or georeference says."""
    raw: RawSamples | None = None
    """Layout of an .img file without a label."""
    band: Annotated[int, Field(strict=True, ge=1)] | None = None
    """Band of a TIFF with several, from 1 on."""
    classes: Annotated[dict[ClassName, NumberRange], Field(min_length=1)]
    """Name of an area -> its number in the file, or [least, greatest], both included. The first
    area that has a number counts. Numbers are the file's own: 0 to 255 of a PNG of 8 bits."""

    @model_validator(mode="after")
    def _sound(self) -> AreaRaster:
        for name, (low, high) in self.classes.items():
            if low > high:
                fail(f"classes.{name}", f"[{low:g}, {high:g}]: the least comes first")
            if name == SURFACE:
                fail(f"classes.{name}", "is the name of what is in no area; take another")
        return self
