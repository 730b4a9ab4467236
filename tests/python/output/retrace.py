"""Models made of sheets, and rays against the models that a dataset holds: from its files alone."""

from __future__ import annotations

import base64
import json
from pathlib import Path

import numpy as np

_CORNERS = np.array([(-1, -1), (1, -1), (1, 1), (-1, 1)], dtype=float)
_FACES = np.array([0, 1, 2, 0, 2, 3], dtype="<u2")


def write_sheets(path: Path, **sheets) -> Path:
    """A glTF of square sheets, a node each.

    place (x, y, z) and normal axis 0..2 of the file's axes; half: half its side; material: of glTF;
    alpha: of vertex colours at its corners."""
    data, views, accessors, meshes, nodes, materials = b"", [], [], [], [], []

    def add(array, kind, component):
        nonlocal data
        views.append({"buffer": 0, "byteOffset": len(data), "byteLength": array.nbytes})
        row = {"bufferView": len(views) - 1, "componentType": component, "type": kind}
        row["count"] = array.size if kind == "SCALAR" else len(array)
        if kind == "VEC3":
            row |= {"min": array.min(axis=0).tolist(), "max": array.max(axis=0).tolist()}
        accessors.append(row)
        data += array.tobytes() + b"\0" * (-array.nbytes % 4)
        return len(accessors) - 1

    for name, sheet in sheets.items():
        axis, half = sheet.get("axis", 0), sheet.get("half", 1.0)
        points = np.zeros((4, 3))
        points[:, (axis + 1) % 3], points[:, (axis + 2) % 3] = half * _CORNERS.T
        attributes = {"POSITION": add(points.astype("<f4"), "VEC3", 5126)}
        if "alpha" in sheet:
            colors = np.ones((4, 4), dtype="<f4")
            colors[:, 3] = sheet["alpha"]
            attributes["COLOR_0"] = add(colors, "VEC4", 5126)
        primitive = {"attributes": attributes, "indices": add(_FACES, "SCALAR", 5123)}
        primitive["material"] = len(materials)
        materials.append({"name": name, **sheet.get("material", {})})
        meshes.append({"primitives": [primitive]})
        nodes.append({"name": name, "mesh": len(meshes) - 1, "translation": sheet["place"]})
    uri = "data:application/octet-stream;base64," + base64.b64encode(data).decode()
    document = {
        "asset": {"version": "2.0"},
        "scenes": [{"nodes": list(range(len(nodes)))}],
        "scene": 0,
        "nodes": nodes,
        "meshes": meshes,
        "materials": materials,
        "accessors": accessors,
        "bufferViews": views,
        "buffers": [{"byteLength": len(data), "uri": uri}],
    }
    path.write_text(json.dumps(document))
    return path


def read_faces(path):
    """(F, 3, 3) corners of a PLY, mm."""
    header, _, body = path.read_bytes().partition(b"end_header\n")
    counts = [int(line.split()[2]) for line in header.splitlines() if line.startswith(b"element")]
    vertex = np.dtype([("p", "<f4", 3), ("n", "<f4", 3), ("c", "u1", 3)])
    face = np.dtype([("n", "u1"), ("i", "<i4", 3)])
    points = np.frombuffer(body, vertex, counts[0])["p"].astype(float)
    return points[np.frombuffer(body, face, counts[1], counts[0] * vertex.itemsize)["i"]]


def _read(path):
    return json.loads(path.read_text())


class Retrace:
    """Rays of one image against the models at the poses that its labels state, backs culled."""

    def __init__(self, root, scene="train/000000"):
        self.root, self.scene = root, root / scene
        self.gt, self.cameras = _read(self.scene / "scene_gt.json"), None
        self.cameras = _read(self.scene / "scene_camera.json")
        parts = root / "models_parts"
        self.parts = _read(parts / "models_info.json") if parts.exists() else {}

    def pieces(self, obj_id):
        """(moving nodes, corners) of what a model is made of."""
        own = {k: row for k, row in self.parts.items() if row["obj_id"] == obj_id}
        if own:
            folder = self.root / "models_parts"
            return [
                (row["nodes"], read_faces(folder / f"obj_{int(k):06d}.ply"))
                for k, row in own.items()
            ]
        return [([], read_faces(self.root / "models" / f"obj_{obj_id:06d}.ply"))]

    def hits(self, im_id, gt_id, pixels, at=None):
        """(n,): depth, mm, along z of what pixels (n, 2) meet; inf for nothing. at: of a row."""
        pose = self.gt[str(im_id)][gt_id]
        at = at or pose
        K = np.reshape(self.cameras[str(im_id)]["cam_K"], (3, 3))
        R, t = np.reshape(at["cam_R_m2c"], (3, 3)), np.array(at["cam_t_m2c"])
        rays = np.linalg.solve(K, np.column_stack([pixels, np.ones(len(pixels))]).T).T
        nearest = np.full(len(pixels), np.inf)
        for nodes, corners in self.pieces(pose["obj_id"]):
            motions = at.get("articulation", {})
            named = [node for node in nodes if node in motions]
            motion = np.reshape(motions[named[0]], (4, 4)) if named else np.eye(4)
            moved = corners @ motion[:3, :3].T + motion[:3, 3]
            moved = moved @ R.T + t
            for a, b, c in moved:
                e1, e2 = b - a, c - a
                p = np.cross(rays, e2)
                det = p @ e1  # > 0: the ray meets the side that winds counter-clockwise
                with np.errstate(all="ignore"):
                    u = p @ -a / det
                    q = np.cross(-a, e1)
                    v = rays @ q / det
                    z = (e2 @ q) / det
                hit = (det > 0) & (u >= 0) & (v >= 0) & (u + v <= 1) & (z > 0)
                nearest[hit] = np.minimum(nearest[hit], z[hit])
        return nearest

    def compare(self, im_id, gt_id=0, rows=None):
        """(pixels of the mask, of them and all others those that certainly differ)."""
        from PIL import Image

        with Image.open(self.scene / "mask" / f"{im_id:06d}_{gt_id:06d}.png") as image:
            mask = np.array(image) > 0
        rows = range(mask.shape[0]) if rows is None else rows
        lines, columns = np.meshgrid(list(rows), np.arange(mask.shape[1]), indexing="ij")
        pixels = np.column_stack([columns.ravel(), lines.ravel()]).astype(float)
        found = [
            np.isfinite(self.hits(im_id, gt_id, pixels + shift))
            for shift in ([0, 0], [0.02, 0], [-0.02, 0], [0, 0.02], [0, -0.02])
        ]
        sure = np.all(found, axis=0) | ~np.any(found, axis=0)
        seen = mask[lines.ravel(), columns.ravel()]
        return int(seen.sum()), int((sure & (found[0] != seen)).sum())
