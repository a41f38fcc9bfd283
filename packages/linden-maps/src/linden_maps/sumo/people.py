"""People on foot: walks between homes, schools and transit stations, and passengers of the shuttle at its stops."""

import math
import random
from collections.abc import Sequence
from typing import NamedTuple

from lxml import etree

from linden_maps.sumo.bus_stops import BusStop
from linden_maps.sumo.demand import HOUR_S, HOUR_SHARES, Demand, HomeWard, drawn, likelihoods, school_way
from linden_maps.sumo.net import Net, NetEdge
from linden_maps.sumo.places import SCHOOL, TRANSIT, Place, pavements

BUSY_WALKS_PER_KM = 8.0
"""Walks that begin in the busiest hour for each km of pavement: an estimate, some 520 an hour in Linden."""
WALK_REACH_M = 800.0  # as the crow flies: ten minutes, which planners call the reach of a walk
MEAN_WALK_S = 330.0  # so many seconds' walks are under way at the beginning: 450 m at 1.35 m/s
SCHOOL_SHARE, TRANSIT_SHARE = 0.35, 0.25
"""Of the walks while a school begins or ends, and of all other walks: estimates."""

BUSY_RIDERS_PER_STOP = 6.0
"""Passengers that come to each stop in the busiest hour: an estimate, more than the Linden LEAP had."""
HEADWAY_S = 720.0  # of the Linden LEAP: passengers that have come since the last shuttle wait at the beginning
STOP_REACH_M = 400.0  # of a walk to a stop: Transit Capacity and Quality of Service Manual, 3rd ed., chapter 5
FARTHER_M = 100.0  # no passenger rides to the other side of the street
LINE = "shuttle"
EPSILON_S = "0.1"  # a person that waits from the beginning stops for this long first: a ride needs a stage before it


class Walk(NamedTuple):
    """One person's way on foot between two places along streets."""

    depart_s: float
    start: str
    start_m: float
    end: str
    end_m: float


class Rider(NamedTuple):
    """A passenger of the shuttle; ``start`` is None for one that waits from the beginning."""

    depart_s: float
    start: str | None
    start_m: float
    stop_id: str
    destination_id: str


def draw_walks(net: Net, demand: Demand, places: tuple[Place, ...]) -> list[Walk]:
    """Return the walks of a demand in the order of their departure: those under way first. None without pavements."""
    streets = [edge for edge in net.edges.values() if edge.pavements]
    if not streets:
        return []
    dice = random.Random(f"walks {demand.seed}")  # noqa: S311 - to be had again by its seed, not to be a secret
    pavement_km = sum(edge.length_m for edge in streets) / 1000.0
    rate_hz = BUSY_WALKS_PER_KM * pavement_km * HOUR_SHARES[int(demand.hour)] * demand.scale / HOUR_S
    later = sorted(dice.uniform(0.0, demand.duration_s) for _ in range(round(rate_hz * demand.duration_s)))
    schools, stations = pavements(net, places, SCHOOL), pavements(net, places, TRANSIT)
    likelihood = likelihoods(streets)
    walks = []
    for depart_s in [0.0] * round(rate_hz * MEAN_WALK_S) + later:
        goal = _goal(dice, demand, schools, stations)
        start = drawn(_near(streets, goal, WALK_REACH_M) if goal else streets, likelihood, dice)
        end = goal or drawn(
            [each for each in _near(streets, start, WALK_REACH_M) if each is not start] or [start], likelihood, dice
        )
        if school_way(demand.hour) is HomeWard.FROM or (goal in stations and dice.random() < 0.5):
            start, end = end, start
        walks.append(Walk(depart_s, start.id, _somewhere(start, dice), end.id, _somewhere(end, dice)))
    return walks


def _goal(
    dice: random.Random, demand: Demand, schools: Sequence[NetEdge], stations: Sequence[NetEdge]
) -> NetEdge | None:
    """Return the school or station of a walk; None for a walk between homes."""
    if schools and school_way(demand.hour) is not None and dice.random() < SCHOOL_SHARE:
        return dice.choice(schools)
    return dice.choice(stations) if stations and dice.random() < TRANSIT_SHARE else None


