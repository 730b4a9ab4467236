"""The glTF reader on published files: models, samples, broken files, the validator's corpus.

What valid files hold is found by a second reader, gltf_reference.py. The sources of all files are
in the README of the data folder.
"""

from __future__ import annotations

import importlib.util
import json
import re
import sys
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest

from perilune._core import Model

SPACECRAFT = ["cassini", "epoxi", "iss", "lro_textured", "lro_untextured", "mro"]
SPACECRAFT += ["space_shuttle_d", "tdrs_a", "voyager"]


def load_reference() -> ModuleType:
    path = Path(__file__).with_name("gltf_reference.py")
    spec = importlib.util.spec_from_file_location("gltf_reference", path)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    sys.modules[spec.name] = module
    spec.loader.exec_module(module)
    return module


reference = load_reference()


def gltf_files(folder: Path) -> list[Path]:
    return sorted(p for p in folder.rglob("*") if p.suffix in (".gltf", ".glb"))


def refusal(path: Path, kinds: tuple[type[Exception], ...] = (ValueError, OSError)) -> str:
    """The text of the error a file is refused with; it names the file."""
    with pytest.raises(kinds) as caught:
        Model(str(path))
    text = str(caught.value)
    assert str(path) in text
    return text.replace(str(path), "")


def left_out(model: Model) -> int:
    """Triangles the model's warnings say are left out as degenerate."""
    text = "\n".join(model.warnings)
    return sum(int(n) for n in re.findall(r"(\d+) (?:zero-area )?triangles .*left out", text))


def check_against_reference(path: Path) -> None:
    expected = reference.read(path)
    areas = expected.doubled_areas
    if not np.any(areas > 0):
        assert "no triangle" in refusal(path)
        return
    model = Model(str(path))
    # Areas next to zero may round either way between the two readers' orders of operations: as
    # when the corners of a triangle in line are stored half a unit in the last place beside it.
    longest = np.linalg.norm(expected.corners - np.roll(expected.corners, 1, 1), axis=2).max(axis=1)
    rounding = 2**-23 * abs(expected.corners).max(axis=(1, 2)) * longest
    doubtful = np.count_nonzero((areas > 0) & (areas < 2 * rounding))
    assert abs(model.triangle_count - np.count_nonzero(areas > 0)) <= doubtful
    assert model.triangle_count + left_out(model) == len(areas)
    assert len(model.parts) <= expected.parts
    kept = expected.corners[areas > 0].reshape(-1, 3)
    size = np.ptp(kept, axis=0).max()
    np.testing.assert_allclose(model.bounds[0], kept.min(axis=0), rtol=0, atol=1e-6 * size)
    np.testing.assert_allclose(model.bounds[1], kept.max(axis=0), rtol=0, atol=1e-6 * size)
    mesh = model.mesh()
    assert mesh["indices"].max() < model.vertex_count
    a, b, c = np.moveaxis(mesh["positions"][mesh["indices"]].astype(float), 1, 0)
    faces = np.cross(b - a, c - a)
    assert np.linalg.norm(faces, axis=1).sum() == pytest.approx(areas.sum(), rel=1e-6)
    np.testing.assert_allclose(np.linalg.norm(mesh["normals"], axis=1), 1, atol=1e-5)
    assert mesh["triangle_part"].max() < len(model.parts)
    assert all(part["material"] in model.materials for part in model.parts)


@pytest.mark.parametrize("name", SPACECRAFT)
def test_published_spacecraft(data_dir: Path, name: str) -> None:
    path = data_dir / "spacecraft" / "plain" / f"{name}.glb"
    check_against_reference(path)
    assert Model(str(path)).triangle_count > 2000


def test_no_published_spacecraft_is_forgotten(data_dir: Path) -> None:
    assert [p.stem for p in gltf_files(data_dir / "spacecraft" / "plain")] == SPACECRAFT


def test_samples_agree_with_the_reference(data_dir: Path) -> None:
    failures = []
    files = gltf_files(data_dir / "gltf" / "valid")
    assert len(files) > 30
    for path in files:
        try:
            check_against_reference(path)
        except (AssertionError, ValueError, OSError, pytest.fail.Exception) as error:
            failures.append(f"{path.name}: {error}")
    assert failures == []


