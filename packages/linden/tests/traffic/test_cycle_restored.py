import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from linden.protocol.values.enums import TrafficLightState as Light
from linden.traffic import cycle
from linden.traffic.cycle import CycleState, restored

PLAN = cycle.plan([[[0, 2], [1]], [[3]], [[4], [5], [6, 7]]])
ALL = np.arange(8)


def after(seconds: float, step_s: float = 0.5) -> CycleState:
    state = cycle.initial(PLAN)
    for _ in range(round(seconds / step_s)):
        state = cycle.step(PLAN, state, step_s)
    return state


def shown(state: CycleState) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    return state.colour, cycle.elapsed_s(PLAN, state), cycle.is_frozen(PLAN, state)


@given(st.integers(0, 120).map(lambda n: 0.5 * n))
def test_lights_stand_as_they_were_seen_whenever_that_was(seconds: float) -> None:
    seen = shown(after(seconds))
    for before, after_ in zip(seen, shown(restored(PLAN, cycle.initial(PLAN), ALL, *seen)), strict=True):
        np.testing.assert_array_equal(before, after_)


@given(st.integers(0, 120).map(lambda n: 0.5 * n))
def test_lights_that_have_a_turn_go_on_from_there(seconds: float) -> None:
    state = after(seconds)
    again = restored(PLAN, cycle.initial(PLAN), ALL, *shown(state))
    has_turn = state.elapsed_s > 0.0  # where a stage has just begun and all is red, nothing tells whose it is
    if has_turn.all():
        for _ in range(20):
            state, again = cycle.step(PLAN, state, 0.5), cycle.step(PLAN, again, 0.5)
            np.testing.assert_array_equal(state.colour, again.colour)


def test_others_stay_as_they_are() -> None:
    state = after(7.0)
    changed = restored(PLAN, state, np.array([3]), np.array([Light.RED], np.uint8), np.array([1.0]), np.array([True]))
    others = np.delete(ALL, 3)
    for before, now in zip(shown(state), shown(changed), strict=True):
        np.testing.assert_array_equal(before[others], now[others])
    assert [column[3] for column in shown(changed)] == [Light.RED, 1.0, True]


@pytest.mark.parametrize("colour", [Light.OFF, Light.UNKNOWN])
def test_colours_outside_of_the_cycle_are_shown_too(colour: Light) -> None:
    state = restored(PLAN, after(3.0), np.array([3]), np.array([colour], np.uint8), np.array([0.5]), np.array([False]))
    assert state.colour[3] == colour
