"""Bus stops on a SUMO network, where a route file has the shuttle's stops."""

import math
from pathlib import Path
from typing import NamedTuple

from lxml import etree

from linden.authoring.sumo.net import Net, NetLane
from linden.errors import UserError

LENGTH_M = 12.0  # of a bus stop: the shuttle's 4 m twice, and room to pull in
REACH_M = 8.0  # from a stop's place to the middle of its lane


class RouteStop(NamedTuple):
    """A stop of a route file, in CARLA's frame."""

    id: str
    name: str
    x_m: float
    y_m: float


def read_stops(path: Path) -> tuple[RouteStop, ...]:
    """The ``<stop id x y>`` elements of a route file.

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


def stops_file(net: Net, stops: tuple[RouteStop, ...]) -> tuple[bytes, tuple[RouteStop, ...]]:
    """SUMO's additional file with a bus stop for each of ``stops``, and the stops far from any lane for cars."""
    root = etree.Element("additional")
    lost = []
    for stop in stops:
        x_m, y_m = stop.x_m + net.offset_m[0], -stop.y_m + net.offset_m[1]
        distance_m, at_m, lane = min(
            (( *_along(lane, x_m, y_m), lane) for edge in net.car_edges() for lane in edge.car_lanes[:1]),
            key=lambda found: found[0],
        )  # fmt: skip
        if distance_m > REACH_M:
            lost.append(stop)
            continue
        half_m = 0.5 * min(LENGTH_M, lane.length_m - 0.2)
        middle_m = min(max(at_m, half_m + 0.1), lane.length_m - half_m - 0.1)
        given = {
            "id": stop.id,
            "name": stop.name,
            "lane": lane.id,
            "startPos": f"{middle_m - half_m:.2f}",
            "endPos": f"{middle_m + half_m:.2f}",
        }
        etree.SubElement(root, "busStop", given)
    return etree.tostring(root, pretty_print=True, xml_declaration=True, encoding="UTF-8"), tuple(lost)


def _along(lane: NetLane, x_m: float, y_m: float) -> tuple[float, float]:
    """How far a place lies from a lane, and how far along the lane it is."""
    best, passed_m = (math.inf, 0.0), 0.0
    for first, second in zip(lane.shape, lane.shape[1:], strict=False):
        dx_m, dy_m = second[0] - first[0], second[1] - first[1]
        length_m = math.hypot(dx_m, dy_m)
        if length_m > 0.0:
            share = ((x_m - first[0]) * dx_m + (y_m - first[1]) * dy_m) / length_m**2
            share = min(max(share, 0.0), 1.0)
            away_m = math.hypot(first[0] + share * dx_m - x_m, first[1] + share * dy_m - y_m)
            best = min(best, (away_m, passed_m + share * length_m))
        passed_m += length_m
    return best
