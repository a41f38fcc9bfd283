"""The folder that a run leaves: ``runs/<time>-<agent>-<route>/``, with ``runs/latest`` pointing to the newest."""

from __future__ import annotations

import json
import re
from typing import TYPE_CHECKING, Any

from basu.errors import UserError
from basu.utils.atomic import write_bytes

if TYPE_CHECKING:
    from datetime import datetime
    from pathlib import Path

CONFIG_FILE, RESULT_FILE, PICTURE_FILE, LATEST = "config.json", "result.json", "path.png", "latest"


def make_folder(output: Path, started: datetime, agent: str, route: str) -> Path:
    """A new folder for a run.

    Raises:
        UserError: it cannot be made.
    """
    stem = f"{started:%Y-%m-%dT%H-%M-%S}-{_plain(agent)}-{_plain(route)}"
    number = 1
    while True:
        folder = output / (stem if number == 1 else f"{stem}-{number}")
        try:
            folder.mkdir(parents=True)
        except FileExistsError:
            if not output.is_dir():
                raise UserError(f"{output} is not a folder; name another place with --output") from None
            number += 1
            continue
        except OSError as error:
            raise UserError(
                f"{folder} could not be made: {error.strerror}; name another place with --output"
            ) from error
        return folder


def point_latest(folder: Path) -> None:
    """Let ``latest`` beside ``folder`` point to it.

    Raises:
        UserError: the file system has no symbolic links, or the folder cannot be written.
    """
    draft = folder.with_name(f".{LATEST}.part")
    try:
        draft.unlink(missing_ok=True)
        draft.symlink_to(folder.name, target_is_directory=True)
        draft.replace(folder.with_name(LATEST))
    except OSError as error:
        raise UserError(
            f"{folder.with_name(LATEST)} could not be pointed to {folder.name}: {error.strerror}"
        ) from error


def write_json(path: Path, document: dict[str, Any]) -> None:
    """Write a document for people and programs alike."""
    write_bytes(path, (json.dumps(document, indent=2, allow_nan=False, ensure_ascii=False) + "\n").encode())


def _plain(name: str) -> str:
    """A name that every file system takes."""
    return re.sub(r"[^A-Za-z0-9._-]+", "_", name).strip("._") or "_"
