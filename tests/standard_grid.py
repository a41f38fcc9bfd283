"""The cut-ins by which the Joint Research Centre compares the models of UN Regulation 157: 15,930 cases.

Both vehicles are 4.3 m by 1.9 m, and 1.6 m apart across the path. The own vehicle has 20 to 60 km/h, and
the other is slower. Gaps are 1 to 59 m. Lateral speeds are 0 to 1.7 m/s, reached with 1.5 m/s².
K. Mattas and others: Driver models for the definition of safety requirements of automated vehicles in international
regulations. Accident Analysis and Prevention 174, 106743, 2022.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from basu.metrics.careful_driver.model import Situation
from basu.metrics.careful_driver.simulation import RelativeMotion, Sizes, drive

if TYPE_CHECKING:
    from collections.abc import Iterator

    from basu.metrics.careful_driver.model import CarefulDriver, Flags, Numbers

LENGTH_M, WIDTH_M, APART_M = 4.3, 1.9, 1.6
STEP_S, RATE_HZ, STEPS = 0.1, 10.0, 350
LATERAL_MPS2 = 1.5
OWN_KMH = (10, 20, 30, 40, 50, 60)
GAPS_M = np.arange(1, 60, 1)
LATERAL_MPS = np.arange(0.0, 1.8, 0.1)


class CutIn(NamedTuple):
    """One case of the grid."""

    own_kmh: int
    other_kmh: int
    gap_m: float  # between the bumpers when the lateral speed is reached
    lateral_mps: float


def speeds_kmh() -> tuple[tuple[int, int], ...]:
    """Return the pairs of speeds, of the own vehicle and of the other."""
    return tuple((own, other) for own in OWN_KMH for other in range(10, own, 10))


def cases() -> tuple[CutIn, ...]:
    """Return all cases, in the order of `contacts`."""
    pairs = [(*pair, float(gap_m)) for pair in speeds_kmh() for gap_m in GAPS_M]
    return tuple(CutIn(*pair, float(lateral)) for lateral in LATERAL_MPS for pair in pairs)


def contacts(model: CarefulDriver) -> Flags:
    """Return for each of `cases` whether the model hits the vehicle that cuts in."""
    return np.concatenate([_contacts(model, float(lateral)) for lateral in LATERAL_MPS])


def _contacts(model: CarefulDriver, lateral_mps: float) -> Flags:
    """Return the contacts of the cases with one lateral speed."""
    rows = [(own / 3.6, other / 3.6, float(gap_m)) for own, other in speeds_kmh() for gap_m in GAPS_M]
    own_mps, other_mps, gap_m = (np.array(column) for column in zip(*rows, strict=True))
    across_m, across_mps, before = _lateral(lateral_mps)
    ahead_m = gap_m + LENGTH_M
    moved_m = np.cumsum(np.broadcast_to(other_mps, (STEPS, len(rows))), axis=0) / RATE_HZ
    along_m = np.concatenate([_earlier_m(other_mps, before) + ahead_m, [ahead_m], moved_m + ahead_m])
    other = RelativeMotion(
        along_m,
        np.repeat(across_m[:, None], len(rows), axis=1),
        np.broadcast_to(other_mps, along_m.shape),
        np.repeat(across_mps[:, None], len(rows), axis=1),
    )
    start_m = _earlier_m(own_mps, before)[0] if before else np.zeros(len(rows))
    sizes = Sizes(LENGTH_M, WIDTH_M)
    return drive(model, start_m, own_mps, other, sizes, Situation.CUT_IN, STEP_S, dismisses=True).contact


def _earlier_m(speed_mps: Numbers, before: int) -> Numbers:
    """Return places at a steady speed in the steps before the place 0, the earliest first."""
    return np.cumsum(np.broadcast_to(-speed_mps / RATE_HZ, (before, len(speed_mps))), axis=0)[::-1]


def _lateral(lateral_mps: float) -> tuple[Numbers, Numbers, int]:
    """Return the lateral places and speeds of the other, and the number of steps before its full lateral speed.

    It moves until its middle is on the path. Places are sums of speeds. So the rounding of the public
    program decides ties of two boxes.
    """
    aside_m = APART_M + WIDTH_M
    rising = np.arange(0.0, -lateral_mps, -LATERAL_MPS2 / RATE_HZ)
    lasts = int((aside_m * RATE_HZ) // lateral_mps + 1) if lateral_mps else 0
    moving = np.where(np.arange(STEPS) < lasts, -lateral_mps, 0.0)
    earlier_m = np.cumsum(-rising[::-1] / RATE_HZ)[::-1] + aside_m
    later_m = np.cumsum(moving) / RATE_HZ + aside_m
    across_m = np.concatenate([earlier_m, [aside_m], later_m])
    return across_m, np.concatenate([rising, [-lateral_mps], moving]), len(rising)


def by_speeds(found: Flags) -> Iterator[tuple[tuple[int, int], Flags]]:
    """Yield the outcomes of each pair of speeds, in the order of the lateral speeds and gaps."""
    table = found.reshape(len(LATERAL_MPS), len(speeds_kmh()), len(GAPS_M))
    for number, pair in enumerate(speeds_kmh()):
        yield pair, table[:, number, :]
