"""Albedos by Cycles: what albedo.py runs with a Python that has Blender's `bpy`.

Arguments: a folder with `paints.json`, a list of (colour, roughness) of Principled surfaces of
index 1.5, and the angles from the normal in degrees. Writes `albedo.json`, a list of as many
albedos for each, of a ball of facets under a white sky. Nothing of Perilune is imported.
"""

from __future__ import annotations

import json
import math
import os
import sys
from pathlib import Path
from typing import Any

import bpy
import numpy as np

SIZE, SAMPLES = 64, 256


def set_up() -> Any:
    """The inputs of the ball's surface."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    scene.render.engine = "CYCLES"
    scene.cycles.device = "CPU"
    scene.cycles.use_denoising = scene.cycles.use_adaptive_sampling = False
    scene.cycles.sample_clamp_indirect = scene.cycles.blur_glossy = 0.0
    scene.cycles.max_bounces, scene.cycles.samples = 1, SAMPLES
    scene.view_settings.view_transform = "Raw"
    scene.render.resolution_x = scene.render.resolution_y = SIZE
    scene.render.image_settings.file_format = "OPEN_EXR"
    scene.render.image_settings.color_depth = "32"
    scene.world = bpy.data.worlds.new("sky")
    scene.world.use_nodes = True
    scene.world.node_tree.nodes["Background"].inputs["Color"].default_value = (1, 1, 1, 1)
    bpy.ops.mesh.primitive_uv_sphere_add(segments=720, ring_count=360, radius=1.0)
    material = bpy.data.materials.new("paint")
    material.use_nodes = True
    bpy.context.object.data.materials.append(material)
    lens = bpy.data.cameras.new("camera")
    lens.type, lens.ortho_scale = "ORTHO", 2.0
    camera = bpy.data.objects.new("camera", lens)
    camera.location = (0, 0, 5)
    scene.collection.objects.link(camera)
    scene.camera = camera
    return material.node_tree.nodes["Principled BSDF"].inputs


def render(folder: Path) -> np.ndarray:
    path = str(folder / "ball.exr")
    bpy.ops.render.render(write_still=False)
    bpy.data.images["Render Result"].save_render(path)
    image = bpy.data.images.load(path)
    image.colorspace_settings.name = "Non-Color"
    pixels = np.empty(SIZE * SIZE * 4, np.float32)
    image.pixels.foreach_get(pixels)
    bpy.data.images.remove(image)
    return pixels.reshape(SIZE, SIZE, 4)[..., 0]


def at(image: np.ndarray, degrees: float) -> float:
    """Mean of the pixels about an angle, by a line through them."""
    x, y = np.meshgrid(*2 * [(np.arange(SIZE) + 0.5) * 2.0 / SIZE - 1.0])
    cosine = np.sqrt(np.maximum(0.0, 1.0 - x**2 - y**2))
    near = np.abs(np.degrees(np.arccos(cosine)) - degrees) < (4.0 if degrees < 4.0 else 2.0)
    line = np.stack([np.ones(near.sum()), cosine[near] - math.cos(math.radians(degrees))], 1)
    return float(np.linalg.lstsq(line, image[near], rcond=None)[0][0])


def main() -> None:
    folder, angles = Path(sys.argv[1]), [float(word) for word in sys.argv[2:]]
    inputs = set_up()
    inputs["IOR"].default_value, inputs["Metallic"].default_value = 1.5, 0.0
    out = []
    for color, roughness in json.loads((folder / "paints.json").read_text()):
        inputs["Base Color"].default_value = (color, color, color, 1.0)
        inputs["Roughness"].default_value = roughness
        image = render(folder)
        out.append([at(image, degrees) for degrees in angles])
    (folder / "albedo.json").write_text(json.dumps(out))


main()
os._exit(0)  # Blender as a module may crash while it is unloaded
