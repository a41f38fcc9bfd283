"""``result.json``: the judgement of a run as plain values, computed from its record alone."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from basu.metrics.infraction import counts
from basu.metrics.lane_invasion import lane_invasions
from basu.metrics.passengers.as_json import passengers_to_json
from basu.metrics.passengers.verdict import judge
from basu.metrics.path_following import path_following
from basu.metrics.score import driving_score, infraction_score, infractions
from basu.metrics.scoring_json import scoring_to_json
from basu.metrics.stop_signs import signs_passed
from basu.output.report.measures import NOTHING, measures, told

if TYPE_CHECKING:
    from basu.metrics.score import Scoring
    from basu.outcome import Outcome
    from basu.records.history import History

SCHEMA_VERSION = 2
SERVED_M = 3.0  # a service stop is served when the vehicle came to rest within this along the route
AT_REST_MPS = 0.1


def result(outcome: Outcome, history: History | None, scoring: Scoring, meta: dict[str, Any]) -> dict[str, Any]:
    """The document; ``history`` None where nothing was driven."""
    return {
        "schema_version": SCHEMA_VERSION,
        "status": outcome.status.value,
        "fault": outcome.status.fault.name.lower(),
        "message": outcome.message,
        **judgement(history, scoring),
        "scoring": scoring_to_json(scoring),
        "meta": meta,
    }


def judgement(history: History | None, scoring: Scoring) -> dict[str, Any]:
    """Scores, infractions and all that is reported beside them: the part that comes from the record."""
    if history is None or len(history.frames) == 0:
        nothing = {"scores": None, "infractions": [], "stop_signs": [], "stops": [], **NOTHING}
        return {**nothing, "passengers": None, "reported": None}
    found = infractions(history, scoring)
    path = path_following(history)
    infraction = infraction_score(counts(found), scoring)
    return {
        "scores": {
            "driving": driving_score(infraction, path.score, scoring),
            "infraction": infraction,
            "path_following": path.score,
        },
        "infractions": [told(e) for e in found],
        "stop_signs": [
            {
                "id": passed.sign.landmark_id,
                "route_s_m": passed.sign.s_m,
                "t_s": float(history.frames["t_s"][passed.tick]),
                "lowest_speed_mps": passed.lowest_speed_mps,
                "front_to_line_m": passed.front_to_line_m,
                "stopped": passed.stopped,
            }
            for passed in signs_passed(history)
        ],
        "stops": _service_stops(history),
        **measures(history, scoring),
        "passengers": passengers_to_json(
            history, judge(history, scoring.comfort_weights, scoring.standing_place, scoring.harsh_stop_mps2)
        ),
        "reported": _reported(history, path.driven_m, path.planned_m),
    }


def _service_stops(history: History) -> list[dict[str, Any]]:
    """Each service stop: was it served, and how slow did the vehicle get there?"""
    s_m, speed_mps = history.frames["route_s_m"], history.speed_mps()
    rows = []
    for stop in history.facts.route.stops:
        near = np.flatnonzero(np.abs(s_m - stop.s_m) <= SERVED_M)
        lowest = float(speed_mps[near].min()) if len(near) else None
        rows.append(
            {
                "id": stop.id,
                "name": stop.name,
                "route_s_m": stop.s_m,
                "lowest_speed_mps": lowest,
                "rest_s": float(np.count_nonzero(speed_mps[near] < AT_REST_MPS) * history.facts.step_s),
                "served": lowest is not None and lowest < AT_REST_MPS,
            }
        )
    return rows


def _reported(history: History, driven_m: float, planned_m: float) -> dict[str, Any]:
    """Figures that do not enter the score."""
    invasions = lane_invasions(history)
    frames = history.frames
    return {
        "driven_m": driven_m,
        "planned_m": planned_m,
        "route_completion": min(1.0, float(frames["route_s_m"].max()) / planned_m),
        "lane_invasions": {"total": invasions.total, "by_marking": dict(invasions.by_marking)},
        "largest_lateral_m": float(np.abs(frames["lateral_m"]).max()),
        "top_speed_mps": float(history.speed_mps().max()),
    }
