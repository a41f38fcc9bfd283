"""``linden serve`` with a fault: reading an OpenDRIVE text holds Python's lock for a second and more."""

import sys
from typing import Any

from linden.cli import main as linden
from linden.maps.library import LoadedMap, MapLibrary

HELD = 100_000_000
"""Numbers that one call of C adds up; the interpreter has no turn meanwhile."""

read = MapLibrary.from_opendrive


def greedy(library: MapLibrary, *arguments: Any, **options: Any) -> LoadedMap:
    assert sum(range(HELD))
    return read(library, *arguments, **options)


if __name__ == "__main__":
    MapLibrary.from_opendrive = greedy  # type: ignore[method-assign]
    sys.exit(linden(["serve", *sys.argv[1:]]))
