"""What a format of datasets is: how it writes a frame, what it can hold, what ends a dataset."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import AbstractContextManager
from dataclasses import dataclass
from pathlib import Path
from typing import Any, ClassVar, Protocol

from numpy.typing import NDArray

from perilune.document.references import OBJECTS
from perilune.export.writers.formats.channels import Channel
from perilune.sample import Sample
from perilune.simulation import Simulation

Array = NDArray[Any]
Files = dict[str, bytes]
"""Path in the dataset -> content."""
Record = Mapping[str, Any]
"""What `frames/NNNNNN.json` says of a frame; see record.py."""
Info = Mapping[str, Any]
"""dataset_info.json."""


@dataclass(frozen=True)
class Frame:
    """A rendered frame, as a format gets it."""

    index: int
    arrays: Mapping[str, Array]
    """Channel, or table, -> array."""
    record: Record
    """Without `files` and `labels`."""
    sample: Sample
    next_picture: Array | None = None
    """The main picture of the next frame, for formats that ask for it."""

    @property
    def key(self) -> str:
        """Stem of its files' names."""
        return f"{self.index:06d}"


@dataclass(frozen=True)
class Encoded:
    """The files of a frame."""

    files: Files
    labels: Any = None
    """What `Format.finish` needs of it, or users of the record: plain numbers and texts."""


class PackReader(Protocol):
    """The files in a packed file."""

    def names(self) -> Sequence[str]:
        """Their names."""
        ...

    def read(self, name: str) -> bytes:
        """Content of one; KeyError if there is none."""
        ...


class Format:
    """A format. Subclasses are stateless; `info` says what a dataset holds."""

    name: ClassVar[str]
    doc: ClassVar[str]
    """What it is, in a line of the command's help."""
    layout: ClassVar[str]
    """Its files, as docs/formats.md and the card tell them."""
    reader: ClassVar[str]
    """What reads it."""
    needs: ClassVar[tuple[str, ...]] = ()
    """Channels that it renders whatever is asked for; "picture" stands for the main picture."""

    needs_next: ClassVar[bool] = False
    """Whether it shows the next frame beside each."""

    def holds(self, channel: Channel) -> bool:
        """Whether it can hold a channel. Rows of `objects` are in every frame's record."""
        raise NotImplementedError

    def describe(self, sim: Simulation) -> dict[str, Any]:
        """Keys of dataset_info.json of its own. ConfigError for a simulation that the format
        cannot hold."""
        return {}

    def begin(self, sim: Simulation, info: Info) -> Files:
        """Files beside the frames."""
        return {}

    def encode(self, info: Info, frame: Frame) -> Encoded:
        """The files of a frame: a pure function."""
        raise NotImplementedError

    def finish(
        self, info: Info, records: Callable[[], Iterator[Record]]
    ) -> Iterable[tuple[str, Iterable[bytes]]]:
        """Name and content of the files that summarise all frames. records: those of all frames,
        by index; may be called several times."""
        return ()

    def decode(self, info: Info, record: Record, read: Callable[[str], bytes]) -> dict[str, Array]:
        """The channels of a frame from its files, as far as the format tells them: a table's
        fields, an image's values. read: content of one of the frame's files."""
        raise NotImplementedError

    def faults(
        self, info: Info, record: Record, arrays: Mapping[str, Array], read: Callable[[str], bytes]
    ) -> Iterable[str]:
        """What is wrong with a frame's files beyond its arrays, as those of `decode`."""
        return ()

    # --- formats that put the frames of a chunk into one file ---

    pack_name: ClassVar[str | None] = None
    """Name of that file with {chunk}; None: frames have files of their own."""

    def pack(self, info: Info, path: Path, members: Iterable[tuple[str, bytes]]) -> None:
        """Writes the file, in this order. The same members give the same bytes."""
        raise NotImplementedError

    def unpack(self, path: Path) -> AbstractContextManager[PackReader]:
        """Opens the file. May raise anything for a damaged one."""
        raise NotImplementedError

    # ---

    def problem(self, channel: Channel) -> bool:
        """Whether the dataset would lack a channel."""
        return channel.name != OBJECTS and not self.holds(channel)
