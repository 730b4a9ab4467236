"""Maps from PNG of 16 bits and TIFF: the same pictures, heights without terraces, clear errors."""

from __future__ import annotations

import math
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import tifffile
from numpy.typing import NDArray

import perilune
from perilune import _core
from perilune.bodies import maps
from perilune.bodies.gaps import filled
from perilune.config.errors import ConfigError

sys.path.insert(0, str(Path(__file__).resolve().parent))
import air_worlds
from ground_worlds import globe, lattice, numbers, points, seen

SCENE = Path(__file__).parent / "scene.yaml"
RADIUS, HEIGHT = 1e6, 2e4
ROWS = 256

GEO_KEYS = (1, 1, 0, 2, 1024, 0, 1, 2, 1025, 0, 1, 1)  # geographic, pixels are areas


def put(path: Path, values: NDArray[Any], **more: Any) -> Path:
    """A PNG or a TIFF of uncompressed numbers, by its name."""
    if path.suffix == ".png":
        _core.png_write(str(path), values)
    else:
        tifffile.imwrite(path, values, **more)
    return path


def geo_tags(west: float, north: float, step: float) -> dict[str, Any]:
    """Where a TIFF says that it lies, degrees."""
    rows: list[Any] = [
        (33550, "d", 3, (step, step, 0.0), True),
        (33922, "d", 6, (0.0, 0.0, 0.0, west, north, 0.0), True),
        (34735, "H", len(GEO_KEYS), GEO_KEYS, True),
    ]
    return {"extratags": rows}


def gdal_no_data(text: str) -> dict[str, Any]:
    return {"extratags": [(42113, "s", 0, text, True)]}


def colours(dtype: str, channels: int = 3) -> NDArray[Any]:
    """An equirectangular picture whose texels all differ."""
    codes = np.random.default_rng(5).integers(0, 65536, (16, 32, channels))
    shift = 8 if dtype == "uint8" else 0
    return np.asarray((codes >> shift).astype(dtype).squeeze())


def scene(**changes: Any) -> dict[str, NDArray[Any]]:
    """A small frame of the Earth from near it."""
    view = {"kind": "hover", "target": "earth", "height_m": 8e6}
    overrides = {"camera.trajectory": view, **changes}
    return perilune.open(SCENE, overrides=overrides).frame(0, channels=["rgb"], threads=1)


@pytest.mark.parametrize("dtype", ["uint8", "uint16"])
@pytest.mark.parametrize(
    ("channels", "photometric"),
    [(1, "minisblack"), (1, "miniswhite"), (2, "minisblack"), (2, "planar"),
     (3, "rgb"), (3, "planar"), (4, "rgb"), (4, "planar")],
)  # fmt: skip
def test_pictures_in_tiff_are_those_in_png(
    tmp_path: Path, dtype: str, channels: int, photometric: str
) -> None:
    texels = colours(dtype, channels)
    png = _core.Map(str(put(tmp_path / "map.png", texels)))
    more: dict[str, Any] = {"photometric": "rgb" if channels > 2 else "minisblack"}
    stored = texels
    if photometric == "miniswhite":
        stored, more = ~texels, {"photometric": "miniswhite"}
    if channels in (2, 4):
        more["extrasamples"] = ["unassalpha"]
    if channels > 1 and photometric == "planar":
        stored, more["planarconfig"] = np.moveaxis(texels, -1, 0), "separate"
    elif channels == 2:
        more["planarconfig"] = "contig"
    read = maps.picture(put(tmp_path / "map.tif", stored, **more))
    assert isinstance(read.source, np.ndarray)
    assert read.source.dtype == np.uint8
    tiff = _core.Map(read.source)
    assert tiff.size == png.size
    np.testing.assert_array_equal(tiff.columns(), png.columns())
    np.testing.assert_array_equal(tiff.mean, png.mean)


