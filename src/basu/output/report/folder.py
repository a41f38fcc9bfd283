"""The folder that a run leaves: ``runs/<time>-<agent>-<route>/``, with ``runs/latest`` pointing to the newest.

While a run lasts its folder is a draft, ``.<name>.part``; it gets its name when all is in it. So a folder with a
result is a whole one, however the benchmark ended.
"""

from __future__ import annotations

import json
import re
from typing import TYPE_CHECKING, Any

from basu.errors import UserError
from basu.utils.atomic import write_bytes

if TYPE_CHECKING:
    from datetime import datetime
    from pathlib import Path

CONFIG_FILE, RESULT_FILE, TEXT_FILE, PICTURE_FILE = "config.json", "result.json", "result.txt", "path.png"
LATEST = "latest"
DRAFTS = ".*.part"  # the names of drafts, for Path.glob


def run_name(started: datetime, agent: str, route: str) -> str:
    """What the folder of a run by itself is called."""
    return f"{started:%Y-%m-%dT%H-%M-%S}-{plain(agent)}-{plain(route)}"


def make_draft(output: Path, name: str) -> Path:
    """A new draft for the folder ``name`` in ``output``.

    Raises:
        UserError: it cannot be made.
    """
    number = 1
    while True:
        draft = output / f".{_numbered(name, number)}.part"
        try:
            draft.mkdir(parents=True)
        except FileExistsError:
            if not output.is_dir():
                raise UserError(f"{output} is not a folder; name another place with --output") from None
            number += 1
            continue
        except OSError as error:
            raise UserError(f"{draft} could not be made: {error.strerror}; name another place with --output") from error
        return draft


def publish(draft: Path, name: str) -> Path:
    """Give a draft its name, or with a number where that is taken; the folder under its name.

    Raises:
        UserError: it cannot be renamed.
    """
    number = 1
    while True:
        folder = draft.with_name(_numbered(name, number))
        try:
            if not folder.exists():
                draft.rename(folder)
                return folder
        except OSError as error:
            if not folder.exists():
                raise UserError(f"{draft} could not be renamed to {folder.name}: {error.strerror}") from error
        number += 1


def point_latest(folder: Path, output: Path) -> None:
    """Let ``latest`` in ``output`` point to ``folder``, which lies somewhere below.

    Raises:
        UserError: the file system has no symbolic links, or the folder cannot be written.
    """
    draft, latest = output / f".{LATEST}.part", output / LATEST
    try:
        draft.unlink(missing_ok=True)
        draft.symlink_to(folder.relative_to(output), target_is_directory=True)
        draft.replace(latest)
    except OSError as error:
        raise UserError(f"{latest} could not be pointed to {folder.name}: {error.strerror}") from error


def write_json(path: Path, document: dict[str, Any]) -> None:
    """Write a document for people and programs alike."""
    write_bytes(path, (json.dumps(document, indent=2, allow_nan=False, ensure_ascii=False) + "\n").encode())


def plain(name: str) -> str:
    """A name that every file system takes."""
    return re.sub(r"[^A-Za-z0-9._-]+", "_", name).strip("._") or "_"


def _numbered(name: str, number: int) -> str:
    return name if number == 1 else f"{name}-{number}"
