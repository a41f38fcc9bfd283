"""Claims about the leaderboard's result file: its structure, its statuses, its totals, and what cannot be submitted.

The structure is written down here from the public program; ``scripts/outside/leaderboard_results.py`` lets the program
itself read such a file.
"""

import json
from pathlib import Path
from typing import Any

import pytest

from basu.cli import main
from basu.errors import UserError
from basu.metrics.result import Result, judge
from basu.outcome import Outcome, Status
from basu.records.history import History
from basu_leaderboard.submission import SubmittedRun, submission
from fakes.drives import at, driven, hit, stop_sign, straight_route, traffic_light

TRACK: dict[str, Any] = {"track": "SENSORS", "sensors": ["sensor.other.gnss", "sensor.speedometer"], "refused": None}
INFRACTIONS = [
    "collisions_layout",
    "collisions_pedestrian",
    "collisions_vehicle",
    "red_light",
    "stop_infraction",
    "outside_route_lanes",
    "min_speed_infractions",
    "yield_emergency_vehicle_infractions",
    "scenario_timeouts",
    "route_dev",
    "vehicle_blocked",
    "route_timeout",
]
COMPLETED = Outcome(Status.COMPLETED, "arrived")


def run(
    history: History | None,
    outcome: Outcome = COMPLETED,
    track: dict[str, Any] | None = TRACK,
    repetition: int = 0,
) -> SubmittedRun:
    """A run of route 7 as the folder of a run gives it."""
    access = {"track": "sensors", "open": False, "refused": {}} | ({} if track is None else {"leaderboard": track})
    meta = {"route": "7", "simulated_s": 50.0, "wall_s": 20.1234, "started": "2026-01-01", "access": access}
    result: Result = judge(outcome, history, meta=meta)
    return SubmittedRun(result, history, repetition)


def full_of_events() -> History:
    """A car hit, a stop sign and a red light run, and a tenth of the way on the pavement."""
    route = straight_route(500.0, controls=(stop_sign(100.0), traffic_light(200.0)))
    history = driven(at(10.0, 50.0), route=route, collisions=[hit(100, "vehicle.audi.tt", 7)])
    history.frames["route_light"] = 0
    history.frames["off_lane_m"][600:699] = 2.0
    return history


def test_the_file_has_the_leaderboards_structure() -> None:
    document = submission([run(full_of_events())], "2.0")
    assert list(document) == ["_checkpoint", "entry_status", "eligible", "sensors", "values", "labels"]
    checkpoint = document["_checkpoint"]
    assert list(checkpoint) == ["global_record", "progress", "records"]
    (record,) = checkpoint["records"]
    keys = ["index", "route_id", "status", "num_infractions", "infractions", "scores", "meta"]
    assert list(record) == keys
    assert list(record["infractions"]) == list(checkpoint["global_record"]["infractions"]) == INFRACTIONS
    assert set(record["scores"]) == {"score_route", "score_penalty", "score_composed"}
    assert record["meta"] == {"route_length": 500.0, "duration_game": 50.0, "duration_system": 20.123}
    assert document["sensors"] == ["carla_gnss", "carla_speedometer"]
    assert len(document["values"]) == len(document["labels"]) == 15
    assert all(isinstance(value, str) for value in document["values"])
    assert json.loads(json.dumps(document)) == document


def test_infractions_stand_in_the_leaderboards_words() -> None:
    (record,) = submission([run(full_of_events())], "2.0")["_checkpoint"]["records"]
    assert record["status"] == "Completed"
    assert record["num_infractions"] == 4
    assert record["infractions"]["collisions_vehicle"] == [
        "Agent collided against object with type=vehicle.audi.tt and id=7 at (x=50.000, y=0.000, z=0.000)"
    ]
    (aside,) = record["infractions"]["outside_route_lanes"]
    assert aside.startswith("Agent went outside its route lanes for about ")
    assert float(aside.split(" ")[8]) == pytest.approx(50.0, abs=1.0)  # where the leaderboard's totals look for it


def test_the_totals_are_those_of_the_records() -> None:
    clean, broken = run(driven(at(10.0, 50.0), route=straight_route(500.0))), run(full_of_events(), repetition=1)
    totals = submission([clean, broken], "2.1")["_checkpoint"]["global_record"]
    penalty = broken.result.metrics["leaderboard"]["2.1"]["infraction_penalty"]
    assert totals["status"] == "Completed"
    assert totals["scores_mean"]["score_penalty"] == pytest.approx((1.0 + penalty) / 2.0, abs=1e-6)
    assert totals["scores_std_dev"]["score_route"] == 0.0
    assert totals["infractions"]["stop_infraction"] == pytest.approx(1.0)  # one on 1 km
    assert totals["infractions"]["outside_route_lanes"] == pytest.approx(0.05, abs=0.001)  # km, and no rate


@pytest.mark.parametrize(
    ("history", "outcome", "track", "status", "entry"),
    [
        (driven(at(10.0, 20.0)), COMPLETED, TRACK, "Perfect", "Finished"),
        (None, Outcome(Status.AGENT_CRASHED, "it raised"), TRACK, "Failed - Agent couldn't be set up", "Finished"),
        (
            driven(at(10.0, 5.0), route=straight_route(500.0)),
            Outcome(Status.AGENT_CRASHED, "it raised"), TRACK, "Failed - Agent crashed", "Finished",
        ),
        (
            driven([*at(10.0, 5.0), *at(0.0, 200.0)], route=straight_route(500.0)),
            Outcome(Status.ROUTE_BLOCKED, "at rest"), TRACK, "Failed - Agent got blocked", "Finished",
        ),
        (
            None, Outcome(Status.SETUP_FAILED, "too many"), {**TRACK, "sensors": [], "refused": "too many"},
            "Failed - Agent's sensors were invalid", "Rejected",
        ),
        (None, Outcome(Status.SIMULATOR_FAILED, "gone"), TRACK, "Failed - Simulation crashed", "Crashed"),
    ],
)  # fmt: skip
def test_a_run_has_the_leaderboards_status(
    history: History | None, outcome: Outcome, track: dict[str, Any], status: str, entry: str
) -> None:
    document = submission([run(history, outcome, track)], "2.0")
    assert document["_checkpoint"]["records"][0]["status"] == status
    assert (document["entry_status"], document["eligible"]) == (entry, entry == "Finished")
    assert document["_checkpoint"]["global_record"]["status"] == status.split(" ", maxsplit=1)[0]


def test_a_run_without_the_rules_of_a_track_cannot_be_submitted() -> None:
    """An agent that knew the whole world would else stand beside one with eight cameras."""
    with pytest.raises(UserError, match="was held to no track of the leaderboard; drive it with --leaderboard-track"):
        submission([run(driven(at(10.0, 20.0)), track=None)], "2.0")


def test_runs_of_two_tracks_are_two_submissions() -> None:
    one, other = run(driven(at(10.0, 20.0))), run(driven(at(10.0, 20.0)), track={**TRACK, "track": "MAP"})
    with pytest.raises(UserError, match="are of the tracks MAP and SENSORS; submit each by itself"):
        submission([one, other], "2.0")


def test_a_folder_that_is_no_run_gets_a_sentence(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["leaderboard", "results", str(tmp_path), "-o", str(tmp_path / "out.json")]) == 2
    said = capsys.readouterr().err
    assert said.startswith("basu: ")
    assert "Traceback" not in said
    assert not (tmp_path / "out.json").exists()
