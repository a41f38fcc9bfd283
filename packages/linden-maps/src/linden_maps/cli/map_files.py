"""Maps that commands name, as files: an OpenDRIVE file, or the name of a built-in map."""

from pathlib import Path

import linden
from linden.errors import UserError

_PACKAGED = Path(linden.__file__).parent / "data"


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
