"""``spawn_points``: poses for new vehicles in the middle of driving lanes, in the direction of travel."""

import math

import numpy as np

from linden.background import checkpoint
from linden.geometry import from_opendrive
from linden.maps.opendrive.evaluate.tables import Tables, tables_of
from linden.maps.opendrive.model import OpenDrive, Road
from linden.protocol.values.enums import LaneType
from linden.protocol.values.space import Transform

SPACING_M = 30.0
END_MARGIN_M = 6.0  # keeps a vehicle's nose and tail out of the junction
CLEARANCE_M = 0.5  # above the road; CARLA's own towns have 0.3 to 0.6
NARROWEST_LANE_M = 2.2  # a car of 1.9 m with its mirrors


def spawn_points(opendrive: OpenDrive) -> tuple[Transform, ...]:
    """Return recommended spawn points, in the order of road id, s, lane id. Frame: CARLA's."""
    tables = tables_of(opendrive)
    places = sorted(place for index, road in enumerate(opendrive.roads) for place in _on_road(tables, index, road))
    if not places:
        return ()
    lane = np.asarray([place[3] for place in places], dtype=np.int64)
    s_m = np.asarray([place[1] for place in places])
    centres = tables.lane_centres(lane, s_m)
    points = []
    for row, x_m, y_m, z_m, heading_rad, slope, width_m in zip(lane, *centres, strict=True):
        if width_m < NARROWEST_LANE_M:
            continue
        road = tables.roads[tables.lanes["road"][row]]
        backwards = (tables.lanes["lane_id"][row] > 0) == road.is_right_hand
        along_rad = math.remainder(heading_rad + (math.pi if backwards else 0.0), math.tau)
        pose = from_opendrive(float(x_m), float(y_m), float(z_m) + CLEARANCE_M, along_rad)
        pitch = math.degrees(math.atan(-slope if backwards else slope))
        points.append(pose._replace(rotation=pose.rotation._replace(pitch=pitch)))
    return tuple(points)


def _on_road(tables: Tables, road_index: int, road: Road) -> list[tuple[int, float, int, int]]:
    """Return (road id, s, lane id, lane row) of every candidate on an ordinary road."""
    usable_m = road.length_m - 2.0 * END_MARGIN_M
    if road.is_in_junction or usable_m < 0.0:
        return []
    count = int(usable_m // SPACING_M) + 1
    first_m = END_MARGIN_M + (usable_m - (count - 1) * SPACING_M) / 2.0
    found = []
    checkpoint()
    for s_m in (first_m + nth * SPACING_M for nth in range(count)):
        section_index = road.section_index_at(s_m)
        found += [
            (road.id, s_m, lane.id, tables.lane_row[road_index, section_index, lane.id])
            for lane in road.sections[section_index].lanes
            if lane.type is LaneType.DRIVING and lane.id != 0
        ]
    return found
