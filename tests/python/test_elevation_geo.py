"""Elevation models and other rasters that rasterio reads (extra `geo`), as it writes them."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
import rasterio
from numpy.typing import NDArray
from tests.python.test_elevation import LOCAL, MOON, numbers, posts_of, read

from perilune.bodies.surface_rasters import ALBEDO, read_surface
from perilune.config.elevation import SurfaceRaster

LONGLAT = "+proj=longlat +R=1737400 +no_defs"
POLAR = "+proj=stere +lat_0=-90 +lat_ts=-90 +R=1737400 +units=m +no_defs"
UTM = "+proj=utm +zone=10 +datum=WGS84 +units=m +no_defs"


def write(
    path: Path, driver: str, values: NDArray[Any], crs: str | None = LONGLAT, **options: Any
) -> Path:
    """Columns from longitude -180 and rows from latitude 90 on, or about the pole."""
    bands = values if values.ndim == 3 else values[np.newaxis]
    count, height, width = bands.shape
    step = 360.0 / width if crs == LONGLAT else 100.0
    west, north = (-180.0, 90.0) if crs == LONGLAT else (-50.0 * width, 50.0 * height)
    extent = {"height": height, "width": width, "count": count, "dtype": bands.dtype}
    with rasterio.open(
        path, "w", driver=driver, crs=crs, **extent,
        transform=rasterio.transform.from_origin(west, north, step, step), **options,
    ) as file:  # fmt: skip
        file.write(bands)
    return path


@pytest.mark.parametrize(
    ("driver", "name", "crs"),
    [
        ("AAIGrid", "a.asc", LONGLAT),
        ("PDS4", "a.xml", POLAR),
        ("JP2OpenJPEG", "a.jp2", LONGLAT),
        ("ENVI", "a.bil", POLAR),
    ],
)
def test_other_formats(tmp_path: Path, driver: str, name: str, crs: str) -> None:
    values = numbers()
    lossless = {"REVERSIBLE": "YES", "QUALITY": "100"} if driver == "JP2OpenJPEG" else {}
    found = read(write(tmp_path / name, driver, values, crs, **lossless))
    np.testing.assert_array_equal(posts_of(found), values)
    assert found.raster.whole == (crs == LONGLAT)
    if crs == POLAR:  # x = 1750 m, to longitude 90, y = 850 m of the last column and first row
        want = found.raster.posts(np.array([[850.0, 1750.0, -1737.4e3]]))
        np.testing.assert_allclose(want, [[35.0, 0.0]], atol=0.01)


def test_scale_offset_unit_and_missing(tmp_path: Path) -> None:
    values = numbers("float32") * 1e-3
    values[3, 4] = -9.0
    path = write(tmp_path / "a.bil", "ENVI", values, nodata=-9.0)
    with rasterio.open(path, "r+") as file:
        file.scales, file.offsets, file.units = (0.5,), (2.0,), ("km",)
    found = read(path)
    assert found.missing == 1.0 / values.size
    heights = posts_of(found)
    known = values != -9.0
    np.testing.assert_allclose(heights[known], 500.0 * values[known] + 2000.0, atol=1e-3)
    np.testing.assert_allclose(
        posts_of(read(path, scale_m=3.0, offset_m=0.0))[known], 3.0 * values[known], atol=1e-4
    )
    with rasterio.open(path, "r+") as file:
        file.units = ("feet",)
    with pytest.raises(ValueError, match=r"scale_m: .*a\.bil: is in 'feet'; give the metres"):
        read(path)


def test_units_of_tiff(tmp_path: Path) -> None:
    """tifffile reads it; the unit stands in GDAL's metadata."""
    values = numbers() // 10
    path = write(tmp_path / "a.tif", "GTiff", values)
    with rasterio.open(path, "r+") as file:
        file.units = ("km",)
    np.testing.assert_allclose(posts_of(read(path)), 1e3 * values)


def test_masked_numbers_are_missing(tmp_path: Path) -> None:
    path = write(tmp_path / "a.jp2", "JP2OpenJPEG", np.ones((18, 36), np.uint8), LONGLAT)
    hidden = np.full((18, 36), 255, np.uint8)
    hidden[5, 6] = 0
    with rasterio.open(path, "r+") as file:
        file.write_mask(hidden)
    assert read(path).missing == 1.0 / 648.0


def test_bands(tmp_path: Path) -> None:
    """One must be chosen: of surface rasters by `band`; elevation models have one."""
    values = np.stack([numbers("uint8"), numbers("uint8") // 2])
    path = write(tmp_path / "a.bsq", "ENVI", values, LONGLAT)
    with pytest.raises(ValueError, match=r"file: .*a\.bsq: holds 2 bands of uint8, not one band"):
        read(path)
    given = SurfaceRaster(file=path.name, scale=0.01, band=2)
    found = read_surface(given, path, ALBEDO, MOON)
    np.testing.assert_allclose(posts_of(found), 0.01 * values[1], atol=1e-6)
    with pytest.raises(ValueError, match=r"band: .*a\.bsq: 3; the file has 2"):
        read_surface(given.model_copy(update={"band": 3}), path, ALBEDO, MOON)


def test_other_projections_are_named(tmp_path: Path) -> None:
    path = write(tmp_path / "a.bil", "ENVI", numbers(), UTM)
    with pytest.raises(
        ValueError, match=r"projection 'utm'; supported: geographic.*give projectio"
    ):
        read(path)
    ellipsoid = POLAR.replace("+R=1737400", "+a=1737400 +b=1737000")
    path = write(tmp_path / "b.bil", "ENVI", numbers(), ellipsoid)
    with pytest.raises(ValueError, match=r"projection: .*ellipsoid.*give projection"):
        read(path)


def test_no_georeference(tmp_path: Path) -> None:
    path = write(tmp_path / "a.jpg", "JPEG", numbers("uint8"), None)
    assert read(path, projection=LOCAL).samples.shape == (18, 36)


def test_the_netcdf_of_the_data(data_dir: Path) -> None:
    path = data_dir / "lunar_dem/edge_cases/dem_nodata_nan.nc"
    with pytest.raises(ValueError, match="the projection 'utm'"):
        read(path)
    found = read(path, projection=LOCAL)
    assert found.missing == pytest.approx(103 / 3975)
    assert np.isfinite(found.samples).all()
