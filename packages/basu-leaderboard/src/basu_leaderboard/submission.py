"""The result file of the leaderboard 2.x, from the results and records of BASU's runs.

Source of the structure, of its words and of its rounding: ``leaderboard/utils/statistics_manager.py`` of
carla-simulator/leaderboard, branches leaderboard-2.0 and leaderboard-2.1; of the sentences: ``atomic_criteria.py`` of
carla-simulator/scenario_runner, branch leaderboard-2.0. ``scripts/outside/leaderboard_results.py`` lets that program
read a file of ours and compute its totals again.
"""

from __future__ import annotations

import math
import statistics
from typing import TYPE_CHECKING, Any, Literal, NamedTuple

from basu.errors import UserError
from basu.metrics.leaderboard import Kind
from basu.outcome import Fault, Status
from basu_leaderboard.sensor_sets import OPENDRIVE_MAP, SPEEDOMETER

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from basu.metrics.result import Result
    from basu.records.history import History

SubmissionVersion = Literal["2.0", "2.1"]
DIGITS, SCORE_DIGITS = 3, 6  # ROUND_DIGITS, ROUND_DIGITS_SCORE
ICONS = {
    "sensor.camera.rgb": "carla_camera",
    "sensor.lidar.ray_cast": "carla_lidar",
    "sensor.other.radar": "carla_radar",
    "sensor.other.gnss": "carla_gnss",
    "sensor.other.imu": "carla_imu",
    OPENDRIVE_MAP: "carla_opendrive_map",
    SPEEDOMETER: "carla_speedometer",
}
"""Its names of sensors in the file."""
RECORDED = (
    Kind.COLLISION_STATIC,
    Kind.COLLISION_PEDESTRIAN,
    Kind.COLLISION_VEHICLE,
    Kind.RED_LIGHT,
    Kind.STOP,
    Kind.OUTSIDE_LANES,
    Kind.MIN_SPEED,
    Kind.YIELD_EMERGENCY,
    Kind.SCENARIO_TIMEOUT,
    Kind.ROUTE_DEVIATION,
    Kind.BLOCKED,
    Kind.ROUTE_TIMEOUT,
)
"""The kinds of infractions in the file's order."""
LABELS = {
    "score_composed": "Avg. driving score",
    "score_route": "Avg. route completion",
    "score_penalty": "Avg. infraction penalty",
    Kind.COLLISION_PEDESTRIAN.value: "Collisions with pedestrians",
    Kind.COLLISION_VEHICLE.value: "Collisions with vehicles",
    Kind.COLLISION_STATIC.value: "Collisions with layout",
    Kind.RED_LIGHT.value: "Red lights infractions",
    Kind.STOP.value: "Stop sign infractions",
    Kind.OUTSIDE_LANES.value: "Off-road infractions",
    Kind.ROUTE_DEVIATION.value: "Route deviations",
    Kind.ROUTE_TIMEOUT.value: "Route timeouts",
    Kind.BLOCKED.value: "Agent blocked",
    Kind.YIELD_EMERGENCY.value: "Yield emergency vehicles infractions",
    Kind.SCENARIO_TIMEOUT.value: "Scenario timeouts",
    Kind.MIN_SPEED.value: "Min speed infractions",
}
"""The labels of the totals, in the order of ``values``."""
ENDINGS = {
    Kind.ROUTE_DEVIATION: "Agent deviated from the route",
    Kind.BLOCKED: "Agent got blocked",
    Kind.ROUTE_TIMEOUT: "Agent timed out",
}
NO_SETUP, CRASHED, NO_SENSORS, NO_SIMULATION = (
    "Agent couldn't be set up",
    "Agent crashed",
    "Agent's sensors were invalid",
    "Simulation crashed",
)


class SubmittedRun(NamedTuple):
    """One run with its record."""

    result: Result
    history: History | None  # None where nothing was driven
    repetition: int


