"""The preview sheet: any size, any content, and what its parts promise."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from PIL import Image

import perilune
from perilune import _core
from perilune.base import colors
from perilune.frame.request import object_dtype
from perilune.sample import CameraLabel, Description, Sample
from perilune.show import notebook, preview
from perilune.show.preview import canvas, overlay, panels, sheet


def make_sample(width=64, height=48, empty=False, channels=None):
    """A sample made by hand: a disc 50 m away in the middle, nothing around it."""
    rows, columns = np.mgrid[:height, :width]
    radius = 0.3 * min(width, height)
    disc = np.hypot(columns - width / 2, rows - height / 2) < radius
    if empty:
        disc[:] = False
    K = np.array([[width, 0.0, (width - 1) / 2], [0.0, width, (height - 1) / 2], [0.0, 0.0, 1.0]])
    everywhere = {
        "rgb": np.where(disc[..., None], np.uint8(200), np.uint8(0)).repeat(3, axis=2),
        "depth": np.where(disc, 50.0 + 0.01 * columns, 0.0).astype(np.float32),
        "normal": np.where(disc[..., None], [0.0, 0.0, -1.0], 0.0).astype(np.float32),
        "position": np.where(disc[..., None], np.dstack([columns, rows, rows]) * 1e3, np.nan),
        "semantic": np.dstack([disc, 2 * disc]).astype(np.uint16),
        "instance": (7 * disc).astype(np.int32),
        "phase": np.where(disc, 0.5, np.nan).astype(np.float32),
        "flow": np.where(disc[..., None], [1.0, 2.0], np.nan).astype(np.float32),
    }
    objects = np.zeros(1, object_dtype())
    objects["R_m2c"], objects["t_m2c"], objects["instance_id"] = np.eye(3), [0, 0, 50.0], 7
    objects["bbox_visib"] = -1
    if disc.any():
        ys, xs = np.nonzero(disc)
        objects["bbox_visib"] = [xs.min(), ys.min(), np.ptp(xs), np.ptp(ys)]
        objects["px_count_visib"] = disc.sum()
    camera = CameraLabel(K, width, height, np.eye(3), np.zeros(3))
    meta = {"seed": 1, "index": 0, "time_utc": "2026-03-20T12:00:00.000Z"}
    chosen = {name: everywhere[name] for name in channels or everywhere}
    return Sample(chosen, objects, Description(camera, meta), [])


@pytest.mark.parametrize("empty", [False, True])
@pytest.mark.parametrize(
    ("width", "height"), [(1, 1), (3, 2), (64, 64), (640, 480), (1000, 30), (30, 1000), (4096, 512)]
)
def test_any_size_and_empty_frames(width, height, empty):
    image = preview.draw(make_sample(width, height, empty))
    assert image.dtype == np.uint8
    assert image.shape[1] == sheet.COLUMNS * (sheet.PANEL_WIDTH + sheet.GAP) + sheet.GAP
    assert (image != colors.BACKGROUND).any(axis=2).mean() > 0.01


def test_large_square_image():
    image = preview.draw(make_sample(4096, 4096, channels=["rgb", "depth", "instance"]))
    assert image.max() > 100


def test_every_channel_of_the_core_is_drawn(small_scene):
    sim = perilune.open(small_scene, overrides={"camera.sensor": {}})
    sample = sim.frame(0, channels=[*(row["name"] for row in _core.CHANNELS), "objects"])
    found = sheet._panels(sample, sim.taxonomy.channel_names, {})
    titles = {panel.title.split("/")[0].removesuffix(" (log)") for panel in found}
    assert titles == {row["name"] for row in _core.CHANNELS} - {"rgb"}
    assert all(panel.image.shape == (72, 96, 3) for panel in found)
    (instance,) = (panel for panel in found if panel.title == "instance")
    assert {name for _, name in instance.swatches} <= {"planet", "probe"}
    assert "probe" in {name for _, name in instance.swatches}


def test_written_sheet_is_what_was_drawn(small_scene, tmp_path):
    image = preview.render_sheet(perilune.open(small_scene), 1, threads=1)
    preview.save(image, tmp_path / "sheet.png")
    with Image.open(tmp_path / "sheet.png") as read:
        np.testing.assert_array_equal(np.array(read), image)
    with pytest.raises(ValueError, match=r"\.png"):
        preview.save(image, tmp_path / "sheet.jpg")
    with pytest.raises(OSError, match="missing"):
        preview.save(image, tmp_path / "missing" / "sheet.png")


def test_sheet_of_nothing_is_refused():
    sample = make_sample()
    bare = Sample({}, sample.objects, Description(sample.camera, sample.meta), [])
    with pytest.raises(ValueError, match="no pixel channel"):
        preview.draw(bare)
    assert notebook._sample_png(bare) is None


def test_sample_without_objects_or_rgb_is_drawn():
    whole = make_sample()
    for channels in ({"rgb": whole["rgb"]}, {"depth": whole["depth"]}):
        described = Description(whole.camera, whole.meta)
        assert preview.draw(Sample(channels, None, described, [])).any()


def test_overlay_draws_box_and_axes_where_they_belong():
    panel = sheet._overlay_panel(make_sample(640, 480), (480, 640))
    changed = (panel.image != make_sample(640, 480)["rgb"]).any(axis=2)
    rows, columns = np.nonzero(changed)
    x, y, width, height = make_sample(640, 480).objects["bbox_visib"][0]
    assert abs(columns.min() - x) <= 2
    assert abs(columns.max() - (x + width)) <= 2
    assert abs(rows.min() - y) <= 2
    assert abs(rows.max() - (y + height)) <= 2
    # The x axis (red) points right from the centre, the y axis (green) down.
    red, green = panel.image[240, 360].astype(int), panel.image[300, 320].astype(int)
    assert red[0] > red[1] + 80
    assert green[1] > green[0] + 80


@pytest.mark.parametrize(
    "lens",
    [
        ("brown_conrady", np.array([-0.3, 0.1, *[0.0] * 6])),
        ("brown_conrady", np.array([0.4, *[0.0] * 7])),
        ("fisheye", np.array([-0.02, 0.0, 0.0, 0.0])),
    ],
)
def test_axes_are_where_the_lens_puts_them(lens):
    """An object far off the axis: each axis runs through the projections of its own points."""
    plain = make_sample(640, 480)
    camera = replace(plain.camera, lens=lens)
    sample = Sample(dict(plain), plain.objects, Description(camera, plain.meta), [])
    sample.objects["t_m2c"] = origin = np.array([12.0, -10.0, 50.0])
    sample.objects["bbox_visib"] = [0, 0, 160, 160]
    picture = sheet._overlay_panel(sample, (480, 640)).image.astype(int)
    start = camera.project(origin)[0]
    assert np.abs(start - _core.project(plain.camera.K, None, origin[None])[0]).max() > 3.0
    lines = overlay.axes_px(np.eye(3), origin, sample.objects["bbox_visib"][0], camera)
    for axis, color in enumerate(overlay._AXIS_COLORS[:2]):
        assert 50.0 < np.linalg.norm(lines[axis, -1] - start) < 140.0
        for metres in (3.0, 5.0):
            x, y = np.rint(camera.project(origin + metres * np.eye(3)[axis])[0]).astype(int)
            assert np.abs(picture[y, x] - color).max() < 60


def test_ramp_falls_evenly_in_lightness():
    luminance = colors.ramp().astype(float) @ [0.2126, 0.7152, 0.0722]
    assert luminance[0] - luminance[-1] > 120
    assert (np.diff(luminance) < 2.0).all()
    assert (np.diff(luminance[::16]) < 0).all()


def test_scaling_keeps_order_and_leaves_out_what_is_not_valid():
    random = np.random.default_rng(5)
    values = 10.0 ** random.uniform(0, 7, (40, 50))
    values[0] = np.nan
    valid = np.isfinite(values)
    scaled = colors.scale_values(values, valid)
    assert scaled.rule == "log"
    assert (scaled.low, scaled.high) == (values[valid].min(), values[valid].max())
    order = np.argsort(values[valid])
    assert (np.diff(scaled.t[valid][order]) >= 0).all()
    assert scaled.t[valid].min() >= 0
    assert scaled.t[valid].max() <= 1
    assert colors.scale_values(values, np.zeros_like(valid)) is None
    assert colors.scale_values(values, valid, spread=False).rule == "linear"


def test_ids_have_stable_distinct_colors():
    ids = np.arange(40)
    palette = colors.id_colors(ids)
    assert len({tuple(color) for color in palette.tolist()}) == 40
    np.testing.assert_array_equal(palette[0], colors.EMPTY)
    picture = np.array([[0, 3], [39, 3]], dtype=np.int32)
    np.testing.assert_array_equal(colors.colored_ids(picture), palette[picture])
    far = np.array([[0, 3], [2_000_000_000, 3]], dtype=np.int32)
    np.testing.assert_array_equal(colors.colored_ids(far)[0], palette[[0, 3]])


def test_resize_keeps_the_mean_and_whole_pixels():
    image = np.random.default_rng(1).integers(0, 256, (60, 80, 3)).astype(np.uint8)
    small = canvas.resize(image, 15, 20)
    expected = image.reshape(15, 4, 20, 4, 3).mean(axis=(1, 3))
    assert np.abs(small - expected).max() <= 1.0  # Pillow rounds after each of the two axes
    np.testing.assert_array_equal(canvas.resize(image, 120, 160)[::2, ::2], image)
    assert canvas.fitted((64, 64), (700, 640)) == (640, 640)
    assert canvas.fitted((480, 640), (120, 320)) == (120, 160)


def test_lines_are_cut_at_the_canvas():
    def draw(picture, *points):
        return canvas.draw_lines(picture, [canvas.Line(np.array(points), (255, 0, 0), 2.0)])

    black = np.zeros((20, 30, 3), np.uint8)
    picture = draw(black, (-1e12, 10.0), (1e12, 10.0))
    assert (picture[10, :, 0] == 255).all()
    assert picture[:9].max() == picture[12:].max() == 0
    # Edges are smooth: a line of two pixels covers half of a row on each side.
    np.testing.assert_allclose(picture[[9, 11], :, 0].astype(float).mean(axis=1), 127.5, atol=64)
    for points in (((np.nan, 0.0), (5.0, 5.0)), ((-5.0, -5.0), (-5.0, 40.0))):
        np.testing.assert_array_equal(draw(picture, *points), picture)


def test_lines_leave_other_pixels_as_they_are():
    image = np.random.default_rng(2).integers(0, 256, (37, 41, 3)).astype(np.uint8)
    np.testing.assert_array_equal(canvas.draw_lines(image, []), image)
    drawn = canvas.draw_lines(
        image, [canvas.Line(np.array([(2.0, 2.0), (6.0, 6.0)]), (9, 9, 9), 2)]
    )
    np.testing.assert_array_equal(drawn[10:], image[10:])


@pytest.mark.parametrize("width", [30, 80, 400])
def test_text_is_cut_where_it_does_not_fit(width):
    text = "a long name of a part of a spacecraft"
    cut = canvas.shortened(text, width, 17)
    assert canvas.text_width(cut, 17) <= width
    assert cut == text or (cut.endswith("..") and text.startswith(cut[:-2]))


def test_legends_stay_below_their_picture():
    """Names that do not fit, the last one alone among them, are counted within the width."""
    for count in range(1, 12):
        names = [(np.array([255, 0, 0]), "word" * 3)] * count
        page = canvas.Canvas.blank(330, 60, (0, 0, 0))
        sheet._draw_swatches(
            page, 5, 10, 300, panels.Panel("x", np.zeros((1, 1, 3)), swatches=names)
        )
        columns = np.flatnonzero(page.pixels().any(axis=(0, 2)))
        assert columns.min() >= 10
        assert columns.max() < 310


@pytest.mark.parametrize(
    ("value", "unit", "text"),
    [(12.3456, "m", "12.35 m"), (2.5e6, "m", "2500 km"), (0.5, "rad", "0.5 rad"), (3.0, "1", "3")],
)
def test_values_are_short(value, unit, text):
    assert panels.format_value(value, unit) == text


def test_notebook_shows_samples_as_png():
    class Formatter(dict):
        def for_type(self, kind, function):
            self[kind] = function

    class Shell:
        class display_formatter:  # noqa: N801 (IPython's name)
            formatters = {"image/png": Formatter()}  # noqa: RUF012

    notebook.load_ipython_extension(Shell)
    formatter = Shell.display_formatter.formatters["image/png"]
    assert formatter["perilune.sample.Sample"](make_sample()).startswith(b"\x89PNG")
    assert notebook.show(make_sample())._repr_png_().startswith(b"\x89PNG")
    notebook.unload_ipython_extension(Shell)
    assert not formatter
