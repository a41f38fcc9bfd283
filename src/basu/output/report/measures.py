"""What a record tells beside the thesis's score, as plain values: lanes, deviation, takeovers, the leaderboard."""

from __future__ import annotations

from dataclasses import asdict
from typing import TYPE_CHECKING, Any

from basu.metrics.delays import delays
from basu.metrics.disengagements import disengagements
from basu.metrics.lanes import outside_lanes, wrong_way
from basu.metrics.leaderboard import leaderboard_scores
from basu.metrics.red_lights import lights_passed
from basu.metrics.route_deviation import route_deviation

if TYPE_CHECKING:
    from collections.abc import Iterable

    from basu.metrics.infraction import Evidence
    from basu.metrics.leaderboard import LeaderboardScores
    from basu.metrics.score import Scoring
    from basu.metrics.shares import Share
    from basu.records.history import History

NOTHING: dict[str, Any] = {
    "red_lights": [],
    "route_deviation": None,
    "outside_lanes": None,
    "wrong_way": None,
    "disengagements": None,
    "delays": None,
    "leaderboard": None,
}


def measures(history: History, scoring: Scoring) -> dict[str, Any]:
    """The keys of ``NOTHING``, filled."""
    deviation = route_deviation(history, scoring.route_deviation_m)
    outside = outside_lanes(history)
    return {
        "red_lights": _red_lights(history),
        "route_deviation": {
            **_share(deviation.outside),
            "threshold_m": deviation.threshold_m,
            "largest_m": deviation.largest_m,
        },
        "outside_lanes": {
            **_share(outside.total),
            "metres_by_where": {where.value: metres for where, metres in outside.metres_by_where.items()},
        },
        "wrong_way": _share(wrong_way(history)),
        "disengagements": _disengagements(history),
        "delays": _delays(history),
        "leaderboard": {scores.version.value: _leaderboard(history, scores) for scores in leaderboard_scores(history)},
    }


def told(found: Evidence) -> dict[str, Any]:
    """One infraction or incident with its evidence."""
    return {**asdict(found), "kind": found.kind.value}


def _events(found: Iterable[Evidence]) -> list[dict[str, Any]]:
    return [told(event) for event in found]


def _share(share: Share) -> dict[str, Any]:
    """How much of the drive it was, and where."""
    return {
        "metres": share.metres,
        "share": share.share,
        "seconds": share.seconds,
        "events": _events(share.events),
    }


def _red_lights(history: History) -> list[dict[str, Any]]:
    """Every traffic light of the route that was passed."""
    return [
        {
            "id": passed.light.landmark_id,
            "route_s_m": passed.light.s_m,
            "t_s": float(history.frames["t_s"][passed.tick]),
            "speed_mps": passed.speed_mps,
            "state_at_front": passed.front_state,
            "state_at_rear": passed.state,
            "run": passed.run,
        }
        for passed in lights_passed(history)
    ]


def _disengagements(history: History) -> dict[str, Any]:
    """Takeovers and who drove how far."""
    found = disengagements(history)
    return {
        "number": len(found.events),
        "autonomous_m": found.autonomous_m,
        "manual_m": found.manual_m,
        "miles_per_disengagement": found.miles_per_disengagement,
        "events": _events(found.events),
    }


def _delays(history: History) -> dict[str, Any]:
    """Rests and time."""
    found = delays(history)
    return {
        "longest_rest_s": found.longest_rest_s,
        "time_s": found.time_s,
        "time_limit_s": found.time_limit_s,
        "events": _events((*found.blocked, *found.timeouts)),
    }


def _leaderboard(history: History, scores: LeaderboardScores) -> dict[str, Any]:
    """The scores of one version with what they come from."""
    return {
        "driving": scores.driving,
        "route_completion": scores.route_completion,
        "infraction_penalty": scores.infraction_penalty,
        "ended_by": None if scores.ended_by is None else scores.ended_by.value,
        "not_measured": [kind.value for kind in scores.not_measured],
        "events": [
            {
                "kind": event.kind.value,
                "tick": event.tick,
                "t_s": float(history.frames["t_s"][event.tick]),
                "percentage": event.percentage,
            }
            for event in scores.events
        ],
    }
