"""Lights as somebody else saw them: the state in which they show given colours and times."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from linden.traffic import cycle
from linden.traffic.cycle import F64, STAGES, U8, LightPlan, LightState


def restored(
    plan: LightPlan,
    state: LightState,
    lights: NDArray[np.integer[Any]],
    colour: U8,
    elapsed_s: F64,
    frozen: NDArray[np.bool_],
) -> LightState:
    """Return the state with these lights (N,) as given, each (N,); all others stay as they are.

    A group's turn is that of the controller whose time has begun to pass, or whose lights are not red; where neither
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
        state = cycle.with_frozen(state, np.unique(groups[frozen == is_frozen]), frozen=is_frozen)
    return state
