"""The three answers at the head of a result say what the judgement says."""

from dataclasses import replace

import pytest

from basu.metrics.result import Result, judge
from basu.metrics.success import Success
from basu.outcome import Outcome, Status
from basu.output.report.console import table
from basu.output.report.html.page import report
from basu.output.report.in_words import answers
from fakes.drives import at, driven, hit, ramp, stop_sign, straight_route
from fakes.run_records import crashing, record

DONE = Outcome(Status.COMPLETED, "arrived")
CALM = [*ramp(0.0, 6.0, 8.0), *at(6.0, 10.0), *ramp(6.0, 0.0, 8.0)]
HARSH = [*at(10.0, 4.0), *ramp(10.0, 0.0, 1.5), *at(0.0, 2.0)]


def said(result: Result) -> dict[str, str]:
    return {answer.question: answer.sentence for answer in answers(result)}


def judged(speeds_mps: list[float], outcome: Outcome = DONE, **more: object) -> Result:
    return judge(outcome, driven(speeds_mps, **more))  # type: ignore[arg-type]


def test_a_calm_drive_without_a_timetable_is_safe_and_comfortable() -> None:
    found = said(judged(CALM))
    assert found["safe"] == "yes: no collision at fault, no broken traffic rule, always on its route"
    assert found["comfortable"].startswith("yes: no harsh stop; comfort score ")
    assert found["on time"] == "not judged: the route has no timetable"


def test_what_decides_against_a_drive_makes_it_unsafe() -> None:
    result = judged(at(8.0, 14.0), route=straight_route(controls=(stop_sign(60.0),)), collisions=[hit(250)])
    found = said(result)["safe"]
    assert found.startswith("no: ")
    assert found.endswith("; and 1 more")
    assert result.success.reasons[0] in found


def test_a_drive_that_ended_early_is_safe_as_far_as_it_went() -> None:
    blocked = Outcome(Status.ROUTE_BLOCKED, "stood still for 180 s")
    assert said(judged(CALM, blocked))["safe"].endswith("as far as it drove")


def test_a_drive_that_says_nothing_of_the_agent_is_not_judged() -> None:
    gone = Outcome(Status.SIMULATOR_FAILED, "the simulator went away")
    assert said(judged(CALM, gone))["safe"] == "not judged: the simulator went away"
    assert answers(replace(judged(CALM), scores=None)) == ()


def test_a_harsh_stop_is_not_comfortable_and_is_named() -> None:
    found = said(judged(HARSH))["comfortable"]
    assert found.startswith("no: braked harshly once, felt up to ")


@pytest.mark.parametrize(
    ("delays_s", "sentence"),
    [
        ((0.0, 4.0), "yes: 2 of 2 stops"),
        ((4.0, 400.0), "no: 1 of 2 stops, up to 400 s late"),
        ((-254.0, 0.0), "no: 1 of 2 stops, up to 254 s early"),
        ((0.0, None), "no: 1 of 2 stops, 1 not reached"),
    ],
)
def test_the_timetable_is_kept_or_not(delays_s: tuple[float | None, ...], sentence: str) -> None:
    result = judged(CALM)
    visits = [{"on_time": each is not None and abs(each) < 10.0, "delay_s": each} for each in delays_s]
    metrics = {**result.metrics, "passengers": {**result.metrics["passengers"], "service": visits}}
    assert said(replace(result, metrics=metrics))["on time"] == sentence


def test_a_case_is_safe_by_its_verdict() -> None:
    case = {"verdict": "FAILURE", "message": "hit walker"}
    result = replace(judged(CALM), case=case, success=Success(False, ("hit walker",)))
    assert said(result)["safe"] == "no: hit walker"


def test_console_and_page_begin_with_them() -> None:
    lines = table(judge(DONE, driven(CALM), meta={"simulated_s": 20.0, "wall_s": 1.0})).splitlines()
    assert [line.split()[0] for line in lines[:4]] == ["safe", "comfortable", "on", "ended"]
    page = report(record(crashing())).decode()
    assert page.index('<dl class="in-words">') < page.index("<h2>")
    assert '<dt>Safe?</dt><dd><b class="no">No</b>' in page


def test_the_console_has_the_figures_of_all_metrics_with_details_only() -> None:
    result = judge(DONE, crashing(), meta={"simulated_s": 20.0, "wall_s": 1.0})
    short, whole = table(result, details=False).splitlines(), table(result).splitlines()
    assert whole[: len(short)] == short
    assert not any(line.startswith(("leaderboard", "passengers", "driven")) for line in short)
    assert sum(line.startswith("leaderboard") for line in whole) == 3
    for found in result.infractions:
        assert any(found.detail in line for line in short)
