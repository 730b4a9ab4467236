"""A frame as Cycles sees it: what against_cycles.py runs with a Python that has Blender's `bpy`.

Reads the description (`job.json`) in the folder that is its argument; for every number of samples
writes the radiance (.npy), and the seconds of all renders to `seconds.json`. Nothing of Perilune is
imported.
"""

from __future__ import annotations

import json
import math
import os
import sys
import time
from pathlib import Path
from typing import Any

import bpy
import numpy as np
from mathutils import Matrix, Quaternion, Vector

# From the axes of OpenCV's camera (y down, z forward) to Blender's (y up, z backward).
TURNED = Matrix(((1, 0, 0, 0), (0, -1, 0, 0), (0, 0, -1, 0), (0, 0, 0, 1)))


def add_model(model: dict[str, Any], index: int) -> None:
    """A glTF file, by Blender's own reader, which turns it to z-up as Perilune does."""
    before = set(bpy.data.objects)
    bpy.ops.import_scene.gltf(filepath=model["path"])
    pose = Matrix(model["to_camera"])
    placed = pose @ Matrix.Scale(model["scale"], 4) @ Matrix.Translation(-Vector(model["offset"]))
    frame = bpy.data.objects.new(f"frame {index}", None)
    bpy.context.scene.collection.objects.link(frame)
    frame.matrix_world = TURNED @ placed
    for item in set(bpy.data.objects) - before - {frame}:
        item.pass_index = index + 1
        if item.parent is None:
            item.parent = frame


def sphere(body: dict[str, Any]) -> Any:
    """An ellipsoid whose texture coordinates are longitude and latitude."""
    rows, columns = 256, 512
    u, v = np.meshgrid(np.linspace(0, 1, columns + 1), np.linspace(0, 1, rows + 1))
    lon, lat = (2 * u - 1) * math.pi + body["center_lon_rad"], (v - 0.5) * math.pi
    unit = np.stack([np.cos(lat) * np.cos(lon), np.cos(lat) * np.sin(lon), np.sin(lat)], axis=-1)
    points = (unit * np.array(body["radii_m"])).reshape(-1, 3)
    corner = (np.arange(rows)[:, None] * (columns + 1) + np.arange(columns)).reshape(-1)
    faces = np.stack([corner, corner + 1, corner + columns + 2, corner + columns + 1], axis=-1)
    mesh = bpy.data.meshes.new(body["name"])
    mesh.from_pydata(points.tolist(), [], faces.tolist())
    layer = mesh.uv_layers.new()
    uv = np.stack([u, v], axis=-1).reshape(-1, 2)[faces.reshape(-1)]
    layer.data.foreach_set("uv", uv.astype(np.float32).reshape(-1))
    mesh.polygons.foreach_set("use_smooth", [True] * len(faces))
    return mesh


def add_body(body: dict[str, Any]) -> None:
    mesh = sphere(body)
    material = bpy.data.materials.new(body["name"])
    material.use_nodes = True
    nodes, links = material.node_tree.nodes, material.node_tree.links
    nodes.clear()
    out, diffuse = nodes.new("ShaderNodeOutputMaterial"), nodes.new("ShaderNodeBsdfDiffuse")
    links.new(diffuse.outputs[0], out.inputs[0])
    if body["map"] is not None:
        image, tint = nodes.new("ShaderNodeTexImage"), nodes.new("ShaderNodeMix")
        image.image = bpy.data.images.load(body["map"])
        tint.data_type, tint.blend_type = "RGBA", "MULTIPLY"
        tint.inputs["Factor"].default_value = 1.0
        tint.inputs["B"].default_value = (*body["albedo"], 1.0)
        links.new(image.outputs["Color"], tint.inputs["A"])
        links.new(tint.outputs["Result"], diffuse.inputs["Color"])
    else:
        diffuse.inputs["Color"].default_value = (*body["albedo"], 1.0)
    mesh.materials.append(material)
    item = bpy.data.objects.new(body["name"], mesh)
    item.matrix_world = TURNED @ Matrix(body["to_camera"])
    bpy.context.scene.collection.objects.link(item)


