"""``linden map info``: counts and named places of a map."""

import argparse

from linden_maps.cli.map_source import opendrive_of
from linden_maps.cli.output import say
from linden_maps.statistics import count, named_places


def run(arguments: argparse.Namespace) -> int:
    """Print what the map has, one count a line, then its named places."""
    opendrive = opendrive_of(arguments.file)
    for name, value in count(opendrive)._asdict().items():
        say(f"{name.replace('_', ' '):24} {f'{value:.2f}' if isinstance(value, float) else value}")
    for place in named_places(opendrive):
        say(f"{'place':24} {place}")
    return 0
