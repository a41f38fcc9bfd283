"""Files: written whole or not at all, JSON read with clear errors, packaged files, a user's Python file as a module."""

from __future__ import annotations

import importlib.util
import json
import os
import sys
import unicodedata
from pathlib import Path
from typing import TYPE_CHECKING, Any

import basu
from basu.errors import UserError

if TYPE_CHECKING:
    from importlib.abc import Loader
    from types import ModuleType


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


def read_json(path: Path, what: str, otherwise: str = "") -> Any:  # noqa: ANN401 - whatever stands in the file
    """The document in ``path``.

    ``what`` is what complaints call the file, ``otherwise`` what to do about one that cannot be read.

    Raises:
        UserError: the file cannot be read, or is no JSON.
    """
    advice = f"; {otherwise}" if otherwise else ""
    try:
        return loads(path.read_text(encoding="utf-8"))
    except OSError as error:
        raise UserError(f"{what} {path} cannot be read: {error.strerror}{advice}") from error
    except ValueError as error:
        raise UserError(f"{what} {path} is no JSON: {error}{advice}") from error


def other_version(path: Path, found: object, reads: int, advice: str = "use the version that wrote it") -> UserError:
    """Return the refusal of a document of the schema version ``found``; ``advice`` is the next step."""
    return UserError(f"{path} has the schema version {found!r}, and this version of basu reads {reads}; {advice}")


MOST_DIGITS = 18  # of a whole number: more do not fit into 64 bits


def loads(text: str) -> Any:  # noqa: ANN401 - whatever the text holds
    """Return the JSON document of a text from outside; control characters but line ends and tabs become U+FFFD.

    Otherwise a terminal would execute the escape sequences in an agent's name, for example.

    Raises:
        ValueError: the text is no JSON, is nested too deeply, or has a number that does not fit into 64 bits.
    """
    try:
        return printable(json.loads(text, parse_int=_whole))
    except RecursionError:
        raise ValueError("it is nested too deeply") from None


def _whole(digits: str) -> int:
    if len(digits.lstrip("-")) > MOST_DIGITS:
        raise ValueError(f"a whole number has more than {MOST_DIGITS} digits")
    return int(digits)


def printable(value: Any) -> Any:  # noqa: ANN401 - whatever the text holds
    """Return a JSON value with control characters replaced by U+FFFD; keys and values alike.

    Line ends and tabs stay. An agent could else steer the terminal that its error is printed on.
    """
    if isinstance(value, str):
        return value if value.isprintable() else "".join(map(_shown, value))
    if isinstance(value, list):
        return [printable(each) for each in value]
    if isinstance(value, dict):
        return {printable(key): printable(each) for key, each in value.items()}
    return value


def _shown(character: str) -> str:
    """Return a character, or U+FFFD for a control character that is no line end or tab."""
    return "\ufffd" if unicodedata.category(character) == "Cc" and character not in "\n\t" else character


PACKAGE_FOLDER = Path(basu.__file__).parent


def places(beside: Path | None) -> tuple[Path, ...]:
    """Where a relative name is looked for, in order: here, beside the agent's file, among what BASU brings."""
    beside_folder = () if beside is None else (beside.resolve().parent,)
    return (Path.cwd(), *beside_folder, PACKAGE_FOLDER)


def find(name: str, what: str, beside: Path | None = None) -> Path:
    """The first place that has ``name``; ``beside`` is the agent's file.

    Raises:
        UserError: none has it; says where it was looked for.
    """
    for place in places(beside):
        if (place / name).exists():
            return place / name
    looked = ", ".join(str(place) for place in ((Path(name),) if Path(name).is_absolute() else places(beside)))
    raise UserError(f"{what} '{name}' was not found (looked in {looked}); `basu list` shows what comes with BASU")


def module_of(path: Path, name: str) -> tuple[ModuleType, Loader]:
    """The module of a file, known by ``name`` and not yet executed, and what executes it; ``path`` ends in .py.

    Its folder is searched after everything else: a file of several finds its own, and shadows nothing.
    """
    spec = importlib.util.spec_from_file_location(name, path)
    assert spec is not None, "a path that ends in .py has a loader"
    assert spec.loader is not None, "likewise"
    module = importlib.util.module_from_spec(spec)
    sys.modules[name] = module
    beside = str(path.resolve().parent)
    if beside not in sys.path:
        sys.path.append(beside)
    return module, spec.loader