def test_rocks_agree_with_the_reference(data_dir: Path) -> None:
    files = gltf_files(data_dir / "rocks")
    assert len(files) == 9
    for path in files:
        check_against_reference(path)


# Broken files, each with what its error says. Two can be repaired, two hold what glTF allows.
INVALID = {
    "assimp/MissingBin/BoxTextured.gltf": 'missing file "BoxTextured0.bin"',
    "assimp/RecursiveNodes/RecursiveNodes.gltf": "cycle",
    "assimp/SchemaFailures/sceneWrongType.gltf": "scene: must be an integer",
    "cgltf/BadBasisU.gltf": "broken JSON",
    "gltf-rs/non_sparse_accessor_without_buffer_view.gltf": "1 zero-area triangles",
    "magnum/buffer-invalid-short-size.glb": "only 12 bytes",
    "magnum/buffer-invalid-short-size.gltf": 'missing file "external-data.bin"',
    "magnum/camera-invalid.gltf": "no triangle",
    "magnum/error.gltf": "asset.version",
    "magnum/image-invalid-notfound.gltf": "outside the model's folder",
    "magnum/invalid-uri.gltf": "base64",
    "magnum/material-invalid.gltf": "materials[0].alphaMode",
    "magnum/mesh-invalid-empty-primitives.gltf": "meshes[1].primitives",
    "magnum/mesh-invalid-missing-primitives-property.gltf": "meshes[1].primitives",
    "magnum/mesh-invalid.gltf": "buffers[2].uri",
    "magnum/required-extensions-unsupported.gltf": "KHR_materials_pbrSpecularGlossiness",
    "magnum/scene-invalid-child-oob.gltf": "nodes[4].children[0]",
    "magnum/scene-invalid-cycle.gltf": "cycle",
    "magnum/scene-invalid-multiple-parents.gltf": "two parents",
    "magnum/version-legacy.gltf": '"1.0"',
    "magnum/version-unsupported.gltf": '"3.0"',
    "tinygltf/integer-out-of-bounds.gltf": "bufferViews[0].byteLength",
    "tinygltf/invalid-buffer-index.gltf": "bufferViews[1].buffer",
}
REPAIRED = {
    "assimp/BoxBadNormals-glTF-Binary/BoxBadNormals.glb": "4 degenerate normals are replaced",
    "assimp/IncorrectVertexArrays/Cube.gltf": "make no whole triangles",
}
HARMLESS = {"assimp/issue_3269/texcoord_crash.gltf"}  # TEXCOORD_1 without TEXCOORD_0


def test_broken_files(data_dir: Path) -> None:
    folder = data_dir / "gltf" / "invalid"
    names = {str(p.relative_to(folder)) for p in gltf_files(folder)}
    assert names == INVALID.keys() | REPAIRED.keys() | HARMLESS
    for name, fault in INVALID.items():
        assert fault in refusal(folder / name), name
    for name, warning in REPAIRED.items():
        assert warning in "\n".join(Model(str(folder / name)).warnings), name
    for name in HARMLESS:
        assert Model(str(folder / name)).triangle_count == 10


@pytest.mark.parametrize(
    ("name", "missing"),
    [
        ("encoded-uris", "buffer-unencoded/@file#.bin"),
        ("escaped-strings", "nonexisting-file.png"),
        ("material-metallicroughness", "texture.png"),
    ],
)
def test_missing_files_are_named(data_dir: Path, name: str, missing: str) -> None:
    path = data_dir / "gltf" / "missing_external" / f"{name}.gltf"
    assert f'missing file "{missing}"' in refusal(path, (OSError,))


COMPRESSED = {
    "draco/Space Shuttle (D)": "space_shuttle_d",
    "draco/cassini": "cassini",
    "draco/iss": "iss",
    "draco/iss_stationary_blender": None,
    "draco/mro": "mro",
    "meshopt/hubble_a": None,
}  # and the plain counterparts


