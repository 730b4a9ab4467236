"""Lens of the image sensor: aperture, light on the axis, vignetting by table and flat field."""

from __future__ import annotations

import copy
import warnings

import numpy as np
import pytest
import tifffile
from PIL import Image
from scipy import ndimage, signal

import perilune
from perilune.camera import measured
from perilune.camera.imaging import f_number, sensor_of
from perilune.config import ConfigError
from perilune.document.loader import read_tree

QUIET = {"read_noise_e": 0.0, "prnu": 0.0, "dark_current_e_s": 0.0, "mosaic": "mono", "bits": 16,
         "gain_e_dn": 0.5, "exposure": {"mode": "fixed"},
         "point_spread": {"core": "point"}}  # fmt: skip
OFF = {"render.tolerance_dn": 0.0, "render.force_off": ["shot_noise"], "render.samples": 1,
       "camera.exposure_time_s": 2e-5}  # fmt: skip


@pytest.fixture(scope="module")
def tree(request):
    """The small scene, its camera close over an Earth that glows: light in every pixel."""
    root = request.config.rootpath
    tree = read_tree(root / "tests/python/scene.yaml")
    tree["spacecraft"]["sat"]["model"] = str(root / "assets/models/smallsat.glb")
    tree["bodies"]["earth"]["emission_w_m2_sr"] = [100.0, 100.0, 100.0]
    tree["camera"]["trajectory"] = {"kind": "orbit_object", "target": "earth", "distance_m": 7e6}
    return tree


def opened(tree, sensor, **overrides):
    tree = copy.deepcopy(tree)
    tree["camera"]["sensor"] = sensor
    return perilune.open(tree, overrides=overrides)


def light(tree, **keys):
    """Electrons above black, of a frame without noise."""
    sample = opened(tree, QUIET | keys, **OFF).frame(0, ["raw"])
    return (sample["raw"].astype(float) - 64.0) * 0.5


def test_an_aperture_is_a_focal_ratio(tree):
    """fov 40 degrees over 48 pixels of 10 um: a focal length of 24 / tan(20 deg) * 0.01 mm."""
    sim = opened(tree, {"aperture_mm": 0.2, "pixel_um": 10.0})
    focal_mm = 24.0 / np.tan(np.radians(20.0)) * 0.01
    assert f_number(sim.config.camera) == pytest.approx(focal_mm / 0.2, rel=1e-14)
    assert f_number(opened(tree, {}).config.camera) == 4.0
    preset = opened(tree, {"preset": "ccd47_20", "aperture_mm": 0.5}).config.camera
    assert f_number(preset) == pytest.approx(focal_mm * 1.3 / 0.5, rel=1e-14)


def test_light_goes_with_the_area_of_the_aperture(tree):
    one, two = (light(tree, aperture_mm=d, pixel_um=10.0) for d in (0.05, 0.1))
    lit = one > 100.0
    assert lit.all()
    assert np.abs(two[lit] / one[lit] - 4.0).max() < 0.05  # of rounding
    plane = light(tree, f_number=1.0, pupil="plane", transmission=0.01)
    sine = light(tree, f_number=1.0, transmission=0.01)
    assert plane.min() > 100.0
    assert plane.sum() / sine.sum() == pytest.approx(4.0 / 5.0, rel=2e-3)


@pytest.mark.parametrize(
    ("sensor", "text"),
    [
        ({"f_number": 4.0, "aperture_mm": 3.0}, r"only one of f_number, aperture_mm"),
        ({"vignetting_profile": [[0, 1.0], [0, 0.9]]}, r"vignetting_profile: the angles must rise"),
        ({"vignetting_profile": [[0, 1.5]]}, r"vignetting_profile\[0\]\[1\]"),
        ({"vignetting_profile": []}, r"vignetting_profile"),
        ({"pupil": "flat"}, r"pupil"),
    ],
)
def test_what_is_no_lens_is_refused(tree, sensor, text):
    with pytest.raises(ConfigError, match=text):
        opened(tree, sensor)


def test_an_impossible_aperture_is_named(tree):
    text = r"  camera\.sensor\.aperture_mm = 1000: .*f/0\.000"
    with pytest.raises(ConfigError, match=text):
        opened(tree, {"aperture_mm": 1000.0})
    with pytest.raises(ConfigError, match=text):  # also of a limit of its driver
        opened(tree, {"aperture_mm": {"uniform": [0.1, 1000.0]}})


