"""The document that repeats a run: ``config.json`` with the options, the scoring, digests of files and versions.

``options`` and ``scoring`` are read back by ``--config``; everything else is information. Digests and versions tell
whether the run would be the same one.
"""

from __future__ import annotations

import hashlib
import platform
from collections.abc import Iterable, Mapping
from importlib.metadata import version
from pathlib import Path
from typing import Any, NamedTuple

import basu
from basu.errors import UserError
from basu.files import PACKAGE_FOLDER, other_version, read_json
from basu.settings.forms import words_of
from basu.settings.option import Layer, Settings, fields_of, is_told, to_json

CONFIG_VERSION = 2
RUN, SCENARIO_RUN = "run", "scenario run"
SUFFIX = ".py"


class Config(NamedTuple):
    """The part of a document that is read back."""

    options: Layer
    scoring: Layer
    warnings: tuple[str, ...]  # why the run may differ from the one that left the document


def config_document(kind: str, options: Settings, scoring: Settings | None, files: Iterable[Path]) -> dict[str, Any]:
    """The document without what a command adds as information. ``files`` decide over the run's outcome."""
    plain = to_json(options)
    told = [field for field in fields_of(type(options)) if is_told(field, options)]
    return {
        "schema_version": CONFIG_VERSION,
        "kind": kind,
        "command": command_of(kind, options, scoring),
        "options": {field.name: plain[field.name] for field in told if field.option.repeats},
        **({} if scoring is None else {"scoring": to_json(scoring)}),
        "session": {field.name: plain[field.name] for field in told if not field.option.repeats},
        "working_folder": str(Path.cwd()),
        "files": [{"path": _shown(path), "sha256": _digest(path)} for path in dict.fromkeys(files)],
        "versions": {
            "basu": basu.__version__,
            "carla": version("carla"),
            "numpy": version("numpy"),
            "python": platform.python_version(),
        },
    }


def command_of(kind: str, options: Settings, scoring: Settings | None = None) -> list[str]:
    """Return the command line of a run: the options that differ from their defaults, but none of the session."""
    session = [field.name for field in fields_of(type(options)) if not field.option.repeats]
    return ["basu", *kind.split(), *words_of(options, but=session), *([] if scoring is None else words_of(scoring))]


def read_config(path: Path, kind: str, model: type[Settings]) -> Config:
    """Read a document for ``--config``; a run's folder means the document in it.

    Raises:
        UserError: it cannot be read, is another command's, or was written by an earlier version.
    """
    file = path / "config.json" if path.is_dir() else path
    document = read_json(file, "the config", "name the config.json of a run's folder")
    if not isinstance(document, dict):
        raise UserError(f"the config {file} is no JSON object; name the config.json of a run's folder")
    found = document.get("schema_version")
    if found is None:
        raise UserError(
            f"the config {file} has no 'schema_version': an earlier version of basu wrote it, which did not keep "
            f"every option; give the options again (it says: {_old_command(document)})"
        )
    if found != CONFIG_VERSION:
        raise other_version(file, found, CONFIG_VERSION)
    if document.get("kind") != kind:
        other = document.get("kind")
        hint = f"use `basu {other} --config {file}`" if other in {RUN, SCENARIO_RUN} else f"it must be '{kind}'"
        raise UserError(f"the config {file} is of kind {other!r}; {hint}")
    sections = []
    for name in ("options", "scoring"):
        values = document.get(name, {})
        if not isinstance(values, dict):
            raise UserError(f"{file}: {name} is {values!r}; it must be an object")
        sections.append(Layer(values, str(file), name))
    options, scoring = sections
    _no_session(options, model)
    folder = document.get("working_folder")
    found_files = {**options.values, **_found(model, options.values, Path(str(folder)))} if folder else options.values
    return Config(options._replace(values=found_files), scoring, tuple(_differences(document, folder)))


def _no_session(options: Layer, model: type[Settings]) -> None:
    """Refuse options that do not repeat a run: where it is run is for the command line."""
    flags = {field.name: field.flag for field in fields_of(model) if not field.option.repeats}
    for name in options.values:
        if name in flags:
            raise UserError(f"{options.name(model, name)} is no part of a run's config; give {flags[name]}")


def _old_command(document: Mapping[str, Any]) -> str:
    command = document.get("command")
    return " ".join(map(str, command)) if isinstance(command, list) else "no command"


def _found(model: type[Settings], values: Mapping[str, Any], folder: Path) -> dict[str, Any]:
    """The values that name files which are not here, but in the folder that the first run was started in."""
    changed: dict[str, Any] = {}
    for field in fields_of(model):
        value = values.get(field.name)
        if field.names_files and isinstance(value, str):
            changed[field.name] = _here_or_there(value, folder)
        elif field.names_files and isinstance(value, list):
            changed[field.name] = [_here_or_there(each, folder) if isinstance(each, str) else each for each in value]
    return changed


def _here_or_there(name: str, folder: Path) -> str:
    """A file's name, with the folder before it where the file is only there."""
    path = Path(name.partition(f"{SUFFIX}:")[0] + SUFFIX if f"{SUFFIX}:" in name else name)
    if path.is_absolute() or path.exists() or not (folder / path).exists():
        return name
    return str(folder / name)


def _differences(document: Mapping[str, Any], folder: object) -> list[str]:
    """Sentences about what is not as it was: files and versions."""
    found = []
    files = document.get("files")
    for entry in files if isinstance(files, list) else []:
        path = _resolved(str(entry.get("path")), folder) if isinstance(entry, dict) else None
        if path is not None and not path.exists():
            found.append(f"{entry['path']} is not there any more")
        elif path is not None and _digest(path) != entry.get("sha256"):
            found.append(f"{entry['path']} has changed since")
    versions = document.get("versions")
    here = {"basu": basu.__version__, "carla": version("carla"), "numpy": version("numpy")}
    for name, now in here.items():
        before = versions.get(name, now) if isinstance(versions, dict) else now
        if before != now:
            found.append(f"{name} was {before} and is {now}")
    return found


def _shown(path: Path) -> str:
    """A file as the document has it: relative to here or to the package, where it lies in one of them."""
    whole = path.resolve()
    for folder in (PACKAGE_FOLDER, Path.cwd()):
        if whole.is_relative_to(folder):
            return str(whole.relative_to(folder))
    return str(whole)


def _resolved(name: str, folder: object) -> Path:
    """The file that a document means."""
    places = [Path.cwd(), *([Path(folder)] if isinstance(folder, str) else []), PACKAGE_FOLDER]
    return next((place / name for place in places if (place / name).exists()), Path(name))


def _digest(path: Path) -> str:
    return hashlib.sha256(path.read_bytes()).hexdigest()
