"""Writes a file whole or not at all, and says it in a sentence where the disk does not let us."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING

from basu.errors import UserError

if TYPE_CHECKING:
    from pathlib import Path


def write_bytes(path: Path, data: bytes) -> None:
    """Put ``data`` into ``path`` by way of a neighbour, so that a reader never sees half a file.

    Raises:
        UserError: the disk is full, or the folder cannot be written.
    """
    draft = path.with_name(f".{path.name}.part")
    try:
        with draft.open("wb") as file:
            file.write(data)
            file.flush()
            os.fsync(file.fileno())
        draft.replace(path)
    except OSError as error:
        draft.unlink(missing_ok=True)
        raise UserError(
            f"{path} ({len(data)} bytes) could not be written: {error.strerror}; "
            "make room or name another place with --output"
        ) from error
