"""Copies of a campaign folder to and from an object store by fsspec (s3://, gs://, abfs://, file://).

A campaign is driven in a folder of this machine. Complete blocks, kept records and documents are copied to the store
when a block is complete and at the end. Each object is written whole or not at all. The last object of a record's
folder is its document, and the campaign's document is written after all that it describes.
"""

from __future__ import annotations

import contextlib
import os
import re
import tempfile
from pathlib import Path
from typing import TYPE_CHECKING

from basu.campaigns.campaign_folder import CAMPAIGN_FILE, PROGRESS_FILE, SCRATCH
from basu.campaigns.drive_table import JOURNAL
from basu.campaigns.records import DRIVE_FILE
from basu.errors import UserError

if TYPE_CHECKING:
    from collections.abc import Iterator

ADDRESS = re.compile(r"[A-Za-z][A-Za-z0-9+.-]+://\S+")
LAST = (DRIVE_FILE, PROGRESS_FILE, CAMPAIGN_FILE)  # written after what they describe, in this order


def is_address(text: str) -> bool:
    """Whether a text is an address of a store rather than a path."""
    return ADDRESS.fullmatch(text) is not None


class Store:
    """A folder on a store."""

    def __init__(self, address: str) -> None:
        """Open a folder, which need not be there yet.

        Raises:
            UserError: fsspec or the library of this kind of store is not installed, or there is no such kind.
        """
        self.address = address.rstrip("/")
        try:
            import fsspec  # noqa: PLC0415 - an extra
        except ImportError as error:
            raise UserError(f"{address} needs fsspec; install it with `pip install basu[storage]`") from error
        try:
            self._files, self._root = fsspec.core.url_to_fs(self.address)
        except ImportError as error:
            raise UserError(f"{address} cannot be opened: {error}") from error
        except ValueError as error:
            raise UserError(f"{address} cannot be opened: {error}; name s3://, gs://, abfs:// or a folder") from error

    def write(self, name: str, data: bytes) -> None:
        """Write an object; a reader sees the whole of it or what was there before.

        Raises:
            UserError: the store refuses it.
        """
        path = self._path(name)
        with self._said("written", "go on with --resume, which loses no drive"):
            self._files.makedirs(path.rpartition("/")[0], exist_ok=True)
            with self._files.transaction, self._files.open(path, "wb") as file:
                file.write(data)

    def read(self, name: str) -> bytes:
        """The content of an object.

        Raises:
            UserError: the store refuses it.
        """
        with self._said("read", "look at the address and the credentials"):
            data: bytes = self._files.cat_file(self._path(name))
            return data

    def names(self) -> list[str]:
        """The names of all objects below the folder, sorted.

        Raises:
            UserError: the store refuses it.
        """
        with self._said("read", "look at the address and the credentials"):
            self._files.invalidate_cache()
            root = self._root.rstrip("/")
            return sorted(path[len(root) + 1 :] for path in self._files.find(root) if path.startswith(f"{root}/"))

    def remove(self, name: str) -> None:
        """Remove an object.

        Raises:
            UserError: the store refuses it.
        """
        with self._said("written", "go on with --resume"):
            self._files.rm_file(self._path(name))

    def _path(self, name: str) -> str:
        return f"{self._root.rstrip('/')}/{name}"

    @contextlib.contextmanager
    def _said(self, done: str, advice: str) -> Iterator[None]:
        """Any failure of the store as one sentence.

        Raises:
            UserError: there was one.
        """
        try:
            yield
        except UserError:
            raise
        except Exception as error:  # every kind of store has errors of its own
            said = " ".join(str(error).split()) or type(error).__name__
            raise UserError(f"{self.address} could not be {done}: {said}; {advice}") from error


class Mirror:
    """Copies a campaign's folder of this machine to its store."""

    def __init__(self, folder: Path, store: Store) -> None:
        """Take a folder; what a store has already is written again once."""
        self._folder, self.store = folder, store
        self._copied: dict[str, tuple[int, int]] = {}  # time of the last change and size, by name
        self._there = set(store.names())

    def copy(self, *, with_journals: bool = False) -> None:
        """Bring the store up to date; the journals of open blocks are copied at the end only.

        Raises:
            UserError: the store refuses it.
        """
        local = _files_in(self._folder)
        for name in sorted(local, key=_order):
            if name.startswith(f"{JOURNAL}/") and not with_journals:
                continue
            if self._copied.get(name) != local[name]:
                with contextlib.suppress(FileNotFoundError):  # a record that is not among the narrowest any more
                    self.store.write(name, (self._folder / name).read_bytes())
                    self._copied[name] = local[name]
                    self._there.add(name)
        for name in sorted(self._there - set(local), key=_order, reverse=True):
            self.store.remove(name)
            self._there.discard(name)
            self._copied.pop(name, None)


def fetch(store: Store, folder: Path) -> None:
    """Copy a campaign from its store into a folder of this machine.

    Raises:
        UserError: there is none, or the store refuses it.
    """
    names = store.names()
    if CAMPAIGN_FILE not in names:
        raise UserError(f"there is no campaign at {store.address}; name an address that `basu campaign run` has left")
    for name in sorted(names, key=_order):
        path = folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(store.read(name))


@contextlib.contextmanager
def local_copy(where: str) -> Iterator[tuple[Path, Store | None]]:
    """The folder of a campaign: a path as it is, an address as a copy that is removed afterwards, with its store.

    Raises:
        UserError: see ``fetch``.
    """
    if not is_address(where):
        yield Path(where), None
        return
    store = Store(where)
    with tempfile.TemporaryDirectory(prefix="campaign-") as folder:
        fetch(store, Path(folder))
        yield Path(folder), store


def _files_in(folder: Path) -> dict[str, tuple[int, int]]:
    """The files of a campaign that belong on a store, with time and size."""
    found = {}
    for parent, folders, files in os.walk(folder):
        folders[:] = [name for name in folders if not name.startswith(".") and name != SCRATCH]
        for file in files:
            path = Path(parent, file)
            name = path.relative_to(folder).as_posix()
            if file.startswith("."):
                continue
            with contextlib.suppress(FileNotFoundError):
                found[name] = _state(path)
    return found


def _state(path: Path) -> tuple[int, int]:
    status = path.stat()
    return status.st_mtime_ns, status.st_size


def _order(name: str) -> tuple[int, int, str]:
    """The order of writing: journals, since a block without one counts as complete; tables, records, documents."""
    last = name.rpartition("/")[2]
    rank = LAST.index(last) + 1 if last in LAST else 0
    return (rank, 0 if name.startswith(f"{JOURNAL}/") else 1 if name.startswith("drives/") else 2, name)


def written_page(store: Store | None, path: Path) -> str:
    """Where a page of a campaign lies: its path, or its address after it was copied to the store.

    Raises:
        UserError: the store refuses it.
    """
    if store is None:
        return str(path)
    store.write(path.name, path.read_bytes())
    return f"{store.address}/{path.name}"
