"""Recordings from files: the header, then frame after frame, without holding more than one in memory.

::

    with Recording(path) as recording:
        print(recording.header.map_name)
        for frame in recording.frames():
            frame.positions["location_cm"]
"""

import io
import logging
import struct
from collections.abc import Container, Iterator
from pathlib import Path
from types import TracebackType
from typing import BinaryIO, NamedTuple

import numpy as np

from linden.replay.file import layouts
from linden.replay.file.decode import DISPUTED_IDS, Cursor, FilePacket, decode, name_of
from linden.replay.file.folder import open_at_once
from linden.replay.file.layouts import PacketId
from linden.replay.file.packets import CutShortError, Frame, Header, NoRecordingError, RecordingError

log = logging.getLogger("linden")

_PACKET_HEAD = struct.Struct("<BI")
_VERSION = struct.Struct("<H")
_LENGTH = struct.Struct("<H")
_DATE = struct.Struct("<q")
_LATEST_DATE_UNIX_S = 253402300799
"""The end of the year 9999; what is beyond is no date."""
_KNOWN_VERSIONS = (1, 2)
"""2 is written by development versions after 0.9.16; only the types of attributes are numbered differently."""


class FramePlace(NamedTuple):
    """Where a frame lies: bytes ``start`` to ``end`` of the file, and when it was; see ``Frame`` for the times."""

    number: int
    duration_s: float
    elapsed_s: float
    start: int
    end: int


class Recording:
    """A recording open for reading.

    Attributes:
        path: of the file.
        header: version, time and map.
    """

    def __init__(self, path: Path) -> None:
        """Open a file and read its header.

        Raises:
            OSError: it cannot be opened.
            RecordingError: it is not a recording.
        """
        self.path = path
        self._file = open(path, "rb", opener=open_at_once)  # noqa: SIM115 - Path.open takes no opener
        try:
            self._size = self._file.seek(0, io.SEEK_END)
            self._file.seek(0)
            self.header = _read_header(self._file, path)
        except BaseException:
            self._file.close()
            raise
        self._begin = self._file.tell()

    def __enter__(self) -> "Recording":  # noqa: PYI034 - typing.Self is of 3.11
        """Return the recording itself; it is closed at the end of the block."""
        return self

    def __exit__(
        self, _kind: type[BaseException] | None, _error: BaseException | None, _trace: TracebackType | None
    ) -> None:
        """Close the file."""
        self.close()

    def close(self) -> None:
        """Close the file."""
        self._file.close()

    def frames(self) -> Iterator[Frame]:
        """Yield every whole frame, first to last.

        Raises:
            CutShortError: after the last whole frame, where the file ends inside a frame.
            RecordingError: something in it cannot be; says at which byte.
        """
        for place in self.places():
            yield self.frame(place)

    def whole_frames(self) -> Iterator[Frame]:
        """Yield every whole frame; where the file then ends inside a frame, the log says so.

        Raises:
            RecordingError: something in it cannot be.
        """
        try:
            yield from self.frames()
        except CutShortError as error:
            log.warning("%s", error)

    def places(self) -> Iterator[FramePlace]:
        """Yield where each whole frame lies, without reading what is in it.

        Raises:
            RecordingError: as :meth:`frames`.
        """
        at = self._begin
        while at < self._size:
            start, first = at, self._packet(at)
            if first.id != PacketId.FRAME_START:
                raise self._damaged(at, f"{name_of(first.id)} outside of a frame")
            if len(first.content) != layouts.FRAME_START.itemsize:
                raise self._damaged(at, f"a frame's start of {len(first.content)} bytes")
            number, duration_s, elapsed_s = np.frombuffer(first.content, layouts.FRAME_START)[0].item()
            at = self._after_frame(first.offset + len(first.content))
            yield FramePlace(number, duration_s, elapsed_s, start, at)

    def _after_frame(self, at: int) -> int:
        """Return the byte after the end of the frame with its second packet at ``at``."""
        while True:
            packet_id, size = self._packet_head(at)
            at += _PACKET_HEAD.size + size
            if packet_id == PacketId.FRAME_END:
                return at
            if packet_id == PacketId.FRAME_START:
                raise self._damaged(at - size - _PACKET_HEAD.size, "a frame begins inside another")

    def frame(self, place: FramePlace, wanted: Container[int] = frozenset(PacketId)) -> Frame:
        """Return the frame that lies at a place, with those of its packets that are ``wanted``.

        Raises:
            RecordingError: something in it cannot be.
        """
        self._file.seek(place.start)
        packets: dict[PacketId, object] = {}
        for packet in _split(self._file.read(place.end - place.start), place.start):
            if packet.id in (PacketId.FRAME_START, PacketId.FRAME_END):
                continue
            found = decode(packet) if packet.id in wanted or packet.id in DISPUTED_IDS else None
            if found is None or found[0] not in wanted:
                continue
            kind, content = found
            if kind in packets:
                raise Cursor(packet).fail(f"stands twice in frame {place.number}")
            packets[kind] = content
        return Frame(place.number, place.duration_s, place.elapsed_s, packets)

    def _packet_head(self, at: int) -> tuple[int, int]:
        """Return id and size of the packet at a byte; the file holds all of it."""
        self._file.seek(at)
        head = self._file.read(_PACKET_HEAD.size)
        if len(head) < _PACKET_HEAD.size:
            raise self._cut_short(at)
        packet_id, size = _PACKET_HEAD.unpack(head)
        if at + _PACKET_HEAD.size + size > self._size:
            raise self._cut_short(at)
        return packet_id, size

    def _packet(self, at: int) -> FilePacket:
        packet_id, size = self._packet_head(at)
        return FilePacket(packet_id, at + _PACKET_HEAD.size, self._file.read(size))

    def _cut_short(self, at: int) -> CutShortError:
        return CutShortError(
            f"{self.path}: the recording ends inside a frame (the packet at byte {at} is not whole); the frames "
            f"before it are good",
            at,
        )

    def _damaged(self, at: int, what: str) -> RecordingError:
        return RecordingError(f"{self.path}: damaged recording: at byte {at} stands {what}", at)


def _read_header(file: BinaryIO, path: Path) -> Header:
    def take(count: int) -> bytes:
        found = file.read(count)
        if len(found) < count:
            raise NoRecordingError(f"{path} is not a CARLA recorder file: it ends at byte {file.tell()}", file.tell())
        return found

    def text() -> str:
        return take(_LENGTH.unpack(take(2))[0]).decode("utf-8", "replace")

    (version,) = _VERSION.unpack(take(2))
    if text() != layouts.MAGIC:
        raise NoRecordingError(f"{path} is not a CARLA recorder file: '{layouts.MAGIC}' should stand at byte 4", 4)
    if version not in _KNOWN_VERSIONS:
        raise RecordingError(
            f"{path} is a CARLA recorder file of version {version}; this program reads 1 (up to 0.9.16) and 2", 0
        )
    (date_unix_s,) = _DATE.unpack(take(8))
    if not 0 <= date_unix_s <= _LATEST_DATE_UNIX_S:
        raise RecordingError(
            f"{path}: damaged recording: the 8 bytes before byte {file.tell()} are no date", file.tell()
        )
    return Header(version, date_unix_s, text())


def _split(content: bytes, offset: int) -> Iterator[FilePacket]:
    """Yield the packets of whole frames; ``offset`` is where ``content`` lies in the file."""
    at = 0
    while at < len(content):
        packet_id, size = _PACKET_HEAD.unpack_from(content, at)
        at += _PACKET_HEAD.size
        yield FilePacket(packet_id, offset + at, content[at : at + size])
        at += size
