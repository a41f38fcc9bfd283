"""Options of the page and of recorded keys."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import ClassVar

from basu.settings.option import Settings, option

_PAGE = "--watch shows the drive, its sensors and its figures in a page of the browser"


@dataclass(frozen=True, kw_only=True)
class WindowOptions(Settings):
    """What is shown of a drive, and keys."""

    GROUP = "window and keys"
    GONE: ClassVar[Mapping[str, str]] = {
        "hud": _PAGE,
        "hud_camera": _PAGE,
        "hud_size": "the page has the size of the browser's window; --watch opens it",
        "hud_screenshot": "press K in the page of --watch, or make a film of the run with `basu watch RUN --film FILE`",
        "viewer": f"{_PAGE}; --rosbag writes the sensors into a file that Rerun opens",
    }

    watch: bool = option(
        False, "show the drive in a page of the browser and print its address; P takes over control", repeats=False
    )
    keys: str | None = option(
        None, "play a recorded session of keys, such as data/human_session.json", metavar="FILE", is_file=True
    )
    record_keys: Path | None = option(
        None, "write the keys that a person presses to a session file", metavar="FILE", repeats=False
    )
