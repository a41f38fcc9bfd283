"""Options of the page and of recorded keys."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, ClassVar

from basu.options.groups import WINDOW
from basu.settings.option import Option, Settings

_PAGE = "--watch shows the drive, its sensors and its figures in a page of the browser"


@dataclass(frozen=True, kw_only=True)
class WindowOptions(Settings):
    """What is shown of a drive, and keys."""

    GONE: ClassVar[Mapping[str, str]] = {
        "hud": _PAGE,
        "hud_camera": _PAGE,
        "hud_size": "the page has the size of the browser's window; --watch opens it",
        "hud_screenshot": "press K in the page of --watch, or make a film of the run with `basu watch RUN --film FILE`",
        "viewer": f"{_PAGE}; --rosbag writes the sensors into a file that Rerun opens",
    }

    watch: Annotated[
        bool,
        Option(
            help="show the drive in a page of the browser and print its address; P takes over control",
            group=WINDOW,
            repeats=False,
        ),
    ] = False
    keys: Annotated[
        str | None,
        Option(
            help="play a recorded session of keys, such as data/human_session.json",
            group=WINDOW,
            metavar="FILE",
            is_file=True,
        ),
    ] = None
    record_keys: Annotated[
        Path | None,
        Option(
            help="write the keys that a person presses to a session file", group=WINDOW, metavar="FILE", repeats=False
        ),
    ] = None
