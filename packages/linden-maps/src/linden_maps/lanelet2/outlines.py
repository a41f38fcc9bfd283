"""Outlines of objects in the map's frame."""

import numpy as np

from linden.maps.opendrive.evaluate.pieces import F64
from linden.maps.opendrive.evaluate.tables import Tables
from linden.maps.opendrive.roadside import RoadObject

_SAME_M = 1e-3


def outline_of(tables: Tables, road: int, thing: RoadObject) -> F64:
    """Return the corners (N, 3) of an object of a road (index); of its length and width where it gives no outline."""
    corners = [(c.first_m, c.second_m, c.z_m, c.is_along_road) for c in thing.outline] or [
        (0.5 * u * thing.length_m, 0.5 * v * thing.width_m, 0.0, False) for u, v in ((-1, -1), (1, -1), (1, 1), (-1, 1))
    ]
    along = [first if is_along else thing.s_m for first, _, _, is_along in corners]
    aside = np.array([second if is_along else thing.t_m for _, second, _, is_along in corners])
    s_m = np.clip(along, 0.0, tables.road_length_m[road])
    row = np.full(len(s_m), road)
    pose = tables.curves.pose(row, s_m)
    local = np.array([(0.0, 0.0) if is_along else (first, second) for first, second, _, is_along in corners])
    turned = pose.heading_rad + thing.heading_rad
    x_m = pose.x_m - np.sin(pose.heading_rad) * aside + np.cos(turned) * local[:, 0] - np.sin(turned) * local[:, 1]
    y_m = pose.y_m + np.cos(pose.heading_rad) * aside + np.sin(turned) * local[:, 0] + np.cos(turned) * local[:, 1]
    z_m = tables.elevation.value(row, s_m) + thing.z_offset_m + np.array([corner[2] for corner in corners])
    ring = np.stack([x_m, y_m, z_m], axis=1)
    return ring[:-1] if len(ring) > 2 and np.allclose(ring[0, :2], ring[-1, :2], atol=_SAME_M) else ring
