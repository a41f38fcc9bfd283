"""`TripEnds` extends trips that would end in sight of a simulator's vehicle; `Streets` lists the network's streets."""

from __future__ import annotations

import functools
import math
import random
from collections import defaultdict
from typing import TYPE_CHECKING

from basu.errors import UserError

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

    from basu_sumo.link import Link
    from basu_sumo.road_users import RoadUser

SIGHT_M = 150.0  # no trip ends so near to a vehicle of the simulator: the range of the longest sensors of road vehicles
LAST_EDGES = 2  # of a route: a vehicle on one of them is near its end
LOOK_STEPS = 10  # between two looks for vehicles that are near their ends
THERE_AND_BACK = 2  # edges of one street: where no other ends, the network ends
ATTEMPTS = 50  # destinations drawn for a vehicle until a route leads there


class Streets:
    """Streets for cars: ``edges`` with ``lengths_m``; the network ends behind ``exits`` and before ``entrances``."""

    def __init__(self, link: Link) -> None:
        """Read the network's streets.

        Raises:
            UserError: it has none that cars may use.
        """
        self._link = link
        with link.answering("naming its streets"):
            api = link.api
            edges = sorted(edge for edge in api.edge.getIDList() if not edge.startswith(":"))
            self.edges = [edge for edge in edges if _for_cars(api, edge)]
            self.lengths_m = [float(api.lane.getLength(f"{edge}_0")) for edge in self.edges]
            ends = {edge: (api.edge.getFromJunction(edge), api.edge.getToJunction(edge)) for edge in self.edges}
        if not self.edges:
            raise UserError("SUMO's network has no street for cars; make one with `linden map sumo`")
        ways: dict[str, list[str]] = defaultdict(list)
        for start, end in ends.values():
            ways[start].append(end)
            ways[end].append(start)
        outer = {node for node, others in ways.items() if len(set(others)) == 1 and len(others) <= THERE_AND_BACK}
        self.exits = {edge for edge in self.edges if ends[edge][1] in outer}
        self.entrances = {edge for edge in self.edges if ends[edge][0] in outer}

    def beginning_m(self, edge: str) -> tuple[float, float]:
        """Return where a street begins, in CARLA's frame."""
        x_m, y_m = self._link.api.simulation.convert2D(edge, 0.0)
        return float(x_m) - self._link.offset_m[0], self._link.offset_m[1] - float(y_m)

    def draw(self, dice: random.Random) -> str:
        """Return a street; the longer it is, the likelier."""
        edge: str = dice.choices(self.edges, self.lengths_m)[0]
        return edge


class TripEnds:
    """Gives a new destination to each vehicle that is about to end its trip in sight of a vehicle of the simulator.

    A trip that ends in a stop, such as parking, or where the network ends keeps its end.
    """

    def __init__(self, link: Link) -> None:
        """Look at no vehicle yet."""
        self._link = link
        self._dice = random.Random("trip ends")  # noqa: S311 - to be had again, not to be a secret
        self._steps = 0
        self.prolonged = 0  # trips that were given a new destination

    @functools.cached_property
    def streets(self) -> Streets:
        """The network's streets, read when they are first needed."""
        return Streets(self._link)

    def look(self, users: Mapping[str, RoadUser], viewers_m: Iterable[tuple[float, float]]) -> None:
        """Look at the vehicles near ``viewers_m``, which are places of the simulator's vehicles."""
        self._steps += 1
        places_m = list(viewers_m)
        if self._steps % LOOK_STEPS != 0 or not places_m:
            return
        for name, user in users.items():
            if not user.look.is_person and is_in_sight(user.pose[:2], places_m):
                self._prolong(name, self.streets)

    def _prolong(self, name: str, streets: Streets) -> None:
        """Give one vehicle another destination if its trip ends soon, in the midst of the streets."""
        vehicle = self._link.api.vehicle
        route, at = vehicle.getRoute(name), vehicle.getRouteIndex(name)
        if at < len(route) - LAST_EDGES or route[-1] in streets.exits or vehicle.getStops(name):
            return
        for _ in range(ATTEMPTS):
            end = streets.draw(self._dice)
            found = self._link.api.simulation.findRoute(route[-1], end, vehicle.getTypeID(name))
            if len(found.edges) > LAST_EDGES:
                vehicle.setRoute(name, [*route[max(at, 0) :], *found.edges[1:]])
                self.prolonged += 1
                return


def is_in_sight(at_m: tuple[float, ...], places_m: Iterable[tuple[float, float]], slack_m: float = 0.0) -> bool:
    """Return whether a place lies within ``SIGHT_M`` and ``slack_m`` of one of ``places_m``."""
    return any(math.dist(at_m, place_m) < SIGHT_M + slack_m for place_m in places_m)


def _for_cars(api: object, edge: str) -> bool:
    lane_api, count = api.lane, api.edge.getLaneNumber(edge)  # type: ignore[attr-defined]
    return any(_allows(lane_api.getAllowed(f"{edge}_{nth}"), lane_api.getDisallowed(f"{edge}_{nth}"))
               for nth in range(count))  # fmt: skip


def _allows(allowed: tuple[str, ...], disallowed: tuple[str, ...]) -> bool:
    return "passenger" in allowed if allowed else "passenger" not in disallowed and "all" not in disallowed
