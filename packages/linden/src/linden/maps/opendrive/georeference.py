"""``read_origin``: latitude and longitude of a map's origin, parsed from <geoReference> as by LibCarla 0.9.16.

Found by feeding ``carla.Map`` two dozen texts: the text is split at spaces, each word at "=", and only the words
``+lat_0`` and ``+lon_0`` with exactly one "=" count; the value is read as C's ``strtod`` does, up to the first
character that does not belong to a number. Where either is missing or not a number, latitude 42 and longitude 2 hold.
"""

import math
import re
from typing import NamedTuple

DEFAULT_LATITUDE_DEG = 42.0
DEFAULT_LONGITUDE_DEG = 2.0

_NUMBER = re.compile(r"\s*([+-]?(?:\d+\.?\d*(?:[eE][+-]?\d+)?|\.\d+(?:[eE][+-]?\d+)?))")


class GeoOrigin(NamedTuple):
    """The map's origin in degrees; ``is_readable`` is False where LibCarla falls back to its defaults, or fails."""

    latitude_deg: float
    longitude_deg: float
    is_readable: bool


def read_origin(geo_reference: str) -> GeoOrigin:
    """Return the origin that LibCarla takes from the text of a <geoReference>."""
    found = {"+lat_0": math.nan, "+lon_0": math.nan}
    for word in geo_reference.split(" "):
        key, *values = word.split("=")
        if key in found and len(values) == 1:
            match = _NUMBER.match(values[0])
            found[key] = float(match.group(1)) if match else math.nan
    if not all(map(math.isfinite, found.values())):
        return GeoOrigin(DEFAULT_LATITUDE_DEG, DEFAULT_LONGITUDE_DEG, is_readable=False)
    return GeoOrigin(found["+lat_0"], found["+lon_0"], is_readable=True)
