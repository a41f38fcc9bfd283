"""Claims about keys as pedals and wheel."""

import itertools

import pytest
from hypothesis import given
from hypothesis import strategies as st

from basu.agents.manual.inputs import Held
from basu.agents.manual.keyboard import MOST_STEER, Hands, after

DT_S = 0.05
REST = Hands()
ANYTHING = st.lists(st.integers(0, 31).map(Held), max_size=60)


def held_for(keys: Held, ticks: int, hands: Hands = REST) -> Hands:
    for _ in range(ticks):
        hands = after(hands, keys, DT_S)
    return hands


def test_throttle_and_brake_come_on_as_in_carlas_example_and_go_at_once() -> None:
    assert held_for(Held.THROTTLE, 1).throttle == pytest.approx(0.1)
    assert held_for(Held.THROTTLE, 20).throttle == 1.0
    assert held_for(Held.BRAKE, 1).brake == pytest.approx(0.2)
    assert held_for(Held.BRAKE, 20).brake == 1.0
    assert after(Hands(1.0, 1.0, 0.0), Held.NOTHING, DT_S)[:2] == (0.0, 0.0)


def test_the_wheel_turns_to_its_end_and_stays_there() -> None:
    assert held_for(Held.RIGHT, 1).steer == pytest.approx(0.025)
    assert held_for(Held.RIGHT, 100).steer == MOST_STEER
    assert held_for(Held.LEFT, 100).steer == -MOST_STEER


def test_the_wheel_returns_to_the_middle_and_does_not_swing_past_it() -> None:
    turned = held_for(Held.LEFT, 20)
    path = [turned.steer]
    for _ in range(20):
        turned = after(turned, Held.NOTHING, DT_S)
        path.append(turned.steer)
    assert path[-1] == 0.0
    assert all(later >= earlier for earlier, later in itertools.pairwise(path))
    assert path[1] == pytest.approx(path[0] + 0.075)


def test_steering_against_the_turn_goes_through_the_middle() -> None:
    assert after(Hands(steer=0.05), Held.LEFT, DT_S).steer == 0.0
    assert after(Hands(steer=0.0), Held.LEFT, DT_S).steer == pytest.approx(-0.025)


def test_both_keys_of_the_wheel_are_none() -> None:
    assert after(Hands(steer=0.3), Held.LEFT | Held.RIGHT, DT_S) == after(Hands(steer=0.3), Held.NOTHING, DT_S)


def test_a_wheel_taken_over_beyond_what_keys_can_do_is_not_jerked_back() -> None:
    assert after(Hands(steer=0.95), Held.RIGHT, DT_S).steer == 0.95
    assert after(Hands(steer=0.95), Held.NOTHING, DT_S).steer == pytest.approx(0.875)


@given(ANYTHING)
def test_whatever_is_pressed_stays_within_carlas_ranges(pressed: list[Held]) -> None:
    hands = Hands()
    for keys in pressed:
        hands = after(hands, keys, DT_S)
        assert 0.0 <= hands.throttle <= 1.0
        assert 0.0 <= hands.brake <= 1.0
        assert abs(hands.steer) <= MOST_STEER


@given(ANYTHING)
def test_left_is_the_mirror_of_right(pressed: list[Held]) -> None:
    mirror = {Held.LEFT: Held.RIGHT, Held.RIGHT: Held.LEFT}
    one, other = Hands(), Hands()
    for keys in pressed:
        swapped = keys & ~(Held.LEFT | Held.RIGHT)
        for key, mirrored in mirror.items():
            swapped |= mirrored if key in keys else Held.NOTHING
        one, other = after(one, keys, DT_S), after(other, swapped, DT_S)
        assert one.steer == -other.steer
