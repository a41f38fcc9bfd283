"""Tests of ``basu_window.manual.inputs``."""

import itertools

import carla
import pytest
from hypothesis import given
from hypothesis import strategies as st

from basu_window.manual.inputs import MOST_STEER, Axes, Held, Input, PedalsAndWheel, Person, Strike, after

DT_S = 0.05
REST = PedalsAndWheel()
ANYTHING = st.lists(st.integers(0, 31).map(Held), max_size=60)


def held_for(keys: Held, ticks: int, hands: PedalsAndWheel = REST) -> PedalsAndWheel:
    for _ in range(ticks):
        hands = after(hands, keys, DT_S)
    return hands


def test_throttle_and_brake_come_on_as_in_carlas_example_and_go_at_once() -> None:
    assert held_for(Held.THROTTLE, 1).throttle == pytest.approx(0.1)
    assert held_for(Held.THROTTLE, 20).throttle == 1.0
    assert held_for(Held.BRAKE, 1).brake == pytest.approx(0.2)
    assert held_for(Held.BRAKE, 20).brake == 1.0
    assert after(PedalsAndWheel(1.0, 1.0, 0.0), Held.NOTHING, DT_S)[:2] == (0.0, 0.0)


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
    assert after(PedalsAndWheel(steer=0.05), Held.LEFT, DT_S).steer == 0.0
    assert after(PedalsAndWheel(steer=0.0), Held.LEFT, DT_S).steer == pytest.approx(-0.025)


def test_both_keys_of_the_wheel_are_none() -> None:
    assert after(PedalsAndWheel(steer=0.3), Held.LEFT | Held.RIGHT, DT_S) == after(
        PedalsAndWheel(steer=0.3), Held.NOTHING, DT_S
    )


def test_a_wheel_taken_over_beyond_what_keys_can_do_is_not_jerked_back() -> None:
    assert after(PedalsAndWheel(steer=0.95), Held.RIGHT, DT_S).steer == 0.95
    assert after(PedalsAndWheel(steer=0.95), Held.NOTHING, DT_S).steer == pytest.approx(0.875)


@given(ANYTHING)
def test_whatever_is_pressed_stays_within_carlas_ranges(pressed: list[Held]) -> None:
    hands = PedalsAndWheel()
    for keys in pressed:
        hands = after(hands, keys, DT_S)
        assert 0.0 <= hands.throttle <= 1.0
        assert 0.0 <= hands.brake <= 1.0
        assert abs(hands.steer) <= MOST_STEER


@given(ANYTHING)
def test_left_is_the_mirror_of_right(pressed: list[Held]) -> None:
    mirror = {Held.LEFT: Held.RIGHT, Held.RIGHT: Held.LEFT}
    one, other = PedalsAndWheel(), PedalsAndWheel()
    for keys in pressed:
        swapped = keys & ~(Held.LEFT | Held.RIGHT)
        for key, mirrored in mirror.items():
            swapped |= mirrored if key in keys else Held.NOTHING
        one, other = after(one, keys, DT_S), after(other, swapped, DT_S)
        assert one.steer == -other.steer


AGENTS = carla.VehicleControl(throttle=0.4, steer=0.3)
P = Input(strikes=(Strike.AUTOPILOT,))
Q = Input(strikes=(Strike.REVERSE,))
GAS = Input(Held.THROTTLE)


class Script:
    """Does one thing after the other."""

    def __init__(self, *done: Input) -> None:
        self.done = done

    def read(self, tick: int) -> Input:
        return self.done[tick]


def drives(*done: Input, first: bool, any_input: bool = False) -> list[carla.VehicleControl | None]:
    person = Person(Script(*done), drives_first=first, taken_by_any_input=any_input, live=False)
    return [person.step(tick, DT_S, AGENTS) for tick in range(len(done))]


def test_an_actor_that_drives_first_drives_until_p() -> None:
    answers = drives(GAS, P, GAS, P, GAS, first=True)
    assert [answer is not None for answer in answers] == [True, False, False, True, True]


def test_under_an_agent_keys_do_nothing_before_p() -> None:
    answers = drives(GAS, Input(Held.LEFT), P, GAS, P, first=False)
    assert [answer is not None for answer in answers] == [False, False, True, True, False]


@pytest.mark.parametrize(
    "touch", [GAS, Input(Held.HAND_BRAKE), Input(axes=Axes(0.5, 0.0, 0.0)), Input(axes=Axes(0.0, 0.0, 0.1))]
)
def test_any_touch_takes_over_where_that_is_wished(touch: Input) -> None:
    answers = drives(P, Input(), touch, first=True, any_input=True)
    assert [answer is not None for answer in answers] == [False, False, True]


def test_a_stick_at_rest_takes_nothing_over() -> None:
    answers = drives(P, Input(axes=Axes(0.0, 0.0, 0.0)), first=True, any_input=True)
    assert answers == [None, None]


def test_p_hands_over_even_while_a_key_is_down() -> None:
    both = Input(Held.THROTTLE, (Strike.AUTOPILOT,))
    assert drives(GAS, both, first=True, any_input=True)[1] is None


def test_the_wheel_is_taken_over_as_it_stands() -> None:
    _, taken, later = drives(Input(), P, Input(), first=False)
    assert taken is not None
    assert taken.steer == pytest.approx(0.3 - 0.075)
    assert taken.throttle == 0.0
    assert later is not None
    assert later.steer == pytest.approx(0.3 - 0.15)


def test_q_changes_the_direction_only_for_one_that_drives() -> None:
    _, first, second, third = drives(Q, Input(strikes=(Strike.AUTOPILOT, Strike.REVERSE)), GAS, Q, first=False)
    assert first is not None
    assert first.reverse
    assert second is not None
    assert second.reverse
    assert third is not None
    assert not third.reverse


def test_of_keys_and_pedals_what_is_pressed_more_counts() -> None:
    (answer,) = drives(Input(Held.BRAKE, (), Axes(-0.5, 0.8, 0.1)), first=True)
    assert answer is not None
    assert (answer.throttle, answer.brake, answer.steer) == pytest.approx((0.8, 0.2, -0.5))


def test_the_hand_brake_holds_while_its_key_or_button_is_down() -> None:
    by_key, by_button, released = drives(
        Input(Held.HAND_BRAKE), Input(axes=Axes(0.0, 0.0, 0.0, True)), Input(), first=True
    )
    assert by_key is not None
    assert by_key.hand_brake
    assert by_button is not None
    assert by_button.hand_brake
    assert released is not None
    assert not released.hand_brake
