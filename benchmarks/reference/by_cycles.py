"""A scene as Blender's Cycles sees it; run by a Python that has `bpy`, from the repository's root.

    python -m benchmarks.reference.by_cycles FOLDER

Reads what `Scene.save` wrote into the folder and job.json: threads, passes (whether to render those
that labels need) and renders, [samples, seed] each. Writes cycles.npy, (renders, H, W, 3) radiance,
and seconds.json, of CPU time. As Cycles comes, but for: even samples, the pixel as filter, no
denoiser, no clamps, no blur of reflections, no offsets at terminators.
"""

from __future__ import annotations

import json
import os
import sys
import time
from dataclasses import replace
from pathlib import Path
from typing import Any

import bpy
import numpy as np
from mathutils import Matrix, Quaternion, Vector

from .scene import WATER, Array, Image, Input, Material, Mesh, Scene, load

# From the axes of OpenCV's camera (y down, z forward) to Blender's (y up, z backward).
TURNED = np.array([1.0, -1.0, -1.0])


def picture(image: Image) -> Any:
    values = image.linear()
    height, width, bands = values.shape
    rgba = np.ones((height, width, 4), np.float32)
    rgba[..., :3] = values if bands == 3 else np.repeat(values, 3, axis=-1)
    name = f"image {len(bpy.data.images)}"
    out = bpy.data.images.new(name, width, height, float_buffer=True, is_data=True)
    out.pixels.foreach_set(rgba[::-1].reshape(-1))
    out.update()
    out.pack()
    return out


def connect(tree: Any, value: Input, socket: Any) -> None:
    if isinstance(value, Image):
        node = tree.nodes.new("ShaderNodeTexImage")
        node.image = picture(value)
        node.interpolation = "Closest" if value.nearest else "Linear"
        tree.links.new(node.outputs["Color"], socket)
    elif len(value) == 3:
        socket.default_value = (*value, 1.0)
    else:
        socket.default_value = value[0]


def material(given: Material) -> Any:
    out = bpy.data.materials.new(given.name)
    out.use_nodes = True
    tree = out.node_tree
    tree.nodes.clear()
    end = tree.nodes.new("ShaderNodeOutputMaterial")
    if given.lambert:
        surface = tree.nodes.new("ShaderNodeBsdfDiffuse")
        connect(tree, given.color, surface.inputs["Color"])
    elif given.waves is not None:
        surface = tree.nodes.new("ShaderNodeBsdfGlass")
        surface.distribution = "BECKMANN"
        surface.inputs["Roughness"].default_value = given.waves**0.5  # its square is alpha
        surface.inputs["IOR"].default_value = WATER
    else:
        surface = tree.nodes.new("ShaderNodeBsdfPrincipled")
        connect(tree, given.color, surface.inputs["Base Color"])
        connect(tree, given.roughness, surface.inputs["Roughness"])
        connect(tree, given.metallic, surface.inputs["Metallic"])
        surface.inputs["IOR"].default_value = 1.5
        if isinstance(given.emission, Image) or any(given.emission):
            connect(tree, given.emission, surface.inputs["Emission Color"])
            surface.inputs["Emission Strength"].default_value = 1.0
    if given.normal is not None:
        bent = tree.nodes.new("ShaderNodeNormalMap")
        connect(tree, given.normal, bent.inputs["Color"])
        tree.links.new(bent.outputs["Normal"], surface.inputs["Normal"])
    tree.links.new(surface.outputs[0], end.inputs["Surface"])
    return out


def add_mesh(given: Mesh, materials: list[Any]) -> None:
    mesh = bpy.data.meshes.new(given.name)
    count = len(given.indices)
    mesh.vertices.add(len(given.positions))
    mesh.vertices.foreach_set("co", (given.positions * TURNED).astype(np.float32).reshape(-1))
    mesh.loops.add(3 * count)
    mesh.loops.foreach_set("vertex_index", given.indices.astype(np.int32).reshape(-1))
    mesh.polygons.add(count)
    mesh.polygons.foreach_set("loop_start", np.arange(0, 3 * count, 3, dtype=np.int32))
    if given.uv is not None:
        layer = mesh.uv_layers.new()
        uv = given.uv[given.indices.reshape(-1)]
        layer.data.foreach_set("uv", uv.astype(np.float32).reshape(-1))
    mesh.update(calc_edges=True)
    mesh.polygons.foreach_set("use_smooth", np.ones(count, dtype=bool))
    mesh.normals_split_custom_set_from_vertices((given.normals * TURNED).astype(np.float32))
    mesh.materials.append(materials[given.material])
    item = bpy.data.objects.new(given.name, mesh)
    item.cycles.shadow_terminator_geometry_offset = 0.0
    item.cycles.shadow_terminator_offset = 0.0
    bpy.context.scene.collection.objects.link(item)
    if len(mesh.polygons) != count:
        sys.exit(f"{given.name}: {count - len(mesh.polygons)} triangles were lost")


