"""Elevation models from files: LOLA's grids, GeoTIFF, PNG, arrays; gaps, steps, datums, errors."""

from __future__ import annotations

import math
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import tifffile
from numpy.typing import NDArray
from pydantic import ValidationError

from perilune import _core
from perilune.bodies.elevation import ElevationRaster, read_elevation
from perilune.bodies.gaps import filled
from perilune.config.elevation import Elevation

MOON = (1737400.0, 1737400.0, 1737400.0)
WHOLE = {"kind": "cylindrical", "west_deg": 0.0}
LOCAL = {"kind": "orthographic", "center_lon_lat_deg": [3.6, 26.1], "post_m": 2.0}
F64 = NDArray[np.float64]


def read(path: Path, radii_m: tuple[float, float, float] = MOON, **keys: Any) -> ElevationRaster:
    return read_elevation(Elevation.model_validate({"file": path.name, **keys}), path, radii_m)


def at(lon_deg: Any, lat_deg: Any) -> F64:
    lon, lat = np.broadcast_arrays(np.radians(lon_deg), np.radians(lat_deg))
    return np.stack([np.cos(lat) * np.cos(lon), np.cos(lat) * np.sin(lon), np.sin(lat)], -1)


def posts_of(found: ElevationRaster) -> F64:
    """(rows, columns) heights at the posts, asked for by direction."""
    rows, columns = found.samples.shape
    places = np.stack(np.meshgrid(np.arange(columns), np.arange(rows)), -1).reshape(-1, 2)
    directions = found.raster.directions(places.astype(np.float64))
    return found.heights(directions).reshape(rows, columns)


def numbers(dtype: str = "int16", shape: tuple[int, int] = (18, 36)) -> NDArray[Any]:
    wide = np.random.default_rng(7).integers(-3000, 3000, shape)
    return (wide + 3000 if dtype.startswith("u") else wide).astype(dtype)


def save(path: Path, values: NDArray[Any]) -> Path:
    np.save(path, values)
    return path


# --- the real data --------------------------------------------------------------------------------


def test_lola_reproduces_its_posts_and_the_highest_point(data_dir: Path) -> None:
    path = data_dir / "lunar_dem" / "ldem_4.img"
    found = read(path, projection=WHOLE, scale_m=0.5, datum_radius_km=1737.4)
    stored = np.fromfile(path, "<i2").reshape(720, 1440)
    assert isinstance(found.samples, np.memmap)  # nothing was copied
    assert found.raster.whole
    assert found.missing == 0.0
    assert found.remarks == (  # holes about the north pole
        "1412 of 1440 heights of a row about a pole are exactly 0: if they are missing, give "
        "missing: 0",
    )
    mended = read(path, projection=WHOLE, scale_m=0.5, missing=0.0)
    assert mended.remarks[0].startswith("2200 of 1036800 heights (0.21 %) are no-data")
    known = 0.5 * stored[:3][stored[:3] != 0]
    assert known.min() <= posts_of(mended)[0].min() < posts_of(mended)[0].max() <= known.max()
    np.testing.assert_array_equal(posts_of(found), 0.5 * stored)
    rows, columns = np.unravel_index(stored.argmax(), stored.shape)
    lat, lon = 90.0 - (rows + 0.5) / 4.0, (columns + 0.5) / 4.0
    assert (round(lat, 1), round(lon, 1)) == (5.4, 201.4)
    assert found.heights(at([lon], [lat])).tolist() == [10504.0]
    cubic = read(path, projection=WHOLE, scale_m=0.5, interpolation="cubic")
    np.testing.assert_array_equal(posts_of(cubic)[300:400], 0.5 * stored[300:400])


def test_the_png_of_the_same_heights(data_dir: Path) -> None:
    folder = data_dir / "lunar_dem"
    image = read(folder / "ldem_4.img", projection=WHOLE, scale_m=0.5)
    png = read(folder / "ldem_4_uint16.png", projection=WHOLE, scale_m=0.5, offset_m=-10000.0)
    assert png.samples.dtype == np.uint16
    directions = np.random.default_rng(1).normal(size=(20000, 3))
    np.testing.assert_allclose(png.heights(directions), image.heights(directions), atol=1e-9)


