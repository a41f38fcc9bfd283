"""Claims about what a result and its console lines tell of the careful drivers."""

import json

from basu.metrics.careful_driver.metric import CarefulDrivers
from basu.metrics.result import Result, judge
from basu.outcome import Outcome, Status
from basu.output.report.html.score_card import cards
from basu.records.history import History
from fakes.lane_conflicts import braking, cut_in, meeting, steady


def judged(history: History | None) -> Result:
    return judge(Outcome(Status.SCENARIO_ENDED, "over"), history)


def test_each_model_answers_by_its_name() -> None:
    result = judged(meeting(steady(10.0), cut_in(10.0, 5.0, 9.0)))
    (row,) = result.metrics["careful_drivers"]["encounters"]
    assert [one["model"] for one in row["answers"]] == ["FSM", "CC", "RSS", "Reg157"]
    assert CarefulDrivers().lines(result) == [
        "careful drivers   at 4.8 s with vehicle.audi.tt (actor 9), cut-in: avoided by FSM, RSS, Reg157; not by CC",
        f"{'law':<18}{row['demand']['sentence']}",
    ]
    assert row["demand"]["sentence"] == (
        "annex III of (EU) 2022/1426: with 1.10 s at 18 km/h a vehicle with standing occupants need not avoid the "
        "contact (table: 1.20 s), another has to (table: 0.66 s)"
    )
    assert json.loads(json.dumps(row, allow_nan=False)) == row


def test_where_none_avoids_the_contact_none_is_left_out() -> None:
    result = judged(meeting(steady(10.0), cut_in(10.0, 5.0, 4.0)))
    assert CarefulDrivers().lines(result)[0].endswith("cut-in: avoided by none of FSM, CC, RSS, Reg157")


def test_the_page_has_a_row_for_each_model() -> None:
    page = "".join(cards(judged(meeting(steady(10.0), braking(10.0, 5.0, 4.0, 6.0)))).values())
    for name in ("FSM", "CC", "RSS", "Reg157"):
        assert f'<th scope="row">{name}</th><td>avoided</td>' in page


def test_a_drive_without_encounters_has_neither_line_nor_card() -> None:
    result = judged(meeting(steady(10.0), steady(10.0, 30.0)))
    assert result.metrics["careful_drivers"] == {"encounters": []}
    assert CarefulDrivers().lines(result) == []
    assert "Careful drivers" not in "".join(cards(result).values())
    assert judged(None).metrics["careful_drivers"] is None
