"""``linden map list``: the names of the built-in maps."""

import argparse

from linden_maps.cli.map_files import built_in_maps
from linden_maps.cli.output import say


def run(_arguments: argparse.Namespace) -> int:
    """Print the names of the built-in maps, one a line."""
    for name in built_in_maps():
        say(name)
    return 0
