"""The poses of one frame as the page reads them: a header and 32 bytes for each actor, little-endian.

``page/timeline.js`` reads the same layout. Live worlds and recorded drives are written in it alike.
"""

import struct
from typing import Any

import numpy as np
from numpy.typing import NDArray

MAGIC = 0x31574C57  # "WLW1"
HEADER = struct.Struct("<IIdII")
"""Magic, frame, time in s, number of rows, flags."""
JUMPS = 1
"""Flag: the world has changed at once, so the page does not interpolate from the frame before."""

POSE = np.dtype(
    [
        ("id", "<u4"),
        ("place", "<f4", 3),  # m, CARLA's axes
        ("rotation", "<i2", 3),  # pitch, yaw, roll in 180/32767 degrees
        ("lights", "<u2"),  # bits of VehicleLightState
        ("speed", "<i2"),  # cm/s
        ("steer", "i1"),  # of the front wheels, 0.01 rad to the right
        ("throttle", "u1"),  # of 255
        ("brake", "u1"),  # of 255
        ("limit", "u1"),  # km/h, 0 for none
        ("state", "u1"),  # bits of STATE
        ("ghost", "u1"),  # which run of a comparison the actor belongs to, 0 for the first
    ]
)
assert POSE.itemsize == 32
DEAD, REVERSES, BY_HAND = 1, 2, 4
"""Bits of ``state``: a dead walker, the reverse gear, a person at the wheel."""
_MOST = 32767.0


def turns(degrees: NDArray[np.floating[Any]]) -> NDArray[np.int16]:
    """Return angles as the page reads them; any number of turns is the same angle."""
    shares = degrees * (1.0 / 360.0)
    shares -= np.rint(shares)
    packed: NDArray[np.int16] = np.rint(shares * (2.0 * _MOST)).astype(np.int16)
    return packed


def message(frame: int, t_s: float, *rows: NDArray[Any], jumps: bool = False) -> bytes:
    """Return the bytes of one frame; ``rows`` are arrays of rows, one behind the other."""
    header = HEADER.pack(MAGIC, frame, t_s, sum(map(len, rows)), JUMPS if jumps else 0)
    return b"".join([header, *(part.tobytes() for part in rows)])
