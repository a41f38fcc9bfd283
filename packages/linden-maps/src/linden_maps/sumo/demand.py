"""A demand for a network: trips between homes and the town's edge, drawn from a seed, as many as fit the hour."""

import enum
import random
from collections.abc import Iterable, Mapping, Sequence
from typing import NamedTuple

from lxml import etree

from linden.errors import UserError
from linden_maps.sumo.bus_stops import ParkingArea
from linden_maps.sumo.net import Net, NetEdge
from linden_maps.sumo.places import SCHOOL, TRANSIT, Place, car_streets
from linden_maps.sumo.vehicle_types import KERB_MIX, MIX

BUSY_TRIPS_PER_KM = 14.0
"""Trips that begin in the busiest hour for each km of lane: an estimate, which gives Linden some 1,100 an hour."""

HOUR_SHARES = (0.10, 0.07, 0.05, 0.06, 0.12, 0.30, 0.60, 0.90, 0.80, 0.62, 0.60, 0.66,
               0.70, 0.72, 0.82, 0.94, 1.00, 1.00, 0.78, 0.58, 0.44, 0.36, 0.26, 0.17)  # fmt: skip
"""Trips of each hour of a weekday against the busiest: an estimate in the usual shape, two peaks and a flat noon."""

PURPOSES = ("out", "home", "within", "through")
"""From a home to the town's edge; the other way; from home to home; from edge to edge."""

MORNING, EVENING, ELSE = (0.40, 0.10, 0.20, 0.30), (0.12, 0.38, 0.20, 0.30), (0.25, 0.25, 0.20, 0.30)
"""Shares of the purposes before 10:00, from 15:00 to 20:00, and at all other times: estimates."""

TO_SCHOOL_H, FROM_SCHOOL_H = (8.0, 9.5), (14.0, 15.5)
"""When schools begin and end: the Linden LEAP paused in these hours (docs/reference/passengers.md)."""
SCHOOL_SHARE, TRANSIT_SHARE = 0.12, 0.06
"""Shares of the trips that bring to or fetch from a school at those hours, and a transit station at all: estimates."""
PULL_OUT_S = 5.0  # a vehicle stands at the kerb for so long before it leaves

HOME_SPEED_MPS = 12.0  # streets up to 25 mph have homes; the faster ones are arterials
MEAN_TRIP_S = 200.0  # observed on Linden: so many seconds' trips are under way at the beginning
HOUR_S = 3600.0


class Demand(NamedTuple):
    """What is to be drawn."""

    hour: float = 9.5  # of the day; the shuttle's run departs at half past nine
    duration_s: float = HOUR_S
    scale: float = 1.0
    seed: int = 0


class Trip(NamedTuple):
    """One vehicle's way. One that is under way begins somewhere between its ends."""

    depart_s: float
    start: str
    end: str
    is_under_way: bool
    from_space: str | None = None  # the parking area that it begins in
    to_space: str | None = None  # the parking area that it ends in


class HomeWard(enum.Enum):
    """The way of school children at an hour."""

    TO = "to school"
    FROM = "from school"


def school_way(hour: float) -> HomeWard | None:
    """Return whether children go to school at an hour, or come from it."""
    if TO_SCHOOL_H[0] <= hour < TO_SCHOOL_H[1]:
        return HomeWard.TO
    return HomeWard.FROM if FROM_SCHOOL_H[0] <= hour < FROM_SCHOOL_H[1] else None


def check(demand: Demand) -> None:
    """Check a demand's figures.

    Raises:
        UserError: one of them means nothing.
    """
    if not 0.0 <= demand.hour < 24.0:
        raise UserError(f"the hour is {demand.hour:g}; give one from 0 to below 24, such as 7.5 for half past seven")
    if not demand.duration_s > 0.0:
        raise UserError(f"the demand's duration is {demand.duration_s:g} s; give a time above 0")
    if not demand.scale >= 0.0:
        raise UserError(f"the demand's scale is {demand.scale:g}; give 0 or more, 1 for the usual traffic")


def trips_per_hour(net: Net, demand: Demand) -> float:
    """Return how many trips begin in an hour at that time of the day."""
    lane_km = sum(edge.length_m * len(edge.car_lanes) for edge in net.car_edges()) / 1000.0
    return BUSY_TRIPS_PER_KM * lane_km * HOUR_SHARES[int(demand.hour)] * demand.scale


