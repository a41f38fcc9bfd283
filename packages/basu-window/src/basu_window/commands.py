"""Arguments of ``basu watch``: recorded runs in a page of the browser."""

from __future__ import annotations

import argparse
from pathlib import Path

from basu.cli.later import later
from basu.plugins import Command


def add_watch(watch: argparse.ArgumentParser) -> None:
    """Add the arguments of ``basu watch``."""
    watch.description = "Show recorded runs in a page of the browser: any camera, a slider, and infractions as marks."
    watch.add_argument(
        "runs", type=Path, nargs="+", metavar="RUN", help="a run's folder, such as runs/latest; further ones are ghosts"
    )
    watch.add_argument("--map", type=Path, metavar="FILE.xodr", help="the map of the runs (default: the first run's)")
    watch.add_argument("--port", type=int, default=0, metavar="N", help="port of the page (default: any free one)")
    watch.add_argument("--at", type=float, metavar="S", help="simulated time at which the page begins (default: 0)")
    watch.add_argument(
        "--film",
        type=Path,
        metavar="FILE.mp4",
        help="write a film of the runs without a screen, and end; needs Chromium",
    )
    watch.add_argument(
        "--film-from", type=float, default=0.0, metavar="S", help="simulated time of the first picture (default: 0)"
    )
    watch.add_argument(
        "--film-to", type=float, metavar="S", help="simulated time of the last picture (default: the end of the run)"
    )
    watch.set_defaults(command=later("basu_window.browser.watch:run"))


WATCH = Command("show recorded runs in a page of the browser", add_watch)
