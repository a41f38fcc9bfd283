"""`TripStarts`: delays trips that would begin in sight of a vehicle of the simulator."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

from basu_sumo.road_users import MIRROR
from basu_sumo.trip_ends import LOOK_STEPS, is_in_sight

if TYPE_CHECKING:
    from collections.abc import Callable, Collection, Iterable, Sequence

    from basu_sumo.link import Link
    from basu_sumo.trip_ends import Streets

PARKING_AREA = 64  # flag of a stop, TraCI protocol
SLACK_M = 10.0  # beyond sight: a viewer drives on until the vehicle is on the road


class _Held(NamedTuple):
    """A vehicle that was taken off the road in the step of its departure."""

    at_m: tuple[float, float]  # CARLA's frame
    kind: str
    edges: tuple[str, ...]
    stops: tuple[Any, ...]  # SUMO's, with the fields of TraCI
    lane: int
    along_m: float


class TripStarts:
    """Holds each vehicle back that would begin its trip in sight, until its place is out of sight.

    A trip begins in sight where the network begins, and in SUMO's first step. So does a vehicle of a public line or
    with people aboard.
    """

    def __init__(self, link: Link, streets: Callable[[], Streets]) -> None:
        """Hold no vehicle yet. ``streets`` returns the network's streets, once they are needed."""
        self._link, self._streets = link, streets
        self._held: dict[str, _Held] = {}
        self._steps = 0
        self.delayed = 0  # trips that were held back

    @property
    def held(self) -> Collection[str]:
        """The vehicles that wait."""
        return self._held.keys()

    def look(self, viewers_m: Iterable[tuple[float, float]]) -> frozenset[str]:
        """Hold back what has departed in sight of ``viewers_m``, and let others depart; return the new held vehicles.

        Call it after each step of SUMO.
        """
        self._steps += 1
        places_m = list(viewers_m)
        if self._steps % LOOK_STEPS == 0:
            self._let_go(places_m)
        if not places_m or self._steps == 1:
            return frozenset()
        departed = sorted(self._link.api.simulation.getDepartedIDList())
        return frozenset(name for name in departed if not name.startswith(MIRROR) and self._hold(name, places_m))

    def _hold(self, name: str, places_m: Sequence[tuple[float, float]]) -> bool:
        """Take a vehicle off the road if it has departed in sight; return whether it was."""
        vehicle = self._link.api.vehicle
        x_m, y_m = vehicle.getPosition(name)
        at_m = (float(x_m) - self._link.offset_m[0], self._link.offset_m[1] - float(y_m))
        if not is_in_sight(at_m, places_m, SLACK_M) or vehicle.getRoadID(name) in self._streets().entrances:
            return False
        if vehicle.getLine(name) or vehicle.getPersonIDList(name):
            return False
        edges = tuple(vehicle.getRoute(name)[vehicle.getRouteIndex(name) :])
        stops = tuple(vehicle.getStops(name))
        lane, along_m = int(vehicle.getLaneIndex(name)), float(vehicle.getLanePosition(name))
        self._held[name] = _Held(at_m, vehicle.getTypeID(name), edges, stops, lane, along_m)
        vehicle.remove(name)
        self.delayed += 1
        return True

    def _let_go(self, places_m: Sequence[tuple[float, float]]) -> None:
        """Let held vehicles depart of which the place is out of sight."""
        for name in [name for name, held in self._held.items() if not is_in_sight(held.at_m, places_m, SLACK_M)]:
            self._depart(name, self._held.pop(name))

    def _depart(self, name: str, held: _Held) -> None:
        """Add a vehicle again, as it was when it departed."""
        api, route = self._link.api, f"{name} later {self._steps}"
        api.route.add(route, held.edges)
        first = held.stops[0] if held.stops else None
        parks = first is not None and bool(first.stopFlags & PARKING_AREA) and _edge(first) == held.edges[0]
        api.vehicle.add(
            name,
            route,
            typeID=held.kind,
            departLane="best" if parks else str(held.lane),
            departPos="stop" if parks else f"{held.along_m:.2f}",
            departSpeed="0" if parks else "max",
        )
        for stop in held.stops:
            place, lane = stop.stoppingPlaceID or _edge(stop), int(stop.lane.rpartition("_")[2])
            times_and_kind = stop.duration, stop.stopFlags, stop.startPos, stop.until
            api.vehicle.setStop(name, place, stop.endPos, lane, *times_and_kind)


def _edge(stop: Any) -> str:  # noqa: ANN401 - of libsumo or TraCI
    """Return the edge of a stop."""
    return str(stop.lane.rpartition("_")[0])
