"""The figures of a service: from its calls and journeys, and from the records of its vehicles."""

from __future__ import annotations

import itertools
from dataclasses import replace
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from basu.metrics.passengers.felt import felt
from basu.metrics.passengers.service import EARLY_S, LATE_S
from basu.metrics.passengers.verdict import judge
from basu.outcome import Status
from basu.routing.planned_route import until
from basu_service.falls import Falls, Stander, falls

if TYPE_CHECKING:
    from collections.abc import Sequence

    from basu.metrics.passengers.verdict import PassengerJudgement
    from basu.metrics.result import Result
    from basu_service.demand import Demand
    from basu_service.document import (
        ConnectionsPart,
        End,
        FallsPart,
        HeadwaysPart,
        PersonsPart,
        RidesPart,
        WaitsPart,
    )
    from basu_service.operation import Journey, Service
    from basu_service.plan import ServicePlan

BUNCHED_SHARE = 0.5
"""Of the planned headway: a shorter one is bunched. A convention of this project."""
GAP_FACTOR = 3.0
"""Of the planned headway: a longer time without a departure at a stop fails the service. A convention as well."""


class Operated(NamedTuple):
    """A service that was driven, with what its figures need."""

    plan: ServicePlan
    demand: Demand
    service: Service
    results: Sequence[Result]  # of the vehicles
    minutes: float  # that the service was to last
    lasts_s: float  # to its end, or to the end of the last drive

    def ended_early(self, vehicle: int) -> bool:
        """Whether a vehicle's drive ended before the service, whatever ended it."""
        return self.results[vehicle].outcome.status is not Status.STOPPED


def end_of(journey: Journey, operated: Operated) -> End:
    """Return how a person's way stands at the end."""
    if journey.alighted_s is not None:
        return "carried"
    if journey.vehicle is not None:
        return "stranded" if operated.ended_early(journey.vehicle) else "riding"
    return "waiting" if journey.gave_up_s is None else "gave_up"


def persons(operated: Operated) -> PersonsPart:
    """Count the persons by their end."""
    journeys = operated.service.journeys
    ends = [end_of(journey, operated) for journey in journeys]
    return {
        "came": len(journeys),
        "carried": ends.count("carried"),
        "riding": ends.count("riding"),
        "stranded": ends.count("stranded"),
        "waiting": ends.count("waiting"),
        "gave_up": ends.count("gave_up"),
        "left_behind": sum(len(journey.left_behind) for journey in journeys),
        "carried_past": sum(journey.carried_past for journey in journeys),
    }


def waits(operated: Operated) -> WaitsPart:
    """Measure the waiting times; a wait that lasts at the end counts with what it has been."""
    journeys = operated.service.journeys
    all_s = [_first(each.boarded_s, each.gave_up_s, operated.lasts_s) - each.person.came_s for each in journeys]
    boarded_s = [each.boarded_s - each.person.came_s for each in journeys if each.boarded_s is not None]
    return {
        "mean_s": _mean(all_s),
        "boarded_mean_s": _mean(boarded_s),
        "boarded_p90_s": float(np.quantile(boarded_s, 0.9)) if boarded_s else None,
        "longest_s": max(all_s, default=None),
    }


def _first(*times_s: float | None) -> float:
    return next(each for each in times_s if each is not None)


def _mean(values: Sequence[float]) -> float | None:
    return float(np.mean(values)) if values else None


def headways(operated: Operated) -> HeadwaysPart:
    """Measure the times between departures at each stop; the first of a stop ends no headway."""
    planned_s = operated.plan.timetable.round_s / len(operated.plan.phases_s)
    gaps_s: list[float] = []
    longest_s = 0.0
    for stop_id, _ in operated.plan.places_m:
        left_s = sorted(
            operated.lasts_s if call.departure_s is None else call.departure_s
            for call in operated.service.calls
            if call.stop_id == stop_id
        )
        departed_s = [each for each in left_s if each < operated.lasts_s]
        gaps_s += [later - earlier for earlier, later in itertools.pairwise(departed_s)]
        marks = [0.0, *departed_s, operated.lasts_s]
        longest_s = max(longest_s, *(later - earlier for earlier, later in itertools.pairwise(marks)))
    mean_s = _mean(gaps_s)
    return {
        "planned_s": planned_s,
        "count": len(gaps_s),
        "mean_s": mean_s,
        "variation": None if mean_s is None or len(gaps_s) < 2 else float(np.std(gaps_s)) / mean_s,
        "bunched": _mean([float(each < BUNCHED_SHARE * planned_s) for each in gaps_s]),
        "longest_gap_s": longest_s,
    }


