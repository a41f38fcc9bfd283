"""The cycle of traffic lights: as a table of times and colours, and against an obvious version."""

from dataclasses import dataclass, field

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from linden.protocol.values.enums import TrafficLightState
from linden.traffic import cycle
from linden.traffic.cycle import CycleState, LightPlan

RED, YELLOW, GREEN = TrafficLightState.RED, TrafficLightState.YELLOW, TrafficLightState.GREEN
CROSSING = cycle.plan([[[0, 2], [1, 3]]])
"""One junction: lights 0 and 2 face each other, 1 and 3 cross."""


def after(plan: LightPlan, steps: int, dt_s: float, state: CycleState | None = None) -> CycleState:
    state = cycle.initial(plan) if state is None else state
    for _ in range(steps):
        state = cycle.step(plan, state, dt_s)
    return state


@pytest.mark.parametrize(
    ("time_s", "first", "second"),
    [
        (0, GREEN, RED),
        (10, GREEN, RED),  # a stage lasts until its time is exceeded: 10 s of green end with the 11th second
        (11, YELLOW, RED),
        (14, YELLOW, RED),
        (15, RED, RED),
        (17, RED, RED),
        (18, RED, GREEN),
        (28, RED, GREEN),
        (29, RED, YELLOW),
        (33, RED, RED),
        (36, GREEN, RED),
        (47, YELLOW, RED),
    ],
)
def test_two_controllers_take_turns_in_steps_of_a_second(
    time_s: int, first: TrafficLightState, second: TrafficLightState
) -> None:
    assert after(CROSSING, time_s, 1.0).colour.tolist() == [first, second, first, second]


@pytest.mark.parametrize("dt_s", [0.01, 0.05, 0.1, 1 / 30])
def test_green_gives_way_in_the_first_step_beyond_its_time(dt_s: float) -> None:
    whole = int(10.0 / dt_s + 1e-9)
    assert after(CROSSING, whole, dt_s).colour[0] == GREEN
    assert after(CROSSING, whole + 1, dt_s).colour[0] == YELLOW


def test_elapsed_time_begins_anew_with_every_colour() -> None:
    assert after(CROSSING, 10, 1.0).elapsed_s[0] == 10.0
    assert after(CROSSING, 11, 1.0).elapsed_s[0] == 0.0
    assert after(CROSSING, 12, 1.0).elapsed_s[0] == 1.0


def test_a_long_step_changes_one_colour_and_no_more() -> None:
    assert after(CROSSING, 1, 100.0).colour[0] == YELLOW


def test_never_do_two_controllers_of_a_junction_let_traffic_in() -> None:
    plan = cycle.plan([[[0], [1], [2]]])
    state = cycle.initial(plan)
    shown = set()
    for _ in range(1000):
        state = cycle.step(plan, state, 0.1)
        assert np.sum(state.colour != RED) <= 1
        shown.add(tuple(state.colour))
    assert len(shown) == 7  # each of three green or yellow, and all red


def test_groups_do_not_wait_for_each_other() -> None:
    plan = cycle.plan([[[0], [1]], [[2]]])
    state = cycle.with_frozen(cycle.initial(plan), np.array([0], np.int32), frozen=True)
    assert after(plan, 11, 1.0, state).colour.tolist() == [GREEN, RED, YELLOW]


def test_a_frozen_group_goes_on_where_it_stood() -> None:
    groups = np.array([0], np.int32)
    state = cycle.with_frozen(after(CROSSING, 8, 1.0), groups, frozen=True)
    thawed = cycle.with_frozen(after(CROSSING, 50, 1.0, state), groups, frozen=False)
    assert thawed.elapsed_s[0] == 8.0
    assert after(CROSSING, 2, 1.0, thawed).colour[0] == GREEN
    assert after(CROSSING, 3, 1.0, thawed).colour[0] == YELLOW


def test_a_colour_that_was_set_holds_until_the_controller_changes() -> None:
    state = cycle.with_colour(cycle.initial(CROSSING), 1, GREEN)
    assert after(CROSSING, 17, 1.0, state).colour[1] == GREEN
    assert after(CROSSING, 17, 1.0, state).colour[3] == RED
    assert after(CROSSING, 29, 1.0, state).colour[1] == YELLOW


def test_times_hold_for_all_lights_of_a_controller_and_for_no_other() -> None:
    state = cycle.with_time(CROSSING, cycle.initial(CROSSING), 2, GREEN, 4.0)
    assert after(CROSSING, 5, 1.0, state).colour.tolist() == [YELLOW, RED, YELLOW, RED]
    assert state.times_s[1].tolist() == [2.0, 3.0, 10.0]


def test_a_reset_begins_anew_and_keeps_times_and_freezing() -> None:
    groups = np.array([0], np.int32)
    state = cycle.with_time(CROSSING, after(CROSSING, 20, 1.0), 0, GREEN, 4.0)
    state = cycle.reset(CROSSING, cycle.with_frozen(state, groups, frozen=True), groups)
    assert state.colour.tolist() == [GREEN, RED, GREEN, RED]
    assert cycle.elapsed_s(CROSSING, state).tolist() == [0.0] * 4
    assert cycle.is_frozen(CROSSING, state).tolist() == [True] * 4
    assert state.times_s[0, GREEN] == 4.0


