"""The output ``window``: the head-up display with the person before it, and recorded keys."""

from __future__ import annotations

from typing import TYPE_CHECKING

from basu_window.hud.person_input import onlookers_for

if TYPE_CHECKING:
    from basu.managers.base_manager import BaseManager
    from basu.options.drive import DriveOptions
    from basu.running.outputs import Drive


def check(_options: DriveOptions) -> None:
    """Check nothing: `person_for` opens the devices before the drive and says what is missing."""


def managers(options: DriveOptions, drive: Drive) -> list[BaseManager]:
    """Return the managers of the window and of the recorded keys."""
    return onlookers_for(options, drive.live, drive.agent)