@pytest.mark.parametrize(
    "key",
    ["color_map", "ocean.map", "night_lights.map", "clouds.map", "relief.normal_map",
     "rings.color_map"],
)  # fmt: skip
def test_every_map_of_a_body_may_be_a_tiff(tmp_path: Path, key: str) -> None:
    texels = colours("uint16")
    section, _, name = key.rpartition(".")
    frames = []
    for path in (put(tmp_path / "a.png", texels), put(tmp_path / "a.tif", texels)):
        body: dict[str, Any] = {f"bodies.earth.{key}": str(path)}
        if section:
            more = {"inner_radius_km": 8000, "outer_radius_km": 9000} if section == "rings" else {}
            body = {f"bodies.earth.{section}": {name: str(path), **more}}
        frames.append(scene(**body)["rgb"])
    assert frames[0].any()
    assert np.array_equal(*frames)


def test_pictures_of_the_sky_and_of_materials_may_be_tiffs(tmp_path: Path) -> None:
    texels = colours("uint16")
    frames = []
    for path in (put(tmp_path / "a.png", texels), put(tmp_path / "a.tif", texels)):
        nodes = {"paint": {"type": "image", "file": str(path)},
                 "skin": {"type": "lambert", "base_color": "paint"}}  # fmt: skip
        frames.append(
            scene(
                **{"sky.background": {"map": str(path)}, "bodies.earth.material": "m"},
                materials={"m": {"nodes": nodes}},
            )["rgb"]
        )
    assert np.array_equal(*frames)


def hill() -> NDArray[np.float64]:
    """Heights 0..1, linear in y: a slope with a formula."""
    return np.asarray(0.5 + 0.5 * lattice(ROWS)[..., 1])


def slope_error(heights: _core.Map, height_m: float) -> float:
    """The largest error of the light on the hill, over that of flat ground under a zenith sun."""
    sun = np.array([0.35, 0.9, 0.3]) / np.linalg.norm([0.35, 0.9, 0.3])
    asked, frame = seen(
        globe({"heights": heights}), numbers(height_m=height_m), [[RADIUS] * 3],
        [RADIUS + 3e5, 0.0, 1e5], [-1.0, 0.0, -0.1], sun, size=(24, 18), albedo=0.3,
        tolerance_dn=0.0, samples=4, fov_deg=40.0, force_off=("soft_sun",),
    )  # fmt: skip
    up, hit = points(asked, frame)
    assert hit.all()
    gradient = np.array([0.0, 1.0, 0.0]) - up[..., 1:2] * up
    normal = up - 0.5 * HEIGHT / RADIUS * gradient
    normal /= np.linalg.norm(normal, axis=-1, keepdims=True)
    white = 0.3 / math.pi * air_worlds.SOLAR
    return float(np.abs(frame["radiance"][..., 0] / white - normal @ sun).max())


def test_relief_of_16_bits_and_floats_has_no_terraces(tmp_path: Path) -> None:
    """A hill of 20 km, whose slope is at most 0.01: of 8 bits a step is 78 m."""
    eight = put(tmp_path / "8.png", np.rint(255 * hill()).astype(np.uint8))
    deep = np.rint(65535 * hill()).astype(np.uint16)
    metres = HEIGHT * (hill() - 0.5)
    files: list[tuple[Path, maps.HeightKey, float]] = [
        (put(tmp_path / "16.png", deep), "height_m", HEIGHT),
        (put(tmp_path / "u16.tif", deep), "height_m", HEIGHT),
        (put(tmp_path / "16.png", deep), "height_unit_m", HEIGHT / 65535),
        (put(tmp_path / "i16.tif", np.rint(metres).astype(np.int16)), "height_unit_m", 1.0),
        (put(tmp_path / "f32.tif", metres.astype(np.float32)), "height_unit_m", 1.0),
        (put(tmp_path / "f64.tif", 1.7374e6 + metres), "height_unit_m", 1.0),
    ]
    exact = slope_error(_core.Map(metres.astype(np.float32), srgb=False), 1.0)
    assert exact < 5e-4  # of the texels' size
    coarse = slope_error(_core.Map(maps.heights(eight, "height_m").source, srgb=False), HEIGHT)
    assert coarse > 4.0 * exact
    for path, key, height_m in files:
        read = maps.heights(path, key)
        assert not read.remarks
        error = slope_error(_core.Map(read.source, srgb=False), height_m)
        assert error < 1.02 * exact, (path.name, key, error)