def test_a_step_leaves_the_state_it_came_from_alone() -> None:
    before = after(CROSSING, 10, 1.0)
    kept = CycleState(*(column.copy() for column in before))
    cycle.step(CROSSING, before, 1.0)
    for column, copy in zip(before, kept, strict=True):
        assert column.tolist() == copy.tolist()


def test_a_map_without_lights_has_a_plan_too() -> None:
    plan = cycle.plan([])
    assert cycle.step(plan, cycle.initial(plan), 1.0).colour.tolist() == []


@pytest.mark.parametrize("groups", [[[[0], [0]]], [[[1]]], [[[0]], []]])
def test_a_plan_that_leaves_a_light_out_or_names_it_twice_is_an_error(groups: list[list[list[int]]]) -> None:
    with pytest.raises(ValueError, match="one controller"):
        cycle.plan(groups)


@dataclass
class Controller:
    """Lights that change together."""

    lights: list[int]
    times_s: dict[TrafficLightState, float]
    stage: int = 2
    elapsed_s: float = 0.0

    def show(self, colours: dict[int, TrafficLightState]) -> None:
        for light in self.lights:
            colours[light] = (GREEN, YELLOW, RED)[self.stage]


@dataclass
class Group:
    """Controllers that take turns."""

    controllers: list[Controller]
    turn: int = 0
    frozen: bool = False


@dataclass
class Lights:
    """All groups, and the colour of every light."""

    groups: list[Group]
    colours: dict[int, TrafficLightState] = field(default_factory=dict)

    def reset(self, group: Group) -> None:
        for controller in group.controllers:
            controller.stage, controller.elapsed_s = 2, 0.0
            controller.show(self.colours)
        group.turn = 0
        group.controllers[0].stage = 0
        group.controllers[0].show(self.colours)

    def step(self, dt_s: float) -> None:
        for group in self.groups:
            if group.frozen:
                continue
            controller = group.controllers[group.turn]
            controller.elapsed_s += dt_s
            if controller.elapsed_s <= controller.times_s[(GREEN, YELLOW, RED)[controller.stage]] + cycle.ROUNDING_S:
                continue
            controller.elapsed_s = 0.0
            if controller.stage == 2:
                group.turn = (group.turn + 1) % len(group.controllers)
                controller = group.controllers[group.turn]
                controller.stage, controller.elapsed_s = 0, 0.0
            else:
                controller.stage += 1
            controller.show(self.colours)

    def of(self, light: int) -> tuple[Group, Controller]:
        return next(
            (group, controller)
            for group in self.groups
            for controller in group.controllers
            if light in controller.lights
        )


commands = st.one_of(
    st.tuples(st.just("step"), st.sampled_from([0.05, 0.7, 3.0, 12.0])),
    st.tuples(st.just("colour"), st.integers(0, 5), st.sampled_from(list(TrafficLightState))),
    st.tuples(
        st.just("time"), st.integers(0, 5), st.sampled_from([RED, YELLOW, GREEN]), st.sampled_from([0.0, 1.5, 6.0])
    ),
    st.tuples(st.just("freeze"), st.integers(0, 5), st.booleans()),
    st.tuples(st.just("reset"), st.integers(0, 5)),
)


@settings(max_examples=60)
@given(st.lists(commands, max_size=40))
def test_any_commands_lead_where_the_obvious_version_leads(steps: list[tuple]) -> None:
    layout = [[[3], [0, 1]], [[2]], [[4], [5]]]
    plan = cycle.plan(layout)
    state = cycle.initial(plan)
    naive = Lights([Group([Controller(list(c), {RED: 2.0, YELLOW: 3.0, GREEN: 10.0}) for c in g]) for g in layout])
    for group in naive.groups:
        naive.reset(group)
    for name, *values in steps:
        if name == "step":
            state = cycle.step(plan, state, values[0])
            naive.step(values[0])
            continue
        group, controller = naive.of(values[0])
        number = np.array([naive.groups.index(group)], np.int32)
        if name == "colour":
            state = cycle.with_colour(state, values[0], values[1])
            naive.colours[values[0]] = values[1]
        elif name == "time":
            state = cycle.with_time(plan, state, *values)
            controller.times_s[values[1]] = values[2]
        elif name == "freeze":
            state = cycle.with_frozen(state, number, frozen=values[1])
            group.frozen = values[1]
        else:
            state = cycle.reset(plan, state, number)
            naive.reset(group)
        assert state.colour.tolist() == [naive.colours[light] for light in range(6)]
    assert cycle.elapsed_s(plan, state).tolist() == [naive.of(light)[1].elapsed_s for light in range(6)]
    assert cycle.is_frozen(plan, state).tolist() == [naive.of(light)[0].frozen for light in range(6)]
    assert state.colour.tolist() == [naive.colours[light] for light in range(6)]
