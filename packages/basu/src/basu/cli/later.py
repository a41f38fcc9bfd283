"""Commands that are imported when they are typed: ``--help`` needs none of their packages."""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import argparse
    from collections.abc import Callable


def later(place: str) -> Callable[[argparse.Namespace], int]:
    """Return a command that imports ``place`` (``module:function``) when it is called, and then runs it."""
    module, _, name = place.partition(":")

    def run(arguments: argparse.Namespace) -> int:
        code: int = getattr(importlib.import_module(module), name)(arguments)
        return code

    return run