def submission(runs: Sequence[SubmittedRun], version: SubmissionVersion) -> dict[str, Any]:
    """Return the file's content.

    Args:
        runs: in the order of routes and repetitions.
        version: of the rules of scoring.

    Raises:
        UserError: there is no run, or one was not held to a track of the leaderboard, or to another than the first.
    """
    track = _track_of(runs)
    records = [_record(index, run, version) for index, run in enumerate(runs)]
    totals = _totals(records)
    means, rates = totals["scores_mean"], totals["infractions"]
    statuses = " ".join(record["status"] for record in records)
    entry = "Crashed" if NO_SIMULATION in statuses else "Rejected" if NO_SENSORS in statuses else "Finished"
    return {
        "_checkpoint": {
            "global_record": totals,
            "progress": [len(records), len(records)],
            "records": records,
        },
        "entry_status": entry,
        "eligible": entry == "Finished",
        "sensors": [ICONS[kind] for kind in track["sensors"]],
        "values": [str(means[name] if name in means else rates[name]) for name in LABELS],
        "labels": list(LABELS.values()),
    }


def _track_of(runs: Sequence[SubmittedRun]) -> Mapping[str, Any]:
    """Return the track with the sensors of the first run that was driven; all runs are of this track."""
    if not runs:
        raise UserError("there is no run to submit; name the folders of runs or of a series")
    tracks = []
    for run in runs:
        track = run.result.meta.get("access", {}).get("leaderboard")
        if track is None:
            raise UserError(
                f"the run of {run.result.meta['started']} was held to no track of the leaderboard; drive it with "
                "--leaderboard-track SENSORS or MAP"
            )
        tracks.append(track)
    names = sorted({str(track["track"]) for track in tracks})
    if len(names) > 1:
        raise UserError(f"these runs are of the tracks {' and '.join(names)}; submit each by itself")
    found: Mapping[str, Any] = next((track for track in tracks if track["sensors"]), tracks[0])
    return found


def _record(index: int, run: SubmittedRun, version: SubmissionVersion) -> dict[str, Any]:
    """Return the entry of ``records`` for one run."""
    result, scores = run.result, (run.result.metrics.get("leaderboard") or {}).get(version)
    infractions: dict[str, list[str]] = {kind.value: [] for kind in RECORDED}
    for event in () if scores is None else scores["events"]:
        infractions[event["kind"]].append(_sentence(event, run, scores or {}))
    completion = 0.0 if scores is None else scores["route_completion"]
    factor = 1.0 if scores is None else scores["infraction_penalty"]
    count = sum(map(len, infractions.values()))
    length_m = 0.0 if run.history is None else run.history.facts.route.length_m
    return {
        "index": index,
        "route_id": f"RouteScenario_{result.meta['route']}_rep{run.repetition}",
        "status": _status(result, completion, count, None if scores is None else scores["ended_by"]),
        "num_infractions": count,
        "infractions": infractions,
        "scores": {
            "score_route": round(completion, SCORE_DIGITS),
            "score_penalty": round(factor, SCORE_DIGITS),
            "score_composed": round(max(completion * factor, 0.0), SCORE_DIGITS),
        },
        "meta": {
            "route_length": round(length_m, DIGITS),
            "duration_game": round(result.meta["simulated_s"], DIGITS),
            "duration_system": round(result.meta["wall_s"], DIGITS),
        },
    }


def _status(result: Result, completion: float, count: int, ended_by: str | None) -> str:
    """The status of a route in the leaderboard's words."""
    if completion >= 100.0:
        return "Completed" if count else "Perfect"
    why = _failure(result) if ended_by is None else ENDINGS[Kind(ended_by)]
    return f"Failed - {why}" if why else "Failed"


def _failure(result: Result) -> str:
    """What ended a run from outside of the leaderboard's criteria; empty where they decide."""
    status, driven = result.outcome.status, result.scores is not None
    if result.meta["access"]["leaderboard"]["refused"] is not None:
        return NO_SENSORS
    if status in {Status.AGENT_CRASHED, Status.AGENT_TIMED_OUT, Status.AGENT_INVALID_CONTROL}:
        return CRASHED if driven else NO_SETUP
    if status is Status.SETUP_FAILED:
        return NO_SETUP
    if status.fault in {Fault.SIMULATOR, Fault.BENCHMARK, Fault.USER, Fault.SETUP}:
        return NO_SIMULATION
    own = {
        Status.ROUTE_DEVIATION: Kind.ROUTE_DEVIATION,
        Status.ROUTE_BLOCKED: Kind.BLOCKED,
        Status.ROUTE_TIMEOUT: Kind.ROUTE_TIMEOUT,
    }
    return ENDINGS[own[status]] if status in own else ""


