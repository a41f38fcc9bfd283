"""The lock of a folder of drives: one command at a time writes there, and others see whether one does."""

from __future__ import annotations

import contextlib
import fcntl
import os
from typing import TYPE_CHECKING

from basu.errors import UserError

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

LOCK_FILE = ".lock"


@contextlib.contextmanager
def locked(folder: Path) -> Iterator[None]:
    """Hold the lock of a batch's folder; the system releases it when this process ends, however that goes.

    Folders that were made for the lock go again where nothing was written into them: the batch was refused.

    Raises:
        UserError: another command holds it, or the folder cannot be made.
    """
    made = [each for each in (folder, *folder.parents) if not each.exists()]
    try:
        folder.mkdir(parents=True, exist_ok=True)
        descriptor = os.open(folder / LOCK_FILE, os.O_RDWR | os.O_CREAT | os.O_CLOEXEC, 0o644)
    except OSError as error:
        raise UserError(f"{folder} cannot be used: {error.strerror}; name another place with --output") from error
    try:
        fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
        if os.fstat(descriptor).st_nlink == 0:  # the command that held it has removed it since it was opened
            raise BlockingIOError
    except OSError:
        os.close(descriptor)
        raise UserError(
            f"another command drives in {folder} now; wait for it, or name another place with --output"
        ) from None
    try:
        yield
    finally:
        with contextlib.suppress(OSError):  # the folder may be gone, and another command may have begun to use one
            (folder / LOCK_FILE).unlink()
            for each in made:
                each.rmdir()
        os.close(descriptor)


def is_locked(folder: Path) -> bool:
    """Return whether a command drives in a batch's folder now."""
    try:
        descriptor = os.open(folder / LOCK_FILE, os.O_RDONLY | os.O_CLOEXEC)
    except OSError:
        return False
    try:
        fcntl.flock(descriptor, fcntl.LOCK_SH | fcntl.LOCK_NB)
    except OSError:
        return True
    else:
        return False
    finally:
        os.close(descriptor)
