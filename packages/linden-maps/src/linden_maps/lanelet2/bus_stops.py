"""Bus stops: areas along the kerb (``bus_stop_area``), as autoware_lanelet2_extension has them.

An area reaches from the left edge of the lane at the kerb to the kerb, and takes the parking lane with it. The lanelets
under it refer to its regulatory element.
"""

import json
from importlib import resources
from typing import NamedTuple

import numpy as np

from linden.maps.opendrive.evaluate.pieces import F64
from linden.scenery.scene.linden_survey import placed
from linden_maps.lanelet2.draft import LaneletDraft
from linden_maps.lanelet2.model import Member
from linden_maps.lanelet2.stretches import ROAD, SHOULDER, Stretch
from linden_maps.polylines import places_at

LENGTH_M = 12.0
"""Of an area: the shuttle's 4 m twice, and room to pull in; SUMO's bus stops are as long."""
REACH_M = 8.0
"""From a stop's place to the edge of its lane."""


class KerbStop(NamedTuple):
    """A stop in OpenDRIVE's frame, near its kerb."""

    id: str
    name: str
    x_m: float
    y_m: float


def shuttle_stops(origin_deg: tuple[float, float]) -> tuple[KerbStop, ...]:
    """Return the shuttle's stops in Linden, on a map with its origin at this latitude and longitude."""
    text = (resources.files("linden") / "data" / "linden.geojson").read_text("utf-8")
    stops = [f for f in json.loads(text)["features"] if f["properties"]["feature"] == "shuttle_stop"]
    places = placed([stop["geometry"]["coordinates"] for stop in stops], origin_deg)
    return tuple(
        KerbStop(stop["properties"]["id"], stop["properties"]["name"], float(x), -float(y))
        for stop, (x, y) in zip(stops, places.tolist(), strict=True)
    )


def add_bus_stops(draft: LaneletDraft, stops: tuple[KerbStop, ...]) -> tuple[KerbStop, ...]:
    """Add an area and an element for each stop; return the stops that are far from any lane."""
    lanes = [
        (stretch, lanelet)
        for stretch, lanelet in zip(draft.network.stretches, draft.lanelet_of, strict=True)
        if stretch.subtype == ROAD and stretch.junction_id < 0
    ]
    lost = []
    for stop in stops:
        found = [(_from_edge_m(draft, lanelet, stop), nth) for nth, (_, lanelet) in enumerate(lanes)]
        distance_m, nth = min(found, default=(np.inf, -1))
        if distance_m > REACH_M:
            lost.append(stop)
        else:
            _add(draft, stop, *lanes[nth])
    return tuple(lost)


def _add(draft: LaneletDraft, stop: KerbStop, stretch: Stretch, lanelet: int) -> None:
    beside = {
        other.left: number
        for other, number in zip(draft.network.stretches, draft.lanelet_of, strict=True)
        if other.subtype == SHOULDER and other.forward == stretch.forward
    }
    kerb = beside.get(stretch.right, lanelet)  # the parking lane, where there is one
    left, right = _side(draft, lanelet, "left"), _side(draft, kerb, "right")
    ring = np.concatenate([_window(left, stop), _window(right, stop)[::-1]])
    tags = {"type": "bus_stop_area", "area": "yes", "name": stop.name, "stop_id": stop.id}
    area = draft.add_line(ring, tags, "bus stop", stop.id)
    draft.add_element("bus_stop_area", [Member("way", area, "refers")], [lanelet, kerb], "bus stop", stop.id)


def _side(draft: LaneletDraft, lanelet: int, role: str) -> F64:
    nodes = getattr(draft.bounds[lanelet], role)
    return np.array([draft.target.nodes[node][:3] for node in nodes])


def _from_edge_m(draft: LaneletDraft, lanelet: int, stop: KerbStop) -> float:
    """Return how far a stop lies from the right edge of a lane."""
    return _nearest(_side(draft, lanelet, "right"), stop)[0]


def _nearest(line: F64, stop: KerbStop) -> tuple[float, float]:
    """Return the distance of a stop from a line (N, 3) in plan, and how far along the line the nearest place is, m."""
    start, step = line[:-1, :2], np.diff(line[:, :2], axis=0)
    length = np.hypot(*step.T)
    share = (((stop.x_m, stop.y_m) - start) * step).sum(axis=1)
    share = np.clip(share / np.maximum(length, 1e-9) ** 2, 0.0, 1.0)
    away = np.hypot(*((stop.x_m, stop.y_m) - start - share[:, None] * step).T)
    best = int(np.argmin(away))
    return float(away[best]), float(length[:best].sum() + share[best] * length[best])


def _window(line: F64, stop: KerbStop) -> F64:
    """Return the part of a line about a stop, ``LENGTH_M`` long, moved along where the line ends before."""
    length = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(line[:, :2], axis=0).T))])
    half_m = 0.5 * min(LENGTH_M, float(length[-1]))
    middle_m = min(max(_nearest(line, stop)[1], half_m), float(length[-1]) - half_m)
    start_m, end_m = middle_m - half_m, middle_m + half_m
    at = np.concatenate([[start_m], length[(length > start_m + 1e-3) & (length < end_m - 1e-3)], [end_m]])
    return places_at(line, length, at)
