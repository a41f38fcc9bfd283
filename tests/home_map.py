"""The built-in map as a server has it: derived once on a machine, read once in a process of tests."""

from functools import cache

from linden.maps.cache import MapCache
from linden.maps.library import HOME_MAP, LoadedMap, MapLibrary


@cache
def home_map() -> LoadedMap:
    """Return Linden's map; no test changes it. The test of the cache of maps compares it with one derived anew."""
    return MapLibrary((), MapCache.of_user().read).load(HOME_MAP)