def draw(net: Net, demand: Demand, places: tuple[Place, ...] = (), spaces: Sequence[ParkingArea] = ()) -> list[Trip]:
    """Return the trips of a demand in the order of their departure: those under way first.

    A trip from or to a home begins or ends in one of the ``spaces``, as long as there are free ones; other trips begin
    and end where the network ends.

    Raises:
        UserError: the network has no street to begin or end at.
    """
    check(demand)
    dice = random.Random(demand.seed)  # noqa: S311 - to be had again by its seed, not to be a secret
    homes = [edge for edge in net.car_edges() if _limit_mps(edge) <= HOME_SPEED_MPS] or list(net.car_edges())
    entries = [edge for edge in net.car_edges() if edge.start in net.outer] or homes
    exits = [edge for edge in net.car_edges() if edge.end in net.outer] or homes
    if not homes:
        raise UserError("the network has no lane for cars; a demand needs some")
    shares = MORNING if demand.hour < 10.0 else EVENING if 15.0 <= demand.hour < 20.0 else ELSE
    rate_hz = trips_per_hour(net, demand) / HOUR_S
    under_way = round(rate_hz * MEAN_TRIP_S)
    later = round(rate_hz * demand.duration_s)
    departures = [0.0] * under_way + sorted(round(dice.uniform(0.0, demand.duration_s), 2) for _ in range(later))
    schools, stations = car_streets(net, places, SCHOOL), car_streets(net, places, TRANSIT)
    likelihood = likelihoods(net.car_edges())
    kerb = _Kerb(spaces, dice)
    trips = []
    for number, depart_s in enumerate(departures):
        purpose = dice.choices(PURPOSES, shares)[0]
        starts = kerb.with_room(homes) if purpose in ("out", "within") else entries
        ends = kerb.with_room(homes) if purpose in ("home", "within") else exits
        start = drawn(starts, likelihood, dice)
        end = drawn(_elsewhere(ends, start) or homes, likelihood, dice)
        start, end = _by_place(start, end, dice, demand.hour, (schools, stations))
        is_under_way = number < under_way
        from_space = None if is_under_way or start in entries else kerb.take(start)
        to_space = None if end in exits else kerb.take(end)
        trips.append(Trip(depart_s, start.id, end.id, is_under_way, from_space, to_space))
    return trips


class _Kerb:
    """The parking spaces that are still free: each is given away once in a demand."""

    def __init__(self, spaces: Sequence[ParkingArea], dice: random.Random) -> None:
        """Begin with all ``spaces`` free."""
        self._dice = dice
        self._free: dict[str, list[str]] = {}
        for space in spaces:
            self._free.setdefault(space.edge, []).append(space.id)

    def with_room(self, edges: Sequence[NetEdge]) -> Sequence[NetEdge]:
        """Return the streets with a free space; all where none has one."""
        return [edge for edge in edges if self._free.get(edge.id)] or edges

    def take(self, edge: NetEdge) -> str | None:
        """Return a free space of a street and give it away; None where it has none."""
        free = self._free.get(edge.id)
        return free.pop(self._dice.randrange(len(free))) if free else None


def _by_place(
    start: NetEdge, end: NetEdge, dice: random.Random, hour: float, places: tuple[list[NetEdge], list[NetEdge]]
) -> tuple[NetEdge, NetEdge]:
    """Return the ends of a trip, one of them now and then at one of the ``places``: schools, then transit stations."""
    schools, stations = places
    way = school_way(hour)
    if schools and way is not None and dice.random() < SCHOOL_SHARE:
        place, is_end = dice.choice(schools), way is HomeWard.TO
    elif stations and dice.random() < TRANSIT_SHARE:
        place, is_end = dice.choice(stations), dice.random() < 0.5
    else:
        return start, end
    fits = _elsewhere([place], start) if is_end else _elsewhere([end], place)
    if not fits:
        return start, end
    return (start, place) if is_end else (place, end)


def _limit_mps(edge: NetEdge) -> float:
    return max(lane.speed_mps for lane in edge.car_lanes)


def likelihoods(edges: Iterable[NetEdge]) -> dict[str, float]:
    """How likely each edge is drawn, by its id: the longer it is and the more lanes for cars it has, the likelier."""
    return {edge.id: edge.length_m * max(1, len(edge.car_lanes)) for edge in edges}


def drawn(edges: Sequence[NetEdge], likelihood: Mapping[str, float], dice: random.Random) -> NetEdge:
    """One of the edges, by their likelihoods."""
    return dice.choices(edges, [likelihood[edge.id] for edge in edges])[0]


def _elsewhere(edges: Iterable[NetEdge], start: NetEdge) -> list[NetEdge]:
    """Return the edges to which a trip leaves the street that it begins in."""
    street, begin = start.id.lstrip("-"), start.start
    return [edge for edge in edges if edge.end != begin and edge.id.lstrip("-") != street]


def trips_file(trips: Sequence[Trip]) -> bytes:
    """SUMO's route file of the trips."""
    root = etree.Element("routes")
    for number, trip in enumerate(trips):
        at_kerb = trip.from_space is not None or trip.to_space is not None
        given = {
            "id": f"trip{number}",
            "type": KERB_MIX if at_kerb else MIX,
            "depart": f"{trip.depart_s:.2f}",
            "from": trip.start,
            "to": trip.end,
            "departLane": "best",
            "departSpeed": "max",
        }
        if trip.is_under_way:
            given |= {"departEdge": "random", "departPos": "random_free"}
        if trip.from_space is not None:
            given |= {"departPos": "stop", "departSpeed": "0"}
        element = etree.SubElement(root, "trip", given)
        for space, duration_s in ((trip.from_space, PULL_OUT_S), (trip.to_space, HOUR_S)):
            if space is not None:
                etree.SubElement(element, "stop", {"parkingArea": space, "duration": f"{duration_s:g}"})
    return etree.tostring(root, pretty_print=True, xml_declaration=True, encoding="UTF-8")
