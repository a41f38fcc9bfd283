"""Outlines of OpenDRIVE objects, from road or object coordinates to the frame of the map or of CARLA."""

import numpy as np
from numpy.typing import NDArray

from linden.maps.opendrive.evaluate.tables import Tables
from linden.maps.opendrive.roadside import RoadObject

F64 = NDArray[np.float64]


def ring_of(tables: Tables, road_index: int, thing: RoadObject) -> F64:
    """Return an object's corners in OpenDRIVE's frame, (N, 3) in m, at the height of the road's reference line.

    Without an outline they follow from length and width. A last corner that repeats the first is left out.
    """
    half_x, half_y = 0.5 * thing.length_m, 0.5 * thing.width_m
    corners = [(c.first_m, c.second_m, c.is_along_road) for c in thing.outline] or [
        (x, y, False) for x, y in ((-half_x, -half_y), (half_x, -half_y), (half_x, half_y), (-half_x, half_y))
    ]
    along_m = [first if is_along else thing.s_m for first, _, is_along in corners]
    aside_m = np.array([second if is_along else thing.t_m for _, second, is_along in corners])
    s_m = np.clip(along_m, 0.0, tables.road_length_m[road_index])
    road = np.full(len(s_m), road_index)
    pose = tables.curves.pose(road, s_m)
    local = np.array([(0.0, 0.0) if is_along else (first, second) for first, second, is_along in corners])
    cos, sin = np.cos(pose.heading_rad + thing.heading_rad), np.sin(pose.heading_rad + thing.heading_rad)
    x_m = pose.x_m - np.sin(pose.heading_rad) * aside_m + cos * local[:, 0] - sin * local[:, 1]
    y_m = pose.y_m + np.cos(pose.heading_rad) * aside_m + sin * local[:, 0] + cos * local[:, 1]
    ring = np.stack([x_m, y_m, tables.elevation.value(road, s_m)], axis=1)
    return ring[:-1] if len(ring) > 1 and np.allclose(ring[0, :2], ring[-1, :2], atol=1e-3) else ring


def outline_of(tables: Tables, road_index: int, thing: RoadObject) -> F64:
    """Return an object's outline in CARLA's frame, (N, 2) in m; empty where the object gives none."""
    return ring_of(tables, road_index, thing)[:, :2] * (1.0, -1.0) if thing.outline else np.empty((0, 2))
