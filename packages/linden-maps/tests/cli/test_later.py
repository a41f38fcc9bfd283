"""Claims about commands that are imported when they are typed."""

import argparse
import sys

from linden_maps.cli.later import later


def test_a_command_is_imported_when_it_runs() -> None:
    name = "linden_maps.cli.map_list"
    sys.modules.pop(name, None)
    command = later(f"{name}:run")
    assert name not in sys.modules
    assert command(argparse.Namespace()) == 0
