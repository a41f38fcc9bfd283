"""The options of ``basu run`` that concern a person before a window."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

from basu.errors import UserError
from basu.options import HUD_VIEWS

if TYPE_CHECKING:
    import argparse


WINDOWS = (640, 480), (7680, 4320)  # the panel and the help page need the smallest
PICTURES = (64, 48), (3840, 2160)


class HudOptions(NamedTuple):
    """The fields of ``RunOptions`` that are set here."""

    hud: str | None
    hud_size: tuple[int, int]
    hud_camera: tuple[int, int]
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
        "--hud-size", default="960x540", metavar="WxH", help="of the window, in pixels (default: %(default)s)"
    )
    run.add_argument(
        "--hud-camera",
        default="480x270",
        metavar="WxH",
        help="of the HUD's camera: its pictures take most of the time (default: %(default)s)",
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
    return HudOptions(
        hud=view,
        hud_size=_size("--hud-size", arguments.hud_size, WINDOWS),
        hud_camera=_size("--hud-camera", arguments.hud_camera, PICTURES),
        hud_screenshot=arguments.hud_screenshot,
        keys=arguments.keys,
        record_keys=arguments.record_keys,
    )


def _size(option: str, text: str, allowed: tuple[tuple[int, int], tuple[int, int]]) -> tuple[int, int]:
    """Width and height in pixels, within the smallest and the largest that are allowed."""
    width, _, height = text.partition("x")
    if not (width.isascii() and height.isascii() and width.isdigit() and height.isdigit()):
        raise UserError(f"{option} {text}: write WIDTHxHEIGHT in pixels, as in 960x540")
    size = int(width), int(height)
    (least_width, least_height), (most_width, most_height) = allowed
    if not (least_width <= size[0] <= most_width and least_height <= size[1] <= most_height):
        raise UserError(f"{option} {text}: it may be from {least_width}x{least_height} to {most_width}x{most_height}")
    return size
