"""The output ``viewer``: the drive in Rerun's viewer."""

from __future__ import annotations

from typing import TYPE_CHECKING

from basu.extras import require
from basu_window.extras import RERUN

if TYPE_CHECKING:
    from basu.managers.base_manager import BaseManager
    from basu.options.drive import DriveOptions
    from basu.running.outputs import ShownDrive


def check(_options: DriveOptions) -> None:
    """Check that Rerun is installed.

    Raises:
        UserError: it is not.
    """
    require(RERUN)


def managers(_options: DriveOptions, drive: ShownDrive) -> list[BaseManager]:
    """Return the manager that streams the drive; it prints the viewer's address even in a quiet drive."""
    from basu_window.viewer.viewer_manager import ViewerManager  # noqa: PLC0415 - Rerun, an extra

    return [ViewerManager(drive.live, print)]
