"""Options of the window, the viewer and recorded keys."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, ClassVar, Literal

from basu.errors import UserError
from basu.options.groups import WINDOW
from basu.settings.option import Option, Settings

WINDOWS = (640, 480), (7680, 4320)  # pixels; the panel and the help page need the smallest


@dataclass(frozen=True, kw_only=True)
class WindowOptions(Settings):
    """What is shown of a drive, and keys."""

    GONE: ClassVar[Mapping[str, str]] = {
        "hud_camera": "the camera's picture has half the width and height of the window, which --hud-size sets"
    }

    viewer: Annotated[
        bool,
        Option(help="stream the run to Rerun's viewer and keep it as run.rrd", group=WINDOW, repeats=False),
    ] = False
    watch: Annotated[
        bool,
        Option(
            help="show the drive in a page of the browser and print its address; P takes over control",
            group=WINDOW,
            repeats=False,
            rival="window",
        ),
    ] = False
    hud: Annotated[
        Literal["camera", "map"] | None,
        Option(
            help="show a window; P takes over control; without a view: camera",
            group=WINDOW,
            bare="camera",
            advice="an agent is named before --hud, as in `basu run basic --hud`",
            repeats=False,
            rival="window",
        ),
    ] = None
    hud_size: Annotated[
        tuple[int, int],
        Option(help="size of the window", group=WINDOW, metavar="WxH", unit="pixels", style="size", repeats=False),
    ] = (960, 540)
    hud_screenshot: Annotated[
        Path | None,
        Option(help="PNG of the window, written at the end and by F12", group=WINDOW, metavar="FILE", repeats=False),
    ] = None
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

    def check(self) -> None:
        """Check the options of the window.

        Raises:
            UserError: a picture of no window, or a size beyond the limits.
        """
        if self.hud_screenshot is not None and self.hud is None:
            raise UserError("--hud-screenshot takes a picture of the window; add --hud")
        _check_size("--hud-size", self.hud_size, WINDOWS)
        super().check()


def _check_size(flag: str, size: tuple[int, int], allowed: tuple[tuple[int, int], tuple[int, int]]) -> None:
    """Check that a size lies within the smallest and the largest.

    Raises:
        UserError: it does not.
    """
    (width, height), (least, most) = size, allowed
    if not (least[0] <= width <= most[0] and least[1] <= height <= most[1]):
        raise UserError(f"{flag} {width}x{height}: it may be from {least[0]}x{least[1]} to {most[0]}x{most[1]} pixels")
