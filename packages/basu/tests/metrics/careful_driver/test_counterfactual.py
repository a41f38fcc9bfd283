"""Claims about what the models would have done, and about drivers that try to make an encounter look unavoidable."""

import pytest

from basu.metrics.careful_driver.counterfactual import ModelOutcome, answers
from basu.metrics.careful_driver.encounters import encounters
from basu.metrics.careful_driver.metric import MODELS
from basu.records.history import History
from fakes.lane_conflicts import LANE_M, braking, cut_in, meeting, sideways, steady


def of_contact(history: History) -> dict[str, ModelOutcome]:
    (found,) = (each for each in encounters(history) if each.is_contact)
    return {answer.model: answer for answer in answers(history, found, MODELS)}


def avoiding(history: History) -> set[str]:
    return {name for name, answer in of_contact(history).items() if answer.avoids}


@pytest.mark.parametrize(
    ("gap_m", "avoids"),
    [(4.0, set()), (9.0, {"FSM", "RSS", "Reg157"}), (12.0, {"FSM", "CC", "RSS", "Reg157"})],
)
def test_the_nearer_a_cut_in_the_fewer_avoid_it(gap_m: float, avoids: set[str]) -> None:
    assert avoiding(meeting(steady(10.0), cut_in(10.0, 5.0, gap_m))) == avoids


def test_both_sides_are_alike() -> None:
    left, right = (of_contact(meeting(steady(10.0), cut_in(10.0, 5.0, 9.0, side=side))) for side in (-1.0, 1.0))
    for name, answer in left.items():
        assert answer.hardest_mps2 == pytest.approx(right[name].hardest_mps2)
        assert answer.avoids == right[name].avoids


def test_an_answer_stands_in_words() -> None:
    found = of_contact(meeting(steady(10.0), cut_in(10.0, 5.0, 4.0)))["CC"]
    assert found.sentence == (
        "CC begins at 10.0 m/s, reacts after 1.00 s and brakes with up to 0.0 m/s², "
        "and hits the other with a difference of 5.0 m/s"
    )


def test_speeding_makes_no_cut_in_unavoidable() -> None:
    """A driver at 20 m/s where 10 are allowed: at its speed every model hits the other, at the limit none does."""
    fast = meeting(steady(20.0), cut_in(20.0, 5.0, 12.0), limit_mps=30.0)
    assert avoiding(fast) == set()
    cheat = meeting(steady(20.0), cut_in(20.0, 5.0, 12.0), limit_mps=10.0)
    assert avoiding(cheat) == {"FSM", "CC", "RSS", "Reg157"}
    assert of_contact(cheat)["FSM"].from_mps == 10.0


def test_a_short_gap_makes_no_braking_unavoidable() -> None:
    """A driver that follows 1 m behind: the models begin at the gap that they keep themselves."""
    found = of_contact(meeting(steady(10.0), braking(10.0, 5.0, 4.0, 6.0)))
    assert all(answer.avoids for answer in found.values())


def test_speeding_up_into_the_gap_does_not_help() -> None:
    """A driver that closes up to a vehicle that cuts in far ahead: the models keep the speed of the beginning."""

    def own(t_s: float) -> tuple[float, float]:
        late_s = max(0.0, t_s - 3.5)
        return 10.0 * t_s + 2.0 * late_s**2, 0.0

    history = meeting(own, cut_in(10.0, 8.0, 12.0))
    assert avoiding(history) == {"FSM", "CC", "RSS", "Reg157"}


def test_leaving_the_lane_makes_no_cut_in() -> None:
    """A driver that drifts into its neighbour: on the planned way they never meet, and no model is blamed."""
    own = sideways(10.0, 0.0, (0.0, -LANE_M), 3.0, 2.0)
    history = meeting(own, steady(9.0, 9.0, -LANE_M))
    (found,) = (each for each in encounters(history) if each.is_contact)
    assert found.situation is None
    assert "the models keep their lane" in found.sentence
    assert answers(history, found, MODELS) == ()


def test_a_hard_braking_before_a_follower_is_no_encounter_ahead() -> None:
    history = meeting(braking(10.0, 0.0, 3.0, 8.0), steady(10.0, -12.0))
    (found,) = (each for each in encounters(history) if each.is_contact)
    assert found.situation is None
    assert "from behind" in found.sentence


def test_a_cut_out_is_answered_from_the_gap_to_the_vehicle_that_leaves() -> None:
    leader = sideways(10.0, 14.0, (0.0, -LANE_M), 3.0, 1.5)
    found = of_contact(meeting(steady(10.0), steady(0.0, 75.0), leader=leader))
    assert found["FSM"].avoids
    assert found["FSM"].reaction_s >= 0.0


def test_the_same_record_gives_the_same_answers() -> None:
    history = meeting(steady(10.0), cut_in(10.0, 5.0, 9.0))
    assert repr(of_contact(history)) == repr(of_contact(history))
