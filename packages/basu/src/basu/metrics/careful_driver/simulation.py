"""The drive of a careful driver towards others that move as they do: N encounters at once, step by step.

The own vehicle keeps its path and its speed until the model perceives a danger. After a danger has passed, it keeps the
speed that it has then. Each step looks, compares the boxes, decides and moves.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from basu.metrics.careful_driver.model import View

if TYPE_CHECKING:
    from basu.metrics.careful_driver.model import CarefulDriver, Flags, Numbers, Situation


class RelativeMotion(NamedTuple):
    """The others' way, (T, N) each, on the path of the own vehicle."""

    along_m: Numbers  # middles
    across_m: Numbers
    along_mps: Numbers
    across_mps: Numbers  # in the direction of across_m


class Sizes(NamedTuple):
    """Half the sums of both vehicles' lengths and widths."""

    length_m: float | Numbers
    width_m: float | Numbers


class SimulatedEncounters(NamedTuple):
    """What came of N encounters, (N,) each."""

    contact: Flags
    contact_step: Numbers  # -1 where there was none
    impact_mps: Numbers  # difference of the speeds at the contact, 0 where there was none
    reaction_step: Numbers  # the first in which the model perceived a danger, -1 for none
    hardest_mps2: Numbers  # deceleration
    least_gap_m: Numbers  # ahead and in the path; inf where the other never was


class _State:
    """What changes from step to step."""

    def __init__(self, model: CarefulDriver, start_m: Numbers, speed_mps: Numbers) -> None:
        count = len(start_m)
        self.at_m: Numbers = start_m.copy()
        self.speed_mps: Numbers = speed_mps.copy()
        self.accelerated_mps2: Numbers = np.zeros(count)
        self.wait_s: Numbers = np.full(count, model.delay_s)
        self.braking_mps2: Numbers = np.zeros(count)  # of the last step with a danger
        self.is_over = np.zeros(count, dtype=bool)


def drive(
    model: CarefulDriver,
    start_m: Numbers,
    speed_mps: Numbers,
    other: RelativeMotion,
    sizes: Sizes,
    situation: Situation,
    step_s: float,
    *,
    dismisses: bool = False,
) -> SimulatedEncounters:
    """Let a model drive; ``start_m`` (N,) is the place of its vehicle's middle, ``speed_mps`` (N,) its speed.

    With ``dismisses``, an encounter is over without a contact once the model holds it to be harmless. Otherwise the
    model looks on until the end.
    """
    count = len(start_m)
    state = _State(model, start_m, speed_mps)
    contact_step, reaction_step = np.full(count, -1.0), np.full(count, -1.0)
    impact_mps = np.zeros(count)
    hardest_mps2: Numbers = np.zeros(count)
    least_gap_m: Numbers = np.full(count, np.inf)
    for step in range(len(other.along_m) - 1):
        view = _view(state, other, sizes, step)
        beside = view.clear_m < 0.0
        fresh = ~state.is_over & beside & (view.gap_m < 0.0) & (contact_step < 0.0)
        contact_step[fresh], impact_mps[fresh] = step, np.abs(view.closing_mps[fresh])
        ahead = ~state.is_over & beside & view.is_ahead & (contact_step < 0.0)
        least_gap_m = np.where(ahead, np.minimum(least_gap_m, view.gap_m), least_gap_m)
        danger = model.perceives(view, situation)
        reaction_step[danger & (reaction_step < 0.0) & ~state.is_over] = step
        used_mps2 = _move(model, state, view, danger, step_s)
        hardest_mps2 = np.maximum(hardest_mps2, np.where(state.is_over | (contact_step >= 0.0), 0.0, used_mps2))
        if dismisses:
            state.is_over |= model.dismisses(view, situation)
    return SimulatedEncounters(contact_step >= 0.0, contact_step, impact_mps, reaction_step, hardest_mps2, least_gap_m)


def _view(state: _State, other: RelativeMotion, sizes: Sizes, step: int) -> View:
    """Return what the model sees in a step."""
    ahead_m, across_m = other.along_m[step] - state.at_m, other.across_m[step]
    half_m = sizes.length_m / 2.0
    return View(
        gap_m=np.abs(ahead_m) - half_m - half_m,  # in two steps, for the rounding of ties is that of the public program
        length_m=np.broadcast_to(np.asarray(sizes.length_m, dtype=np.float64), ahead_m.shape),
        clear_m=np.abs(across_m) - sizes.width_m,
        own_mps=state.speed_mps,
        own_mps2=state.accelerated_mps2,
        other_mps=other.along_mps[step],
        across_mps=-np.sign(across_m) * other.across_mps[step],
        is_ahead=ahead_m >= 0.0,
    )


def _move(model: CarefulDriver, state: _State, view: View, danger: Flags, step_s: float) -> Numbers:
    """Move the own vehicle on by a step and return its deceleration."""
    waits = danger & (state.wait_s > 0.0)
    brakes = danger & ~waits
    state.braking_mps2 = np.where(waits, model.coasting_mps2, state.braking_mps2)
    braking_mps2 = model.braking_mps2(view, state.braking_mps2, step_s)
    state.braking_mps2 = np.where(brakes, braking_mps2, state.braking_mps2)
    rate_hz = 1.0 / step_s  # divisions by it round as in the public program; that decides ties
    state.wait_s = np.where(waits, state.wait_s - 1.0 / rate_hz, state.wait_s)
    wanted_mps2 = np.where(danger, state.braking_mps2, 0.0)
    before_mps = state.speed_mps
    state.speed_mps = np.maximum(before_mps - wanted_mps2 / rate_hz, 0.0)
    state.accelerated_mps2 = (state.speed_mps - before_mps) * rate_hz
    state.at_m = state.at_m + state.speed_mps / rate_hz
    return -state.accelerated_mps2