def test_the_polar_geotiff(data_dir: Path) -> None:
    """Beside the formulas of Snyder (1987), 21-5 to 21-8."""
    path = data_dir / "lunar_dem" / "dem_moon_npole_33x33.tif"
    found = read(path)
    stored = tifffile.imread(path)
    np.testing.assert_array_equal(posts_of(found), stored)
    assert found.raster.spacing_m(1737400.0) == pytest.approx(2.4266098484848486)
    step = 2.4266098484848486
    x, y = -53750.0 + 20.5 * step, -51050.0 - 7.5 * step
    colatitude = 2.0 * math.atan(math.hypot(x, y) / (2.0 * 1737400.0))
    lon_deg = math.degrees(math.atan2(x, -y))
    direction = at([lon_deg], [90.0 - math.degrees(colatitude)])
    assert found.heights(direction)[0] == pytest.approx(stored[7, 20], abs=1e-6)


def test_the_patch_of_apollo_15(data_dir: Path) -> None:
    (path,) = (data_dir / "lunar_dem" / "apollo15").glob("*.png")
    scale = 49.0 / 255.0
    plain = read(path, projection=LOCAL, scale_m=scale)
    assert plain.samples.dtype == np.uint8
    assert plain.raster.bounds() == (0.0, pytest.approx(49.0))
    smooth = read(path, projection=LOCAL, scale_m=scale, destep=True)
    before, after = posts_of(plain), posts_of(smooth)
    assert np.abs(after - before).max() <= 0.5 * scale * (1.0 + 1e-6)
    # Between two posts there is nothing or a whole step; smoothed, rarely exactly nothing.
    flat = [(np.diff(values, axis=1) == 0.0).mean() for values in (before, after)]
    assert flat[1] < 0.25 * flat[0]
    curvature = [np.diff(values, 2, axis=1).std() for values in (before, after)]
    assert curvature[1] < 0.7 * curvature[0]


def test_edge_cases_with_no_data(data_dir: Path) -> None:
    folder = data_dir / "lunar_dem" / "edge_cases"
    earth = (6378137.0, 6378137.0, 6356752.3142)
    found = read(folder / "dem_unfinished_nodata.tif", earth)  # undeclared -32768
    assert found.missing == pytest.approx(282 / 1089)
    assert "282 of 1089 heights (26 %) are no-data" in found.remarks[0]
    low, high = found.raster.bounds()
    assert (low, high) == (-10.0, 1909.0)
    ratio = earth[2] / earth[0]
    assert found.place.axis_ratio == pytest.approx(ratio, rel=1e-9)  # its latitudes are geodetic
    with pytest.raises(ValueError, match=r"projection: .*UTM Zone 10.*give projection"):
        read(folder / "dem_nodata.dem", earth)
    found = read(folder / "dem_nodata.dem", earth, projection={**LOCAL, "post_m": 150.0})
    assert found.remarks[0].startswith("96 of 4225 heights (2.3 %) are no-data: filled")
    assert found.raster.bounds()[0] >= 600.0


# --- kinds of files -------------------------------------------------------------------------------

LABEL = """PDS_VERSION_ID            = "PDS3"
RECORD_TYPE = FIXED_LENGTH
RECORD_BYTES = 72
^IMAGE = "grid.img" /* beside */
OBJECT = IMAGE
  LINES = {rows}
  LINE_SAMPLES = {columns}
  SAMPLE_TYPE = {type}
  SAMPLE_BITS = {bits}
  UNIT = {unit}
  SCALING_FACTOR = {scale}
  OFFSET = {offset}
  MISSING_CONSTANT = -9999
END_OBJECT = IMAGE
OBJECT = IMAGE_MAP_PROJECTION
  MAP_PROJECTION_TYPE = "{projection}"
  COORDINATE_SYSTEM_NAME = "MEAN EARTH/POLAR AXIS OF DE421"
  A_AXIS_RADIUS = 1737.4 <km>
  B_AXIS_RADIUS = 1737.4 <km>
  C_AXIS_RADIUS = 1737.4 <km>
  CENTER_LATITUDE = {lat} <deg>
  CENTER_LONGITUDE = {lon} <deg>
  POSITIVE_LONGITUDE_DIRECTION = "EAST"
  MAP_RESOLUTION = {resolution} <pix/deg>
  MAP_SCALE = {map_scale}
  MAXIMUM_LATITUDE = {north} <deg>
  MINIMUM_LATITUDE = {south} <deg>
  WESTERNMOST_LONGITUDE = {west} <deg>
  EASTERNMOST_LONGITUDE = {east} <deg>
  LINE_PROJECTION_OFFSET = {line}
  SAMPLE_PROJECTION_OFFSET = {sample}
END_OBJECT = IMAGE_MAP_PROJECTION
END
"""


