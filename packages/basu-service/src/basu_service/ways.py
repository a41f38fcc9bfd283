"""The ways of a service's persons from door to door, as persons and cars of SUMO, with the shuttle and without it.

With the shuttle a person walks to its stop, waits, rides, and walks on from the stop where it alights. A person that
gave up walks from the stop. Without the shuttle the same person sets out at the same time from the same place. Then it
walks or drives all the way.
"""

from __future__ import annotations

import xml.etree.ElementTree as ET  # it writes only
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from basu_sumo.link import in_process
from basu_sumo.road_users import for_people

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence
    from pathlib import Path

    from basu_service.assumptions import Assumptions
    from basu_service.document import JourneyPart
    from basu_sumo.link import Link

INNER = 0.1  # of a street's length at both ends, where no door is


class Door(NamedTuple):
    """A place on a street of SUMO's network."""

    edge: str
    along_m: float


class Way(NamedTuple):
    """One person's way; times in s from the beginning of the service."""

    number: int
    home: Door
    stop: Door
    destination_stop: Door
    goal: Door
    sets_out_s: float  # it reaches its stop when the service has it come
    drives: bool  # without the shuttle


class _Network:
    """The streets with pavements of a network that SUMO has loaded."""

    def __init__(self, link: Link) -> None:
        self._api = link.api
        self._streets: dict[str, tuple[float, tuple[float, float]]] = {}  # length, and where it begins
        for edge in sorted(link.api.edge.getIDList()):
            if edge.startswith(":"):
                continue
            lanes = [f"{edge}_{nth}" for nth in range(link.api.edge.getLaneNumber(edge))]
            rights = [(link.api.lane.getAllowed(lane), link.api.lane.getDisallowed(lane)) for lane in lanes]
            cars = any("passenger" in may or (not may and "passenger" not in not_) for may, not_ in rights)
            if cars and any(for_people(*each) for each in rights):
                self._streets[edge] = link.api.lane.getLength(lanes[0]), link.api.lane.getShape(lanes[0])[0]

    def stop(self, stop_id: str) -> Door:
        """Return the place of a bus stop."""
        stop = self._api.busstop
        return Door(str(stop.getLaneID(stop_id)).rpartition("_")[0], float(stop.getStartPos(stop_id)))

    def near(self, stop: Door, reach_m: float, rng: np.random.Generator) -> Door:
        """Draw a place in a street near a stop; long streets are likelier."""
        draw, along = rng.random(2)
        at = self._api.lane.getShape(f"{stop.edge}_0")[0]
        reached = [
            (edge, length_m)
            for edge, (length_m, begin) in self._streets.items()
            if np.hypot(begin[0] - at[0], begin[1] - at[1]) <= reach_m
        ]
        lengths_m = np.cumsum([length_m for _, length_m in reached])
        edge, length_m = reached[int(np.searchsorted(lengths_m, draw * lengths_m[-1], side="right"))]
        return Door(edge, round(float((INNER + (1.0 - 2.0 * INNER) * along) * length_m), 2))

    def walk_s(self, start: Door, end: Door) -> float:
        """Return how long SUMO's router gives for a walk."""
        found = self._api.simulation.findIntermodalRoute(
            start.edge, end.edge, departPos=start.along_m, arrivalPos=end.along_m
        )
        return float(sum(stage.travelTime for stage in found))


def draw_ways(
    config: Path, journeys: Sequence[JourneyPart], stops: Sequence[str], assumed: Assumptions, seed: int
) -> list[Way]:
    """Draw home and goal of each person, and ask SUMO's router when it has to set out.

    ``stops`` are those of the service, which SUMO has as bus stops. Draws depend on the seed and the person's number.

    Raises:
        UserError, SimulatorError: SUMO cannot load the scenario, or failed.
    """
    link = in_process(config, step_s=1.0, seed=seed)
    try:
        with link.answering("drawing the ways of persons"):
            network = _Network(link)
            places = {name: network.stop(name) for name in stops}
            return [
                _way(network, number, journey, places, assumed, np.random.default_rng([seed, number]))
                for number, journey in enumerate(journeys)
            ]
    finally:
        link.close()


def _way(
    network: _Network,
    number: int,
    journey: JourneyPart,
    places: Mapping[str, Door],
    assumed: Assumptions,
    rng: np.random.Generator,
) -> Way:
    stop, destination = places[journey["origin"]], places[journey["destination"]]
    home, goal = network.near(stop, assumed.walk_reach_m, rng), network.near(destination, assumed.walk_reach_m, rng)
    sets_out_s = journey["came_s"] - network.walk_s(home, stop)
    return Way(number, home, stop, destination, goal, round(sets_out_s, 2), bool(rng.random() < assumed.car_share))


def counted(way: Way, assumed: Assumptions) -> bool:
    """Return whether a person set out after the warm-up."""
    return way.sets_out_s >= 60.0 * assumed.warm_up_min


def write_with(path: Path, ways: Sequence[Way], journeys: Sequence[JourneyPart], assumed: Assumptions) -> None:
    """Write the walks to and from the shuttle as SUMO's persons, named "to" and "from" with a number."""
    walks = []
    for way in ways:
        journey = journeys[way.number]
        if not counted(way, assumed):
            continue
        walks.append((way.sets_out_s, f"to{way.number}", way.home, way.stop))
        if journey["alighted_s"] is not None:
            walks.append((journey["alighted_s"], f"from{way.number}", way.destination_stop, way.goal))
        elif journey["gave_up_s"] is not None:
            walks.append((journey["gave_up_s"], f"from{way.number}", way.stop, way.goal))
    root = ET.Element("routes")
    for depart_s, name, start, end in sorted(walks, key=lambda each: (each[0], each[1])):
        _person(root, name, depart_s, start, end)
    _write(path, root)


def write_without(path: Path, ways: Sequence[Way], assumed: Assumptions) -> None:
    """Write the ways without the shuttle: persons named "all" walk, and vehicles named "car" drive."""
    root = ET.Element("routes")
    for way in sorted(ways, key=lambda each: (each.sets_out_s, each.number)):
        if not counted(way, assumed):
            continue
        if not way.drives:
            _person(root, f"all{way.number}", way.sets_out_s, way.home, way.goal)
            continue
        given = {
            "id": f"car{way.number}",
            "type": "traffic",
            "depart": f"{way.sets_out_s + 0.5 * assumed.car_access_s:.2f}",
            "from": way.home.edge,
            "to": way.goal.edge,
            "departLane": "best",
            "departPos": "random_free",
            "arrivalPos": "random",
        }
        ET.SubElement(root, "trip", given)
    root[:] = sorted(root, key=lambda each: float(each.attrib["depart"]))
    _write(path, root)


def _person(root: ET.Element, name: str, depart_s: float, start: Door, end: Door) -> None:
    given = {"id": name, "depart": f"{depart_s:.2f}", "departPos": f"{start.along_m:.2f}"}
    person = ET.SubElement(root, "person", given)
    ET.SubElement(person, "walk", {"from": start.edge, "to": end.edge, "arrivalPos": f"{end.along_m:.2f}"})


def _write(path: Path, root: ET.Element) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    ET.ElementTree(root).write(path, encoding="utf-8", xml_declaration=True)