def add_sun(sun: dict[str, Any]) -> None:
    light = bpy.data.lights.new("sun", "SUN")
    light.energy, light.angle = sun["irradiance"], 2.0 * sun["radius_rad"]
    item = bpy.data.objects.new("sun", light)
    toward = TURNED.to_3x3() @ Vector(sun["direction"])
    item.rotation_mode = "QUATERNION"
    item.rotation_quaternion = Quaternion(toward.to_track_quat("Z", "Y"))
    bpy.context.scene.collection.objects.link(item)


def add_camera(camera: dict[str, Any]) -> None:
    lens = bpy.data.cameras.new("camera")
    lens.sensor_fit, lens.sensor_width = "HORIZONTAL", 36.0
    lens.lens = camera["focal_px"] / camera["width"] * lens.sensor_width
    lens.clip_start, lens.clip_end = 0.01, 1e9
    item = bpy.data.objects.new("camera", lens)
    bpy.context.scene.collection.objects.link(item)
    scene = bpy.context.scene
    scene.camera = item
    scene.render.resolution_x, scene.render.resolution_y = camera["width"], camera["height"]
    scene.render.resolution_percentage = 100


def set_up(job: dict[str, Any]) -> None:
    """Cycles as it comes, but for: no denoiser, even samples, as many bounces, black space, the
    passes that labels need."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    scene.render.engine = "CYCLES"
    scene.render.threads_mode, scene.render.threads = "FIXED", job["threads"]
    scene.render.use_persistent_data = True
    scene.view_settings.view_transform = "Raw"
    scene.cycles.device = "CPU"
    scene.cycles.use_denoising = scene.cycles.use_adaptive_sampling = False
    scene.cycles.max_bounces = job["max_bounces"]
    scene.cycles.sample_clamp_indirect = 0.0
    layer = bpy.context.view_layer
    for name in ("z", "normal", "position", "object_index", "material_index", "uv"):
        setattr(layer, f"use_pass_{name}", True)
    scene.world = bpy.data.worlds.new("space")
    scene.world.use_nodes = True
    scene.world.node_tree.nodes["Background"].inputs["Strength"].default_value = 0.0


def render(samples: int, folder: Path) -> float:
    scene = bpy.context.scene
    scene.cycles.samples = samples
    scene.render.image_settings.file_format = "OPEN_EXR"
    scene.render.image_settings.color_depth = "32"
    scene.render.filepath = str(folder / f"cycles_{samples}.exr")
    start = time.perf_counter()
    bpy.ops.render.render(write_still=False)
    seconds = time.perf_counter() - start
    bpy.data.images["Render Result"].save_render(scene.render.filepath)
    image = bpy.data.images.load(scene.render.filepath)
    image.colorspace_settings.name = "Non-Color"
    width, height = image.size
    pixels = np.empty(width * height * 4, np.float32)
    image.pixels.foreach_get(pixels)
    np.save(folder / f"cycles_{samples}.npy", pixels.reshape(height, width, 4)[::-1, :, :3])
    return seconds


def main() -> None:
    folder = Path(sys.argv[1])
    job = json.loads((folder / "job.json").read_text())
    set_up(job)
    for index, model in enumerate(job["models"]):
        add_model(model, index)
    for body in job["bodies"]:
        add_body(body)
    add_sun(job["sun"])
    add_camera(job["camera"])
    render(1, folder)  # loads, builds and keeps the scene
    seconds = {
        str(samples): sorted(render(samples, folder) for _ in range(repeats))[repeats // 2]
        for samples, repeats in job["samples"]
    }
    (folder / "seconds.json").write_text(json.dumps(seconds))


main()
os._exit(0)  # Blender as a module may crash while it is unloaded