def rides(operated: Operated) -> RidesPart:
    """Measure rides and how full the vehicles were."""
    service, plan = operated.service, operated.plan
    places_m = dict(plan.places_m)
    carried = [each for each in service.journeys if each.alighted_s is not None and each.boarded_s is not None]
    way_m = [
        (places_m[each.person.destination_id] - places_m[each.person.stop_id]) % plan.length_m
        + plan.length_m * each.carried_past
        for each in carried
    ]
    aboard_s = 0.0
    for vehicle in range(len(plan.phases_s)):
        marks = [(t_s, count) for t_s, number, count, _ in service.aboard if number == vehicle]
        ends_s = [t_s for t_s, _ in marks[1:]] + [operated.lasts_s]
        aboard_s += sum(count * (end_s - t_s) for (t_s, count), end_s in zip(marks, ends_s, strict=False))
    return {
        "mean_s": _mean([_first(each.alighted_s) - _first(each.boarded_s) for each in carried]),
        "passenger_km": sum(way_m) / 1000.0,
        "mean_aboard": aboard_s / (operated.lasts_s * len(plan.phases_s)) if operated.lasts_s else 0.0,
        "most_aboard": max((count for _, _, count, _ in service.aboard), default=0),
        "most_standing": max((standing for *_, standing in service.aboard), default=0),
    }


def connection_of(journey: Journey, operated: Operated) -> bool | None:
    """Return whether a carried person made the connection that the timetable promised; None without one."""
    person = journey.person
    connection = operated.demand.connections.get(person.destination_id)
    if connection is None or not person.connects or journey.alighted_s is None:
        return None
    promised_s = operated.plan.promised_arrival_s(person.stop_id, person.destination_id, person.came_s)
    if promised_s is None:
        return None
    begins_s = operated.plan.timetable.run_departure_s
    waited = -((begins_s + promised_s + connection.walk_s - connection.first_s) // -connection.every_s)
    leaves_s = connection.first_s + max(0.0, waited) * connection.every_s - begins_s
    return journey.alighted_s + connection.walk_s <= leaves_s


def connections(operated: Operated) -> ConnectionsPart:
    """Count connections."""
    found = [connection_of(journey, operated) for journey in operated.service.journeys]
    return {"made": found.count(True), "missed": found.count(False)}


def standers(operated: Operated) -> list[Stander]:
    """Return each passenger that stood, with the strongest push that it felt while it stood."""
    found = []
    sensed = [None if result.history is None else felt(result.history) for result in operated.results]
    for journey in operated.service.journeys:
        ride = None if journey.vehicle is None else sensed[journey.vehicle]
        if not journey.stood or ride is None:
            continue
        pushes_mps2, t_s = ride.horizontal_mps2(), ride.t_s
        during = np.zeros(len(t_s), dtype=bool)
        for from_s, to_s in journey.stood:
            during |= (t_s >= from_s) & (t_s <= (np.inf if to_s is None else to_s))
        if during.any():
            strongest_mps2 = float(pushes_mps2[during].max())
            found.append(Stander(journey.person.holds_on, journey.person.steadiness, strongest_mps2))
    return found


def falls_part(standing: Sequence[Stander]) -> FallsPart:
    """Put the model's answer into the document's form."""
    found: Falls = falls(standing)
    return {
        "standing": found.standing,
        "expected": found.value,
        "low": found.low,
        "high": found.high,
        "strongest_mps2": max((each.strongest_mps2 for each in standing), default=0.0),
    }


def on_time(operated: Operated) -> float | None:
    """Return the share of departures within the window of the passengers' metric."""
    late_s = [
        call.departure_s - call.planned_departure_s
        for call in operated.service.calls
        if call.departure_s is not None and call.planned_departure_s is not None
    ]
    return _mean([float(-EARLY_S <= each <= LATE_S) for each in late_s])


def reasons(operated: Operated) -> list[str]:
    """Return why the service failed its passengers, in sentences; none where it passed."""
    found = []
    part, gaps, fallen = persons(operated), headways(operated), falls(standers(operated))
    for number, result in enumerate(operated.results, 1):
        if operated.ended_early(number - 1):
            found.append(f"vehicle {number} ended before the service: {result.outcome.message}")
        if contacts := contacts_of(result):
            found.append(f"vehicle {number} had {contacts} contacts")
    if passed := operated.service.passed:
        t_s, vehicle, stop_id, waiting = passed[0]
        found.append(
            f"{len(passed)} calls were left out, the first by vehicle {vehicle + 1} at {t_s:.0f} s: "
            f"it passed {stop_id}, where {waiting} persons waited"
        )
    if part["carried_past"]:
        found.append(f"{part['carried_past']} times a passenger was carried past its destination")
    if part["stranded"]:
        found.append(f"{part['stranded']} passengers were aboard a vehicle that ended its drive")
    if gaps["longest_gap_s"] > GAP_FACTOR * gaps["planned_s"]:
        found.append(
            f"no vehicle left a stop for {gaps['longest_gap_s'] / 60:.0f} min, and one is planned each "
            f"{gaps['planned_s'] / 60:.0f} min"
        )
    if fallen.value >= 1.0:
        found.append(f"{fallen.value:.0f} standing passengers lost balance ({fallen.low:.0f} to {fallen.high:.0f})")
    return found


def contacts_of(result: Result) -> int:
    """Return how many contacts a vehicle had, at fault or not."""
    return int((result.metrics.get("collisions") or {"number": 0})["number"])


def ride_of(result: Result) -> PassengerJudgement | None:
    """Return the judgement of a ride up to the place that it has reached: a service ends between two stops."""
    history = result.history
    if history is None:
        return None
    route = until(history.facts.route, float(history.frames["route_s_m"].max()))
    return judge(replace(history, facts=replace(history.facts, route=route)), ended_early=True)
