"""The risk of a severe injury by the speed of an impact, from published curves, with brackets of their parameters.

- *Pedestrian, severe injury* (AIS 4 and more): Tefft 2013 (Accident Analysis and Prevention 50, 871-878) has 10, 25,
  50, 75 and 90 % at 16, 23, 31, 39 and 46 mph. A logistic curve through 10 and 50 % is within 1.5 % of the others. The
  figures are those of his abstract. The bracket of the middle, 3 mph to each side, is an assumption of this project.
- *Cyclist*: the pedestrian's curve, an assumption of this project; cyclists are hurt less at a given speed.
- *Occupant of a vehicle, death*: Joksch 1993 (Accident Analysis and Prevention 25, 103-104), (change of speed / 71
  mph)^4, quoted from memory. The change of speed is 0.3 to 0.7 of the speed of the impact, by the masses of the two:
  an assumption of this project.

A curve is for adults on average, and its lowest part rests on few cases.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from basu.records.partners import Partner

if TYPE_CHECKING:
    from numpy.typing import NDArray

MPH_MPS = 0.44704
MIDDLE_MPH = (28.0, 34.0)  # bracket of the speed at which half of the pedestrians are severely injured
SLOPE_PER_MPH = float(np.log(9.0)) / 15.0  # from 10 % at 16 mph to 50 % at 31 mph
FATAL_MPH = 71.0  # change of speed at which an occupant dies for certain
CHANGE = (0.3, 0.7)  # bracket of the change of speed, as a part of the impact's
ON_FOOT = (Partner.WALKER, Partner.CYCLIST)


class Curves(NamedTuple):
    """Draws (N,) of the curves' uncertain parameters."""

    middle_mph: NDArray[np.float64]
    change: NDArray[np.float64]


def middle() -> Curves:
    """Return the curves with the middle of their brackets."""
    return Curves(np.array([sum(MIDDLE_MPH) / 2.0]), np.array([sum(CHANGE) / 2.0]))


def drawn_curves(count: int, rng: np.random.Generator) -> Curves:
    """Return draws of the curves."""
    return Curves(rng.uniform(*MIDDLE_MPH, count), rng.uniform(*CHANGE, count))


def severe(speed_mps: float, partner: Partner, curves: Curves) -> NDArray[np.float64]:
    """Return the risk of a severe injury, (N,): of the person hit, or else the death of an occupant of the vehicle."""
    mph = speed_mps / MPH_MPS
    if partner in ON_FOOT:
        return 1.0 / (1.0 + np.exp(-SLOPE_PER_MPH * (mph - curves.middle_mph)))
    return np.minimum(1.0, (curves.change * mph / FATAL_MPH) ** 4)
