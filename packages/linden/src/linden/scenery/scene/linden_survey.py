"""``surveyed``: shuttle stops, their sides of the street and the railroad line of Linden, in CARLA's frame.

Source: ``data/linden.geojson``, which names its own sources.
"""

import json
import math
from functools import cache
from importlib import resources
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

F64 = NDArray[np.float64]

_EQUATOR_M, _FLATTENING = 6378137.0, 1.0 / 298.257223563  # WGS 84


_COMPASS = {"north": (0.0, -1.0), "south": (0.0, 1.0), "east": (1.0, 0.0), "west": (-1.0, 0.0)}


class Surveyed(NamedTuple):
    """Places in CARLA's frame, m."""

    stops_m: F64  # (N, 2)
    kerbs: F64  # (N, 2): from the middle of the street to the side on which the shuttle stops, length 1
    railroad_m: F64  # (M, 2)


@cache
def surveyed(origin_deg: tuple[float, float]) -> Surveyed:
    """Return the places on a map with its origin at this latitude and longitude."""
    text = (resources.files("linden") / "data" / "linden.geojson").read_text("utf-8")
    features = json.loads(text)["features"]
    stops = [f for f in features if f["properties"]["feature"] == "shuttle_stop"]
    lines = [f["geometry"]["coordinates"] for f in features if f["properties"]["feature"] == "railroad"]
    return Surveyed(
        placed([stop["geometry"]["coordinates"] for stop in stops], origin_deg),
        np.array([_COMPASS[stop["properties"]["side"].split()[0]] for stop in stops]).reshape(-1, 2),
        placed(lines[0] if lines else [], origin_deg),
    )


def placed(longitude_latitude: list[list[float]], origin_deg: tuple[float, float]) -> F64:
    """Return places (N, 2) around an origin: the radii of curvature there (Snyder 1987, 4-20, 4-18) give metres.

    Beside a transverse Mercator projection this is off by less than a metre within three kilometres.
    """
    degrees = np.asarray(longitude_latitude, np.float64).reshape(-1, 2)
    latitude = math.radians(origin_deg[0])
    squared = _FLATTENING * (2.0 - _FLATTENING)
    bulge = 1.0 - squared * math.sin(latitude) ** 2
    east = np.radians(degrees[:, 0] - origin_deg[1]) * np.cos(np.radians(degrees[:, 1])) * _EQUATOR_M / math.sqrt(bulge)
    north = np.radians(degrees[:, 1] - origin_deg[0]) * _EQUATOR_M * (1.0 - squared) / bulge**1.5
    return np.column_stack([east, -north])