def test_the_same_heights_are_the_same_picture_in_png_and_tiff(tmp_path: Path) -> None:
    deep = np.rint(65535 * hill()).astype(np.uint16)
    paths = [put(tmp_path / "a.png", deep), put(tmp_path / "a.tif", deep)]
    for relief in ({"height_m": 5e5}, {"height_unit_m": 5e5 / 65535}):
        frames = [
            scene(**{"bodies.earth.relief": {"height_map": str(path), **relief}})["rgb"]
            for path in paths
        ]
        assert np.array_equal(*frames)
    assert not np.array_equal(frames[0], scene()["rgb"])


@pytest.mark.parametrize("suffix", ["png", "tif"])
def test_heights_of_8_bits_stay_8_bits(tmp_path: Path, suffix: str) -> None:
    path = put(tmp_path / f"a.{suffix}", np.rint(255 * hill()).astype(np.uint8))
    source = maps.heights(path, "height_m").source
    assert source == str(path) if suffix == "png" else source.dtype == np.uint8  # type: ignore[union-attr]
    unit = maps.heights(path, "height_unit_m").source
    assert isinstance(unit, np.ndarray)
    assert unit.dtype == np.float32
    assert float(unit.max() - unit.min()) == 255.0


@pytest.mark.parametrize("gap", ["nan", "endless", "tag", "int16"])
def test_missing_heights_are_filled_and_counted(tmp_path: Path, gap: str) -> None:
    metres = np.rint(HEIGHT * hill()) - 1e4
    missing = np.zeros(metres.shape, np.bool_)
    missing[100:120, :30] = missing[0, 0] = missing[110:140, -9:] = True
    value = {"nan": np.nan, "endless": -3.4028234663852886e38, "tag": -9999, "int16": -32768}[gap]
    dtype = np.int16 if gap == "int16" else np.float32
    more = gdal_no_data("-9999") if gap == "tag" else {}
    path = put(tmp_path / "a.tif", np.where(missing, value, metres).astype(dtype), **more)
    relief = {"height_map": str(path), "height_unit_m": 1.0}
    said = rf"relief\.height_map: .*a\.tif: {missing.sum()} of {missing.size} heights .*no-data"
    with pytest.warns(UserWarning, match=said):
        scene(**{"bodies.earth.relief": relief})
    source = maps.heights(path, "height_unit_m").source
    assert isinstance(source, np.ndarray)
    shift = source[200, 300] - metres[200, 300]
    np.testing.assert_allclose((source - metres - shift)[~missing], 0.0, atol=2e-3)
    assert np.abs((source - metres - shift)[missing]).max() < 250.0


def test_gaps_are_filled_smoothly_and_within_range() -> None:
    values = np.random.default_rng(1).uniform(5.0, 6.0, (37, 53))
    missing = np.random.default_rng(2).uniform(size=values.shape) < 0.7
    whole = filled(np.where(missing, np.nan, values), missing)
    np.testing.assert_array_equal(whole[~missing], values[~missing])
    assert whole.min() >= 5.0
    assert whole.max() <= 6.0
    one = np.ones(values.shape, np.bool_)
    one[3, 4] = False
    assert np.allclose(filled(values, one), values[3, 4])


