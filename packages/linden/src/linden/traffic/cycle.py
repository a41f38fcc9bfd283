"""The cycle of traffic lights: a pure function of state and time.

The lights of a controller share one colour; the controllers of a group (a junction) take turns: green, yellow, red,
then the next one's green, all others red meanwhile. So the time of red is that between two turns, when all are red.
Source: CARLA 0.9.16, TrafficLightGroup.cpp, TrafficLightController.cpp and .h.

A replay restores lights: it finds the state with given colours and times.
"""

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from linden.protocol.values.enums import TrafficLightState

F64 = NDArray[np.float64]
I32 = NDArray[np.int32]
U8 = NDArray[np.uint8]
Flags = NDArray[np.bool_]
Indices = NDArray[np.integer[Any]]

STAGES: U8 = np.array([TrafficLightState.GREEN, TrafficLightState.YELLOW, TrafficLightState.RED], np.uint8)
"""Colours of a turn in their order; a controller's ``stage`` counts in it."""
LAST_STAGE = len(STAGES) - 1

TIMES_S = (2.0, 3.0, 10.0)
"""Times of red, yellow and green in s, in the order of the colours' numbers."""
RED_OF_A_SINGLE_LIGHT_S = 10.0
"""A light without a controller has no other light to alternate with; CARLA gives it a longer red instead."""

ROUNDING_S = 1e-6
"""A sum of steps that should equal a time counts as equal, whatever its last bits are."""


class LightPlan(NamedTuple):
    """Which lights belong together; L lights, C controllers, G groups."""

    controller_of_light: I32
    """(L,)"""
    group_of_controller: I32
    """(C,) never falling: the controllers of a group lie next to each other, in the order of their turns."""
    group_of_light: I32
    """(L,) follows from the two before."""
    first_controller: I32
    """(G + 1,) where each group's controllers begin, and C."""
    times_s: F64
    """(C, 3) of red, yellow, green: what ``initial`` starts with."""


class CycleState(NamedTuple):
    """Everything that changes."""

    colour: U8
    """(L,) TrafficLightState of each light."""
    stage: I32
    """(C,) index in ``STAGES``; the last one, except for the controllers that have their turn."""
    turn: I32
    """(G,) the controller that has its turn."""
    elapsed_s: F64
    """(G,) since its stage began; for all other controllers it is zero."""
    lasts_s: F64
    """(G,) for how long its stage lasts: follows from the turn, its stage and the times; inf where frozen."""
    pace: F64
    """(G,) 1, or 0 where time is frozen."""
    times_s: F64
    """(C, 3) of red, yellow, green."""


def plan(groups: Sequence[Sequence[Sequence[int]]], times_s: F64 | None = None) -> LightPlan:
    """Return the plan of groups of controllers of lights; every light from 0 to L - 1 stands in it once.

    Args:
        groups: lights by controller, controllers by group in the order of their turns.
        times_s: (C, 3) of red, yellow, green; CARLA's defaults where left out.
    """
    controllers = [lights for group in groups for lights in group]
    placed = sorted(light for lights in controllers for light in lights)
    if placed != list(range(len(placed))):
        raise ValueError(f"every light belongs to one controller: {placed}")
    if not all(groups):
        raise ValueError("a group has one controller at least")
    controller_of_light = np.empty(len(placed), np.int32)
    for controller, lights in enumerate(controllers):
        controller_of_light[list(lights)] = controller
    sizes = [len(group) for group in groups]
    group_of_controller = np.repeat(np.arange(len(groups), dtype=np.int32), sizes)
    return LightPlan(
        controller_of_light,
        group_of_controller,
        group_of_controller[controller_of_light],
        np.concatenate([[0], np.cumsum(sizes)]).astype(np.int32),
        np.tile(TIMES_S, (len(controllers), 1)) if times_s is None else times_s,
    )


def initial(plan: LightPlan) -> CycleState:
    """Return the state at the start of an episode: in every group the first controller is green, all others red."""
    controllers, groups = len(plan.group_of_controller), len(plan.first_controller) - 1
    dark = CycleState(
        np.full(len(plan.controller_of_light), TrafficLightState.RED, np.uint8),
        np.full(controllers, LAST_STAGE, np.int32),
        plan.first_controller[:-1].copy(),
        np.zeros(groups),
        np.zeros(groups),
        np.ones(groups),
        plan.times_s.copy(),
    )
    return reset(plan, dark, np.arange(groups, dtype=np.int32))


def step(plan: LightPlan, state: CycleState, dt_s: float) -> CycleState:
    """Let time pass in every group that is not frozen; a stage that is over gives way to the next, at most one a step.

    As in CARLA a stage lasts until its time is exceeded, and what is left of the step is not counted to the next.
    """
    elapsed_s = state.elapsed_s + dt_s * state.pace
    over = elapsed_s > state.lasts_s + ROUNDING_S
    state = state._replace(elapsed_s=elapsed_s)
    return _next_stage(plan, state, np.flatnonzero(over)) if over.any() else state


