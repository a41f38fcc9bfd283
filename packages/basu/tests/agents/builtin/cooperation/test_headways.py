"""Claims about headway control by radio texts."""

import pytest

from basu.agents.autonomous_agent import LONGEST_TEXT_BYTES
from basu.agents.builtin.cooperation.headways import GAIN, LONGEST_HOLD_S, Headways

PLACES_M = {"A": 0.0, "B": 1000.0, "C": 2000.0}


def pair() -> tuple[Headways, Headways]:
    return Headways(PLACES_M, 3000.0), Headways(PLACES_M, 3000.0)


def hear(listener: Headways, speaker: Headways, now_s: float) -> None:
    text = speaker.text(now_s)
    assert text is not None
    listener.hear([("7", text)], now_s)


def test_a_vehicle_that_hears_no_other_does_not_hold() -> None:
    own, _ = pair()
    assert own.hold_s("A", 100.0) == 0.0
    assert own.text(100.0) is None


def test_a_vehicle_close_behind_another_one_holds_for_half_the_difference_of_the_gaps() -> None:
    own, other = pair()
    round_s = 3000.0 / 5.0 + 3 * 15.0
    other.left("A", 100.0)
    hear(own, other, 110.0)
    gaps_s = own.gaps_s("A", 400.0)
    assert gaps_s == pytest.approx((300.0, round_s - 300.0))
    assert own.hold_s("A", 400.0) == pytest.approx(GAIN * 0.5 * (round_s - 600.0), abs=1e-6)
    assert own.hold_s("A", 110.0) == LONGEST_HOLD_S
    assert own.hold_s("A", 700.0) == 0.0  # the other one is nearer behind than ahead


def test_what_was_heard_is_moved_on_to_the_next_stops() -> None:
    own, other = pair()
    round_s = 3000.0 / 5.0 + 3 * 15.0
    other.left("A", 100.0)
    hear(own, other, 100.0)
    gaps_s = own.gaps_s("B", 100.0 + round_s / 3.0 + 50.0)
    assert gaps_s == pytest.approx((50.0, round_s - 50.0))
    assert own.gaps_s("elsewhere", 0.0) is None


def test_a_round_that_was_driven_tells_its_time() -> None:
    own, other = pair()
    own.left("A", 0.0)
    own.left("A", 900.0)
    other.left("A", 0.0)
    hear(own, other, 0.0)
    assert own.gaps_s("A", 450.0) == pytest.approx((450.0, 450.0))


def test_a_text_fits_into_a_message_and_names_the_latest_stop_first() -> None:
    names = [f"stop{number}" for number in range(20)]
    own = Headways({name: 100.0 * number for number, name in enumerate(names)}, 3000.0)
    for number, name in enumerate(names):
        own.left(name, 60.0 * number)
    text = own.text(2000.0)
    assert text is not None
    assert len(text.encode()) <= LONGEST_TEXT_BYTES
    assert text.startswith("LEFT stop19 860 stop18 920")


@pytest.mark.parametrize(
    "text", ["", "LEFT", "LEFT A", "LEFT A soon", "LEFT Z 5", "LEFT A -5", "LEFT A nan", "LEFT A 1e9", "DENM 12 1"]
)
def test_strange_texts_change_nothing(text: str) -> None:
    own, _ = pair()
    own.hear([("7", text)], 100.0)
    assert own.gaps_s("A", 100.0) is None
