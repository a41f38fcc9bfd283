"""A SUMO network as frozen values: edges with lanes, connections, nodes, and the OpenDRIVE lanes they were made of."""

from collections import defaultdict
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache, cached_property
from pathlib import Path
from types import MappingProxyType
from typing import NamedTuple

from lxml import etree
from shapely import LineString, Point

PARKING_TYPE = "parking"
NO_TRAFFIC = "all"
THERE_AND_BACK = 2  # edges of one street
WIDTH_M = 3.2  # of a lane without a width: SUMO's documentation, "Networks/SUMO Road Networks"


class NetLane(NamedTuple):
    """One lane. ``origins`` are "ROAD_LANE" of OpenDRIVE; a joined lane has several."""

    id: str
    type: str
    speed_mps: float
    length_m: float
    width_m: float
    shape: tuple[tuple[float, ...], ...]  # SUMO's frame, m
    for_cars: bool
    for_people: bool
    origins: tuple[str, ...]


class NetEdge(NamedTuple):
    """One direction of a street between two nodes. Lanes from right to left."""

    id: str
    start: str
    end: str
    lanes: tuple[NetLane, ...]

    @property
    def car_lanes(self) -> tuple[NetLane, ...]:
        """The lanes that cars may use."""
        return tuple(lane for lane in self.lanes if lane.for_cars)

    @property
    def pavements(self) -> tuple[NetLane, ...]:
        """The lanes that people alone may use."""
        return tuple(lane for lane in self.lanes if lane.for_people and not lane.for_cars)

    @property
    def length_m(self) -> float:
        """The length of its lanes, which all have the same."""
        return self.lanes[0].length_m


class NetConnection(NamedTuple):
    """One way from lane to lane over a node; ``light`` and ``link`` name the head that governs it."""

    start: str
    end: str
    start_lane: int
    end_lane: int
    light: str | None
    link: int
    direction: str
    state: str


@dataclass(frozen=True, eq=False, kw_only=True)
class Net:
    """A whole network without its internal edges. ``offset_m`` was added to OpenDRIVE's x and y."""

    edges: MappingProxyType[str, NetEdge]
    connections: tuple[NetConnection, ...]
    node_types: MappingProxyType[str, str]
    lights: frozenset[str]
    crossed: MappingProxyType[str, tuple[str, ...]]  # the edges that a crossing leads over, by the crossing's id
    crossing_middles: tuple[tuple[float, float], ...]  # SUMO's frame, m
    offset_m: tuple[float, float]

    @cached_property
    def edges_of_origin(self) -> dict[str, list[NetEdge]]:
        """The edges by the OpenDRIVE lane that one of their lanes was made of."""
        found: dict[str, list[NetEdge]] = defaultdict(list)
        for edge in self.edges.values():
            for lane in edge.lanes:
                for origin in lane.origins:
                    found[origin].append(edge)
        return found

    @cached_property
    def incoming(self) -> dict[str, list[NetEdge]]:
        """The edges with car lanes by the node that they lead to."""
        found: dict[str, list[NetEdge]] = defaultdict(list)
        for edge in self.car_edges():
            found[edge.end].append(edge)
        return found

    @cached_property
    def ends(self) -> list[tuple[float, ...]]:
        """Where the lanes of all streets end, SUMO's frame."""
        return [lane.shape[-1][:2] for edge in self.edges.values() for lane in edge.lanes]

    @cached_property
    def outer(self) -> frozenset[str]:
        """The nodes at which the network ends for cars: one street leads there, and back."""
        ways: dict[str, list[str]] = defaultdict(list)
        for edge in self.car_edges():
            ways[edge.start].append(edge.end)
            ways[edge.end].append(edge.start)
        return frozenset(
            node for node, others in ways.items() if len(set(others)) == 1 and len(others) <= THERE_AND_BACK
        )

    def car_edges(self) -> Iterator[NetEdge]:
        """Yield the edges that cars may use."""
        return (edge for edge in self.edges.values() if edge.car_lanes)


def read_net(path: Path) -> Net:
    """Read a network that netconvert wrote."""
    root = etree.parse(str(path)).getroot()
    edges = {
        str(edge.get("id")): NetEdge(
            str(edge.get("id")), str(edge.get("from")), str(edge.get("to")), tuple(_lane(e) for e in edge.iter("lane"))
        )
        for edge in root.iter("edge")
        if edge.get("function") is None
    }
    location = next(root.iter("location"))
    x_m, y_m = (float(part) for part in str(location.get("netOffset")).split(","))
    return Net(
        edges=MappingProxyType(edges),
        connections=tuple(_connection(element) for element in root.iter("connection")),
        node_types=MappingProxyType(
            {
                str(node.get("id")): str(node.get("type"))
                for node in root.iter("junction")
                if node.get("type") != "internal"
            }
        ),
        lights=frozenset(str(light.get("id")) for light in root.iter("tlLogic")),
        crossed=MappingProxyType(
            {
                str(edge.get("id")): tuple(str(edge.get("crossingEdges", "")).split())
                for edge in root.iter("edge")
                if edge.get("function") == "crossing"
            }
        ),
        crossing_middles=tuple(_middle(edge) for edge in root.iter("edge") if edge.get("function") == "crossing"),
        offset_m=(x_m, y_m),
    )


def _middle(crossing: "etree._Element") -> tuple[float, float]:
    """Return the middle between the ends of a crossing."""
    shape = _lane(next(crossing.iter("lane"))).shape
    return 0.5 * (shape[0][0] + shape[-1][0]), 0.5 * (shape[0][1] + shape[-1][1])


def _lane(element: "etree._Element") -> NetLane:
    allow, disallow = str(element.get("allow", "")).split(), str(element.get("disallow", "")).split()
    closed = NO_TRAFFIC in disallow
    origins = " ".join(str(each.get("value")) for each in element.iter("param") if each.get("key") == "origId")
    return NetLane(
        id=str(element.get("id")),
        type=str(element.get("type", "")),
        speed_mps=float(str(element.get("speed"))),
        length_m=float(str(element.get("length"))),
        width_m=float(str(element.get("width", WIDTH_M))),
        shape=tuple(tuple(float(value) for value in point.split(",")) for point in str(element.get("shape")).split()),
        for_cars=not closed and ("passenger" in allow if allow else "passenger" not in disallow),
        for_people=not closed and ("pedestrian" in allow if allow else "pedestrian" not in disallow),
        origins=tuple(dict.fromkeys(origins.split())),
    )


def _connection(element: "etree._Element") -> NetConnection:
    return NetConnection(
        start=str(element.get("from")),
        end=str(element.get("to")),
        start_lane=int(str(element.get("fromLane"))),
        end_lane=int(str(element.get("toLane"))),
        light=element.get("tl"),
        link=int(str(element.get("linkIndex", -1))),
        direction=str(element.get("dir")),
        state=str(element.get("state")),
    )


def along(lane: NetLane, x_m: float, y_m: float) -> tuple[float, float]:
    """Return how far a place lies from a lane, and how far along the lane it is."""
    line, place = _line(lane.shape), Point(x_m, y_m)
    return line.distance(place), line.project(place)


def point_at(lane: NetLane, share: float) -> tuple[float, float]:
    """Return the place at a share of a lane's length, from 0 to 1."""
    place = _line(lane.shape).interpolate(share, normalized=True)
    return place.x, place.y


@cache
def _line(shape: tuple[tuple[float, ...], ...]) -> LineString:
    return LineString([point[:2] for point in shape])
