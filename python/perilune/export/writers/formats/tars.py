"""Tar files of a chunk's frames: no dates, no owners; the same members give the same bytes."""

from __future__ import annotations

import io
import tarfile
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path

_MODE = 0o644


class TarReader:
    """Members of a tar file."""

    def __init__(self, archive: tarfile.TarFile) -> None:
        self._archive = archive
        self._members = {member.name: member for member in archive.getmembers()}

    def names(self) -> Sequence[str]:
        """Names in the order of the file."""
        return list(self._members)

    def read(self, name: str) -> bytes:
        """Content of a member."""
        file = self._archive.extractfile(self._members[name])
        if file is None:
            raise KeyError(name)
        return file.read()


def write_tar(path: Path, members: Iterable[tuple[str, bytes]]) -> None:
    """Writes members in their order."""
    with tarfile.open(path, "w", format=tarfile.USTAR_FORMAT) as archive:
        for name, data in members:
            entry = tarfile.TarInfo(name)
            entry.size, entry.mode = len(data), _MODE
            archive.addfile(entry, io.BytesIO(data))


@contextmanager
def open_tar(path: Path) -> Iterator[TarReader]:
    """Opens a file that write_tar has written."""
    with tarfile.open(path, "r:") as archive:
        yield TarReader(archive)
