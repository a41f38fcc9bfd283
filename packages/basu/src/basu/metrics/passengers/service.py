"""The service as its passengers met it: arrival, dwell and headway at each stop against the route's timetable.

A vehicle is on time from one minute before to five minutes after the planned time: Transit Capacity and Quality of
Service Manual, 3rd ed. (TCRP Report 165, 2013), chapter 5, on-time performance. One run shows one vehicle; its headway
is to a vehicle before it that keeps the timetable.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from basu.metrics.path_following import SERVED_M, serving

if TYPE_CHECKING:
    from collections.abc import Sequence

    from basu.records.history import History
    from basu.records.history.sumo import Passenger
    from basu.routing import Stop
    from basu.routing.timetable import Call

EARLY_S, LATE_S = 60.0, 300.0
BOARDING_S = 5.0
"""Least rest at a stop in which a person can board: doors need 2 to 5 s, a person some 3 s (TCRP Report 165, chapter 6,
quoted from memory). BASU's own drivers rest for 10 s."""


CAPACITY = 12
"""Passengers of an EasyMile EZ10, seated and standing: the manufacturer's figure."""
ONE_BOARDS_S, ONE_ALIGHTS_S = 2.5, 2.0
"""For one passenger through one door without a fare: within the ranges of the Transit Capacity and Quality of Service
Manual, 3rd ed. (TCRP Report 165, 2013), chapter 6, passenger service times."""


class Visit(NamedTuple):
    """One stop; times in s from the run's beginning, which is the round's departure; None where there is none."""

    stop_id: str
    name: str
    served: bool  # as `metrics.arrival` has it
    arrival_s: float | None  # when it came to rest there
    departure_s: float | None  # when it moved on; None where it did not
    dwell_s: float | None
    planned_arrival_s: float | None  # None without a timetable
    planned_departure_s: float | None
    delay_s: float | None  # of the arrival, negative for early
    headway_s: float | None  # to a vehicle before it that is on time
    on_time: bool | None
    waiting: int | None = None  # persons that came before the vehicle left; None for a run without SUMO
    boarded: int | None = None
    left_behind: int | None = None
    alighted: int | None = None
    mean_wait_s: float | None = None  # of the passengers that boarded


def time_to_board(visit: Visit) -> bool:
    """Return whether the vehicle rested long enough to board; a rest that lasts to the end of the record does."""
    return visit.served and (visit.dwell_s is None or visit.dwell_s >= BOARDING_S)


def fault_of(visit: Visit) -> str | None:
    """Return what was wrong with the service at a stop, in words; None where nothing was."""
    if not visit.served:
        return "was passed"
    if not time_to_board(visit):
        return f"was left after {visit.dwell_s:.1f} s, and boarding takes {BOARDING_S:.0f} s"
    if visit.left_behind:
        return f"was left with {visit.left_behind} persons behind"
    left_s, planned_s = visit.departure_s, visit.planned_departure_s
    if left_s is not None and planned_s is not None and left_s < planned_s - EARLY_S:
        return f"was left {planned_s - left_s:.0f} s early"
    return "was not served on time" if visit.on_time is False else None


def service(history: History) -> tuple[Visit, ...]:
    """Each stop of the route, in order."""
    timetable = history.facts.route.timetable
    calls = {} if timetable is None else {call.stop_id: call for call in timetable.calls}
    headway_s = None if timetable is None else timetable.headway_s
    visits = (_visit(history, stop, calls.get(stop.id), headway_s) for stop in history.facts.route.stops)
    return tuple(
        _with_passengers(history, history.sumo.passengers, stop, visit) if history.sumo is not None else visit
        for stop, visit in zip(history.facts.route.stops, visits, strict=True)
    )


def _with_passengers(history: History, passengers: Sequence[Passenger], stop: Stop, visit: Visit) -> Visit:
    """A visit with its passengers: left behind is a person that stood there when the vehicle left or passed the stop.

    At a stop that the vehicle has not passed by the end, all that wait there are left behind.
    """
    passed = np.flatnonzero(history.frames["route_s_m"] > stop.s_m + SERVED_M)
    end_s = float(history.frames["t_s"][passed[0] if len(passed) else -1])
    leaves_s = end_s if visit.departure_s is None else visit.departure_s
    here = [each for each in passengers if each.stop_id == stop.id]
    waits_s = [each.boarded_s - each.came_s for each in here if each.boarded_s is not None]
    behind = sum(each.boarded_s is None and each.came_s <= leaves_s for each in here)
    alighted = sum(each.destination_id == stop.id and each.alighted_s is not None for each in passengers)
    return visit._replace(
        waiting=len(waits_s) + behind,
        boarded=len(waits_s),
        left_behind=behind,
        alighted=alighted,
        mean_wait_s=sum(waits_s) / len(waits_s) if waits_s else None,
    )


def _visit(history: History, stop: Stop, call: Call | None, headway_s: float | None) -> Visit:
    """What happened at one stop."""
    t_s = history.frames["t_s"]
    resting = serving(history, stop.s_m)
    arrival_s = departure_s = None
    if resting.any():
        first = int(np.argmax(resting))
        arrival_s = float(t_s[first])
        last = int(np.flatnonzero(resting)[-1])
        departure_s = float(t_s[last + 1]) if last + 1 < len(t_s) else None
    delay_s = None if call is None or arrival_s is None else arrival_s - call.arrival_s
    return Visit(
        stop_id=stop.id,
        name=stop.name,
        served=arrival_s is not None,
        arrival_s=arrival_s,
        departure_s=departure_s,
        dwell_s=None if arrival_s is None or departure_s is None else departure_s - arrival_s,
        planned_arrival_s=None if call is None else call.arrival_s,
        planned_departure_s=None if call is None else call.departure_s,
        delay_s=delay_s,
        headway_s=None if delay_s is None or headway_s is None else headway_s + delay_s,
        on_time=None if call is None else delay_s is not None and -EARLY_S <= delay_s <= LATE_S,
    )