def labelled(folder: Path, values: NDArray[Any], **words: Any) -> Path:
    """An image with its label beside it; by default a whole body as LOLA has it."""
    rows, columns = values.shape
    kind = {"i": "INTEGER", "u": "UNSIGNED_INTEGER", "f": "REAL"}[values.dtype.kind]
    order = ("IEEE_" if kind == "REAL" else "MSB_") if values.dtype.byteorder == ">" else "LSB_"
    order = "PC_" if kind == "REAL" and order == "LSB_" else order
    given = {
        "rows": rows, "columns": columns, "type": order + kind, "bits": 8 * values.itemsize,
        "unit": "METER", "scale": 0.5, "offset": "1737400.", "projection": "SIMPLE CYLINDRICAL",
        "lat": 0, "lon": 180, "resolution": columns / 360, "map_scale": "303.23 <km/pix>",
        "north": 90, "south": -90, "west": 0, "east": 360, "line": rows / 2 - 0.5,
        "sample": columns / 2 - 0.5, **words,
    }  # fmt: skip
    path = folder / "grid.img"
    path.write_bytes(values.tobytes())
    (folder / "grid.lbl").write_text(LABEL.format(**given))
    return path


@pytest.mark.parametrize("dtype", ["<i2", ">i2", "<u2", ">f4", "<f4", "<i4", ">f8", "u1"])
def test_labelled_images(tmp_path: Path, dtype: str) -> None:
    values = (numbers() % 200).astype(dtype)
    found = read(labelled(tmp_path, values))
    np.testing.assert_array_equal(posts_of(found), 0.5 * values.astype(np.float64))
    assert found.place.x0 == pytest.approx(math.radians(5.0))
    assert found.place.y0 == pytest.approx(math.radians(85.0))
    over = read(
        tmp_path / "grid.img", (1737000.0,) * 3, scale_m=2.0
    )  # the label's sphere is larger
    np.testing.assert_allclose(posts_of(over), 2.0 * values.astype(np.float64) + 400.0, rtol=1e-12)


def test_a_label_may_stand_in_the_image(tmp_path: Path) -> None:
    values = numbers()
    path = labelled(tmp_path, values)
    text = (tmp_path / "grid.lbl").read_text().replace('"grid.img" /* beside */', "41")
    text = text.replace("\n", "\r\n")
    path.write_bytes(text.encode().ljust(40 * 72) + values.tobytes())
    (tmp_path / "grid.lbl").unlink()
    np.testing.assert_array_equal(posts_of(read(path)), 0.5 * values)


def test_labels_in_kilometres_and_of_polar_maps(tmp_path: Path) -> None:
    values = numbers("float32", (20, 20)) / np.float32(1000.0)
    path = labelled(
        tmp_path, values, unit="KILOMETER", scale=1, offset="1737.4", lat=-90,
        projection="POLAR STEREOGRAPHIC", lon=0, map_scale="240 <m/pix>", line=10.5, sample=10.5,
    )  # fmt: skip
    found = read(path)
    np.testing.assert_allclose(posts_of(found), 1000.0 * values.astype(np.float64), rtol=1e-12)
    # DSMAP_POLAR.CAT of LOLA: X = (I - N/2 - 0.5) MAP_SCALE, with I from 1; longitude 0 is up.
    x, y = (15 - 10 - 0.5) * 240.0, -(3 - 10 - 0.5) * 240.0
    lat_deg = -90.0 + math.degrees(2.0 * math.atan(0.5 * math.hypot(x, y) / 1737400.0))
    direction = at([math.degrees(math.atan2(x, y))], [lat_deg])
    assert found.heights(direction)[0] == pytest.approx(1000.0 * values[2, 14], rel=1e-6)


