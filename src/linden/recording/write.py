"""A recording being written: each frame goes to the file at once and whole, so that a killed server leaves it."""

import contextlib
import io
import os
import struct
from collections.abc import Sequence
from pathlib import Path

from linden.recording import encode


class RecordingWriter:
    """A file that grows by frames.

    Attributes:
        path: of the file.
        elapsed_s: of the last frame.
    """

    def __init__(self, path: Path, map_name: str, date_unix_s: int) -> None:
        """Begin a file; one that stands there is replaced.

        Raises:
            OSError: it cannot be written.
        """
        self.path = path
        self.elapsed_s = 0.0
        self._frames = 0
        self._file: io.FileIO = path.open("wb", buffering=0)
        self._end = 0
        self._last_duration_at = 0
        try:
            self._append(encode.header(map_name, date_unix_s))
        except OSError:
            self._file.close()
            raise

    def add(self, delta_s: float, packets: Sequence[bytes]) -> None:
        """Add a frame, ``delta_s`` after the last; time begins with the first.

        Raises:
            OSError: the file takes no more; it then ends with the last whole frame.
        """
        if self._frames:
            self.elapsed_s += delta_s
        began = self._end
        self._append(encode.frame(self._frames + 1, self.elapsed_s, packets))
        self._frames += 1
        if self._last_duration_at:
            self._file.seek(self._last_duration_at)
            self._file.write(struct.pack("<d", delta_s))
            self._file.seek(self._end)
        self._last_duration_at = began + encode.DURATION_OFFSET

    def _append(self, content: bytes) -> None:
        left = memoryview(content)
        try:
            while left:
                left = left[self._file.write(left) :]
        except OSError:
            with contextlib.suppress(OSError):  # a frame that cannot be taken back is read as cut short
                os.ftruncate(self._file.fileno(), self._end)
            raise
        self._end += len(content)

    def close(self) -> None:
        """End the file."""
        self._file.close()
