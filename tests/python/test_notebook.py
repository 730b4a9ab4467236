"""What notebooks show: with the real IPython, and a notebook run by the real kernel."""

from __future__ import annotations

import base64
import copy
import html.parser
import io
import pickle
import re

import numpy as np
import pytest
from IPython.core.formatters import DisplayFormatter
from PIL import Image

import perilune

CHANNELS = ["rgb", "depth", "normal", "semantic", "part", "instance", "objects", "masks"]
PNG = re.compile(r"data:image/png;base64,([A-Za-z0-9+/=]+)")


@pytest.fixture(scope="module")
def sim(repo_dir):
    driver = {"ideal": 40.0, "jitter_variance": 4.0, "clip_min": 30.0, "clip_max": 50.0}
    scene = repo_dir / "tests/python/scene.yaml"
    return perilune.open(scene, overrides={"camera.fov_deg": driver, "description": "a <b> & c"})


@pytest.fixture(scope="module")
def sample(sim):
    return sim.frame(1, channels=CHANNELS)


def shown(thing):
    """What IPython makes of the value of a cell, by type of content."""
    return DisplayFormatter().format(thing)[0]


class Tags(html.parser.HTMLParser):
    """Fails where a tag is closed that is not open, or left open."""

    def __init__(self):
        super().__init__()
        self.open = []
        self.text = ""

    def handle_starttag(self, tag, attrs):
        if tag != "img":
            self.open.append(tag)

    def handle_startendtag(self, tag, attrs):
        pass

    def handle_endtag(self, tag):
        assert self.open.pop() == tag

    def handle_data(self, data):
        self.text += data + "\n"


def page(thing):
    """The HTML of a thing and its text."""
    found = shown(thing)["text/html"]
    tags = Tags()
    tags.feed(found)
    assert tags.open == []
    return found, tags.text


def pictures(found):
    """The embedded pictures, as arrays."""
    return [
        np.asarray(Image.open(io.BytesIO(base64.b64decode(data, validate=True))))
        for data in PNG.findall(found)
    ]


def test_a_sample_shows_its_pictures_with_names_shapes_and_units(sample):
    found, text = page(sample)
    for line in ("uint8 32 x 48 x 3, DN", "float32 32 x 48, m", "int32 32 x 48, id", "masks"):
        assert line in text
    for title in ("rgb", "visible boxes and axes", "depth", "normal", "semantic/2", "part"):
        assert title in text
    images = pictures(found)
    assert len(images) == 9
    assert all(image.std() > 0.0 for image in images), "no empty picture"
    assert "objects (1)" in text
    assert "camera.fov_deg" in text
    assert len(found) < 1_000_000


def test_the_thumbnail_is_the_picture(sample):
    first = pictures(page(sample)[0])[0]
    height, width = first.shape[:2]
    assert width / height == pytest.approx(48 / 32, abs=0.02)
    assert first.mean() == pytest.approx(sample["rgb"].mean(), abs=3.0)


def test_a_sample_of_one_channel_or_none(sim):
    for channels in (["depth"], [], ["objects"], ["semantic"]):
        _, text = page(sim.frame(0, channels=channels))
        assert "Frame 0" in text


@pytest.mark.parametrize(
    ("what", "expected"),
    [
        ("sim", ["Simulation scene", "seed 7", "earth", "sat", "48 x 32", "orbit_object"]),
        ("sim.plan(0)", ["Plan", "cast_shadows", "DN", "ms", "on", "off"]),
        ("sample.plan", ["Plan", "antialiasing"]),
        ("sim.taxonomy", ["Taxonomy", "semantic[..., 1]", "spacecraft", "part (", "background"]),
        ("sim.config", ["Config", "spacecraft.sat.size_m", "defaults ("]),
        ("sim.config.camera", ["Camera", "trajectory.kind", "orbit_object", "exposure.mode"]),
        ("sample.objects", ["Objects", "t_m2c", "100.0 %"]),
    ],
)
def test_all_others_show_tables(sim, sample, what, expected):
    _, text = page(eval(what, {"sim": sim, "sample": sample}))
    for part in expected:
        assert part in text


def test_texts_of_the_user_are_no_html(sim):
    found, text = page(sim)
    assert "a <b> & c" in text
    assert "<b> & c" not in found


def test_a_graph_and_figures_show_themselves(repo_dir, sim):
    material = perilune.open(repo_dir / "configs/mli_randomised.yaml").graph("gold")
    assert shown(material)["image/svg+xml"].startswith("<svg") or "svg" in material.svg[:200]
    pytest.importorskip("matplotlib")
    figure = sim.plot_orbits(frames=range(2))
    assert shown(figure)["image/png"].startswith(b"\x89PNG")
    assert pickle.loads(pickle.dumps(figure)).axes


def test_rows_of_objects_are_arrays(sample):
    """They show a table, and are what they were for all else."""
    rows = sample.objects
    assert isinstance(rows, np.ndarray)
    assert "text/html" not in shown(rows["t_m2c"])
    assert "text/html" not in shown(rows[0])
    assert np.stack([rows, rows]).shape == (2, 1)
    for again in (pickle.loads(pickle.dumps(rows)), copy.deepcopy(rows)):
        assert again.tobytes() == rows.tobytes()
    plan = pickle.loads(pickle.dumps(sample.plan))
    assert plan == sample.plan == list(sample.plan)


CELLS = [
    "import perilune\nsim = perilune.open(SCENE)",
    "sim",
    "sample = sim[1]\nsample",
    "sample.objects",
    "sim.plan(1)",
    "sim.taxonomy",
    "sim.config.render",
    "sim.plot_orbits(frames=range(2))",
]


def test_a_notebook_run_by_the_kernel(repo_dir):
    """Nothing is loaded, and every cell shows more than text."""
    nbclient = pytest.importorskip("nbclient")
    import nbformat

    book = nbformat.v4.new_notebook()
    scene = repr(str(repo_dir / "tests/python/scene.yaml"))
    book.cells = [nbformat.v4.new_code_cell(cell.replace("SCENE", scene)) for cell in CELLS]
    nbclient.NotebookClient(book, timeout=120, kernel_name="python3").execute()
    for cell, is_plot in zip(book.cells[1:], [False] * 6 + [True], strict=True):
        (output,) = cell.outputs
        data = output["data"]
        assert ("image/png" if is_plot else "text/html") in data, cell.source
    assert len(PNG.findall(book.cells[2].outputs[0]["data"]["text/html"])) >= 5