def test_errors_name_the_section_that_has_the_key(tree):
    near = {"sensor": {"aperture_mm": 1000.0}}
    with pytest.raises(ConfigError, match=r"  sensors\.near\.sensor\.aperture_mm = 1000"):
        opened({**tree, "sensors": {"near": near, "far": {}}}, {})
    # a section of the platform's that a sensor has is named where it stands
    with pytest.raises(ConfigError, match=r"  camera\.sensor\.quantum_efficiency: the sensor sees"):
        opened({**tree, "sensors": {"far": {"bands": [{"center_um": 2.0, "width_um": 0.1}]}}},
               {"mosaic": "planes"})  # fmt: skip
    near = {"sensor": {"flat_field": "none.npy"}}
    sim = opened({**tree, "sensors": {"near": near, "far": {}}}, {"flat_field": "none.png"})
    with pytest.raises(FileNotFoundError, match=r"sensors\.near\.sensor\.flat_field: no such"):
        sim.frame(0, ["raw"])
    with pytest.raises(FileNotFoundError, match=r": camera\.sensor\.flat_field: no such"):
        sim.frame(1, ["raw"])


def test_a_profile_is_interpolated_by_angle(tree):
    profile = [[0.0, 1.0], [10.0, 0.8], [25.0, 0.2]]
    plain = light(tree, vignetting=0.0)
    dimmed = light(tree, vignetting_profile=profile)
    focal = 24.0 / np.tan(np.radians(20.0))
    y, x = np.mgrid[:32, :48]
    angle = np.degrees(np.arctan(np.hypot(x - 23.5, y - 15.5) / focal))
    factor = np.interp(angle, *np.transpose(profile))
    assert np.abs(dimmed - plain * factor).max() < 0.51  # digital numbers of half an electron
    both = light(tree, vignetting_profile=profile, vignetting=4.0)
    assert np.abs(both - plain * factor * np.cos(np.radians(angle)) ** 4).max() < 0.51
    assert plain.max() > 1000.0


def write(kind, path, numbers):
    """A file of the kind, and the scale of its numbers."""
    if kind == "npy":
        np.save(path, numbers)
        return path, 1.0
    if kind == "tif":
        tifffile.imwrite(path, numbers.astype(np.float32))
        return path, 1.0
    depth = np.uint16 if kind == "png16" else np.uint8
    most = float(np.iinfo(depth).max)
    Image.fromarray(np.round(numbers / numbers.max() * most).astype(depth)).save(path)
    return path, 65535.0 / numbers.max()


@pytest.mark.parametrize(("kind", "error"), [("npy", 1e-12), ("tif", 1e-6), ("png16", 1e-4),
                                             ("png8", 3e-3)])  # fmt: skip
def test_files_of_numbers(tmp_path, kind, error):
    numbers = np.random.default_rng(3).uniform(0.5, 1.0, (5, 7))
    path, scale = write(kind, tmp_path / f"flat.{kind[:3]}", numbers)
    assert np.abs(measured.read(path) / scale - numbers).max() < error


def test_a_flat_field_is_stretched_over_the_image(tree, tmp_path):
    """As SciPy stretches it, about the corners of the image; its middle counts as 1."""
    numbers = 3.0 * np.random.default_rng(4).uniform(0.5, 1.0, (8, 12))
    path, _ = write("npy", tmp_path / "flat.npy", numbers)
    plain, flat = light(tree, vignetting=0.0), light(tree, flat_field=str(path))
    factor = ndimage.zoom(numbers / numbers[3, 5], 4, order=1, mode="nearest", grid_mode=True)
    assert np.abs(flat - plain * factor).max() < 0.6
    assert np.abs(flat - plain).max() > 100.0


