"""Material graphs: compiled from the configuration, assigned to triangles, and checked."""

from perilune.materials.check import check, is_choice, is_drawn, users
from perilune.materials.drivers import applied
from perilune.materials.graph import Graph, build, values
from perilune.materials.images import Image, ImageFiles, Images, images_in
from perilune.materials.place import Placed, Triples, parameters, triangles

__all__ = [
    "Graph",
    "Image",
    "ImageFiles",
    "Images",
    "Placed",
    "Triples",
    "applied",
    "build",
    "check",
    "images_in",
    "is_choice",
    "is_drawn",
    "parameters",
    "triangles",
    "users",
    "values",
]
