"""The maps that commands are given: an OpenDRIVE file, or the name of a built-in map."""

from pathlib import Path
from typing import TYPE_CHECKING

from linden.errors import UserError

if TYPE_CHECKING:
    from linden.maps.library import LoadedMap
    from linden.maps.opendrive.model import OpenDrive

_PACKAGED = Path(__file__).parent.parent / "data"


def opendrive_of(name: str) -> "OpenDrive":
    """Read a file, or else the built-in map of that name.

    Raises:
        UserError: there is neither, or it cannot be read; with the name, and the line where one is to blame.
    """
    return parsed(name, content_of(name))


def parsed(name: str, content: bytes) -> "OpenDrive":
    """Return the map that a file's bytes describe; ``name`` is for the sentence.

    Raises:
        UserError: they cannot be read; see :func:`opendrive_of`.
    """
    from linden.maps.opendrive.parse import parse  # noqa: PLC0415 - `linden --help` does not pay for it

    try:
        return parse(content)
    except UserError as error:
        told = str(error)
        raise UserError(f"{name}, {told}" if told.startswith("line ") else f"{name}: {told}") from None


def world_map_of(name: str) -> "LoadedMap":
    """Return the map as a server has it, its facts out of the user's cache where they are kept.

    Raises:
        UserError: there is no such map, or it cannot be read.
    """
    from linden.maps.cache import MapCache  # noqa: PLC0415 - `linden --help` does not pay for it
    from linden.maps.library import LoadedMap  # noqa: PLC0415 - see above

    try:
        text = content_of(name).decode("utf-8")
    except UnicodeDecodeError as error:
        raise UserError(f"{name} is no text in UTF-8: {error.reason} at byte {error.start}") from None
    bare = Path(name).name.removesuffix(".xodr")
    return LoadedMap(name=bare, text=text, **vars(MapCache.of_user().facts_of(text)))


def bytes_of(path: Path) -> bytes:
    """Return the bytes of a file.

    Raises:
        UserError: it cannot be read.
    """
    try:
        return path.read_bytes()
    except OSError as error:
        raise UserError(
            f"cannot read {path}: {error.strerror}; name an existing file or a built-in map: "
            + ", ".join(built_in_maps())
        ) from None


def built_in_maps() -> list[str]:
    """Return the names of the maps that come with the package."""
    return sorted(file.stem for file in _PACKAGED.glob("*.xodr"))


def content_of(name: str) -> bytes:
    """Return the bytes of a file, or else of the built-in map of that name."""
    return _built_in(name).read_bytes() if is_built_in(name) else bytes_of(Path(name))


def is_built_in(name: str) -> bool:
    """Return whether a built-in map has this name, and no file has."""
    path = Path(name)
    return not path.is_file() and path.name == name and _built_in(name).is_file()


def _built_in(name: str) -> Path:
    return _PACKAGED / f"{name.removesuffix('.xodr')}.xodr"
