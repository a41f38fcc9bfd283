"""Whoever looks on at a run for ``--viewer``; nobody where it was not asked for, so Rerun need not be there."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from basu.managers.base_manager import BaseManager, Live
    from basu.options import RunOptions


def viewer_for(options: RunOptions, live: Live) -> list[BaseManager]:
    """The manager that streams to Rerun, where ``--viewer`` is given."""
    if not options.viewer:
        return []
    from basu.output.viewer.viewer_manager import ViewerManager  # noqa: PLC0415 - imports Rerun, an extra

    return [ViewerManager(live, print)]