@pytest.mark.parametrize(
    ("key", "values", "more", "said"),
    [
        ("relief", np.zeros((4, 8), np.float32), {}, "float32, which have no white: give heig"),
        ("relief", np.zeros((4, 8), np.int16), {}, "int16, which have no white: give height"),
        ("relief", np.zeros((4, 8, 3), np.uint16), {}, "whole numbers or floats, not 3 of uint16"),
        ("unit", np.full((4, 8), np.nan, np.float32), {}, "all of its numbers are no-data"),
        ("color_map", np.zeros((4, 8), np.float32), {}, "uint8 or uint16, not 1 of float32"),
        ("color_map", np.zeros((4, 8), np.int16), {}, "uint8 or uint16, not 1 of int16"),
        ("color_map", np.zeros((4, 8), np.uint8), geo_tags(0.0, 90.0, 45.0),
         "its centre column at 180 deg: give map_center_lon_deg: 180, not 0"),
        ("color_map", np.zeros((4, 8), np.uint8), geo_tags(-180.0, 60.0, 10.0),
         "longitudes -180..-100 deg and latitudes 20..60 deg: not over the whole body"),
    ],
)  # fmt: skip
def test_errors_name_file_and_key(
    tmp_path: Path, key: str, values: NDArray[Any], more: dict[str, Any], said: str
) -> None:
    photometric = "rgb" if values.ndim == 3 else "minisblack"
    path = str(put(tmp_path / "odd.tif", values, photometric=photometric, **more))
    body: dict[str, Any] = {"color_map": {"bodies.earth.color_map": path}}.get(
        key,
        {"bodies.earth.relief": {
            "height_map": path, "height_unit_m" if key == "unit" else "height_m": 1.0}},
    )  # fmt: skip
    name = "color_map" if key == "color_map" else "relief.height_map"
    with pytest.raises(ConfigError) as error:
        scene(**body)
    assert f"bodies.earth.{name}: " in str(error.value)
    assert "odd.tif: " in str(error.value)
    assert said in str(error.value)


def test_odd_files_of_heights(tmp_path: Path) -> None:
    rgb = put(tmp_path / "rgb.png", colours("uint16"))
    with pytest.raises(ValueError, match=r"rgb\.png: must be a grey PNG"):
        maps.heights(rgb, "height_m")
    whole = put(tmp_path / "whole.tif", colours("uint16", 1)).read_bytes()
    for size in (5, 100, len(whole) // 2):
        (tmp_path / "cut.tif").write_bytes(whole[:size])
        with pytest.raises(ValueError, match=r"cut\.tif: not a TIFF that is read here"):
            maps.heights(tmp_path / "cut.tif", "height_m")
    (tmp_path / "a.jpg").write_bytes(b"\xff\xd8\xff")
    with pytest.raises(ValueError, match="height_unit_m needs a grey PNG or a TIFF"):
        maps.heights(tmp_path / "a.jpg", "height_unit_m")


def test_numbers_straight_into_the_core() -> None:
    values = np.arange(32, dtype=np.float32).reshape(4, 8) * 1e4
    read = _core.Map(values, srgb=False)
    assert read.size == (8, 4)
    assert read.mean[0] == pytest.approx(values.mean())
    np.testing.assert_allclose(read.columns()[:, 0], values.mean(axis=0))
    for wrong in (np.full((2, 2), np.nan, np.float32), np.zeros((2, 2, 5), np.uint8),
                  np.zeros((0, 2), np.float32), np.zeros((2, 2, 2), np.float32)):  # fmt: skip
        with pytest.raises(ValueError, match=r"finite|channels|sides|shape"):
            _core.Map(wrong)


def test_published_files(data_dir: Path, tmp_path: Path) -> None:
    """LOLA's heights in half metres; mosaics of the USGS with LZMA and tags; a map of the pole."""
    lola = data_dir / "lunar_dem/ldem_4_uint16.png"
    source = maps.heights(lola, "height_unit_m").source
    assert isinstance(source, np.ndarray)
    assert 0.5 * float(np.ptp(source)) == pytest.approx(19.9e3, rel=0.05)
    folder = data_dir / "planets/usgs_geotiff"
    assert maps.picture(folder / "moon.tif", 0.0).remarks[0].endswith("read as this number")
    assert isinstance(maps.picture(folder / "europa.tif", 180.0).source, np.ndarray)
    with pytest.raises(ValueError, match=r"europa\.tif: .*give map_center_lon_deg: 180, not 0"):
        maps.picture(folder / "europa.tif", 0.0)
    with pytest.raises(ValueError, match="neither a geographic nor an equirectangular grid"):
        maps.heights(data_dir / "lunar_dem/dem_moon_npole_33x33.tif", "height_unit_m", 0.0)
