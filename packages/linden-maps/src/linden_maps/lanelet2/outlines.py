"""Outlines of objects in the map's frame, at their own heights."""

import numpy as np

from linden.maps.opendrive.evaluate.pieces import F64
from linden.maps.opendrive.evaluate.tables import Tables
from linden.maps.opendrive.outlines import ring_of
from linden.maps.opendrive.roadside import RoadObject


def outline_of(tables: Tables, road: int, thing: RoadObject) -> F64:
    """Return the corners (N, 3) of an object of a road (index); of its length and width where it gives no outline."""
    ring = ring_of(tables, road, thing)
    ring[:, 2] += thing.z_offset_m
    ring[:, 2] += np.array([corner.z_m for corner in thing.outline][: len(ring)] or 0.0)
    return ring
