"""The plan of a service: rounds of a closed route, the times of each vehicle, and the check of the timetable."""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from basu.agents.builtin.perception import SHUTTLE_TOP_MPS
from basu.errors import UserError
from basu.routing.timetable import Call

if TYPE_CHECKING:
    from basu.routing.route_file import RouteDescription
    from basu.routing.timetable import Timetable

NEAREST_M = 10.0  # from one vehicle to the next at the start
CLOSED_M = 5.0  # between the first and the last point of a route that is driven round after round
FASTEST_ROUND_MPS = 6.0  # more than a shuttle's mean speed, for the number of rounds
OF_ROUND = "/"  # between the id of a stop and the number of the round, from the second on


def stop_of(identity: str) -> str:
    """Return the id of a stop without the round."""
    return identity.partition(OF_ROUND)[0]


@dataclass(frozen=True, slots=True, kw_only=True)
class ServicePlan:
    """A service on one closed route.

    Attributes:
        description: the route of one round.
        places_m: each stop's distance along the round, by the points of the route file.
        starts_m: where each vehicle begins, along the first round.
        phases_s: the time in the round at which each vehicle begins, by the timetable.
    """

    description: RouteDescription
    length_m: float
    places_m: tuple[tuple[str, float], ...]
    starts_m: tuple[float, ...]
    phases_s: tuple[float, ...]
    timetable: Timetable

    def rounds(self, lasts_s: float) -> RouteDescription:
        """Return the route of as many rounds as a vehicle can drive in a time, and one more."""
        count = 2 + int(lasts_s * FASTEST_ROUND_MPS / self.length_m)
        one, timetable = self.description, self.timetable
        points = one.points[:-1] * count + one.points[-1:]
        stops = tuple(
            mark if number == 0 else replace(mark, id=f"{mark.id}{OF_ROUND}{number + 1}")
            for number in range(count)
            for mark in one.stops
        )
        calls = tuple(
            Call(
                stop_id=call.stop_id if number == 0 else f"{call.stop_id}{OF_ROUND}{number + 1}",
                arrival_s=call.arrival_s + number * timetable.round_s,
                departure_s=call.departure_s + number * timetable.round_s,
            )
            for number in range(count)
            for call in timetable.calls
        )
        longer = replace(timetable, round_s=count * timetable.round_s, calls=calls)
        return replace(one, points=points, stops=stops, timetable=longer)

    def planned_departure_s(self, vehicle: int, stop_id: str, call: int) -> float | None:
        """Return when a vehicle is due to leave a stop for the nth time, from 0; None for a stop without a time."""
        for each in self.timetable.calls:
            if each.stop_id == stop_id:
                first_s = each.departure_s - self.phases_s[vehicle]
                if each.departure_s < self.phases_s[vehicle] - 1e-6:
                    first_s += self.timetable.round_s
                return first_s + call * self.timetable.round_s
        return None

    def promised_arrival_s(self, stop_id: str, destination_id: str, came_s: float) -> float | None:
        """Return when a person that came at a time would arrive, if all kept the timetable; None without times."""
        times = {call.stop_id: call for call in self.timetable.calls}
        if stop_id not in times or destination_id not in times:
            return None
        departures_s = [
            self.planned_departure_s(vehicle, stop_id, call)
            for vehicle in range(len(self.phases_s))
            for call in range(2 + int(came_s / self.timetable.round_s))
        ]
        leaves_s = min(each for each in departures_s if each is not None and each >= came_s)
        rides_s = (times[destination_id].arrival_s - times[stop_id].departure_s) % self.timetable.round_s
        return leaves_s + rides_s


