"""Commands that are imported when they are typed: the command line alone needs none of their packages."""

import argparse
import importlib
from collections.abc import Callable

from linden.errors import UserError


def later(place: str, extra: str = "") -> Callable[[argparse.Namespace], int]:
    """Return a command that imports ``place`` (``module:function``) when it is called, and then runs it.

    ``extra`` names the extra of linden with the packages that the module needs. Without one of them the command raises
    UserError.
    """
    module, _, name = place.partition(":")

    def run(arguments: argparse.Namespace) -> int:
        try:
            command: Callable[[argparse.Namespace], int] = getattr(importlib.import_module(module), name)
        except ModuleNotFoundError as error:
            if not extra or (error.name or "").startswith("linden"):
                raise
            raise UserError(
                f"this command needs the package {error.name}; install it with: pip install 'linden[{extra}]'"
            ) from None
        return command(arguments)

    return run
