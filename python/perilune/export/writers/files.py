"""Files of datasets: atomic writing, flushing to the disk, JSON."""

from __future__ import annotations

import errno
import io
import json
import os
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

SOURCE_FILE = "dataset_info.json"
CARD_FILE = "dataset_info.md"
"""Written last: a dataset without it is incomplete."""
TEMPORARY = ".tmp"
"""Suffix of files that are being written."""
PARTIAL = ".partial"
"""Hidden folder of what is being written."""
PNG_LEVEL = 1
"""Of deflate: 6 takes six times longer for a picture, and changes its size by -9 to +18 %."""


def make_folder(folder: str | Path) -> None:
    """Creates a writable folder; OSError that names it otherwise."""
    path = Path(folder)
    try:
        path.mkdir(parents=True, exist_ok=True)
        # Only a file tells: permissions, read-only mounts and quotas have no common question.
        probe = path / f".writable.{os.getpid()}.tmp"
        probe.write_bytes(b"")
        probe.unlink()
    except OSError as error:
        reason = "a file stands there" if isinstance(error, FileExistsError) else error.strerror
        raise OSError(error.errno, f"cannot be written to: {reason}", str(path)) from error


def write_bytes(path: Path, parts: Iterable[bytes | memoryview], sync: bool = True) -> None:
    """Writes a file atomically, through a temporary one and a rename.

    sync: flushes the content to the disk before the rename, in case of a power cut."""
    temporary = path.with_name(f"{path.name}.{os.getpid()}{TEMPORARY}")
    try:
        with open(temporary, "wb") as file:
            for part in parts:
                file.write(part)
            file.flush()
            if sync:
                os.fsync(file.fileno())
        os.replace(temporary, path)
    except OSError as error:
        temporary.unlink(missing_ok=True)
        raise OSError(error.errno, f"cannot be written: {error.strerror}", str(path)) from error
    except BaseException:
        temporary.unlink(missing_ok=True)
        raise


def npy_parts(array: NDArray[Any]) -> tuple[bytes, memoryview]:
    """An array as NPY, version 1.0: its header, and its bytes, which are not copied."""
    plain = np.ascontiguousarray(array)
    head = io.BytesIO()
    described = np.lib.format.header_data_from_array_1_0(plain)
    np.lib.format.write_array_header_1_0(head, described)
    return head.getvalue(), plain.reshape(-1).view(np.uint8).data


def write_text(path: Path, text: str, sync: bool = True) -> None:
    """The same for a text."""
    write_bytes(path, [text.encode("utf-8")], sync)


def write_other_text(path: Path, text: str) -> None:
    """The same, unless the file has this content already."""
    try:
        if path.read_bytes() == text.encode("utf-8"):
            return
    except FileNotFoundError:
        pass
    write_text(path, text)


def sync_folder(folder: Path) -> None:
    """Flushes the names of a folder's files to the disk."""
    descriptor = os.open(folder, os.O_RDONLY | os.O_DIRECTORY)
    try:
        os.fsync(descriptor)
    except OSError as error:
        if error.errno != errno.EINVAL:  # some network disks have nothing to bring
            raise
    finally:
        os.close(descriptor)


def sync_files(paths: Iterable[Path]) -> None:
    """Flushes the content of written files to the disk."""
    for path in paths:
        with open(path, "rb") as file:
            os.fsync(file.fileno())


def remove_temporary(folder: Path) -> None:
    """Removes partial files of killed runs. Only for the holder of the folder's lock."""
    for name in names_in(folder):
        if name.endswith(TEMPORARY):
            (folder / name).unlink(missing_ok=True)


def json_text(value: Any) -> str:
    """JSON with sorted keys, and the shortest digits that give the same double."""
    return json.dumps(value, indent=2, sort_keys=True, allow_nan=False) + "\n"


def json_by_id(entries: Mapping[int, Any]) -> str:
    """JSON of an object keyed by ids, in numerical order, one entry per line."""
    lines = [
        f'  "{key}": {json.dumps(entries[key], sort_keys=True, allow_nan=False)}'
        for key in sorted(entries)
    ]
    return "{\n" + ",\n".join(lines) + "\n}\n"


def json_rows(rows: Iterable[Any]) -> str:
    """JSON of a list, one entry per line."""
    lines = [f"  {json.dumps(row, sort_keys=True, allow_nan=False)}" for row in rows]
    return "[\n" + ",\n".join(lines) + "\n]" if lines else "[]"


def json_sections(sections: Mapping[str, Any]) -> str:
    """JSON of an object with lists and small values, each entry of a list on its own line."""
    lines = []
    for name in sorted(sections):
        value = sections[name]
        text = json_rows(value) if isinstance(value, list) else json.dumps(value, sort_keys=True)
        lines.append(f"{json.dumps(name)}: {text}")
    return "{\n" + ",\n".join(lines) + "\n}\n"


def load_object(path: Path) -> dict[str, Any]:
    """A JSON object; an empty one if the file is missing or invalid, so that it is made again."""
    try:
        value = json.loads(path.read_text(encoding="utf-8"))
    except (FileNotFoundError, json.JSONDecodeError, UnicodeDecodeError):
        return {}
    return value if isinstance(value, dict) else {}


def names_in(folder: Path) -> list[str]:
    """Names of what a folder holds; none if it is missing."""
    try:
        return os.listdir(folder)
    except FileNotFoundError:
        return []
