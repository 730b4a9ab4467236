"""Material graphs: built from the configuration, put on triangles, and checked."""

from perilune.materials.check import check
from perilune.materials.drivers import applied
from perilune.materials.graph import Graph, build, values
from perilune.materials.images import Image, ImageFiles, Images, images_in
from perilune.materials.place import Placed, on_body, parameters, place

__all__ = [
    "Graph",
    "Image",
    "ImageFiles",
    "Images",
    "Placed",
    "applied",
    "build",
    "check",
    "images_in",
    "on_body",
    "parameters",
    "place",
    "values",
]
