"""Locations between the metres of the world and the centimetres of the file, without losing a bit.

A recording holds cm as 32-bit floats, which are coarser than the same number of m by up to 28 %. So the writer adds, in
a packet that CARLA skips, by how many last bits the m that come of the cm are off.
"""

import numpy as np
from numpy.typing import NDArray

F32 = NDArray[np.float32]

_CM_PER_M = np.float32(100.0)


def to_file(location_m: F32) -> tuple[F32, NDArray[np.int8]]:
    """Return the location (N, 3) in cm and the correction, in last bits of the location in m."""
    location_cm = location_m * _CM_PER_M
    off = location_m.view(np.int32) - _plain_m(location_cm).view(np.int32)
    return location_cm, off.astype(np.int8)


def from_file(location_cm: F32, ulps: NDArray[np.int8] | None) -> F32:
    """Return the location (N, 3) in m; ``ulps`` None where the file has no corrections, being CARLA's."""
    location_m = _plain_m(np.ascontiguousarray(location_cm))
    if ulps is None:
        return location_m
    exact: F32 = (location_m.view(np.int32) + ulps).view(np.float32)
    return exact


def _plain_m(location_cm: F32) -> F32:
    location_m: F32 = location_cm / _CM_PER_M
    return location_m
