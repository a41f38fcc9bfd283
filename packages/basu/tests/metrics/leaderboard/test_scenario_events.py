"""Claims about scenario timeouts and emergency vehicles in the leaderboard's scores, from the rows of scenarios."""

from typing import Any

import pytest

from basu.metrics.leaderboard import Kind, Version, leaderboard_scores
from basu.metrics.leaderboard.scenario_events import YIELDS
from fakes.drives import at, driven

TIMEOUT: dict[str, Any] = {"reached": True, "timed_out": True, "ended_s": 10.0, "judgements": [], "actors": []}
IN_TIME = {**TIMEOUT, "timed_out": False}
NOT_LET_BY = {**IN_TIME, "judgements": [{"criterion": YIELDS, "passed": False}]}
LET_BY = {**IN_TIME, "judgements": [{"criterion": YIELDS, "passed": True}]}
NEVER_NEAR = {**IN_TIME, "judgements": [{"criterion": YIELDS, "passed": None}]}


@pytest.mark.parametrize(
    ("row", "kind", "factor", "points"),
    [(TIMEOUT, Kind.SCENARIO_TIMEOUT, 0.7, 0.4), (NOT_LET_BY, Kind.YIELD_EMERGENCY, 0.7, 0.4)],
)
def test_each_costs_what_the_leaderboard_takes_and_nothing_in_1_0(
    row: dict[str, Any], kind: Kind, factor: float, points: float
) -> None:
    first, second, third = leaderboard_scores(driven(at(10.0, 20.0)), [row])
    assert (first.infraction_penalty, first.events) == (1.0, ())
    assert second.infraction_penalty == pytest.approx(factor)
    assert third.infraction_penalty == pytest.approx(1.0 / (1.0 + points))
    assert [(event.kind, event.tick) for event in second.events] == [(kind, 200)]


def test_a_vehicle_that_was_let_by_costs_nothing() -> None:
    assert leaderboard_scores(driven(at(10.0, 20.0)), [LET_BY])[1].infraction_penalty == 1.0


def test_a_scenario_that_lasted_to_the_end_of_the_run_counts_there() -> None:
    history = driven(at(10.0, 20.0))
    (event,) = leaderboard_scores(history, [{**NOT_LET_BY, "ended_s": None}])[1].events
    assert event.tick == len(history.frames) - 1 or event.tick > 390


def test_a_scenario_behind_the_leaderboards_end_does_not_count() -> None:
    history = driven([*at(10.0, 10.0), *at(0.0, 200.0)])
    scores = leaderboard_scores(history, [{**TIMEOUT, "ended_s": 205.0}])[1]
    assert (scores.ended_by, [event.kind for event in scores.events]) == (Kind.BLOCKED, [Kind.BLOCKED])


@pytest.mark.parametrize(
    ("rows", "missing"),
    [
        ([], [Kind.SCENARIO_TIMEOUT, Kind.YIELD_EMERGENCY]),
        ([IN_TIME], [Kind.YIELD_EMERGENCY]),
        ([LET_BY], []),
        ([NEVER_NEAR], [Kind.YIELD_EMERGENCY]),
        ([{**IN_TIME, "reached": False}], [Kind.SCENARIO_TIMEOUT, Kind.YIELD_EMERGENCY]),
        (
            [{key: value for key, value in IN_TIME.items() if key != "timed_out"}],
            [Kind.SCENARIO_TIMEOUT, Kind.YIELD_EMERGENCY],
        ),
    ],
)
def test_what_no_scenario_could_show_is_named_as_not_measured(rows: list[dict[str, Any]], missing: list[Kind]) -> None:
    for scores in leaderboard_scores(driven(at(10.0, 20.0)), rows):
        wanted = [] if scores.version is Version.V1_0 else missing
        assert sorted(kind.value for kind in scores.not_measured) == sorted(kind.value for kind in wanted)


def test_the_case_of_a_drive_counts_by_its_status() -> None:
    case = {"status": "ScenarioTimeout", "judgements": [], "actors": []}
    assert [event.kind for event in leaderboard_scores(driven(at(10.0, 20.0)), [case])[1].events] == [
        Kind.SCENARIO_TIMEOUT
    ]
