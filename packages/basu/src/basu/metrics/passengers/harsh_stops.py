"""Harsh stops: brakings that are felt above a threshold: when, how hard, from what speed, to what speed.

The threshold is 1.5 m/s²: the medium level of Karekla and Tyler 2018 (see `balance`), half as much again as what
volunteers without a handhold answered without a step. It is a definition, and adjustable.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from basu.thresholds import AT_REST_MPS

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from basu.metrics.passengers.felt import Felt

HARSH_MPS2 = 1.5
ONSET_MPS2 = 0.3  # a braking begins where it is first felt as one
APART_S = 1.0  # brakings nearer to each other than this are one


class HarshStop(NamedTuple):
    """One harsh braking; ticks are indices of frames."""

    onset_tick: int  # before which nothing was felt yet
    tick: int  # of the strongest push
    end_tick: int  # when it is below ONSET_MPS2 again
    t_s: float  # of the onset
    from_mps: float
    to_mps: float
    strongest_mps2: float  # filtered, positive
    jerk_mps3: float  # largest change of it, either way
    above_s: float  # how long it was above the threshold
    to_rest: bool


def harsh_stops(felt: Felt, threshold_mps2: float = HARSH_MPS2) -> tuple[HarshStop, ...]:
    """All brakings that reach the threshold, in order. In reverse, braking pushes the other way; both count."""
    towards = np.where(felt.speed_mps < -AT_REST_MPS, -1.0, 1.0)
    braking_mps2 = -felt.filtered_along_mps2 * towards
    step_s = float(felt.t_s[1] - felt.t_s[0])
    above = np.flatnonzero(braking_mps2 >= threshold_mps2)
    slowing = np.abs(felt.speed_mps)
    above = above[slowing[np.maximum(above - round(APART_S / step_s), 0)] > AT_REST_MPS]  # a slope is not a braking
    if len(above) == 0:
        return ()
    groups = np.split(above, np.flatnonzero(np.diff(above) > APART_S / step_s) + 1)
    return tuple(_one(felt, braking_mps2, int(group[0]), int(group[-1]), len(group) * step_s) for group in groups)


def _one(felt: Felt, braking_mps2: NDArray[np.float64], first: int, last: int, above_s: float) -> HarshStop:
    """The braking that is above the threshold from ``first`` to ``last``."""
    calm = braking_mps2 < ONSET_MPS2
    before, after = np.flatnonzero(calm[:first]), np.flatnonzero(calm[last:])
    onset = int(before[-1]) if len(before) else 0
    end = last + int(after[0]) if len(after) else len(calm) - 1
    strongest = first + int(np.argmax(braking_mps2[first : last + 1]))
    speed_mps = np.abs(felt.speed_mps)
    to_mps = float(speed_mps[onset : end + 1].min())
    return HarshStop(
        onset_tick=onset,
        tick=strongest,
        end_tick=end,
        t_s=float(felt.t_s[onset]),
        from_mps=float(speed_mps[max(0, onset - 2) : onset + 1].max()),  # the filter is a step or two late
        to_mps=to_mps,
        strongest_mps2=float(braking_mps2[strongest]),
        jerk_mps3=float(np.abs(felt.jerk_along_mps3[onset : end + 1]).max()),
        above_s=above_s,
        to_rest=to_mps < AT_REST_MPS,
    )
