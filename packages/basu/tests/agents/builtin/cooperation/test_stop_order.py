"""Claims about the order at stop signs that vehicles agree by radio."""

import pytest

from basu.agents.builtin.cooperation.stop_order import CLEAR_S, KEPT_S, YIELDS_S, StopOrder, StoppedVehicle, line_text

HERE, ACROSS = (0.0, 0.0), (10.0, 0.0)


def heard(stopped_s: float, now_s: float, line: tuple[float, float] = ACROSS) -> StopOrder:
    order = StopOrder()
    order.hear([line_text(StoppedVehicle(*line, stopped_s), now_s)], now_s)
    return order


def test_the_vehicle_that_stopped_first_drives_first() -> None:
    now_s = 105.0
    own = StoppedVehicle(*HERE, 102.0)
    assert heard(100.0, now_s).is_before(own, now_s)
    assert not heard(104.0, now_s).is_before(own, now_s)


def test_of_two_vehicles_one_at_most_waits_for_the_other() -> None:
    now_s = 110.0
    for step in range(-40, 41):
        one, other = StoppedVehicle(*HERE, 105.0), StoppedVehicle(*ACROSS, 105.0 + 0.1 * step)
        first, second = StopOrder(), StopOrder()
        first.hear([line_text(other, now_s)], now_s)
        second.hear([line_text(one, now_s)], now_s)
        waits = [first.is_before(one, now_s), second.is_before(other, now_s)]
        assert sum(waits) <= 1
        assert any(waits) == (abs(0.1 * step) > CLEAR_S + 0.005) or abs(abs(0.1 * step) - CLEAR_S) < 0.011


def test_a_text_counts_for_a_moment_and_no_vehicle_waits_for_ever() -> None:
    order = heard(100.0, 105.0)
    own = StoppedVehicle(*HERE, 102.0)
    order.hear([], 105.0 + KEPT_S + 0.01)
    assert not order.is_before(own, 105.0 + KEPT_S + 0.01)
    late_s = 102.0 + YIELDS_S + 0.1
    assert not heard(100.0, late_s).is_before(own, late_s)


def test_a_line_elsewhere_or_the_own_line_does_not_count() -> None:
    own = StoppedVehicle(*HERE, 102.0)
    assert not heard(100.0, 105.0, (60.0, 0.0)).is_before(own, 105.0)
    assert not heard(100.0, 105.0, (0.1, 0.0)).is_before(own, 105.0)
    assert heard(100.0, 105.0, (0.0, 37.0)).is_before(own, 105.0)  # opposite lines of a junction of the LEAP


@pytest.mark.parametrize("text", ["", "LINE", "LINE 1 2", "LINE 1 2 3 4", "LINE a b c", "LINE nan 0 1", "LEFT A 5"])
def test_strange_texts_change_nothing(text: str) -> None:
    order = StopOrder()
    order.hear([text], 105.0)
    assert not order.is_before(StoppedVehicle(*HERE, 104.9), 105.0)
