"""Makes the document of a service that was driven."""

from __future__ import annotations

from pathlib import PurePath
from typing import TYPE_CHECKING

from basu_service.document import SCHEMA_VERSION
from basu_service.figures import (
    Operated,
    connection_of,
    connections,
    contacts_of,
    end_of,
    falls_part,
    headways,
    on_time,
    persons,
    reasons,
    ride_of,
    rides,
    standers,
    waits,
)

if TYPE_CHECKING:
    from collections.abc import Sequence

    from basu.metrics.result import Result
    from basu_service.document import CallPart, JourneyPart, ServiceDocument, VehiclePart
    from basu_service.operation import Call, Journey


def service_document(
    operated: Operated, *, seed: int, holds: bool, agents: Sequence[str], contacts_between: int
) -> ServiceDocument:
    """Return the document; ``agents`` are the names of the vehicles' agents, ``holds`` says that the timetable does."""
    why, timetable = reasons(operated), operated.plan.timetable
    minutes = round(timetable.run_departure_s / 60.0)
    return {
        "schema_version": SCHEMA_VERSION,
        "passed": not why,
        "reasons": why,
        "seed": seed,
        "minutes": operated.minutes,
        "lasts_s": operated.lasts_s,
        "begins": f"{timetable.run_day} {minutes // 60:02d}:{minutes % 60:02d}",
        "holding": "timetable" if holds else "none",
        "demand": PurePath(operated.demand.source).name,
        "persons": persons(operated),
        "waits": waits(operated),
        "headways": headways(operated),
        "rides": rides(operated),
        "connections": connections(operated),
        "falls": falls_part(standers(operated)),
        "on_time": on_time(operated),
        "contacts_between": contacts_between,
        "vehicles": [
            _vehicle(operated, number, agent, result)
            for number, (agent, result) in enumerate(zip(agents, operated.results, strict=True))
        ],
        "calls": [_call(call) for call in operated.service.calls],
        "journeys": [_journey(journey, operated) for journey in operated.service.journeys],
    }


def _vehicle(operated: Operated, number: int, agent: str, result: Result) -> VehiclePart:
    """Return one vehicle in short."""
    service = operated.service
    calls = [call for call in service.calls if call.vehicle == number]
    dwells_s = [call.departure_s - call.arrival_s for call in calls if call.departure_s is not None]
    ride = ride_of(result)
    return {
        "number": number + 1,
        "agent": agent,
        "status": result.outcome.status.value,
        "message": result.outcome.message,
        "driven_m": float((result.metrics.get("reported") or {"driven_m": 0.0})["driven_m"]),
        "calls": len(calls),
        "passed": sum(vehicle == number for _, vehicle, _, _ in service.passed),
        "dwell_mean_s": sum(dwells_s) / len(dwells_s) if dwells_s else None,
        "boarded": sum(call.boarded for call in calls),
        "comfort_score": None if ride is None else ride.comfort,
        "harsh_stops": 0 if ride is None else len(ride.stops),
        "contacts": contacts_of(result),
        "infractions": len(result.infractions),
        "disengagements": int((result.metrics.get("disengagements") or {"number": 0})["number"]),
    }


def _call(call: Call) -> CallPart:
    return {
        "vehicle": call.vehicle + 1,
        "stop": call.stop_id,
        "arrival_s": round(call.arrival_s, 3),
        "departure_s": _rounded(call.departure_s),
        "planned_departure_s": _rounded(call.planned_departure_s),
        "held_s": round(call.held_s, 3),
        "boarded": call.boarded,
        "alighted": call.alighted,
        "left_behind": call.left_behind,
    }


def _journey(journey: Journey, operated: Operated) -> JourneyPart:
    person, made = journey.person, connection_of(journey, operated)
    stood_s = sum((operated.lasts_s if to_s is None else to_s) - from_s for from_s, to_s in journey.stood)
    return {
        "origin": person.stop_id,
        "destination": person.destination_id,
        "kind": person.kind.value,
        "came_s": round(person.came_s, 3),
        "boarded_s": _rounded(journey.boarded_s),
        "alighted_s": _rounded(journey.alighted_s),
        "gave_up_s": _rounded(journey.gave_up_s),
        "vehicle": None if journey.vehicle is None else journey.vehicle + 1,
        "stood_s": round(stood_s, 3),
        "left_behind": [why for _, why in journey.left_behind],
        "end": end_of(journey, operated),
        "connection": None if made is None else "made" if made else "missed",
    }


def _rounded(value: float | None) -> float | None:
    return None if value is None else round(value, 3)
