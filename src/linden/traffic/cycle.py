"""How traffic lights change: a pure transition over arrays, step for step as CARLA's groups and controllers do.

The lights of a controller share one colour; the controllers of a group (a junction) take turns: green, yellow, red,
then the next one's green, all others red meanwhile. So the time of red is that between two turns, when all are red.
Source: CARLA 0.9.16, TrafficLightGroup.cpp, TrafficLightController.cpp and .h.
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from linden.values.enums import TrafficLightState

F64 = NDArray[np.float64]
I32 = NDArray[np.int32]
U8 = NDArray[np.uint8]
Flags = NDArray[np.bool_]

STAGES: U8 = np.array([TrafficLightState.GREEN, TrafficLightState.YELLOW, TrafficLightState.RED], np.uint8)
"""Colours of a turn in their order; a controller's ``stage`` counts in it."""
LAST_STAGE = len(STAGES) - 1

TIMES_S = (2.0, 3.0, 10.0)
"""Times of red, yellow and green in s, in the order of the colours' numbers."""
RED_OF_A_SINGLE_LIGHT_S = 10.0
"""A light without a controller has nobody to take turns with; CARLA gives it a longer red instead."""

ROUNDING_S = 1e-6
"""A sum of steps that should equal a time counts as equal, whatever its last bits are."""


class LightPlan(NamedTuple):
    """Which lights belong together; L lights, C controllers, G groups."""

    controller_of_light: I32
    """(L,)"""
    group_of_controller: I32
    """(C,) never falling: the controllers of a group lie next to each other, in the order of their turns."""
    first_controller: I32
    """(G + 1,) where each group's controllers begin, and C."""
    times_s: F64
    """(C, 3) of red, yellow, green: what ``initial`` starts with."""


class LightState(NamedTuple):
    """Everything that changes."""

    colour: U8
    """(L,) TrafficLightState of each light."""
    stage: I32
    """(C,) index in ``STAGES``."""
    elapsed_s: F64
    """(C,) since the stage began."""
    turn: I32
    """(G,) the controller whose turn it is."""
    frozen: Flags
    """(G,)"""
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
    return LightPlan(
        controller_of_light,
        np.repeat(np.arange(len(groups), dtype=np.int32), sizes),
        np.concatenate([[0], np.cumsum(sizes)]).astype(np.int32),
        np.tile(TIMES_S, (len(controllers), 1)) if times_s is None else times_s,
    )


def initial(plan: LightPlan) -> LightState:
    """Return the state at the start of an episode: in every group the first controller is green, all others red."""
    controllers, groups = len(plan.group_of_controller), len(plan.first_controller) - 1
    dark = LightState(
        np.full(len(plan.controller_of_light), TrafficLightState.RED, np.uint8),
        np.full(controllers, LAST_STAGE, np.int32),
        np.zeros(controllers),
        plan.first_controller[:-1].copy(),
        np.zeros(groups, np.bool_),
        plan.times_s.copy(),
    )
    return reset(plan, dark, np.arange(groups, dtype=np.int32))


def step(plan: LightPlan, state: LightState, dt_s: float) -> LightState:
    """Let time pass in every group that is not frozen; a stage that is over gives way to the next, at most one a step.

    As in CARLA a stage lasts until its time is exceeded, and what is left of the step is not counted to the next.
    """
    active = state.turn[~state.frozen]
    elapsed_s = state.elapsed_s.copy()
    elapsed_s[active] += dt_s
    over = elapsed_s[active] > state.times_s[active, STAGES[state.stage[active]]] + ROUNDING_S
    if not over.any():
        return state._replace(elapsed_s=elapsed_s)
    return _next_stage(plan, state._replace(elapsed_s=elapsed_s), active[over])


def _next_stage(plan: LightPlan, state: LightState, controllers: I32) -> LightState:
    """Move each of the controllers on, or where it has shown its last colour, the next one of its group."""
    state.elapsed_s[controllers] = 0.0
    stage, turn = state.stage.copy(), state.turn.copy()
    done = stage[controllers] == LAST_STAGE
    groups = plan.group_of_controller[controllers[done]]
    following = controllers[done] + 1
    following = np.where(following == plan.first_controller[groups + 1], plan.first_controller[groups], following)
    turn[groups] = following
    stage[following] = 0
    state.elapsed_s[following] = 0.0
    stage[controllers[~done]] += 1
    changed = np.concatenate([controllers[~done], following])
    return _show(plan, state._replace(stage=stage, turn=turn), changed)


def _show(plan: LightPlan, state: LightState, controllers: I32) -> LightState:
    """Give the lights of these controllers the colour of their stage."""
    lights = np.isin(plan.controller_of_light, controllers)
    colour = state.colour.copy()
    colour[lights] = STAGES[state.stage[plan.controller_of_light[lights]]]
    return state._replace(colour=colour)


def reset(plan: LightPlan, state: LightState, groups: I32) -> LightState:
    """Begin the cycle of these groups anew: all red, but green for their first controllers. Times and freezing stay."""
    stage, elapsed_s, turn = state.stage.copy(), state.elapsed_s.copy(), state.turn.copy()
    members = np.isin(plan.group_of_controller, groups)
    stage[members] = LAST_STAGE
    elapsed_s[members] = 0.0
    turn[groups] = plan.first_controller[groups]
    stage[turn[groups]] = 0
    fresh = state._replace(stage=stage, elapsed_s=elapsed_s, turn=turn)
    return _show(plan, fresh, np.flatnonzero(members).astype(np.int32))


def with_colour(state: LightState, light: int, colour: TrafficLightState) -> LightState:
    """Give one light a colour; it keeps it until its controller changes the next time."""
    colours = state.colour.copy()
    colours[light] = colour
    return state._replace(colour=colours)


def with_time(plan: LightPlan, state: LightState, light: int, colour: TrafficLightState, time_s: float) -> LightState:
    """Set for how long red, yellow or green lasts: for all lights of the same controller, from now on."""
    times_s = state.times_s.copy()
    times_s[plan.controller_of_light[light], colour] = time_s
    return state._replace(times_s=times_s)


def with_frozen(state: LightState, groups: I32, *, frozen: bool) -> LightState:
    """Stop or restart time in these groups."""
    flags = state.frozen.copy()
    flags[groups] = frozen
    return state._replace(frozen=flags)
