"""The lanes of a map as a directed graph, with posted limits and lane-section ends from the OpenDRIVE text.

A node is a lane of one lane section; an edge leads to a lane that a vehicle reaches by driving straight on, its weight
is the length of the lane that is left behind. Lane changes are not part of it: a shuttle's way keeps to its lane.
"""

from __future__ import annotations

import math
from bisect import bisect_right
from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from lxml import etree

if TYPE_CHECKING:
    from collections.abc import Iterable

    import carla
    import networkx as nx
    from numpy.typing import NDArray


MPS_PER_UNIT = {"mph": 0.44704, "km/h": 1.0 / 3.6, "m/s": 1.0}  # OpenDRIVE 1.4, e_unitSpeed; without unit: m/s


@dataclass(frozen=True, slots=True)
class Road:
    """One road; places are m along its reference line, ascending, speeds m/s."""

    length_m: float
    name: str  # of the street; empty for the connections within a junction
    section_starts_m: tuple[float, ...]
    limit_starts_m: tuple[float, ...]
    limits_mps: tuple[float, ...]  # nan where a stretch posts none

    def limit_at(self, s_m: float) -> float:
        """Return the posted limit in m/s at ``s_m``, nan where there is none."""
        index = bisect_right(self.limit_starts_m, s_m) - 1
        return self.limits_mps[index] if index >= 0 else math.nan

    def section_extent_m(self, section: int) -> tuple[float, float]:
        """Return where a lane section begins and ends."""
        ends_m = (*self.section_starts_m[1:], self.length_m)
        return self.section_starts_m[section], ends_m[section]


def read_roads(opendrive: str) -> dict[int, Road]:
    """Read the roads of an OpenDRIVE text, by id."""
    root = etree.fromstring(
        opendrive.encode(), etree.XMLParser(resolve_entities=False, no_network=True, huge_tree=True)
    )
    return {int(element.get("id", "-1")): _road(element) for element in root.iterfind("road")}


def _road(element: etree._Element) -> Road:
    """Read one ``<road>`` of an OpenDRIVE file."""
    posted = sorted((s, _limit_mps(e.find("speed"))) for s, e in _places(element.iterfind("type")))
    return Road(
        length_m=float(element.get("length", "0")),
        name=element.get("name", "") if element.get("junction", "-1") == "-1" else "",
        section_starts_m=tuple(sorted(s for s, _ in _places(element.iterfind("lanes/laneSection")))),
        limit_starts_m=tuple(s for s, _ in posted),
        limits_mps=tuple(limit for _, limit in posted),
    )


def _places(elements: Iterable[etree._Element]) -> list[tuple[float, etree._Element]]:
    """Elements with the place along the road that their ``s`` gives."""
    return [(float(element.get("s", "0")), element) for element in elements]


def _limit_mps(speed: etree._Element | None) -> float:
    """Return the value of a ``<speed>`` element in m/s; nan for none, 'no limit' and 'undefined'."""
    if speed is None:
        return math.nan
    try:
        return float(speed.get("max", "")) * MPS_PER_UNIT.get(speed.get("unit", "m/s"), math.nan)
    except ValueError:
        return math.nan


STEP_OVER_M = 0.1  # from just before a lane's end to just behind it
SAMPLE_SPACING_M = 2.0  # of the points at which lanes are looked up by position


class LaneKey(NamedTuple):
    """A lane of one section of one road; ``lane`` is negative where it runs with the road's reference line."""

    road: int
    section: int
    lane: int


class Street(NamedTuple):
    """A lane as a picture of the town shows it."""

    points_m: NDArray[np.float64]  # (K, 2) of its centre line, CARLA frame
    name: str  # of its road