def test_labels_of_patches(tmp_path: Path) -> None:
    """A grid of LOLA in parts, and an equirectangular one with offsets only."""
    values = numbers()
    words = {"north": 45, "south": 0, "west": 270, "east": 360, "resolution": 0.4}
    found = read(labelled(tmp_path, values, lat=0, **words))
    first = found.raster.directions(np.zeros((1, 2)))
    np.testing.assert_allclose(first, at([270.0 + 1.25], [45.0 - 1.25]), atol=1e-12)
    step = math.degrees(100.0 / 1737400.0)
    words = {"lat": 60, "lon": 20, "map_scale": "100 <METERS/PIXEL>", "line": -50, "sample": 7}
    words |= {"north": 0, "south": 0, "west": 0, "east": 1, "projection": "EQUIRECTANGULAR"}
    found = read(labelled(tmp_path, values, **words))
    origin = at([20.0], [-53.0 * step])
    np.testing.assert_allclose(found.raster.posts(origin), [[7.0, 3.0]], atol=1e-6)


def test_raw_images_without_a_label(tmp_path: Path) -> None:
    values = numbers()
    path = tmp_path / "grid.img"
    path.write_bytes(values.astype(">f4").tobytes())
    raw = {"type": "float32", "byte_order": "big"}
    np.testing.assert_array_equal(posts_of(read(path, projection=WHOLE, raw=raw)), values)
    path.write_bytes(values[:, :24].astype("<i2").tobytes())
    with pytest.raises(ValueError, match=r"raw: .*grid.img.*give raw.type and raw.width"):
        read(path, projection=LOCAL)
    found = read(path, projection=LOCAL, raw={"width": 24})
    np.testing.assert_array_equal(posts_of(found), values[:, :24])


@pytest.mark.parametrize(
    "dtype", ["uint8", "int16", "uint16", "float32", "int32", "float64", ">i2"]
)
def test_arrays_keep_their_numbers(tmp_path: Path, dtype: str) -> None:
    values = numbers(dtype.lstrip(">")).astype(dtype)
    found = read(save(tmp_path / "a.npy", values), projection=LOCAL)
    np.testing.assert_array_equal(posts_of(found), values.astype(np.float64))


def test_radii_in_doubles_keep_their_digits(tmp_path: Path) -> None:
    values = 3396190.0 + 1e-3 * numbers("float64")
    found = read(
        save(tmp_path / "a.npy", values), (3396190.0,) * 3, projection=LOCAL, offset_m=-3396190.0
    )
    np.testing.assert_allclose(posts_of(found), values - 3396190.0, atol=1e-6)