def deep(given: Mesh, index: int) -> Mesh:
    """A ball below water that keeps what enters."""
    middle = 0.5 * (given.positions.min(0) + given.positions.max(0))
    shrunk = middle + 0.99 * (given.positions - middle)
    return replace(given, name=f"{given.name}.deep", positions=shrunk, material=index, uv=None)


def add_sun(sun: dict[str, Any]) -> None:
    light = bpy.data.lights.new("sun", "SUN")
    light.energy, light.angle = sun["irradiance"], 2.0 * sun["radius_rad"]
    item = bpy.data.objects.new("sun", light)
    toward = Vector(np.array(sun["direction"]) * TURNED)
    item.rotation_mode = "QUATERNION"
    item.rotation_quaternion = Quaternion(toward.to_track_quat("Z", "Y"))
    bpy.context.scene.collection.objects.link(item)


def add_camera(camera: dict[str, Any]) -> None:
    width, height = camera["width"], camera["height"]
    lens = bpy.data.cameras.new("camera")
    lens.sensor_fit, lens.sensor_width = "HORIZONTAL", 36.0
    lens.lens = camera["focal_px"][0] / width * lens.sensor_width
    # Blender's shift moves the picture by parts of its width
    lens.shift_x = -(camera["centre_px"][0] - 0.5 * (width - 1)) / width
    lens.shift_y = (camera["centre_px"][1] - 0.5 * (height - 1)) / width
    lens.clip_start, lens.clip_end = 0.01, 1e12
    item = bpy.data.objects.new("camera", lens)
    item.matrix_world = Matrix.Identity(4)
    bpy.context.scene.collection.objects.link(item)
    scene = bpy.context.scene
    scene.camera = item
    scene.render.resolution_x, scene.render.resolution_y = width, height
    scene.render.resolution_percentage = 100


def set_up(bounces: int, threads: int) -> None:
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    scene.render.engine = "CYCLES"
    scene.render.threads_mode, scene.render.threads = "FIXED", threads
    scene.render.use_persistent_data = True
    scene.view_settings.view_transform = "Raw"
    cycles = scene.cycles
    cycles.device = "CPU"
    cycles.use_denoising = cycles.use_adaptive_sampling = False
    cycles.max_bounces = cycles.diffuse_bounces = cycles.glossy_bounces = bounces
    cycles.transmission_bounces = bounces
    cycles.sample_clamp_direct = cycles.sample_clamp_indirect = 0.0
    cycles.blur_glossy = cycles.light_sampling_threshold = 0.0
    cycles.caustics_reflective = cycles.caustics_refractive = True
    cycles.pixel_filter_type = "BOX"
    scene.world = bpy.data.worlds.new("space")
    scene.world.use_nodes = True
    scene.world.node_tree.nodes["Background"].inputs["Strength"].default_value = 0.0


def render(samples: int, seed: int, folder: Path) -> tuple[Array, float]:
    """Radiance (H, W, 3), and seconds of CPU time without those of saving it."""
    scene = bpy.context.scene
    scene.cycles.samples, scene.cycles.seed = samples, seed
    scene.render.image_settings.file_format = "OPEN_EXR"
    scene.render.image_settings.color_depth = "32"
    start = time.process_time()
    bpy.ops.render.render(write_still=False)
    seconds = time.process_time() - start
    path = folder / "cycles.exr"
    bpy.data.images["Render Result"].save_render(str(path))
    image = bpy.data.images.load(str(path))
    image.colorspace_settings.name = "Non-Color"
    width, height = image.size
    pixels = np.empty(width * height * 4, np.float32)
    image.pixels.foreach_get(pixels)
    bpy.data.images.remove(image)
    return pixels.reshape(height, width, 4)[::-1, :, :3].copy(), seconds


def place(scene: Scene, job: dict[str, Any]) -> None:
    if scene.air:
        sys.exit("air is not exported to Cycles")
    set_up(scene.max_bounces, job["threads"])
    if job["passes"]:
        layer = bpy.context.view_layer
        for name in ("z", "normal", "position", "object_index", "material_index", "uv"):
            setattr(layer, f"use_pass_{name}", True)
    materials = [material(row) for row in scene.materials]
    materials.append(material(Material("black", (0.0, 0.0, 0.0), lambert=True)))
    for mesh in scene.meshes:
        add_mesh(mesh, materials)
        if scene.materials[mesh.material].waves is not None:
            add_mesh(deep(mesh, len(materials) - 1), materials)
    add_sun(scene.sun)
    add_camera(scene.camera)


def main() -> None:
    folder = Path(sys.argv[1])
    job = json.loads((folder / "job.json").read_text())
    place(load(folder), job)
    render(1, 0, folder)  # loads, builds and keeps the scene
    images, seconds = [], []
    for samples, seed in job["renders"]:
        image, took = render(samples, seed, folder)
        images.append(image)
        seconds.append(took)
    np.save(folder / "cycles.npy", np.stack(images))
    (folder / "seconds.json").write_text(json.dumps(seconds))


if __name__ == "__main__":
    main()
    sys.stdout.flush()
    os._exit(0)  # Blender as a module may crash while it is unloaded
