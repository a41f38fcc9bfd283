"""`MapCache`: data derived from maps in the user's cache folder, so that the next start does not derive it again.

A file is named by all that decides what it says: the map's text, the sources that derive, the machine. So it is never
out of date; it may be broken, and then it is made anew. Without a folder to write to everything works, only slower.
"""

import hashlib
import logging
import os
from collections.abc import Callable
from itertools import count
from pathlib import Path
from typing import IO, Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from linden.compiled import fingerprint, machine
from linden.maps.archive import Arrays, pack, pack_walls, unpack, unpack_walls
from linden.maps.facts import MapFacts
from linden.maps.reading import MapReading
from linden.maps.reading_process import read_text

log = logging.getLogger("linden")
Read = TypeVar("Read")

MOST_BYTES = 500_000_000
"""How much the folder may hold; a town of 240,000 triangles takes 24 MB."""

_DIGEST_BYTES = 32
_PARTS = count()  # two threads may write the same file
_PACKAGE = Path(__file__).parent.parent
_DERIVING = ("maps/*.py", "maps/opendrive/**/*.py", "protocol/values/*.py", "geometry.py", "compiled.py")


class MapCache:
    """A folder of what was read of maps."""

    def __init__(self, folder: Path, most_bytes: int = MOST_BYTES) -> None:
        """Use a folder, which is made when there is something to keep."""
        self._folder = folder
        self._most_bytes = most_bytes
        self._is_told = False

    @classmethod
    def of_user(cls) -> "MapCache":
        """Return the cache in the user's cache folder, as the XDG Base Directory Specification places it."""
        folder = Path(os.environ.get("XDG_CACHE_HOME", ""))
        if not folder.is_absolute():  # to be ignored, says the specification
            try:
                folder = Path.home() / ".cache"
            except RuntimeError:  # a user without a home: nothing can be kept
                folder = Path(os.devnull)
        return cls(folder / "linden" / "maps")

    def facts_of(self, text: str) -> MapFacts:
        """Return the facts of an OpenDRIVE text, as :meth:`read` does."""
        return self.read(text).facts

    def read(self, text: str, walls_beyond_m: float | None = None) -> MapReading:
        """Return what an OpenDRIVE text says, out of the folder or read by :func:`read_text`.

        Facts and walls have files of their own, so a text has its facts once, and other walls need no other facts.

        Raises:
            MapError, UserError, NotWantedError: as of ``read_text``.
        """
        key = _key(text)
        facts_file, walls_file = self._folder / f"{key}.npz", self._folder / f"{key}-{walls_beyond_m}.npz"
        facts = _kept(facts_file, unpack)
        if walls_beyond_m is None and facts is not None:
            return MapReading(facts)
        walls_m = None if walls_beyond_m is None or facts is None else _kept(walls_file, unpack_walls)
        if facts is not None and walls_m is not None:
            return MapReading(facts, walls_m)
        reading = read_text(text, walls_beyond_m, facts)
        if facts is None:
            self._write(facts_file, pack(reading.facts))
        if walls_beyond_m is not None:
            self._write(walls_file, pack_walls(reading.wall_feet_m))
        return reading

    def kept(self, name: str, make: Callable[[], bytes], read: Callable[[bytes], Read]) -> Read:
        """Return what ``read`` reads of the file of that name, made where there is none or it is broken.

        The name has to tell all that decides what is in it.
        """
        file = self._folder / name
        try:
            digest, content = _parts(file)
            if digest == _digest(content):
                found = read(content)
                os.utime(file)  # so that it counts as used
                return found
        except FileNotFoundError as error:
            log.debug("%s is made: %s", file, error)
        except Exception as error:  # noqa: BLE001 - whatever may be wrong with a file, it can be made anew
            log.info("%s is made anew: %s", file, error)
        content = make()
        self.replace(name, content)
        return read(content)

    def keep(self, name: str, make: Callable[[], bytes]) -> None:
        """Have something kept under a name, for :meth:`kept` to read; made only where there is no file of that name."""
        if not self.has(name):
            self.kept(name, make, bytes)

    def has(self, name: str) -> bool:
        """Return whether there is a file of that name, which then counts as used."""
        try:
            os.utime(self._folder / name)
        except OSError:
            return False
        return True

    def replace(self, name: str, content: bytes) -> None:
        """Keep something else than before under a name."""
        self._keep(self._folder / name, lambda stream: stream.writelines((_digest(content), content)))

    def _write(self, file: Path, arrays: dict[str, NDArray[Any]]) -> None:
        self._keep(file, lambda stream: np.savez(stream, **arrays))  # type: ignore[arg-type] # one array could be called allow_pickle

    def _keep(self, file: Path, write: Callable[[IO[bytes]], object]) -> None:
        part = file.with_suffix(f".{os.getpid()}.{next(_PARTS)}.part")
        try:
            self._folder.mkdir(parents=True, exist_ok=True)
            with part.open("wb") as stream:
                write(stream)
            part.replace(file)  # at once: no reader sees half a file, and of two writers the last one wins
            self._prune()
        except OSError as error:
            if not self._is_told:
                log.warning(
                    "what was compiled and derived cannot be kept in %s (%s), so every start makes it anew, which may "
                    "take a minute; set XDG_CACHE_HOME to a folder that can be written",
                    self._folder,
                    error.strerror or error,
                )
            self._is_told = True

    def _prune(self) -> None:
        """Remove the files used longest ago that the limit has no room for; what a killed server left is among them."""
        used = sorted(((file.stat(), file) for file in self._folder.iterdir()), key=lambda pair: -pair[0].st_mtime_ns)
        total = 0
        for status, file in used:
            total += status.st_size
            if total > self._most_bytes:
                file.unlink(missing_ok=True)


def _parts(file: Path) -> tuple[bytes, bytes]:
    """Return the digest and the content of a file, without a copy: copies of 50 MB hold Python's lock for 0.1 s.

    Raises:
        OSError: the file cannot be read.
    """
    with file.open("rb", buffering=0) as stream:
        return stream.read(_DIGEST_BYTES), stream.readall()


def _digest(content: bytes) -> bytes:
    return hashlib.sha256(content).digest()


def _key(text: str) -> str:
    sources = fingerprint(*(file for pattern in _DERIVING for file in _PACKAGE.glob(pattern)))
    digest = hashlib.sha256(f"{sources} {machine()}\n".encode())
    digest.update(text.encode())
    return digest.hexdigest()[:32]


def _kept(file: Path, unpacked: Callable[[Arrays], Read]) -> Read | None:
    """Return what the arrays in a file stand for, None where there is no such file or it is no good."""
    try:
        with np.load(file, allow_pickle=False) as archive:
            arrays: dict[str, NDArray[Any]] = {name: archive[name] for name in archive.files}
        found = unpacked(arrays)
        os.utime(file)  # so that it counts as used
    except FileNotFoundError:
        return None
    except Exception as error:  # noqa: BLE001 - whatever may be wrong with a file, it can be made anew
        log.info("%s is made anew: %s", file, error)
        return None
    return found