def geotiff(
    path: Path, values: NDArray[Any], keys: list[int], doubles: list[float], **more: Any
) -> Path:
    """keys: of four numbers each, as in a GeoKeyDirectory."""
    tags = [
        (33550, "d", 3, more.get("scale", (10.0, 10.0, 0.0)), True),
        (33922, "d", 6, (0.0, 0.0, 0.0, *more.get("tie", (-180.0, 90.0)), 0.0), True),
        (34735, "H", 4 + len(keys), (1, 1, 0, len(keys) // 4, *keys), True),
        (34736, "d", len(doubles), tuple(doubles), True),
        *more.get("tags", ()),
    ]
    tifffile.imwrite(path, values, extratags=tags)
    return path


SPHERE = [2048, 0, 1, 32767, 2057, 34736, 1, 0, 2058, 34736, 1, 1]
METRES = [1024, 0, 1, 1, 1025, 0, 1, 1, *SPHERE, 3076, 0, 1, 9001]


def test_geographic_geotiff(tmp_path: Path) -> None:
    values = numbers()
    items = (
        '<GDALMetadata><Item name="SCALE" sample="0" role="scale">0.25</Item>'
        '<Item name="OFFSET" sample="0" role="offset">7</Item></GDALMetadata>'
    )
    tags = [(42112, "s", 0, items, True), (42113, "s", 0, str(values[3, 5]), True)]
    keys = [1024, 0, 1, 2, 1025, 0, 1, 1, *SPHERE]
    path = geotiff(tmp_path / "a.tif", values, keys, [1737400.0, 1737400.0], tags=tags)
    found = read(path)
    gaps = values == values[3, 5]
    assert found.missing == gaps.mean()
    np.testing.assert_array_equal(posts_of(found)[~gaps], (0.25 * values + 7.0)[~gaps])
    assert found.raster.whole
    points = [1024, 0, 1, 2, 1025, 0, 1, 2, *SPHERE]  # pixels are points
    path = geotiff(tmp_path / "b.tif", values[:, :19], points, [1737400.0] * 2)
    first = read(path).raster.directions(np.zeros((1, 2)))
    np.testing.assert_allclose(first, at([-180.0], [90.0]), atol=1e-12)


@pytest.mark.parametrize("transform", [14, 15, 17, 21])
def test_projected_geotiff(tmp_path: Path, transform: int) -> None:
    """Against the formulas of Snyder (1987) for the place of a post, x = 350 m, y = -250 m."""
    radius, x, y = 1737400.0, 350.0, -250.0
    lat0 = {14: 30.0, 15: -70.0, 17: 60.0, 21: 30.0}[transform]
    longitude = 3095 if transform == 15 else 3080
    keys = [*METRES, 3075, 0, 1, transform, 3081, 34736, 1, 2, longitude, 34736, 1, 3,
            3082, 34736, 1, 4, 3083, 34736, 1, 5]  # fmt: skip
    doubles = [radius, radius, lat0, 40.0, 1000.0, 2000.0]
    values = numbers("float32")
    tie = (1000.0 - 5.0, 2000.0 + 5.0)
    found = read(geotiff(tmp_path / "a.tif", values, sorted_keys(keys), doubles, tie=tie))
    column, row = 35, 25
    rho = math.hypot(x, y)
    phi0, lam0 = math.radians(lat0), math.radians(40.0)
    if transform == 17:
        lat, lon = y / radius, lam0 + x / (radius * math.cos(phi0))
    elif transform == 15:
        true = 0.5 * (1.0 + math.sin(math.radians(70.0)))
        lat = 2.0 * math.atan(rho / (2.0 * radius * true)) - math.pi / 2.0
        lon = lam0 + math.atan2(x, y)
    else:
        c = 2.0 * math.atan(rho / (2.0 * radius)) if transform == 14 else math.asin(rho / radius)
        lat = math.asin(math.cos(c) * math.sin(phi0) + y * math.sin(c) * math.cos(phi0) / rho)
        lon = lam0 + math.atan2(
            x * math.sin(c),
            rho * math.cos(phi0) * math.cos(c) - y * math.sin(phi0) * math.sin(c),
        )
    direction = at([math.degrees(lon)], [math.degrees(lat)])
    np.testing.assert_allclose(
        found.raster.directions(np.array([[column, row]])), direction, atol=1e-9
    )


def sorted_keys(keys: list[int]) -> list[int]:
    """GeoKeys stand in the order of their numbers."""
    groups = sorted(tuple(keys[i : i + 4]) for i in range(0, len(keys), 4))
    return [number for group in groups for number in group]


def test_other_files_need_an_extra(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """test_elevation_geo.py reads them."""
    path = tmp_path / "a.nc"
    path.write_bytes(b"CDF\x01" + bytes(60))
    monkeypatch.setitem(sys.modules, "rasterio", None)
    with pytest.raises(ValueError, match=r"file: .*a\.nc: .*perilune\[geo\]"):
        read(path)


# --- gaps, datums, places -------------------------------------------------------------------------


def test_gaps_are_filled_from_around_and_told(tmp_path: Path) -> None:
    rows, columns = np.mgrid[:40, :50]
    plane = (2.0 * columns - 3.0 * rows).astype(np.float32)
    holes = plane.copy()
    holes[10:14, 20:26], holes[30, 5], holes[0, 0] = np.nan, -9999.0, 3e38
    found = read(save(tmp_path / "a.npy", holes), projection=LOCAL, missing=-9999.0)
    assert found.missing == pytest.approx(26 / 2000)
    assert found.remarks == (
        "26 of 2000 heights (1.3 %) are no-data: filled from those around them",
    )
    posts, known = posts_of(found), np.isfinite(holes) & (np.abs(holes) < 9999.0)
    np.testing.assert_array_equal(posts[known], plane[known])
    np.testing.assert_allclose(posts, plane, atol=3.0)
    with pytest.raises(ValueError, match=r"missing: .*a\.npy: holds no heights"):
        read(save(tmp_path / "a.npy", np.full((3, 3), np.nan)), projection=LOCAL)


def test_gaps_of_a_patch_do_not_reach_across(tmp_path: Path) -> None:
    values = np.zeros((8, 8))
    values[:, -1] = 1000.0
    missing = np.zeros((8, 8), np.bool_)
    missing[3:5, 0] = True
    assert filled(values, missing, around=False)[3, 0] < 1e-9
    assert filled(values, missing, around=True)[3, 0] > 100.0


def test_heights_over_a_sphere_of_an_oblate_body(tmp_path: Path) -> None:
    mars = (3396190.0, 3396190.0, 3376200.0)
    values = numbers()
    path = save(tmp_path / "a.npy", values)
    found = read(path, mars, projection=WHOLE, datum_radius_km=3396.0)
    np.testing.assert_array_equal(posts_of(found), values)
    layers = [(found.raster, "bilinear", 0.0, found.datum_m)]
    terrain = _core.Terrain(np.array(mars), layers, None)
    rows, columns = np.mgrid[:18, :36]
    directions = at(5.0 + 10.0 * columns, 85.0 - 10.0 * rows).reshape(-1, 3)
    surface = terrain.heights(directions) + 1.0 / np.linalg.norm(directions / mars, axis=-1)
    np.testing.assert_allclose(surface, 3396000.0 + values.ravel(), atol=1e-6)
    over = read(path, mars, projection=WHOLE)
    assert over.datum_m == 0.0
    of_moon = read(path, projection=WHOLE, datum_radius_km=1738.0)
    assert of_moon.datum_m == 0.0
    np.testing.assert_allclose(posts_of(of_moon), values + 600.0, rtol=1e-12)


def test_geodetic_latitudes(tmp_path: Path) -> None:
    radii = (6378137.0, 6378137.0, 6356752.3142)
    path = save(tmp_path / "a.npy", numbers())
    geodetic = read(path, radii, projection={**WHOLE, "latitudes": "geodetic"})
    row = geodetic.raster.posts(at([5.0], [44.80757678]))  # of geodetic latitude 45
    np.testing.assert_allclose(row, [[0.0, 4.0]], atol=1e-7)
    given = Elevation.model_validate({"file": "a.npy", "projection": WHOLE})
    of_body = read_elevation(given, path, radii, "geodetic")
    assert of_body.place == geodetic.place
    assert read(path, radii, projection=WHOLE).place.axis_ratio == 1.0


@pytest.mark.parametrize("pole", ["north", "south"])
def test_given_polar_places(tmp_path: Path, pole: str) -> None:
    path = save(tmp_path / "a.npy", numbers("float32", (21, 31)))
    place = {"kind": "polar_stereographic", "pole": pole, "post_m": 50.0, "center_m": [100.0, 0.0]}
    found = read(path, projection={**place, "center_lon_deg": 90.0})
    sign = 1.0 if pole == "north" else -1.0
    # The pole is two columns left of the middle; longitude 90 points down, or up.
    np.testing.assert_allclose(
        found.raster.posts(sign * at([0.0], [90.0])), [[13.0, 10.0]], atol=1e-6
    )
    lat_deg = sign * (90.0 - math.degrees(2.0 * math.atan(50.0 / (2.0 * 1737400.0))))
    np.testing.assert_allclose(
        found.raster.posts(at([90.0], [lat_deg])), [[13.0, 10.0 + sign]], atol=1e-6
    )


def test_edges_of_posts(tmp_path: Path) -> None:
    path = save(tmp_path / "a.npy", numbers("int16", (19, 37)))
    found = read(path, projection={**WHOLE, "edges": "posts"})
    assert found.raster.whole
    assert found.place.x0 == 0.0
    assert found.place.y0 == pytest.approx(math.pi / 2.0)


def test_rows_from_south_to_north(tmp_path: Path) -> None:
    values = numbers()
    keys = [1024, 0, 1, 2, 1025, 0, 1, 1, *SPHERE]
    path = geotiff(
        tmp_path / "a.tif",
        values,
        keys,
        [1737400.0] * 2,
        scale=(10.0, -10.0, 0.0),
        tie=(0.0, -90.0),
    )
    found = read(path)
    assert found.heights(at([25.0], [-85.0]))[0] == values[0, 2]
    assert found.heights(at([25.0], [85.0]))[0] == values[17, 2]


def test_a_body_of_zeros_has_no_holes(tmp_path: Path) -> None:
    for rows in (1, 3, 18):
        values = np.zeros((rows, 36), np.int16)
        assert read(save(tmp_path / "a.npy", values), projection=WHOLE).remarks == ()


@pytest.mark.parametrize("around", [True, False])
def test_destepped_heights_are_closer_to_the_truth(tmp_path: Path, around: bool) -> None:
    rows, columns = np.mgrid[:96, :192]
    waves = np.sin(2.0 * np.pi * columns / 192) * np.sin(2.0 * np.pi * rows / 96)
    truth = 6.0 * waves + (0.0 if around else 0.02 * columns)
    place = WHOLE if around else LOCAL
    path = save(tmp_path / "a.npy", np.rint(truth).astype(np.int16))
    found = posts_of(read(path, projection=place, destep=True))
    assert np.abs(found - np.rint(truth)).max() <= 0.5
    assert (found - truth).std() < 0.5 * (np.rint(truth) - truth).std()
    slopes = [np.diff(values, axis=1) for values in (truth, found, np.rint(truth))]
    assert (slopes[1] - slopes[0]).std() < 0.2 * (slopes[2] - slopes[0]).std()


# --- errors ---------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("keys", "fault"),
    [
        ({}, r"projection: .*a\.npy: does not say where it lies; give projection"),
        ({"projection": LOCAL, "raw": {}}, r"raw: .*a\.npy: only for images"),
        ({"projection": {**WHOLE, "east_deg": 10.0}, "destep": True}, r"destep: .*holds floats"),
        ({"projection": {**LOCAL, "post_m": 1e6}}, r"projection: .*a\.npy: an orthographic raster"),
    ],
)
def test_errors_name_key_and_file(tmp_path: Path, keys: dict[str, Any], fault: str) -> None:
    with pytest.raises(ValueError, match=fault):
        read(save(tmp_path / "a.npy", numbers("float32")), **keys)


def test_broken_files(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match=r"file: .*none\.npy: no such file"):
        read(tmp_path / "none.npy")
    for name, content in (("a.npy", b"\x93NUMPY\x01"), ("a.tif", b"II*\0abc"), ("a.png", b"")):
        start = b"\x89PNG\r\n\x1a\n" + bytes(30) if name == "a.png" else content
        (tmp_path / name).write_bytes(start)
        with pytest.raises(ValueError, match=rf"file: .*{name}"):
            read(tmp_path / name, projection=LOCAL, scale_m=1.0)
    with pytest.raises(ValueError, match="rows and columns"):
        read(save(tmp_path / "b.npy", np.zeros((2, 2, 2))), projection=LOCAL)
    short = labelled(tmp_path, numbers(), rows=100)
    with pytest.raises(ValueError, match=r"file: .*has 1296 bytes, but 100 rows of 36 int16"):
        read(short)
    west = labelled(tmp_path, numbers(), projection="SINUSOIDAL")
    with pytest.raises(ValueError, match=r"projection: .*SINUSOIDAL; supported: SIMPLE"):
        read(west)
    _core.png_write(str(tmp_path / "grey.png"), numbers("uint16"))
    with pytest.raises(ValueError, match=r"scale_m: .*grey\.png"):
        read(tmp_path / "grey.png", projection=LOCAL)


@pytest.mark.parametrize(
    ("keys", "fault"),
    [
        ({"projection": {**WHOLE, "east_deg": -10.0}}, "east of west_deg"),
        ({"projection": {**WHOLE, "south_deg": 90.0}}, "south of north_deg"),
        ({"projection": {"kind": "mercator"}}, "orthographic"),
        ({"scale_m": 0.0}, "must not be 0"),
        ({"interpolation": "nearest"}, "cubic"),
    ],
)
def test_refused_sections(keys: dict[str, Any], fault: str) -> None:
    with pytest.raises(ValidationError, match=fault):
        Elevation.model_validate({"file": "a", **keys})
