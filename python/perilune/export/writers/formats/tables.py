"""The table of formats: a format is its own file and a line here."""

from __future__ import annotations

from perilune.export.writers.formats.base import Format
from perilune.export.writers.formats.bop_webdataset import BopWebDataset
from perilune.export.writers.formats.coco import Coco
from perilune.export.writers.formats.exr import Exr, ExrHalf
from perilune.export.writers.formats.hdf5 import Hdf5
from perilune.export.writers.formats.kitti_flow import KittiFlow
from perilune.export.writers.formats.npz import Npz
from perilune.export.writers.formats.ply import Ply
from perilune.export.writers.formats.png import Png
from perilune.export.writers.formats.speed import Speed
from perilune.export.writers.formats.webdataset import WebDataset
from perilune.export.writers.formats.yolo import Yolo, YoloSegment
from perilune.export.writers.formats.yolo_pose import YoloPose

_ROWS: tuple[Format, ...] = (
    BopWebDataset(),
    Coco(),
    Yolo(),
    YoloSegment(),
    YoloPose(),
    Speed(),
    KittiFlow(),
    Png(),
    Npz(),
    Exr(),
    ExrHalf(),
    WebDataset(),
    Hdf5(),
    Ply(),
)
FORMATS: dict[str, Format] = {row.name: row for row in _ROWS}
"""Every format but BOP's scene folders, which are their own."""
