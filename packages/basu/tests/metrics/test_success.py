"""The one rule of success: what decides against a drive, alone, and what says nothing of the agent."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from basu.metrics.result import Result, judge
from basu.metrics.success import Success, success_of_verdict
from basu.outcome import Outcome, Status
from basu.output.report.comparison import row
from basu.output.report.console import table
from basu.records.history import OTHER, History
from fakes.drives import at, driven, hit, stop_sign
from fakes.paths import along, route_along

DONE = Outcome(Status.COMPLETED, "arrived after 25.0 s")
CORNERS = ((0.0, 0.0), (200.0, 0.0))
SIGN = stop_sign(100.0, "69")
SCENARIO = {"id": "1", "scenario": "CutIn", "reached": True, "began_s": 1.0, "verdict": "FAILURE", "message": "it hit"}


def good() -> History:
    return along(route_along(CORNERS), CORNERS)


def asked(history: History, outcome: Outcome = DONE, **more: object) -> Result:
    return judge(outcome, history, **more)  # type: ignore[arg-type]


def test_a_drive_along_its_route_passes() -> None:
    assert asked(good()).success == Success(passed=True)


def test_a_missed_stop_sign_fails_a_drive_that_arrived() -> None:
    found = asked(along(route_along(CORNERS, (SIGN,)), CORNERS))
    assert found.success.passed is False
    assert found.success.reasons[0].startswith("ran stop sign 69 at ")
    assert found.success.sentence in table(found).replace("result            ", "")
    assert row("agent", found).cell("result") == "failed"


def test_speeding_fails_it() -> None:
    found = asked(along(route_along(CORNERS), CORNERS, speed_mps=20.0))
    assert found.success.reasons[0].split(" at ")[0] == "was too fast"


def test_a_way_off_the_road_fails_it() -> None:
    corners = ((0.0, 0.0), (80.0, 0.0), (85.0, 4.0), (90.0, 4.0), (95.0, 0.0), (200.0, 0.0))
    (reason, *_) = asked(along(route_along(CORNERS), corners)).success.reasons
    assert reason.startswith("left the road at ")


def test_the_wrong_way_fails_it_and_a_metre_back_does_not() -> None:
    there_and_back = ((0.0, 0.0), (100.0, 0.0), (90.0, 0.0), (200.0, 0.0))
    assert any("wrong way" in reason for reason in asked(along(route_along(CORNERS), there_and_back)).success.reasons)
    a_metre = ((0.0, 0.0), (100.0, 0.0), (99.0, 0.0), (200.0, 0.0))
    assert asked(along(route_along(CORNERS), a_metre)).success.passed


def test_to_be_pushed_back_by_a_contact_is_not_the_wrong_way() -> None:
    back = along(route_along(CORNERS), ((0.0, 0.0), (100.0, 0.0), (94.0, 0.0), (200.0, 0.0)))
    turn = int(np.argmin(np.abs(back.frames["x_m"][:260] - 100.0)))

    def reasons(*ticks: int) -> tuple[str, ...]:
        contacts = tuple(hit(tick, "vehicle.lincoln.mkz_2020", 9) for tick in ticks)
        return asked(replace(back, collisions=contacts)).success.reasons

    assert any("wrong way" in reason for reason in reasons())
    assert not any("wrong way" in reason for reason in reasons(turn))
    assert any("wrong way" in reason for reason in reasons(turn - 60))


ROUND = ((0.0, 0.0), (80.0, 0.0), (85.0, -3.5), (105.0, -3.5), (110.0, 0.0), (200.0, 0.0))


def beside(other_m: tuple[float, float], type_id: str, speed_mps: float = 0.0) -> History:
    """The record of a way through the oncoming lane with one other at a place, which moves east by its speed alone."""
    history = along(route_along(CORNERS), ROUND)
    others = np.zeros(len(history.frames), dtype=OTHER)
    others["tick"], others["id"] = history.frames["tick"], 7
    others["x_m"], others["y_m"], others["velocity_x_mps"] = *other_m, speed_mps
    return replace(history, others=others, facts=replace(history.facts, actor_types={7: type_id}))


@pytest.mark.parametrize(
    ("history", "passed"),
    [
        pytest.param(along(route_along(CORNERS), ROUND), False, id="nothing"),
        pytest.param(beside((95.0, 0.5), "vehicle.ford.ambulance"), True, id="a parked van"),
        pytest.param(beside((95.0, 2.5), "static.prop.constructioncone"), True, id="a cone at the edge"),
        pytest.param(beside((95.0, 0.0), "vehicle.ford.ambulance", 4.0), False, id="a van that drives"),
        pytest.param(beside((95.0, 1.0), "vehicle.gazelle.omafiets", 4.0), True, id="a cyclist"),
        pytest.param(beside((95.0, 4.5), "vehicle.ford.ambulance"), False, id="a van on the pavement"),
        pytest.param(beside((40.0, 0.0), "vehicle.ford.ambulance"), False, id="a van far behind"),
    ],
)
def test_the_oncoming_lane_is_for_passing_what_stands_in_ones_own(
    history: History,
    passed: bool,  # noqa: FBT001 - parametrized
) -> None:
    found = asked(history).success
    assert found.passed is passed
    assert any("in the lane of oncoming traffic at" in reason for reason in found.reasons) is not passed


def test_two_metres_in_the_oncoming_lane_are_forgiven() -> None:
    corners = ((0.0, 0.0), (80.0, 0.0), (84.0, -1.8), (85.0, -1.8), (90.0, 0.0), (200.0, 0.0))
    assert asked(along(route_along(CORNERS), corners)).success.passed


@pytest.mark.parametrize(
    ("verdict", "passed"), [("FAILURE", False), ("AGENT_FAULT", False), ("SUCCESS", True), ("NOT_EXERCISED", True)]
)
def test_a_failed_scenario_of_the_route_fails_it(verdict: str, passed: bool) -> None:  # noqa: FBT001 - parametrized
    found = asked(good(), scenarios=({**SCENARIO, "verdict": verdict},))
    assert found.success.passed is passed
    assert found.success.reasons == (() if passed else ("scenario 1 (CutIn): it hit",))
    assert ("1 not exercised" in table(found)) is (verdict == "NOT_EXERCISED")


@pytest.mark.parametrize(
    ("status", "passed"),
    [
        (Status.AGENT_CRASHED, False),
        (Status.ROUTE_TIMEOUT, False),
        (Status.ROUTE_DEVIATION, False),
        (Status.SIMULATOR_FAILED, None),
        (Status.SETUP_FAILED, None),
        (Status.INTERRUPTED, None),
        (Status.STOPPED, None),
    ],
)
def test_a_route_not_driven_to_its_end_fails_where_the_agent_ended_it(status: Status, passed: bool | None) -> None:  # noqa: FBT001
    assert asked(good(), Outcome(status, "it ended")).success == Success(
        passed, (f"not completed ({status.value}): it ended",)
    )


def test_no_fault_that_follows_takes_a_broken_rule_back() -> None:
    history = along(route_along(CORNERS, (SIGN,)), CORNERS)
    assert asked(history, Outcome(Status.SIMULATOR_FAILED, "gone")).success.passed is False


def test_a_collision_counts_where_the_ego_is_at_fault() -> None:
    moving = driven(at(4.0, 2.0), collisions=[hit(5)])
    assert any(reason.startswith("at fault") for reason in asked(moving).success.reasons)
    standing = driven(at(0.0, 2.0), collisions=[hit(5)])
    assert not any("fault" in reason for reason in asked(standing).success.reasons)


def test_a_run_that_died_at_once_shows_no_score_that_could_be_mistaken() -> None:
    found = asked(good(), Outcome(Status.AGENT_CRASHED, "it raised"))
    line = next(line for line in table(found).splitlines() if line.startswith("driving score"))
    assert line.split("driving score")[1].strip().startswith("not completed; the thesis's figure ")
    assert row("agent", found).cell("driving score").startswith("not completed")


def test_the_document_keeps_the_answer() -> None:
    found = asked(good(), Outcome(Status.AGENT_CRASHED, "it raised"))
    document = found.document()
    assert document["passed"] is False
    assert document["reasons"] == ["not completed (AgentCrashed): it raised"]
    assert Result.from_document(document).success == found.success
    del document["passed"], document["reasons"]
    assert Result.from_document(document).success == Success(None)


@pytest.mark.parametrize(
    ("verdict", "passed"), [("SUCCESS", True), ("FAILURE", False), ("AGENT_FAULT", False), ("NOT_EXERCISED", None)]
)
def test_a_verdict_of_a_case_in_the_same_words(verdict: str, passed: bool | None) -> None:  # noqa: FBT001
    assert success_of_verdict(verdict, "why").passed is passed
