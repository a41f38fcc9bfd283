"""``outline_of``: the outline of an OpenDRIVE object, from road or object coordinates to CARLA's frame."""

import numpy as np
from numpy.typing import NDArray

from linden.maps.opendrive.evaluate.tables import Tables
from linden.maps.opendrive.roadside import RoadObject

F64 = NDArray[np.float64]


def outline_of(tables: Tables, road_index: int, thing: RoadObject) -> F64:
    """Return an object's outline in CARLA's frame, (N, 2) in m, without a last corner that repeats the first."""
    if not thing.outline:
        return np.empty((0, 2))
    along_m = [corner.first_m if corner.is_along_road else thing.s_m for corner in thing.outline]
    aside_m = np.array([corner.second_m if corner.is_along_road else thing.t_m for corner in thing.outline])
    s_m = np.clip(along_m, 0.0, tables.road_length_m[road_index])
    pose = tables.curves.pose(np.full(len(s_m), road_index), s_m)
    local = np.array([(0.0, 0.0) if corner.is_along_road else corner[:2] for corner in thing.outline])
    cos, sin = np.cos(pose.heading_rad + thing.heading_rad), np.sin(pose.heading_rad + thing.heading_rad)
    x_m = pose.x_m - np.sin(pose.heading_rad) * aside_m + cos * local[:, 0] - sin * local[:, 1]
    y_m = pose.y_m + np.cos(pose.heading_rad) * aside_m + sin * local[:, 0] + cos * local[:, 1]
    outline = np.stack([x_m, -y_m], axis=1)
    return outline[:-1] if len(outline) > 1 and np.allclose(outline[0], outline[-1], atol=1e-3) else outline
