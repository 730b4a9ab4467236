"""The JSON files of a dataset as types: exact keys, exact shapes, finite numbers."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Annotated, Any, Literal, TypeVar

from pydantic import BaseModel, ConfigDict, Field, JsonValue, TypeAdapter, ValidationError

from perilune.drivers import path_text
from perilune.export.check.findings import Report

T = TypeVar("T")

_SHOWN = 5
"""Number of faults of one file that are listed."""

LARGEST_SIDE = 32768
"""Largest side of an image in pixels, as in the configuration."""

Number = Annotated[float, Field(allow_inf_nan=False)]
Positive = Annotated[float, Field(allow_inf_nan=False, gt=0.0)]
Count = Annotated[int, Field(ge=0)]
Three = Annotated[list[Number], Field(min_length=3, max_length=3)]
Nine = Annotated[list[Number], Field(min_length=9, max_length=9)]
Sixteen = Annotated[list[Number], Field(min_length=16, max_length=16)]
Box = Annotated[list[int], Field(min_length=4, max_length=4)]
Id = Annotated[str, Field(pattern=r"^(0|[1-9][0-9]*)$")]


class Exact(BaseModel):
    """An object of a JSON file: these keys, and no others."""

    model_config = ConfigDict(extra="forbid", strict=True, frozen=True)


class Camera(Exact):
    """camera.json."""

    cx: Number
    cy: Number
    depth_scale: Positive
    fx: Positive
    fy: Positive
    height: Annotated[int, Field(ge=1, le=LARGEST_SIDE)]
    width: Annotated[int, Field(ge=1, le=LARGEST_SIDE)]


class Frame(Exact):
    """Index of a frame, and values of its drivers by key path."""

    index: Annotated[int, Field(ge=0)]
    drivers: dict[str, JsonValue]
    scene_drivers: dict[str, JsonValue] = Field(default_factory=dict)
    overrides: dict[str, JsonValue] = Field(default_factory=dict)


class CameraRow(Exact):
    """The camera in the middle of the exposure of a row."""

    row: Count
    cam_R_w2c: Nine  # noqa: N815
    cam_t_w2c: Three


class SceneCamera(Exact):
    """An entry of scene_camera.json."""

    cam_K: Nine  # noqa: N815
    cam_R_w2c: Nine  # noqa: N815
    cam_t_w2c: Three
    depth_scale: Positive
    sensor: str | None = None
    frame: Frame | None = None
    rows: list[CameraRow] | None = None
    """Under a rolling shutter."""


class PoseRow(Exact):
    """An instance in the middle of the exposure of a row."""

    row: Count
    cam_R_m2c: Nine  # noqa: N815
    cam_t_m2c: Three
    articulation: dict[str, Sixteen] | None = None


class Pose(Exact):
    """An entry of scene_gt.json."""

    cam_R_m2c: Nine  # noqa: N815
    cam_t_m2c: Three
    obj_id: Count
    articulation: dict[str, Sixteen] | None = None
    """Moving node -> its motion in the model's frame: 4 x 4, row by row, mm."""
    rows: list[PoseRow] | None = None
    """Under a rolling shutter. Interpolate linearly, rotations by the shorter arc, in camera
    axes."""


class Info(Exact):
    """An entry of scene_gt_info.json."""

    bbox_obj: Box
    bbox_visib: Box
    px_count_all: Count
    px_count_valid: Count
    px_count_visib: Count
    visib_fract: Annotated[float, Field(ge=0.0, le=1.0)]


class Runs(Exact):
    """Uncompressed run lengths."""

    counts: list[Count]
    size: Annotated[list[Count], Field(min_length=2, max_length=2)]


class Annotation(Exact):
    """An entry of `annotations` of the COCO file."""

    area: Count
    bbox: Box
    category_id: Count
    height: int
    id: int
    ignore: bool
    image_id: Count
    iscrowd: Annotated[int, Field(ge=0, le=0)]
    segmentation: Runs
    width: int


class Image(Exact):
    """An entry of `images` of the COCO file."""

    coco_url: str
    date_captured: str
    file_name: str
    flickr_url: str
    height: int
    id: Count
    license: int
    width: int


class Category(Exact):
    """An entry of `categories` of the COCO file."""

    id: Count
    name: str
    supercategory: str


