"""What is derived from a map, kept as long as the map itself: asked for in many places, computed once."""

from collections.abc import Callable
from functools import wraps
from typing import TypeVar
from weakref import WeakKeyDictionary

from linden.opendrive.model import OpenDrive

Derived = TypeVar("Derived")


def kept(derive: Callable[[OpenDrive], Derived]) -> Callable[[OpenDrive], Derived]:
    """Let ``derive`` compute once for each map. What it returns must not hold the map, or neither would ever go."""
    known: WeakKeyDictionary[OpenDrive, Derived] = WeakKeyDictionary()

    @wraps(derive)
    def once(opendrive: OpenDrive) -> Derived:
        if opendrive not in known:
            known[opendrive] = derive(opendrive)
        return known[opendrive]

    return once
