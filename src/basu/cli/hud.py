"""The options of ``basu run`` that concern a person before a window."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

from basu.errors import UserError
from basu.options import HUD_VIEWS

if TYPE_CHECKING:
    import argparse


class HudOptions(NamedTuple):
    """The fields of ``RunOptions`` that are set here."""

    hud: str | None
    hud_size: tuple[int, int]
    hud_screenshot: Path | None
    keys: str | None
    record_keys: Path | None


def add_hud(run: argparse.ArgumentParser) -> None:
    """The options."""
    run.add_argument(
        "--hud",
        nargs="?",
        const=HUD_VIEWS[0],
        metavar="VIEW",
        help=f"watch in a window, and take over with P: {' or '.join(HUD_VIEWS)} (default: %(const)s)",
    )
    run.add_argument(
        "--hud-size", default="960x540", metavar="WxH", help="of the window and its camera (default: %(default)s)"
    )
    run.add_argument(
        "--hud-screenshot", type=Path, metavar="FILE", help="PNG of the window, written at the end and by F12"
    )
    run.add_argument("--keys", metavar="FILE", help="play a recorded session of keys, such as data/human_session.json")
    run.add_argument("--record-keys", type=Path, metavar="FILE", help="write down the keys that are pressed")


def hud_options(arguments: argparse.Namespace) -> HudOptions:
    """What was asked for, checked.

    Raises:
        UserError: it makes no sense.
    """
    view: str | None = arguments.hud
    if view is not None and view not in HUD_VIEWS:
        raise UserError(
            f"--hud {view}: the view is {' or '.join(HUD_VIEWS)}; an agent is named before --hud, as in "
            f"`basu run {view} --hud`"
        )
    if arguments.hud_screenshot is not None and view is None:
        raise UserError("--hud-screenshot takes a picture of the window; add --hud")
    return HudOptions(view, _size(arguments.hud_size), arguments.hud_screenshot, arguments.keys, arguments.record_keys)


def _size(text: str) -> tuple[int, int]:
    """Width and height in pixels."""
    width, _, height = text.partition("x")
    if not (width.isascii() and height.isascii() and width.isdigit() and height.isdigit()):
        raise UserError(f"--hud-size {text}: write WIDTHxHEIGHT in pixels, as in 960x540")
    size = int(width), int(height)
    if not (480 <= size[0] <= 7680 and 320 <= size[1] <= 4320):
        raise UserError(f"--hud-size {text}: a window is from 480x320 to 7680x4320")
    return size
