"""Where recordings lie: what a client may name, and which file is meant. See docs/decisions/0020-recordings.md."""

import os
from pathlib import Path, PurePosixPath, PureWindowsPath

from linden.errors import Refusal


class RecordingFolder:
    """The folder for recordings; nothing outside of it is read or written for a client."""

    def __init__(self, folder: Path | None = None) -> None:
        """Use a folder, or where None is given the user's own: ``$XDG_DATA_HOME/linden/recordings``."""
        self.path = (_of_user() if folder is None else folder).absolute()

    def file(self, name: str) -> Path:
        """Return the file that a client means by a name: one in the folder, or a path below it.

        Raises:
            Refusal: the name is empty or leads out of the folder.
        """
        if not name or "\0" in name:
            raise Refusal("a recording needs a name, such as 'drive.log'")
        pure = PureWindowsPath(name) if "\\" in name else PurePosixPath(name)
        found = Path(os.path.normpath(self.path / Path(*pure.parts)))
        if found == self.path or not found.resolve().is_relative_to(self.path.resolve()):
            raise Refusal(
                f"recording '{name}' lies outside of {self.path}, where this server keeps recordings; give a name "
                f"without folders, or start the server with --recordings DIR, DIR being the folder you mean"
            )
        return found


def _of_user() -> Path:
    """Return the folder as the XDG Base Directory Specification places a user's data."""
    data = Path(os.environ.get("XDG_DATA_HOME", ""))
    if not data.is_absolute():  # to be ignored, says the specification
        data = Path.home() / ".local" / "share"
    return data / "linden" / "recordings"