class CocoInfo(Exact):
    """`info` of the COCO file."""

    contributor: str
    date_created: str
    description: str
    url: str
    version: str
    year: int


class Coco(Exact):
    """scene_gt_coco.json."""

    annotations: list[Annotation]
    categories: list[Category]
    images: list[Image]
    info: CocoInfo
    licenses: list[dict[str, Any]]


class Line(Exact):
    """A continuous symmetry."""

    axis: Three
    offset: Three


class ModelInfo(Exact):
    """An entry of models_info.json."""

    diameter: Positive
    min_x: Number
    min_y: Number
    min_z: Number
    size_x: Annotated[Number, Field(ge=0.0)]
    size_y: Annotated[Number, Field(ge=0.0)]
    size_z: Annotated[Number, Field(ge=0.0)]
    symmetries_continuous: list[Line] = []
    symmetries_discrete: list[Sixteen] = []
    faces_one_sided: Count = 0
    """Number of faces whose back is not rendered; renderers without culling show more."""
    faces_cut_in_part: Count = 0
    """Number of faces, the last of the file, of which alpha leaves only a part."""
    triangles_left_out: Count = 0
    """Number of triangles that alpha removes completely, which are not written as faces."""
    surface: Literal["ellipsoid", "shape", "terrain"] | None = None
    """What a body is: of an ellipsoid the model has points, of terrain it is coarse."""


class EvalInfo(ModelInfo):
    """An entry of models_info.json of the evaluation models. Their surface is only approximately
    the same, so their box need not be centred at the origin."""


class PartInfo(ModelInfo):
    """An entry of models_info.json of the moving parts."""

    obj_id: Count
    nodes: list[str]
    """Moving nodes above it, nearest first; it moves with the first that `articulation` of an
    instance names."""


class SensorEntry(Exact):
    """An entry of `sensors` of dataset_info.json."""

    name: str
    trigger_interval: Annotated[int, Field(ge=1)]


class Channel(Exact):
    """An entry of `channels` of dataset_info.json: files in addition to BOP's."""

    components: Count | None
    dtype: Literal["uint8", "uint16", "int32", "int64", "float32", "float64", "table"]
    file: Literal["png", "npy"]


class Source(BaseModel):
    """dataset_info.json, as far as a check needs it; other keys are allowed."""

    model_config = ConfigDict(strict=True, frozen=True)

    chunk_size: Annotated[int, Field(ge=1)]
    config_name: str
    config_sha256: str
    dataset_name: Annotated[str, Field(pattern="^[a-z0-9]+$")]
    description: str
    seed: int
    sensors: list[SensorEntry] = []
    """In the order in which they take frames; empty without sensors."""
    pictures: dict[Literal["rgb", "sensor_rgb", "raw"], Literal["rgb", "sensor_rgb", "raw"]] = {}
    """Folder -> channel of the images other than labels; empty: `rgb` alone."""
    channels: dict[str, Channel] = {}
    """Channels in addition to BOP's, a folder each."""
    keypoints: dict[str, list[str]] | None = None
    """Object -> names of its keypoints; None: the scenes have no file of them."""
    split: Annotated[str, Field(pattern="^[a-z0-9]+(_[a-z0-9]+)?$")]


def by_id(kind: Any) -> TypeAdapter[Any]:
    """An object whose keys are ids."""
    return TypeAdapter(dict[Id, kind])


def _unique(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    result = dict(pairs)
    if len(result) != len(pairs):
        raise ValueError("a key occurs twice in one object")
    return result


def read_json(report: Report, path: Path, adapter: TypeAdapter[T]) -> T | None:
    """The validated content of a file; None, with a finding, if it is invalid."""
    try:
        value = json.loads(path.read_text(encoding="utf-8"), object_pairs_hook=_unique)
        return adapter.validate_python(value)
    except FileNotFoundError:
        report.add(path, "is missing")
    except ValidationError as error:
        faults = error.errors(include_url=False)
        for fault in faults[:_SHOWN]:
            where = path_text(fault["loc"])
            report.add(path, f"{where or '(top level)'}: {fault['msg']}")
        if len(faults) > _SHOWN:
            report.add(path, f"{len(faults) - _SHOWN} more faults of this kind")
    except (OSError, ValueError, RecursionError) as error:
        report.add(path, f"cannot be read: {error}")
    return None
