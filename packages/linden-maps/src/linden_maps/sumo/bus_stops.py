"""Bus stops on a SUMO network, where a route file has the shuttle's stops; parking areas along its parking lanes."""

from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np
from lxml import etree

from linden.errors import UserError
from linden_maps.sumo.net import PARKING_TYPE, Net, along, point_at

LENGTH_M = 12.0  # of a bus stop: the shuttle's 4 m twice, and room to pull in
SPACE_M, CORNER_M = 6.7, 10.0
"""A space at the kerb is 22 feet long; none lies near a corner (Manual on Uniform Traffic Control Devices, 3B.19)."""
STOP_CLEAR_M = 24.0  # of a bus stop: room for the shuttle to pull in and out
REACH_M = 8.0  # from a stop's place to the middle of its lane


class RouteStop(NamedTuple):
    """A stop of a route file, in CARLA's frame."""

    id: str
    name: str
    x_m: float
    y_m: float


def read_stops(path: Path) -> tuple[RouteStop, ...]:
    """Return the ``<stop id x y>`` elements of a route file.

    Raises:
        UserError: it cannot be read, or a stop lacks its place.
    """
    try:
        root = etree.parse(str(path)).getroot()
        return tuple(
            RouteStop(
                str(stop.attrib["id"]), str(stop.get("name", "")), float(stop.attrib["x"]), float(stop.attrib["y"])
            )
            for stop in root.iter("stop")
        )
    except (OSError, etree.XMLSyntaxError) as error:
        raise UserError(f"cannot read the stops of {path}: {error}") from None
    except (KeyError, ValueError) as error:
        raise UserError(f"{path}: a <stop> needs id, x and y: {error}") from None


class ParkingArea(NamedTuple):
    """One parking space at the roadside: the lane beside it, from and to along the lane, the space's width."""

    id: str
    edge: str
    lane: str
    from_m: float
    to_m: float
    width_m: float


def parking_areas(net: Net, taken_m: Sequence[tuple[float, float, float]] = ()) -> tuple[ParkingArea, ...]:
    """Return the spaces of each parking lane beside a lane for cars; none near the ends of the street.

    ``taken_m`` are x and y in SUMO's frame, and the radius about them, in which nothing may park. Each space is an
    area of its own, so that a demand can choose one. Within an area, SUMO gives the next free space to each arrival.
    """
    taken = np.asarray(taken_m, np.float64).reshape(-1, 3)
    areas = []
    for edge in net.car_edges():
        lane = edge.car_lanes[0]
        beside = edge.lanes[max(0, edge.lanes.index(lane) - 1)]
        if beside.type != PARKING_TYPE:
            continue
        for number in range(int((lane.length_m - 2.0 * CORNER_M) / SPACE_M)):
            from_m = CORNER_M + number * SPACE_M
            middle_m = point_at(beside, (from_m + 0.5 * SPACE_M) / lane.length_m)
            if not (np.hypot(*(taken[:, :2] - middle_m).T) < taken[:, 2] + 0.5 * SPACE_M).any():
                name = f"parking{edge.id}.{number}"
                areas.append(ParkingArea(name, edge.id, lane.id, from_m, from_m + SPACE_M, beside.width_m))
    return tuple(areas)


class BusStop(NamedTuple):
    """A stop on SUMO's network: its lane, from and to along the lane, its place in SUMO's frame."""

    id: str
    name: str
    lane: str
    from_m: float
    to_m: float
    at_m: tuple[float, float]


def bus_stops(net: Net, stops: tuple[RouteStop, ...]) -> tuple[tuple[BusStop, ...], tuple[RouteStop, ...]]:
    """Return a bus stop for each of ``stops``, and the stops far from any lane for cars."""
    found, lost = [], []
    for stop in stops:
        x_m, y_m = stop.x_m + net.offset_m[0], -stop.y_m + net.offset_m[1]
        distance_m, at_m, lane = min(
            (( *along(lane, x_m, y_m), lane) for edge in net.car_edges() for lane in edge.car_lanes[:1]),
            key=lambda found: found[0],
        )  # fmt: skip
        if distance_m > REACH_M:
            lost.append(stop)
            continue
        half_m = 0.5 * min(LENGTH_M, lane.length_m - 0.2)
        middle_m = min(max(at_m, half_m + 0.1), lane.length_m - half_m - 0.1)
        found.append(BusStop(stop.id, stop.name, lane.id, middle_m - half_m, middle_m + half_m, (x_m, y_m)))
    return tuple(found), tuple(lost)


def stops_file(stops: tuple[BusStop, ...], areas: tuple[ParkingArea, ...]) -> bytes:
    """SUMO's additional file with the bus stops and the parking areas."""
    root = etree.Element("additional")
    for stop in stops:
        given = {"id": stop.id, "name": stop.name, "lane": stop.lane}
        along_lane = {"startPos": f"{stop.from_m:.2f}", "endPos": f"{stop.to_m:.2f}"}
        etree.SubElement(root, "busStop", given | along_lane)
    for area in areas:
        given = {"id": area.id, "lane": area.lane, "roadsideCapacity": "1", "width": f"{area.width_m:.2f}"}
        along_lane = {"startPos": f"{area.from_m:.2f}", "endPos": f"{area.to_m:.2f}"}
        etree.SubElement(root, "parkingArea", given | along_lane)
    return etree.tostring(root, pretty_print=True, xml_declaration=True, encoding="UTF-8")
