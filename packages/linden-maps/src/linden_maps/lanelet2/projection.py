"""Latitude and longitude of a map's points by its own transverse Mercator projection on WGS84, which PROJ computes."""

import math
import re
from functools import lru_cache
from typing import NamedTuple, TypeVar

import numpy as np
from numpy.typing import NDArray
from pyproj import Proj
from pyproj.exceptions import ProjError

from linden.errors import UserError

Numbers = TypeVar("Numbers", float, NDArray[np.float64])

_WORD = re.compile(r"\+([a-z_0-9]+)(?:=(\S+))?")


class Projection(NamedTuple):
    """A transverse Mercator projection on WGS84."""

    latitude_deg: float
    longitude_deg: float
    scale: float
    false_easting_m: float
    false_northing_m: float

    def degrees(self, x_m: Numbers, y_m: Numbers) -> tuple[Numbers, Numbers]:
        """Return latitude and longitude of points."""
        longitude, latitude = _proj(*self)(x_m, y_m, inverse=True)
        return latitude, longitude

    def metres(self, latitude_deg: Numbers, longitude_deg: Numbers) -> tuple[Numbers, Numbers]:
        """Return x and y of points."""
        x_m, y_m = _proj(*self)(longitude_deg, latitude_deg)
        return x_m, y_m


@lru_cache
def _proj(latitude_deg: float, longitude_deg: float, scale: float, x_m: float, y_m: float) -> Proj:
    return Proj(proj="tmerc", lat_0=latitude_deg, lon_0=longitude_deg, k_0=scale, x_0=x_m, y_0=y_m, ellps="WGS84")


NOWHERE = Projection(0.0, 0.0, 1.0, 0.0, 0.0)
"""Of a map that does not say where it lies: its origin at latitude 0 and longitude 0, as CARLA's own towns have it."""


def projection_of(geo_reference: str) -> Projection | None:
    """Return the projection of the text of a <geoReference>; None where it is empty.

    Raises:
        UserError: the text names another kind of projection, or a number in it is none or cannot be.
    """
    words = {key: value or "" for key, value in _WORD.findall(geo_reference)}
    if not geo_reference.strip():
        return None
    kind = words.get("proj", "")
    if kind == "utm":
        zone = _number(words, "zone", math.nan)
        if not 1 <= zone <= 60:
            raise UserError(f"the georeference {_short(geo_reference)!r} names no UTM zone from 1 to 60")
        south = "south" in words
        return Projection(0.0, 6.0 * zone - 183.0, 0.9996, 500000.0, 10000000.0 if south else 0.0)
    if kind != "tmerc":
        raise UserError(
            f"the georeference {_short(geo_reference)!r} is no transverse Mercator projection; "
            "write the map in +proj=tmerc or +proj=utm"
        )
    found = Projection(
        _number(words, "lat_0", 0.0),
        _number(words, "lon_0", 0.0),
        _number(words, "k", _number(words, "k_0", 1.0)),
        _number(words, "x_0", 0.0),
        _number(words, "y_0", 0.0),
    )
    try:
        _proj(*found)
    except ProjError as error:
        reason = str(error).rpartition(": ")[2].rstrip(")")
        raise UserError(f"the georeference {_short(geo_reference)!r} is none that PROJ knows: {reason}") from None
    return found


def _number(words: dict[str, str], key: str, default: float) -> float:
    text = words.get(key, "")
    if not text:
        return default
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        raise UserError(f"the georeference has +{key}={text[:40]}; it should be a number")
    return value


def _short(text: str) -> str:
    return text.strip() if len(text.strip()) <= 60 else f"{text.strip()[:57]}..."