@pytest.mark.parametrize("name", COMPRESSED)
def test_compressed_models(data_dir: Path, name: str) -> None:
    check_against_reference(data_dir / "spacecraft" / f"{name}.glb")


def test_no_compressed_model_is_forgotten(data_dir: Path) -> None:
    folder = data_dir / "spacecraft"
    found = [p for p in gltf_files(folder) if p.parent.name != "plain"]
    assert {f"{p.parent.name}/{p.stem}" for p in found} == COMPRESSED.keys()


@pytest.mark.parametrize("name", [name for name, plain in COMPRESSED.items() if plain])
def test_compressed_models_equal_the_plain_ones(data_dir: Path, name: str) -> None:
    """Positions within 3e-5 of the size, as the plain files were made (README of the data)."""
    folder = data_dir / "spacecraft"
    draco = Model(str(folder / f"{name}.glb"))
    plain = Model(str(folder / "plain" / f"{COMPRESSED[name]}.glb"))
    assert [part["material"] for part in draco.parts] == [part["material"] for part in plain.parts]
    found, expected = draco.mesh(), plain.mesh()
    np.testing.assert_array_equal(found["triangle_part"], expected["triangle_part"])
    tolerances = {"positions": 3e-5 * np.ptp(plain.bounds, axis=0).max(), "normals": 1e-3}
    for key, tolerance in {**tolerances, "uv": 1e-5}.items():
        assert (key in found) == (key in expected)
        if key in found:
            ours, theirs = (m[key][m["indices"]] for m in (found, expected))
            np.testing.assert_allclose(ours, theirs, rtol=0, atol=tolerance)


# Errors of the reference validator that leave no meaning to the geometry or the file.
BREAKING = {
    "ACCESSOR_INDEX_PRIMITIVE_RESTART",
    "ARRAY_TYPE_MISMATCH",
    "BUFFER_BYTE_LENGTH_MISMATCH",
    "GLB_CHUNK_TOO_BIG",
    "GLB_DUPLICATE_CHUNK",
    "GLB_EMPTY_CHUNK",
    "GLB_INVALID_MAGIC",
    "GLB_LENGTH_TOO_SMALL",
    "GLB_UNEXPECTED_END_OF_CHUNK_DATA",
    "GLB_UNEXPECTED_FIRST_CHUNK",
    "INVALID_JSON",
    "INVALID_URI",
    "IO_ERROR",
    "MESH_PRIMITIVE_INDICES_ACCESSOR_INVALID_FORMAT",
    "NODE_LOOP",
    "NODE_PARENT_OVERRIDE",
    "PATTERN_MISMATCH",
    "SCENE_NON_ROOT_NODE",
    "TYPE_MISMATCH",
    "UNKNOWN_ASSET_MAJOR_VERSION",
    "UNRESOLVED_REFERENCE",
    "VALUE_NOT_IN_RANGE",
}
# Broken references of what is not read.
UNREAD = re.compile(r"^/(animations|skins|cameras)/|/skin$")


def breaking_codes(report: Path) -> set[str]:
    messages = json.loads(report.read_text())["issues"]["messages"]
    return {
        message["code"]
        for message in messages
        if message["severity"] == 0 and not UNREAD.search(message.get("pointer", ""))
    } & BREAKING


def test_validator_corpus(data_dir: Path) -> None:
    """No file of it has a triangle with an area, so all are refused: the broken ones for their
    fault, the others for want of triangles alone."""
    wrong = []
    broken = 0
    files = gltf_files(data_dir / "gltf" / "validator")
    assert len(files) == 132
    for path in files:
        codes = breaking_codes(path.with_name(path.name + ".report.json"))
        fault = "no triangle" not in refusal(path)
        broken += bool(codes)
        if codes and not fault:
            wrong.append(f"{path.name}: {codes} goes unnoticed")
    assert broken == 40
    assert wrong == []


def test_a_folder_and_a_missing_file(tmp_path: Path) -> None:
    refusal(tmp_path, (OSError,))
    refusal(tmp_path / "gone.glb", (OSError,))
