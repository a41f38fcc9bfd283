"""The service as its passengers met it: arrival, dwell and headway at each stop against the route's timetable.

A vehicle is on time from one minute before to five minutes after the planned time: Transit Capacity and Quality of
Service Manual, 3rd ed. (TCRP Report 165, 2013), chapter 5, on-time performance. One run shows one vehicle; its headway
is to a vehicle before it that keeps the timetable.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from basu.metrics.path_following import serving

if TYPE_CHECKING:
    from basu.records.history import History
    from basu.routing import Stop
    from basu.routing.timetable import Call

EARLY_S, LATE_S = 60.0, 300.0


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


def service(history: History) -> tuple[Visit, ...]:
    """Each stop of the route, in order."""
    timetable = history.facts.route.timetable
    calls = {} if timetable is None else {call.stop_id: call for call in timetable.calls}
    headway_s = None if timetable is None else timetable.headway_s
    return tuple(_visit(history, stop, calls.get(stop.id), headway_s) for stop in history.facts.route.stops)


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
