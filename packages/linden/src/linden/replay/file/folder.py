"""``RecordingFolder`` resolves a file name in the folder for recordings. See docs/decisions/0020-recordings.md."""

import errno
import os
import stat
from pathlib import Path, PurePosixPath, PureWindowsPath

from linden.errors import Refusal


class RecordingFolder:
    """The folder for recordings; nothing outside of it is read or written for a client."""

    def __init__(self, folder: Path | None = None) -> None:
        """Use a folder, or where None is given the user's own: ``$XDG_DATA_HOME/linden/recordings``."""
        self._given = folder

    @property
    def path(self) -> Path:
        """Return the folder of the recorded files.

        Raises:
            Refusal: none is given, and the user has none.
        """
        return (_of_user() if self._given is None else self._given).absolute()

    def file(self, name: str) -> Path:
        """Return the file that a client means by a name: one in the folder, or a path below it.

        Raises:
            Refusal: the name is empty or leads out of the folder.
        """
        if not name or "\0" in name:
            raise Refusal("a recording needs a name, such as 'drive.log'")
        pure = PureWindowsPath(name) if "\\" in name else PurePosixPath(name)
        folder = self.path
        found = Path(os.path.normpath(folder / Path(*pure.parts)))
        if found == folder or not found.resolve().is_relative_to(folder.resolve()):
            raise Refusal(
                f"recording '{name}' lies outside of {folder}, where this server keeps recordings; give a name "
                f"without folders, or start the server with --recordings DIR, DIR being the folder you mean"
            )
        return found


def open_at_once(path: str, flags: int) -> int:
    """Return a descriptor of a file, as an opener of ``open``; a pipe would let the server wait for its other end.

    Raises:
        OSError: it cannot be opened, or is a pipe.
    """
    descriptor = os.open(path, flags | getattr(os, "O_NONBLOCK", 0), 0o666)
    kind = os.fstat(descriptor).st_mode
    if stat.S_ISFIFO(kind):
        os.close(descriptor)
        raise OSError(errno.EINVAL, "it is a pipe, not a file", path)
    return descriptor


def _of_user() -> Path:
    """Return the folder as the XDG Base Directory Specification places a user's data."""
    data = Path(os.environ.get("XDG_DATA_HOME", ""))
    if not data.is_absolute():  # to be ignored, says the specification
        try:
            data = Path.home() / ".local" / "share"
        except RuntimeError as error:
            raise Refusal("this user has no folder for recordings; start the server with --recordings DIR") from error
    return data / "linden" / "recordings"
