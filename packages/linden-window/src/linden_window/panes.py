"""A sensor's measurement as the page reads it: magic, length of a JSON header, the header, then pixels or points.

``page/panes.js`` reads the same layout. The header is padded with blanks so that the content begins at a multiple of 4.
"""

import json
import math
import struct
from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

MAGIC = 0x31504C57  # "WLP1"
HEADER = struct.Struct("<II")
POINT = np.dtype([("place", "<i2", 2), ("colour", "u1", 3), ("unused", "u1")])
"""A point from above: cm ahead and to the right of the sensor, and its colour."""
_MOST_CM = 32767.0
MOST_POINTS = 20_000


def picture(name: str, frame: int, rgb: NDArray[np.uint8]) -> bytes:
    """Return the pane of a picture of the shape (H, W, 3)."""
    height, width, _ = rgb.shape
    return _packed({"kind": "picture", "name": name, "frame": frame, "width": width, "height": height}, rgb.tobytes())


def points(name: str, frame: int, places_m: NDArray[np.floating[Any]], colours: NDArray[np.uint8]) -> bytes:
    """Return the pane of points: (N, 2) m ahead and to the right, and (N, 3) colours.

    Points farther than 327 m are cut, and more than ``MOST_POINTS`` are thinned.
    """
    every = math.ceil(len(places_m) / MOST_POINTS) or 1
    places_m, colours = places_m[::every], colours[::every]
    rows = np.zeros(len(places_m), POINT)
    rows["place"] = np.rint(np.clip(places_m * 100.0, -_MOST_CM, _MOST_CM))
    rows["colour"] = colours
    return _packed({"kind": "points", "name": name, "frame": frame, "count": len(rows)}, rows.tobytes())


def lines(name: str, frame: int, values: Sequence[tuple[str, str]]) -> bytes:
    """Return the pane of readings: pairs of a name and a value with its unit."""
    shown = [{"name": each, "value": value} for each, value in values]
    return _packed({"kind": "lines", "name": name, "frame": frame, "lines": shown}, b"")


def _packed(header: dict[str, Any], content: bytes) -> bytes:
    head = json.dumps(header).encode()
    head += b" " * (-len(head) % 4)
    return HEADER.pack(MAGIC, len(head)) + head + content