@pytest.mark.parametrize("shape", [(1, 1), (3, 3), (4, 6), (15, 14), (41, 40), (99, 130)])
def test_a_measured_kernel_is_convolved_as_scipy_does(tree, tmp_path, shape):
    """Odd, even, and larger than the image; light beyond the image is dark."""
    kernel = np.random.default_rng(5).uniform(0.0, 1.0, shape) ** 4
    np.save(tmp_path / "psf.npy", kernel / kernel.sum())
    spread = {"point_spread": {"kernel": str(tmp_path / "psf.npy")}}
    profile = {"vignetting_profile": [[0, 1.0], [5, 0.2], [9, 0.7], [25, 0.1]]}  # a pattern
    plain, blurred = light(tree, **profile), light(tree, **profile, **spread)
    full = signal.fftconvolve(plain, kernel / kernel.sum())
    top, left = shape[0] // 2, shape[1] // 2
    expected = full[top : top + 32, left : left + 48]
    assert np.abs(blurred - expected).max() < 0.8  # plain is rounded to halves before, too
    assert np.abs(blurred - plain).max() > 100.0 or shape == (1, 1)


def test_kernels_are_divided_by_their_sum(tree, tmp_path):
    kernel = np.array([[0.0, 1.0], [2.0, 1.0]])
    np.save(tmp_path / "counts.npy", kernel)
    np.save(tmp_path / "fractions.npy", 0.3 * kernel)
    Image.fromarray(kernel.astype(np.uint8)).save(tmp_path / "counts.png")
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        for name in ("counts.npy", "counts.png"):
            assert measured.kernel(tmp_path / name) == pytest.approx(kernel / 4.0)
    with pytest.warns(UserWarning, match=r"the kernel's sum is 1\.2"):
        assert measured.kernel(tmp_path / "fractions.npy") == pytest.approx(kernel / 4.0)
    np.save(tmp_path / "dark.npy", 0.0 * kernel)
    with pytest.raises(ValueError, match="some light"):
        measured.kernel(tmp_path / "dark.npy")


@pytest.mark.parametrize("spread", [{"core": "measured"}, {"core": "airy", "kernel": "a.npy"}])
def test_a_kernel_and_its_core_belong_together(tree, spread):
    with pytest.raises(ConfigError, match=r"point_spread\.core: the core `measured` needs"):
        opened(tree, {"point_spread": spread})


@pytest.mark.parametrize(
    ("name", "content", "text"),
    [
        ("a.npy", b"no", "a.npy: not an image of numbers"),
        ("a.png", b"no", "a.png: not an image of numbers: not a PNG file"),
        ("a.txt", b"no", "files of images of numbers end in"),
        ("a.npy", np.ones((2, 2, 3)), r"real numbers in \(height, width\)"),
        ("a.npy", -np.ones((2, 2)), "negative"),
        ("a.npy", np.full((2, 2), np.nan), "infinite or none"),
        ("a.npy", np.zeros((2, 2)), "too dark"),
        ("a.npy", np.ones((0, 2)), "real numbers"),
        ("a.npy", np.array([["a"]]), "real numbers"),
    ],
)
def test_files_that_are_no_flat_fields(tree, tmp_path, name, content, text):
    path = tmp_path / name
    if isinstance(content, bytes):
        path.write_bytes(content)
    else:
        np.save(path, content)
    with pytest.raises(ValueError, match=text):
        opened(tree, {"flat_field": str(path)}).frame(0, ["raw"])


def test_a_png_of_colours_and_a_missing_file(tree, tmp_path):
    Image.new("RGB", (4, 4)).save(tmp_path / "a.png")
    with pytest.raises(ValueError, match=r"must be a grey PNG"):
        opened(tree, {"flat_field": str(tmp_path / "a.png")}).frame(0, ["raw"])
    with pytest.raises(FileNotFoundError, match=r"camera\.sensor\.flat_field: no such file"):
        opened(tree, {"flat_field": "none.npy"}).frame(0, ["raw"])


def test_a_changed_file_is_read_again(tree, tmp_path):
    path = tmp_path / "flat.npy"
    np.save(path, np.ones((2, 2)))
    sim = opened(tree, {"flat_field": str(path)})
    given = sensor_of(sim.config.camera)["flat_field"]
    assert (given == 1.0).all()
    assert given.dtype == np.float32
    np.save(path, np.array([[1.0, 2.0, 1.0]]))
    assert sensor_of(sim.config.camera)["flat_field"].tolist() == [[0.5, 1.0, 0.5]]
