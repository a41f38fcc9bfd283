"""Files and folders that are there as a whole or not at all."""

import contextlib
import os
import shutil
import tempfile
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path

from linden.errors import UserError


def write_file(path: Path, data: bytes) -> None:
    """Write a file in place of an older one.

    Raises:
        UserError: it cannot be written; an older file is left as it was, and no part of the new one stays.
    """
    part = path.with_name(f".{path.name}.part")
    try:
        if path.is_dir():
            raise IsADirectoryError(0, "it is a folder")
        with part.open("wb") as stream:
            stream.write(data)
            stream.flush()
            os.fsync(stream.fileno())
        part.replace(path)
    except OSError as error:
        raise unwritable_file(path, error) from None
    finally:
        with contextlib.suppress(OSError):
            part.unlink(missing_ok=True)


def write_output(path: Path, data: bytes) -> None:
    """Write what a command's ``-o`` names: a file as :func:`write_file` does, or a device such as /dev/stdout.

    Raises:
        UserError: it cannot be written.
    """
    if not path.exists() or path.is_file() or path.is_dir():
        write_file(path, data)
        return
    try:
        path.write_bytes(data)
    except OSError as error:
        raise unwritable_file(path, error) from None


def unwritable_file(file: Path, error: OSError) -> UserError:
    """Return the error for a file that cannot be written."""
    return UserError(
        f"cannot write {file}: {error.strerror or error}; name a file in a folder that exists and has room"
    )


def write_folder(path: Path, files: Mapping[str, bytes]) -> None:
    """Write a folder of files in place of an older one that holds no others.

    Raises:
        UserError: it cannot be written, or holds other files; nothing is changed then.
    """
    with staged_folder(path, lambda name: name in files) as stage:
        for name, data in files.items():
            (stage / name).write_bytes(data)


@contextlib.contextmanager
def staged_folder(path: Path, is_ours: Callable[[str], bool]) -> Iterator[Path]:
    """Give an empty folder beside ``path``, which takes its place at the end unless something is raised.

    Raises:
        UserError: it cannot be written, or ``path`` holds files that are not ours.
    """
    stage = None
    try:
        _refuse_strangers(path, is_ours)
        path.parent.mkdir(parents=True, exist_ok=True)
        stage = Path(tempfile.mkdtemp(prefix=f".{path.name}.", suffix=".part", dir=path.parent))
        stage.chmod(0o777 & ~_umask())
        yield stage
        _take_place(stage, path)
    except OSError as error:
        raise _unwritable_folder(path, error) from None
    finally:
        if stage is not None:
            shutil.rmtree(stage, ignore_errors=True)


def _refuse_strangers(path: Path, is_ours: Callable[[str], bool]) -> None:
    if not path.exists():
        return
    if not path.is_dir():
        raise NotADirectoryError(0, "it is a file")
    if not os.access(path, os.W_OK):
        raise PermissionError(0, "the folder is read-only")
    strangers = sorted(entry.name for entry in path.iterdir() if not is_ours(entry.name))
    if strangers:
        raise UserError(f"{path} holds {strangers[0]}, which is no part of the map; name a new folder, or empty it")


def _take_place(stage: Path, path: Path) -> None:
    if not path.exists():
        stage.rename(path)
        return
    old = stage.with_name(f"{stage.name}.old")
    path.rename(old)
    try:
        stage.rename(path)
    except OSError:
        old.rename(path)
        raise
    shutil.rmtree(old, ignore_errors=True)


def _umask() -> int:
    value = os.umask(0)
    os.umask(value)
    return value


def _unwritable_folder(path: Path, error: OSError) -> UserError:
    return UserError(f"cannot write {path}: {error.strerror or error}; name a place that can be written and has room")
