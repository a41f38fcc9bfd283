"""``basu watch``: recorded runs in the page of the window, which is a distribution of its own."""

from __future__ import annotations

from typing import TYPE_CHECKING

from basu.output.hud.person_input import window_module

if TYPE_CHECKING:
    import argparse


def run(arguments: argparse.Namespace) -> int:
    """Show the records of runs in the browser until Ctrl-C."""
    code: int = window_module("watch").run(arguments)
    return code
