"""Commands that are imported when they are typed: the command line alone needs none of their packages."""

import argparse
import importlib
from collections.abc import Callable


def later(place: str) -> Callable[[argparse.Namespace], int]:
    """Return a command that imports ``place`` (``module:function``) when it is called, and then runs it."""
    module, _, name = place.partition(":")

    def run(arguments: argparse.Namespace) -> int:
        command: Callable[[argparse.Namespace], int] = getattr(importlib.import_module(module), name)
        return command(arguments)

    return run
