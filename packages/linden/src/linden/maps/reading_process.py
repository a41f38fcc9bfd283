"""Reads large OpenDRIVE texts in a process of their own; the memory that reading takes ends with that process.

A text of 24 MB becomes millions of small objects. Python's allocator keeps 200 MB after they are gone, and the C
library's holds its lock for seconds while it returns them (decision 0110). Here the server's process gets arrays only.
"""

import ctypes
import json
import logging
import signal
import subprocess
import sys
import tempfile
from typing import IO, Any

import numpy as np
from numpy.typing import NDArray

from linden.background import checkpoint
from linden.errors import UserError
from linden.maps.archive import pack, pack_reading, unpack, unpack_reading
from linden.maps.facts import MapFacts
from linden.maps.opendrive.limits import MapError
from linden.maps.reading import MapReading, read

log = logging.getLogger("linden")

LARGE_BYTES = 1_000_000
"""From this size on a text is read in a process of its own, which takes a second to start."""

_PROGRAM = "from linden.maps.reading_process import main; main()"
_PR_SET_PDEATHSIG = 1  # Linux, prctl(2): the process gets a signal when the thread that started it is gone
_LOOK_S = 0.05
"""How often a thread that waits for the process looks whether the map is still wanted."""


def read_text(text: str, walls_beyond_m: float | None = None, facts: MapFacts | None = None) -> MapReading:
    """Return what :func:`linden.maps.reading.read` returns; a large text is read in a process of its own.

    Raises:
        MapError: the text is no OpenDRIVE that can be used.
        UserError: there is no memory or no disk for the process.
        NotWantedError: the work of this thread was given up; the process has been ended.
    """
    data = text.encode()
    if len(data) < LARGE_BYTES:
        return read(text, walls_beyond_m, facts)
    try:
        with tempfile.TemporaryFile() as given, tempfile.TemporaryFile() as made:
            known = {} if facts is None else pack(facts)
            np.savez(given, text=np.frombuffer(data, np.uint8), **known)  # type: ignore[arg-type] # as in cache.py
            given.seek(0)
            _run(walls_beyond_m, given, made)
            made.seek(0)
            return _read_back(made)
    except OSError as error:
        raise UserError(
            f"the map cannot be handed to the process that reads it: {error}; make room in {tempfile.gettempdir()}, "
            "or name another folder by TMPDIR"
        ) from error


def _run(walls_beyond_m: float | None, given: IO[bytes], made: IO[bytes]) -> None:
    process = subprocess.Popen(  # noqa: S603 - this very Python
        [sys.executable, "-c", _PROGRAM, json.dumps(walls_beyond_m)], stdin=given, stdout=made
    )
    try:
        while True:
            checkpoint()
            try:
                status = process.wait(_LOOK_S)
                break
            except subprocess.TimeoutExpired:
                continue
    finally:
        if process.poll() is None:
            process.kill()
            process.wait()
    if status < 0:
        raise UserError(
            f"the process that reads the map was ended by signal {-status}; if the machine has too little memory, "
            "load a smaller map"
        )
    if status > 0:
        raise RuntimeError(f"the process that reads maps ended with status {status}; its traceback stands above")


def _read_back(made: IO[bytes]) -> MapReading:
    arrays = _arrays(made)
    for sentence in _from_json(arrays["said"]):
        log.warning("%s", sentence)
    if "error" in arrays:
        raise MapError(*_from_json(arrays["error"]))
    return unpack_reading(arrays)


def main() -> None:
    """Read a text, with its facts if they are known, from an archive, and write what it says, or why not, to another.

    The archives are standard input and standard output.
    """
    ctypes.CDLL(None).prctl(_PR_SET_PDEATHSIG, signal.SIGKILL)
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # the server that started this process ends it
    said = _Sentences()
    log.addHandler(said)
    log.propagate = False
    try:
        given = _arrays(sys.stdin.buffer)
        text = given.pop("text").tobytes().decode()
        arrays = pack_reading(read(text, json.loads(sys.argv[1]), unpack(given) if given else None))
    except MapError as error:
        arrays = {"error": _to_json([error.reason, error.line])}
    except MemoryError:
        arrays = {"error": _to_json(["the machine has too little memory to read it", None])}
    np.savez(sys.stdout.buffer, said=_to_json(said.sentences), **arrays)  # type: ignore[arg-type] # as in cache.py


class _Sentences(logging.Handler):
    """Collects what is logged, for the log of the server."""

    def __init__(self) -> None:
        super().__init__(logging.WARNING)
        self.sentences: list[str] = []

    def emit(self, record: logging.LogRecord) -> None:
        self.sentences.append(record.getMessage())


def _arrays(file: IO[bytes]) -> dict[str, NDArray[Any]]:
    with np.load(file, allow_pickle=False) as archive:
        return {name: archive[name] for name in archive.files}


def _to_json(value: object) -> NDArray[np.uint8]:
    return np.frombuffer(json.dumps(value).encode(), np.uint8)


def _from_json(array: NDArray[np.uint8]) -> Any:  # noqa: ANN401 - what was written
    return json.loads(array.tobytes())
