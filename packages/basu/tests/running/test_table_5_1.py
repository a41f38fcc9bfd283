"""Claims about the experiment: table 5.1 against its own formulas, and our table beside it."""

import pytest

from basu.metrics.infraction import Infraction
from basu.output.report.templates import html
from basu.running.table_5_1 import PRINTED, in_page, measured, text
from basu.running.thesis_experiment import CASES, differences

OURS = {
    "basic": measured({Infraction.STOP_SIGN: 1}, 0.998),
    "behavioral": measured({Infraction.COLLISION_STATIC: 1, Infraction.SPEEDING: 1}, 0.56),
    "forward": measured({Infraction.COLLISION_STATIC: 1}, 0.09),
    "human": measured({Infraction.SPEEDING: 3}, 0.98),
}


@pytest.mark.parametrize("agent", PRINTED)
def test_each_printed_driving_score_follows_from_its_printed_parts(agent: str) -> None:
    assert PRINTED[agent].driving_by_formula() == pytest.approx(PRINTED[agent].driving, abs=5e-4)


def test_the_printed_infraction_scores_follow_from_the_counts_but_for_the_behavioral_agents() -> None:
    assert {agent: row.follows() for agent, row in PRINTED.items()} == {
        "basic": True,
        "behavioral": False,
        "forward": True,
        "human": True,
    }
    assert PRINTED["behavioral"].infraction_by_formula() == pytest.approx(0.52)


def test_stop_signs_are_left_out_as_the_thesis_did_and_reported_beside() -> None:
    row = OURS["basic"]
    assert row.infraction == 1.0
    assert row.driving == pytest.approx(0.8 + 0.2 * 0.998)
    assert row.stop_signs == 1
    assert row.driving_with_stop_signs == pytest.approx(0.8 * 0.8 + 0.2 * 0.998)


def test_the_sentences_say_what_does_not_follow_and_what_was_rounded() -> None:
    sentences = differences(PRINTED, OURS, "a program")
    behavioral = next(s for s in sentences if s.startswith("behavioral: "))
    assert "0.13 does not follow from one collision and one speeding" in behavioral
    assert "0.65 x 0.8 = 0.52" in behavioral
    assert "0.528" in behavioral
    human = next(s for s in sentences if s.startswith("human: "))
    assert "rounds the infraction score 0.512 to 0.51" in human
    assert "keys were pressed by: a program" in human
    forward = next(s for s in sentences if s.startswith("forward: "))
    assert "one collision and 0 times too fast here, one collision and 1 times there" in forward
    assert "path following" not in human  # it is the same


def test_both_tables_stand_beside_each_other() -> None:
    lines = text(PRINTED, OURS).splitlines()
    assert len(lines) == 2 + 2 * len(OURS)
    assert lines[4].split() == ["behavioral", "here", "1", "1", "0.520", "0.560", "0.528", "0.528", "(0", "run)"]
    assert lines[5].split() == ["thesis", "1", "1", "0.13", "0.56", "0.216", "not", "counted"]
    (section,) = in_page(PRINTED, OURS, ["because <so>"])
    assert "because &lt;so&gt;" in html(section)


def test_every_row_of_the_table_is_driven() -> None:
    assert [case.row for case in CASES] == list(PRINTED)
