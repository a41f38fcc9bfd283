"""The maps that commands are given: an OpenDRIVE file, or the name of a built-in map."""

from importlib import resources
from pathlib import Path
from typing import TYPE_CHECKING

from linden.errors import UserError

if TYPE_CHECKING:
    from linden.maps.library import LoadedMap
    from linden.maps.opendrive.model import OpenDrive


def opendrive_of(name: str) -> "OpenDrive":
    """Read a file, or else the built-in map of that name.

    Raises:
        UserError: there is neither, or it cannot be read.
    """
    from linden.maps.opendrive.parse import parse  # noqa: PLC0415 - `linden --help` does not pay for it

    return parse(content_of(name))


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
        built_in = sorted(
            entry.name.removesuffix(".xodr")
            for entry in (resources.files("linden") / "data").iterdir()
            if entry.name.endswith(".xodr")
        )
        raise UserError(
            f"cannot read {path}: {error.strerror}; name an existing file"
            + (f" or a built-in map: {', '.join(built_in)}" if built_in else "")
        ) from None


def content_of(name: str) -> bytes:
    """Return the bytes of a file, or else of the built-in map of that name."""
    path = Path(name)
    built_in = resources.files("linden") / "data" / f"{name.removesuffix('.xodr')}.xodr"
    if not path.is_file() and path.name == name and built_in.is_file():
        return built_in.read_bytes()
    return bytes_of(path)
