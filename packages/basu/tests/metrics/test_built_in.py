"""Claims about what stands beside the score: every key in every result, plain JSON, and short lines for the console."""

import json

import numpy as np

from basu.metrics.registry import built_in
from basu.metrics.result import Result, judge
from basu.metrics.scoring import Scoring
from basu.outcome import Outcome, Status
from basu.records.history import History
from fakes.drives import at, driven, straight_route, traffic_light

DONE = Outcome(Status.COMPLETED, "arrived")
NAMES = {metric.name for metric in built_in()}


def judged(history: History | None, scoring: Scoring | None = None) -> Result:
    return judge(DONE, history, scoring)


def lines(result: Result) -> list[str]:
    return [line for metric in built_in() if 25 < metric.order < 95 for line in metric.lines(result)]


def eventful() -> Result:
    """A light run on red, a stretch off the road, one against the lane, a takeover."""
    history = driven(at(10.0, 49.0), route=straight_route(500.0, controls=(traffic_light(100.0),)))
    frames = history.frames
    frames["route_light"] = 0
    frames["off_lane_m"][400:500] = 2.0
    frames["lane_heading_rad"][600:700] = np.pi
    frames["lateral_m"][600:700] = 3.5
    frames["manual"][800:900] = 1
    return judged(history)


def test_every_key_is_there_with_and_without_a_drive() -> None:
    assert set(eventful().metrics) == NAMES
    assert set(judged(None).metrics) == NAMES
    assert set(judged(driven(at(5.0, 5.0))).document()) > NAMES


def test_it_is_plain_json() -> None:
    found = dict(eventful().metrics)
    assert json.loads(json.dumps(found, allow_nan=False)) == found


def test_incidents_carry_the_evidence_that_infractions_carry() -> None:
    found = eventful().metrics
    fields = {"kind", "tick", "t_s", "x_m", "y_m", "z_m", "speed_mps", "route_s_m", "other", "detail"}
    for key in ("outside_lanes", "wrong_way", "route_deviation", "disengagements"):
        assert found[key]["events"], key
        assert all(set(event) == fields for event in found[key]["events"])
    assert found["disengagements"]["number"] == 1


def test_a_scorings_threshold_for_the_plan_is_used() -> None:
    history = driven(at(10.0, 10.0), lateral_m=1.5)
    assert judged(history).metrics["route_deviation"]["metres"] == 0.0
    assert judged(history, Scoring(route_deviation_m=1.0)).metrics["route_deviation"]["share"] == 1.0


def test_the_table_tells_what_happened_in_a_line_each() -> None:
    found = lines(eventful())
    assert found[0] == "traffic lights    1 of 1 run on red"
    assert found[1] == "outside the plan  50.0 m, 10.2 % of the way (not scored)"
    assert found[2].startswith("outside lanes     100.0 m, 20.")
    assert found[3].startswith("wrong way         50.0 m")
    assert found[4] == "disengagements    1, 0.27 miles by the agent to each"
    assert found[5].startswith("leaderboard 1.0   ")
    assert len(found) == 8


def test_the_table_of_a_drive_without_events_has_the_leaderboard_alone() -> None:
    assert lines(judged(driven(at(10.0, 20.0)))) == [
        f"leaderboard {version}   100.00 = 100.00 % of the route x 1.000" for version in ("1.0", "2.0", "2.1")
    ]
