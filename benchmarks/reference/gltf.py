"""Materials of glTF files, read apart from Perilune's reader (which gives the triangles)."""

from __future__ import annotations

import base64
import io
import json
import struct
from pathlib import Path
from typing import Any
from urllib.parse import unquote

import numpy as np
from PIL import Image as Picture

from .scene import Array, Image, Input, Material

KNOWN = {"KHR_materials_emissive_strength", "KHR_materials_specular"}
NEAREST = 9728


class File:
    """A .glb or .gltf."""

    def __init__(self, path: Path) -> None:
        self.path = path
        data = path.read_bytes()
        self.chunk = b""
        if data[:4] == b"glTF":
            size = struct.unpack_from("<I", data, 12)[0]
            self.document: dict[str, Any] = json.loads(data[20 : 20 + size])
            self.chunk = data[28 + size :]
        else:
            self.document = json.loads(data)

    def parts(self) -> dict[int, list[int]]:
        """Node -> material of each of its primitives; -1 for none."""
        found = {}
        for index, node in enumerate(self.document.get("nodes", [])):
            if "mesh" in node:
                mesh = self.document["meshes"][node["mesh"]]
                found[index] = [row.get("material", -1) for row in mesh["primitives"]]
        return found

    def _bytes(self, uri: str) -> bytes:
        if uri.startswith("data:"):
            return base64.b64decode(uri.split(",", 1)[1])
        return (self.path.parent / unquote(uri)).read_bytes()

    def _picture(self, texture: dict[str, Any]) -> tuple[Array, bool]:
        """(H, W, 4) bytes, and whether the nearest texel is asked for."""
        if texture.get("texCoord", 0) != 0 or texture.get("extensions"):
            raise ValueError(f"{self.path}: a texture with {texture} is not exported")
        row = self.document["textures"][texture["index"]]
        sampler = self.document["samplers"][row["sampler"]] if "sampler" in row else {}
        image = self.document["images"][row["source"]]
        if "bufferView" in image:
            view = self.document["bufferViews"][image["bufferView"]]
            buffer = self.document["buffers"][view["buffer"]]
            data = self._bytes(buffer["uri"]) if "uri" in buffer else self.chunk
            start = view.get("byteOffset", 0)
            data = data[start : start + view["byteLength"]]
        else:
            data = self._bytes(image["uri"])
        pixels = np.asarray(Picture.open(io.BytesIO(data)).convert("RGBA"))
        return pixels, sampler.get("magFilter") == NEAREST

    def _color(self, row: dict[str, Any], key: str, factor: tuple[float, ...]) -> Input:
        if key not in row or not any(factor):
            return factor
        pixels, nearest = self._picture(row[key])
        return Image(pixels[..., :3], True, factor, nearest)

    def _number(self, pbr: dict[str, Any], channel: int, factor: float) -> Input:
        if "metallicRoughnessTexture" not in pbr or factor == 0.0:
            return (factor,)
        pixels, nearest = self._picture(pbr["metallicRoughnessTexture"])
        return Image(np.ascontiguousarray(pixels[..., channel]), False, (factor,), nearest)

    def _normal(self, row: dict[str, Any]) -> Image | None:
        if "normalTexture" not in row:
            return None
        pixels, nearest = self._picture(row["normalTexture"])
        vectors = 2.0 * pixels[..., :3].astype(np.float32) / np.float32(255.0) - 1.0
        vectors[..., :2] *= np.float32(row["normalTexture"].get("scale", 1.0))
        vectors /= np.linalg.norm(vectors, axis=-1, keepdims=True)
        return Image((0.5 + 0.5 * vectors).astype(np.float32), nearest=nearest)

    def material(self, index: int) -> Material:
        """ValueError where it has what other renderers are not told of."""
        if index < 0:
            return Material("default", (1.0, 1.0, 1.0), (1.0,), (1.0,))
        row = self.document["materials"][index]
        name = row.get("name", f"material {index}")
        extensions = row.get("extensions", {})
        unknown = sorted(set(extensions) - KNOWN)
        specular = extensions.get("KHR_materials_specular", {})
        lambert = bool(specular) and specular.get("specularFactor", 1.0) == 0.0
        if unknown or (specular and not lambert) or row.get("alphaMode", "OPAQUE") != "OPAQUE":
            text = f"{unknown}, alphaMode {row.get('alphaMode')}, {specular}"
            raise ValueError(f"{self.path}: materials[{index}] ({name}) is not exported: {text}")
        pbr = row.get("pbrMetallicRoughness", {})
        factor = tuple(pbr.get("baseColorFactor", (1.0, 1.0, 1.0))[:3])
        emissive = extensions.get("KHR_materials_emissive_strength", {})
        strength = emissive.get("emissiveStrength", 1.0)
        glow = tuple(strength * v for v in row.get("emissiveFactor", (0.0, 0.0, 0.0)))
        metallic = pbr.get("metallicFactor", 1.0)
        return Material(
            name=name,
            color=self._color(pbr, "baseColorTexture", factor),
            roughness=self._number(pbr, 1, pbr.get("roughnessFactor", 1.0)),
            metallic=self._number(pbr, 2, metallic),
            emission=self._color(row, "emissiveTexture", glow),
            normal=self._normal(row),
            lambert=lambert and metallic == 0.0,
            double_sided=row.get("doubleSided", False),
        )
