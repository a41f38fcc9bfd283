"""The cut-outs and decelerations by which the Joint Research Centre compares three models: 5,850 and 1,121 cases.

The own vehicle follows at the gap that its model keeps. In a deceleration the vehicle ahead brakes evenly to a stand.
In a cut-out it leaves the lane before a standing vehicle, or hits that and stands where it did. Sizes, rate and number
of steps are those of `standard_grid`; the standing vehicle is 5 m long. Reg157 is not among the models compared.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from basu.metrics.careful_driver.encounters import WANDERING_M
from basu.metrics.careful_driver.model import G_MPS2, Situation
from basu.metrics.careful_driver.simulation import RelativeMotion, Sizes, drive
from standard_grid import LENGTH_M, RATE_HZ, STEP_S, STEPS, WIDTH_M

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from basu.metrics.careful_driver.model import CarefulDriver, Flags, Numbers

DECELERATIONS_G = np.arange(0.05, 1.0, 0.05)
DECELERATION_KMH = np.arange(12, 130, 2)
CUT_OUT_KMH = np.arange(10, 132, 10)
FRONT_M = np.arange(2, 152, 5)  # between the bumpers of the vehicle ahead and of the standing one
LATERAL_MPS = np.arange(0.1, 3.1, 0.2)  # of the vehicle that leaves the lane
STANDING_LENGTH_M = 5.0
ASIDE_M = 4.0  # that the vehicle ahead moves aside


class _Leaving(NamedTuple):
    """The vehicle that leaves the lane, (T, N) each, and the step in which it hits the standing one."""

    along_m: Numbers
    across_m: Numbers  # negative
    hit_step: Numbers  # STEPS where it does not


def deceleration_contacts(model: CarefulDriver) -> Flags:
    """Return for each deceleration and speed whether the model hits the vehicle that brakes, (19, 59)."""
    pairs = [(share, kmh / 3.6) for share in DECELERATIONS_G for kmh in DECELERATION_KMH]
    share, own_mps = (np.array(column) for column in zip(*pairs, strict=True))
    slowing = own_mps - np.arange(STEPS)[:, None] * (G_MPS2 * share) / RATE_HZ
    speed_mps = np.maximum(slowing, 0.0)
    along_m = speed_mps.cumsum(axis=0) / RATE_HZ + (model.following_m(own_mps) + LENGTH_M)
    other = RelativeMotion(along_m, np.zeros_like(along_m), speed_mps, np.zeros_like(along_m))
    sizes = Sizes(LENGTH_M, WIDTH_M)
    driven = drive(model, own_mps / RATE_HZ, own_mps, other, sizes, Situation.DECELERATION, STEP_S)
    return driven.contact.reshape(len(DECELERATIONS_G), len(DECELERATION_KMH))


def cut_out_contacts(model: CarefulDriver) -> Flags:
    """Return for each speed, gap and lateral speed whether the model hits a vehicle, (13, 30, 15)."""
    found = [_cut_outs(model, float(lateral)) for lateral in LATERAL_MPS]
    return np.stack(found, axis=-1)


def _cut_outs(model: CarefulDriver, lateral_mps: float) -> Flags:
    """Return the contacts of the cases with one lateral speed, (13, 30)."""
    pairs = [(kmh / 3.6, float(front_m)) for kmh in CUT_OUT_KMH for front_m in FRONT_M]
    own_mps, front_m = (np.array(column) for column in zip(*pairs, strict=True))
    leader_m = model.following_m(own_mps) + LENGTH_M
    standing_m = leader_m + front_m + LENGTH_M
    leaving = _leaving(own_mps, leader_m, standing_m, lateral_mps)
    uncovered = np.argmax(leaving.across_m < -WANDERING_M, axis=0)
    begin = np.minimum(uncovered, leaving.hit_step).astype(int)
    found = np.zeros(len(own_mps), dtype=bool)
    for step in np.unique(begin):
        cases = np.flatnonzero(begin == step)
        found[cases] = _from_step(model, int(step), own_mps[cases], standing_m[cases], _of_cases(leaving, cases))
    return found.reshape(len(CUT_OUT_KMH), len(FRONT_M))


def _leaving(own_mps: Numbers, leader_m: Numbers, standing_m: Numbers, lateral_mps: float) -> _Leaving:
    """Return the vehicle ahead: it moves aside with a steady speed until it is `ASIDE_M` away, or hits the other."""
    lasts = int((ASIDE_M * RATE_HZ) // lateral_mps + 1)
    moving = np.where(np.arange(STEPS) < lasts, -lateral_mps, 0.0)
    across_m = (moving.cumsum() / RATE_HZ + ASIDE_M) - ASIDE_M  # rounded as in the public program
    along_m = np.repeat(own_mps[None, :], STEPS, axis=0).cumsum(axis=0) / RATE_HZ + leader_m
    touches = (np.abs(across_m)[:, None] - WIDTH_M < 0.0) & (
        np.abs(standing_m - along_m) - STANDING_LENGTH_M / 2.0 - LENGTH_M / 2.0 < 0.0
    )
    hit_step = np.where(touches.any(axis=0), touches.argmax(axis=0), STEPS)
    return _Leaving(along_m, np.repeat(across_m[:, None], len(own_mps), axis=1), hit_step)


def _of_cases(leaving: _Leaving, cases: NDArray[np.intp]) -> _Leaving:
    """Return some of the cases."""
    return _Leaving(leaving.along_m[:, cases], leaving.across_m[:, cases], leaving.hit_step[cases])


def _from_step(model: CarefulDriver, step: int, own_mps: Numbers, standing_m: Numbers, leaving: _Leaving) -> Flags:
    """Return the contacts from the step on in which the model begins to look at what was hidden.

    The other is the standing vehicle, and from a hit on the one that hit it. The longer one is moved nearer by half of
    what it is longer, so one length serves for both.
    """
    steps = np.arange(step, STEPS)[:, None]
    hit = steps >= leaving.hit_step
    at_hit = np.minimum(leaving.hit_step, STEPS - 1).astype(int), np.arange(len(own_mps))
    nearer_m = (STANDING_LENGTH_M - LENGTH_M) / 2.0
    along_m = np.where(hit, leaving.along_m[at_hit], standing_m - nearer_m)
    across_m = np.where(hit, leaving.across_m[at_hit], 0.0)
    still = np.zeros_like(along_m)
    start_m = np.repeat(own_mps[None, :], step + 1, axis=0).cumsum(axis=0)[-1] / RATE_HZ
    other = RelativeMotion(along_m, across_m, still, still)
    return drive(model, start_m, own_mps, other, Sizes(LENGTH_M, WIDTH_M), Situation.CUT_OUT, STEP_S).contact