def draw_riders(net: Net, demand: Demand, stops: Sequence[BusStop]) -> list[Rider]:
    """Return the passengers of a demand in the order of their departure; ``stops`` are in the order of the route."""
    dice = random.Random(f"riders {demand.seed}")  # noqa: S311 - as above
    rate_hz = BUSY_RIDERS_PER_STOP * HOUR_SHARES[int(demand.hour)] * demand.scale / HOUR_S
    streets = [edge for edge in net.edges.values() if edge.pavements]
    likelihood = likelihoods(streets)
    riders = []
    for number, stop in enumerate(stops):
        ahead = [each for each in stops[number + 1 :] if math.dist(each.at_m, stop.at_m) > FARTHER_M]
        here = net.edges[stop.lane.rpartition("_")[0]]
        if not ahead or not here.pavements:
            continue
        waiting = _count(dice, rate_hz * HEADWAY_S)
        riders += [Rider(0.0, None, 0.0, stop.id, dice.choice(ahead).id) for _ in range(waiting)]
        for _ in range(_count(dice, rate_hz * demand.duration_s)):
            start = drawn(_near(streets, here, STOP_REACH_M), likelihood, dice)
            depart_s = dice.uniform(0.0, demand.duration_s)
            riders.append(Rider(depart_s, start.id, _somewhere(start, dice), stop.id, dice.choice(ahead).id))
    return sorted(riders, key=lambda rider: rider.depart_s)


def people_file(walks: Sequence[Walk], riders: Sequence[Rider], stops: Sequence[BusStop]) -> bytes:
    """SUMO's route file of all people, in the order of their departure."""
    root = etree.Element("routes")
    edges = {stop.id: stop.lane.rpartition("_")[0] for stop in stops}
    for nth, walk in sorted(enumerate(walks), key=lambda each: each[1].depart_s):
        person = _person(root, f"walk{nth}", walk.depart_s, walk.start_m)
        ways = {"from": walk.start, "to": walk.end, "arrivalPos": f"{walk.end_m:.2f}"}
        etree.SubElement(person, "walk", ways)
    for nth, rider in enumerate(riders):
        person = _person(root, f"rider{nth}", rider.depart_s, rider.start_m)
        if rider.start is None:
            etree.SubElement(person, "stop", {"busStop": rider.stop_id, "duration": EPSILON_S})
        else:
            etree.SubElement(person, "walk", {"from": rider.start, "busStop": rider.stop_id})
        etree.SubElement(person, "ride", {"busStop": rider.destination_id, "lines": LINE})
        etree.SubElement(person, "walk", {"to": edges[rider.destination_id]})
    root[:] = sorted(root, key=lambda person: float(str(person.get("depart"))))
    return etree.tostring(root, pretty_print=True, xml_declaration=True, encoding="UTF-8")


def _person(root: "etree._Element", name: str, depart_s: float, at_m: float) -> "etree._Element":
    return etree.SubElement(root, "person", {"id": name, "depart": f"{depart_s:.2f}", "departPos": f"{at_m:.2f}"})


def _near(streets: Sequence[NetEdge], edge: NetEdge, reach_m: float) -> list[NetEdge]:
    """Return the streets that begin within reach of where an edge begins; the edge itself is one."""
    at = edge.lanes[0].shape[0][:2]
    return [each for each in streets if math.dist(each.lanes[0].shape[0][:2], at) <= reach_m]


def _somewhere(edge: NetEdge, dice: random.Random) -> float:
    """Return a place along an edge, m from its beginning."""
    return round(dice.uniform(0.1, 0.9) * edge.length_m, 2)


def _count(dice: random.Random, mean: float) -> int:
    """Return a number with this mean: the whole part, and one more as often as the rest says."""
    return int(mean) + (dice.random() < mean - int(mean))
