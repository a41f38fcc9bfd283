"""Reads the map that a command names: as OpenDRIVE (`opendrive_of`), or as a server loads it (`world_map_of`)."""

from pathlib import Path

from linden.errors import UserError
from linden.maps.cache import MapCache
from linden.maps.library import LoadedMap
from linden.maps.opendrive.model import OpenDrive
from linden.maps.opendrive.parse import parse
from linden_maps.cli.map_files import content_of


def opendrive_of(name: str) -> OpenDrive:
    """Read a file, or else the built-in map of that name.

    Raises:
        UserError: there is neither, or it cannot be read; with the name, and the line where one is to blame.
    """
    return parsed(name, content_of(name))


def parsed(name: str, content: bytes) -> OpenDrive:
    """Return the map that a file's bytes describe; ``name`` is for the sentence.

    Raises:
        UserError: they cannot be read; see :func:`opendrive_of`.
    """
    try:
        return parse(content)
    except UserError as error:
        told = str(error)
        raise UserError(f"{name}, {told}" if told.startswith("line ") else f"{name}: {told}") from None


def world_map_of(name: str) -> LoadedMap:
    """Return the map as a server has it, its facts out of the user's cache where they are kept.

    Raises:
        UserError: there is no such map, or it cannot be read.
    """
    try:
        text = content_of(name).decode("utf-8")
    except UnicodeDecodeError as error:
        raise UserError(f"{name} is no text in UTF-8: {error.reason} at byte {error.start}") from None
    bare = Path(name).name.removesuffix(".xodr")
    return LoadedMap(name=bare, text=text, **vars(MapCache.of_user().facts_of(text)))