@dataclass(frozen=True, slots=True)
class LaneGraph:
    """All driving lanes of a map, with points on them to find them by (M samples)."""

    graph: nx.DiGraph[LaneKey]
    keys: tuple[LaneKey, ...]  # (K,) the lanes that have samples
    key_of_sample: NDArray[np.int64]  # (M,) index into ``keys``
    s_m: NDArray[np.float64]  # (M,) along the road's reference line
    points_m: NDArray[np.float64]  # (M, 3) CARLA frame
    yaw_rad: NDArray[np.float64]  # (M,) of the lane, CARLA frame
    roads: dict[int, Road]

    def streets(self) -> list[Street]:
        """Return the lanes as a picture of the town shows them."""
        order = np.lexsort((self.s_m, self.key_of_sample))
        cuts = np.flatnonzero(np.diff(self.key_of_sample[order])) + 1
        return [
            Street(self.points_m[lane, :2], self.roads[self.keys[self.key_of_sample[lane[0]]].road].name)
            for lane in np.split(order, cuts)
        ]


def key_of(waypoint: carla.Waypoint) -> LaneKey:
    """Return the lane that a ``carla.Waypoint`` lies on."""
    return LaneKey(waypoint.road_id, waypoint.section_id, waypoint.lane_id)


_KEPT = 4  # maps with their lanes, the newest
_built: dict[str, LaneGraph] = {}  # by OpenDRIVE text


def build(carla_map: carla.Map) -> LaneGraph:
    """Return the graph of a ``carla.Map``, the same one for maps with one OpenDRIVE text.

    Making it takes some tenths of a second for a city quarter. No caller changes it.
    """
    text = carla_map.to_opendrive()
    if text not in _built:
        while len(_built) >= _KEPT:
            del _built[next(iter(_built))]
        _built[text] = _graph_of(carla_map, text)
    return _built[text]


def _graph_of(carla_map: carla.Map, opendrive: str) -> LaneGraph:
    """Make the graph of a ``carla.Map`` with this OpenDRIVE text."""
    roads = read_roads(opendrive)
    keys: dict[LaneKey, int] = {}
    key_of_sample, s_m, poses = [], [], []
    for waypoint in carla_map.generate_waypoints(SAMPLE_SPACING_M):
        key_of_sample.append(keys.setdefault(key_of(waypoint), len(keys)))
        s_m.append(waypoint.s)
        transform = waypoint.transform
        at = transform.location
        poses.append((at.x, at.y, at.z, transform.rotation.yaw))
    pose = np.array(poses, dtype=np.float64).reshape(-1, 4)
    return LaneGraph(
        graph=_connections(carla_map, roads),
        keys=tuple(keys),
        key_of_sample=np.array(key_of_sample, dtype=np.int64),
        s_m=np.array(s_m, dtype=np.float64),
        points_m=pose[:, :3],
        yaw_rad=np.radians(pose[:, 3]),
        roads=roads,
    )


def _connections(carla_map: carla.Map, roads: dict[int, Road]) -> nx.DiGraph[LaneKey]:
    """Edges from the client's topology, and from the lane ends that the topology passes over."""
    import networkx as nx  # noqa: PLC0415 - a quarter of the imports of an agent's process, which makes no graph

    graph: nx.DiGraph[LaneKey] = nx.DiGraph()
    known: dict[LaneKey, None] = {}

    def connect(tail: LaneKey, head: LaneKey) -> None:
        known.update({tail: None, head: None})
        begin_m, end_m = roads[tail.road].section_extent_m(tail.section)
        graph.add_edge(tail, head, weight=end_m - begin_m)

    for entry, following in carla_map.get_topology():
        connect(key_of(entry), key_of(following))
    # the topology begins at roads only: inner lane sections appear in it as followers, and are continued here
    unexplored = [key for key in known if graph.out_degree(key) == 0]
    while unexplored:
        key = unexplored.pop()
        for following in _followers(carla_map, roads[key.road], key):
            if following not in known:
                unexplored.append(following)
            connect(key, following)
    return graph


def _followers(carla_map: carla.Map, road: Road, key: LaneKey) -> list[LaneKey]:
    """Return the lanes that come after the end of a lane; empty at a dead end."""
    begin_m, end_m = road.section_extent_m(key.section)
    last_s_m = end_m - STEP_OVER_M / 2.0 if key.lane < 0 else begin_m + STEP_OVER_M / 2.0
    last = carla_map.get_waypoint_xodr(key.road, key.lane, last_s_m)
    found = [] if last is None else [key_of(waypoint) for waypoint in last.next(STEP_OVER_M)]
    return [following for following in found if following != key]
