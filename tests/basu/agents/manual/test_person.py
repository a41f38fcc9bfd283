"""Claims about the person: who drives, how that changes, and what the vehicle gets."""

import carla
import pytest

from basu.agents.manual.inputs import Axes, Held, Input, Strike
from basu.agents.manual.person import Person

DT_S = 0.05
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


def test_who_drives_first_drives_until_p() -> None:
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


def test_q_changes_the_direction_only_for_who_drives() -> None:
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