def _next_stage(plan: LightPlan, state: CycleState, groups: Indices) -> CycleState:
    """Show the next colour of these groups' controllers, or where it was the last, the first of the next controller."""
    stage, turn, elapsed_s = state.stage.copy(), state.turn.copy(), state.elapsed_s.copy()
    done = groups[stage[turn[groups]] == LAST_STAGE]
    stage[turn[np.setdiff1d(groups, done)]] += 1
    following = turn[done] + 1
    turn[done] = np.where(following == plan.first_controller[done + 1], plan.first_controller[done], following)
    stage[turn[done]] = 0
    elapsed_s[groups] = 0.0
    return _timed(_show(plan, state._replace(stage=stage, turn=turn, elapsed_s=elapsed_s), turn[groups]))


def _show(plan: LightPlan, state: CycleState, controllers: Indices) -> CycleState:
    """Give the lights of these controllers the colour of their stage."""
    lights = np.isin(plan.controller_of_light, controllers)
    colour = state.colour.copy()
    colour[lights] = STAGES[state.stage[plan.controller_of_light[lights]]]
    return state._replace(colour=colour)


def _timed(state: CycleState) -> CycleState:
    """Bring ``lasts_s`` up to date with what it follows from."""
    times_s = state.times_s[state.turn, STAGES[state.stage[state.turn]]]
    return state._replace(lasts_s=np.where(state.pace > 0.0, times_s, np.inf))


def reset(plan: LightPlan, state: CycleState, groups: Indices) -> CycleState:
    """Begin the cycle of these groups anew: all red, but green for their first controllers. Times and freezing stay."""
    stage, turn, elapsed_s = state.stage.copy(), state.turn.copy(), state.elapsed_s.copy()
    members = np.isin(plan.group_of_controller, groups)
    stage[members] = LAST_STAGE
    turn[groups] = plan.first_controller[groups]
    stage[turn[groups]] = 0
    elapsed_s[groups] = 0.0
    return _timed(_show(plan, state._replace(stage=stage, turn=turn, elapsed_s=elapsed_s), np.flatnonzero(members)))


def with_colour(state: CycleState, light: int, colour: TrafficLightState) -> CycleState:
    """Give one light a colour; it keeps it until its controller changes the next time."""
    colours = state.colour.copy()
    colours[light] = colour
    return state._replace(colour=colours)


def with_time(plan: LightPlan, state: CycleState, light: int, colour: TrafficLightState, time_s: float) -> CycleState:
    """Set for how long red, yellow or green lasts: for all lights of the same controller, from now on."""
    times_s = state.times_s.copy()
    times_s[plan.controller_of_light[light], colour] = time_s
    return _timed(state._replace(times_s=times_s))


def with_frozen(state: CycleState, groups: Indices, *, frozen: bool) -> CycleState:
    """Stop or restart time in these groups."""
    pace = state.pace.copy()
    pace[groups] = 0.0 if frozen else 1.0
    return _timed(state._replace(pace=pace))


def elapsed_s(plan: LightPlan, state: CycleState) -> F64:
    """Return for each light (L,) how long its controller's stage has lasted, as CARLA tells its clients."""
    has_turn = state.turn[plan.group_of_light] == plan.controller_of_light
    return np.where(has_turn, state.elapsed_s[plan.group_of_light], 0.0)


def is_frozen(plan: LightPlan, state: CycleState) -> Flags:
    """Return for each light (L,) whether time stands still for it."""
    frozen: Flags = state.pace[plan.group_of_light] == 0.0
    return frozen


def restored(
    plan: LightPlan,
    state: CycleState,
    lights: NDArray[np.integer[Any]],
    colour: U8,
    elapsed_s: F64,
    frozen: NDArray[np.bool_],
) -> CycleState:
    """Return the state with these lights (N,) as given, each (N,); all others stay as they are.

    A group's turn belongs to the controller with elapsed time or with lights that are not red; where neither
    tells, it stays. Frozen is the group of a frozen light.
    """
    colours = state.colour.copy()
    colours[lights] = colour
    stage, turn, since_s = state.stage.copy(), state.turn.copy(), state.elapsed_s.copy()
    groups, controllers = plan.group_of_light[lights], plan.controller_of_light[lights]
    since_s[groups] = 0.0
    tells = (colour != STAGES[-1]) | (elapsed_s > 0.0)
    for light in np.flatnonzero(tells).tolist():
        group, controller = groups[light], controllers[light]
        if elapsed_s[light] >= since_s[group]:
            turn[group], since_s[group] = controller, elapsed_s[light]
            found = np.flatnonzero(colour[light] == STAGES)
            stage[controller] = found[0] if len(found) else stage[controller]
    state = state._replace(colour=colours, stage=stage, turn=turn, elapsed_s=since_s)
    for is_frozen in (True, False):
        state = with_frozen(state, np.unique(groups[frozen == is_frozen]), frozen=is_frozen)
    return state