def _sentence(event: Mapping[str, Any], run: SubmittedRun, scores: Mapping[str, Any]) -> str:
    """One infraction in the leaderboard's words, with the vehicle's place."""
    history = run.history
    assert history is not None  # it has events
    kind, tick = Kind(event["kind"]), int(event["tick"])
    frame = history.frames[tick]
    place = f"(x={frame['x_m']:.3f}, y={frame['y_m']:.3f}, z={frame['z_m']:.3f})"
    if kind in {Kind.COLLISION_STATIC, Kind.COLLISION_PEDESTRIAN, Kind.COLLISION_VEHICLE}:
        other = next((contact for contact in history.collisions if contact.tick == tick), None)
        what = "type=unknown and id=0" if other is None else f"type={other.other_type} and id={other.other_id}"
        return f"Agent collided against object with {what} at {place}"
    percentage = event["percentage"] or 0.0
    if kind is Kind.OUTSIDE_LANES:
        made_m = history.facts.route.length_m * scores["route_completion"] / 100.0
        aside_m = round(made_m * percentage / 100.0, DIGITS)
        return (
            f"Agent went outside its route lanes for about {aside_m} meters "
            f"({round(percentage, 2)}% of the completed route)"
        )
    sentences = {
        Kind.RED_LIGHT: f"Agent ran a red light at {place}",
        Kind.STOP: f"Agent ran a stop at {place}",
        Kind.MIN_SPEED: f"Average speed is {percentage}% of the surrounding traffic's one",
        Kind.YIELD_EMERGENCY: "Agent failed to yield to an emergency vehicle",
        Kind.SCENARIO_TIMEOUT: "Agent timed out a scenario",
        Kind.ROUTE_DEVIATION: f"Agent deviated from the route at {place}",
        Kind.BLOCKED: f"Agent got blocked at {place}",
        Kind.ROUTE_TIMEOUT: "Route timeout.",
    }
    return sentences[kind]


def _totals(records: Sequence[Mapping[str, Any]]) -> dict[str, Any]:
    """``global_record``: means, standard deviations, and infractions for each km; lengths outside the lanes in km."""
    names = ("score_composed", "score_route", "score_penalty")
    scores = {name: [record["scores"][name] for record in records] for name in names}
    means = {name: round(math.fsum(found) / len(found), SCORE_DIGITS) for name, found in scores.items()}
    spread = {name: round(statistics.stdev(found), DIGITS) if len(found) > 1 else 0 for name, found in scores.items()}
    driven_km = sum(record["meta"]["route_length"] / 1000 * record["scores"]["score_route"] / 100 for record in records)
    rates = {}
    for kind in RECORDED:
        found = [text for record in records for text in record["infractions"][kind.value]]
        if kind is Kind.OUTSIDE_LANES:
            rates[kind.value] = round(math.fsum(float(text.split(" ")[8]) / 1000 for text in found), DIGITS)
        else:
            rates[kind.value] = round(len(found) / max(driven_km, 0.001), DIGITS)
    failed = [record for record in records if "Failed" in record["status"]]
    all_perfect = all(record["status"] == "Perfect" for record in records)
    return {
        "index": -1,
        "route_id": -1,
        "status": "Failed" if failed else "Perfect" if all_perfect else "Completed",
        "infractions": rates,
        "scores_mean": means,
        "scores_std_dev": spread,
        "meta": {
            "total_length": sum(record["meta"]["route_length"] for record in records),
            "duration_game": sum(record["meta"]["duration_game"] for record in records),
            "duration_system": sum(record["meta"]["duration_system"] for record in records),
            "exceptions": [[record["route_id"], record["index"], record["status"]] for record in failed],
        },
    }
