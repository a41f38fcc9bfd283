"""Output plugin ``window``: returns the managers of the browser page and of recorded keys for a run."""

from __future__ import annotations

from typing import TYPE_CHECKING

from basu_window.person_input import onlookers_for

if TYPE_CHECKING:
    from basu.managers.base_manager import BaseManager
    from basu.options.drive import DriveOptions
    from basu.running.outputs import ShownDrive


def check(_options: DriveOptions) -> None:
    """Check nothing: `person_for` says before the drive what is missing."""


def managers(options: DriveOptions, drive: ShownDrive) -> list[BaseManager]:
    """Return the managers of the page and of the recorded keys."""
    return onlookers_for(options, drive.live, drive.agent)
