"""A temporary home folder if the user's own cannot be written: the official client keeps files of maps there.

Without it, the client raises boost::filesystem errors in the middle of a load (FileTransfer.cpp).
"""

from __future__ import annotations

import atexit
import functools
import os
import sys
import tempfile
from pathlib import Path

CLIENT_CACHE = "carlaCache"  # of the official client, below the home folder


@functools.cache
def replaced_home() -> Path | None:
    """Return a temporary home folder if the client cannot write its cache in the user's, else None.

    The temporary folder is set as ``HOME`` for this process and the processes that it starts, and removed at the end.
    """
    try:
        cache = Path.home() / CLIENT_CACHE
        cache.mkdir(exist_ok=True)
        with tempfile.TemporaryFile(dir=cache):
            return None
    except (OSError, RuntimeError) as error:  # RuntimeError: the user has no home folder
        folder = tempfile.TemporaryDirectory(prefix="basu-home-")
        atexit.register(folder.cleanup)
        print(  # noqa: T201 - a notice for the user
            f"basu: the home folder cannot be written ({error}); files of CARLA's client go to a temporary folder",
            file=sys.stderr,
            flush=True,
        )
        os.environ["HOME"] = folder.name
        return Path(folder.name)