def make_plan(description: RouteDescription, vehicles: int, apart_s: float | None = None) -> ServicePlan:
    """Plan a service of so many vehicles, which begin ``apart_s`` of the timetable apart; None: equal times.

    Raises:
        UserError: the route is no round, has no stops or timetable, or the timetable cannot be driven.
    """
    points = [(point.x_m, point.y_m) for point in description.points]
    name = f"the route '{description.id}' of {description.source}"
    if math.dist(points[0], points[-1]) > CLOSED_M:
        raise UserError(f"{name} ends {math.dist(points[0], points[-1]):.0f} m from its start; a service needs a round")
    if len(description.stops) < 2:
        raise UserError(f"{name} has {len(description.stops)} service stops; a service needs at least 2 in <stops>")
    timetable = description.timetable
    if timetable is None or len(timetable.calls) < 2:
        raise UserError(f"{name} has no timetable with calls at its stops; name one with --timetable FILE")
    along_m = [0.0]
    for one, other in itertools.pairwise(points):
        along_m.append(along_m[-1] + math.dist(one, other))
    places_m: list[tuple[str, float]] = []
    for mark in description.stops:
        from_m = places_m[-1][1] if places_m else 0.0
        places_m.append((mark.id, _nearest_m(points, along_m, (mark.point.x_m, mark.point.y_m), from_m)))
    _check_drivable(timetable, dict(places_m), along_m[-1], name)
    apart_s = timetable.round_s / vehicles if apart_s is None else apart_s
    if not 0.0 < apart_s * vehicles <= timetable.round_s:
        raise UserError(
            f"{vehicles} vehicles cannot begin {apart_s / 60:g} min apart in {timetable.round_s / 60:g} min; "
            f"--apart is more than 0 and at most {timetable.round_s / 60 / vehicles:g} min"
        )
    phases_s = tuple(vehicle * apart_s for vehicle in range(vehicles))
    starts_m = tuple(_place_at(timetable, dict(places_m), along_m[-1], phase_s) for phase_s in phases_s)
    if any(later - earlier < NEAREST_M for earlier, later in itertools.pairwise(starts_m)):
        raise UserError(
            f"two vehicles begin at the same place, because the timetable has one of them at a stop for {apart_s:g} s; "
            "choose another --apart"
        )
    return ServicePlan(
        description=description,
        length_m=along_m[-1],
        places_m=tuple(places_m),
        starts_m=starts_m,
        phases_s=phases_s,
        timetable=timetable,
    )


def _nearest_m(
    points: list[tuple[float, float]], along_m: list[float], place: tuple[float, float], from_m: float
) -> float:
    """Return where a place lies along the points, beyond ``from_m``."""
    found: list[tuple[float, float]] = []
    for number, ((x0, y0), (x1, y1)) in enumerate(itertools.pairwise(points)):
        length_m = math.hypot(x1 - x0, y1 - y0)
        if length_m == 0.0 or along_m[number + 1] < from_m:
            continue
        share = ((place[0] - x0) * (x1 - x0) + (place[1] - y0) * (y1 - y0)) / length_m**2
        share = min(1.0, max(0.0, share))
        off_m = math.dist(place, (x0 + share * (x1 - x0), y0 + share * (y1 - y0)))
        found.append((round(off_m, 3), along_m[number] + share * length_m))
    return min(found)[1]


def _check_drivable(timetable: Timetable, places_m: dict[str, float], length_m: float, name: str) -> None:
    """Check each leg of a timetable against the shuttle's highest speed.

    Raises:
        UserError: a leg needs more; straight lines between the route's points are never longer than the way.
    """
    calls = timetable.calls
    legs = [*itertools.pairwise(calls), (calls[-1], calls[0])]
    for one, other in legs:
        last = other is calls[0]
        way_m = places_m[other.stop_id] - places_m[one.stop_id] + (length_m if last else 0.0)
        takes_s = other.arrival_s - one.departure_s + (timetable.round_s if last else 0.0)
        if takes_s <= 0.0 or way_m / takes_s > SHUTTLE_TOP_MPS:
            needed = "no time at all" if takes_s <= 0.0 else f"{way_m / takes_s:.1f} m/s on average"
            raise UserError(
                f"the timetable of {name} cannot be driven: {way_m:.0f} m from {one.stop_id} to {other.stop_id} in "
                f"{max(takes_s, 0.0):.0f} s leaves {needed}, and a shuttle drives {SHUTTLE_TOP_MPS:.1f} m/s at most; "
                "give the leg more time"
            )


def _place_at(timetable: Timetable, places_m: dict[str, float], length_m: float, phase_s: float) -> float:
    """Return where along the round a vehicle is due at a time of the round."""
    marks = [(0.0, 0.0)]
    for call in timetable.calls:
        marks += [(call.arrival_s, places_m[call.stop_id]), (call.departure_s, places_m[call.stop_id])]
    marks.append((timetable.round_s, length_m))
    for (from_s, from_m), (to_s, to_m) in itertools.pairwise(marks):
        if from_s <= phase_s <= to_s and to_s > from_s:
            return from_m + (phase_s - from_s) / (to_s - from_s) * (to_m - from_m)
    return 0.0
