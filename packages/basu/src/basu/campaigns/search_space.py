"""The space of a search: the numbers of a case that vary, each with its range and its distribution."""

from __future__ import annotations

import math
from statistics import NormalDist
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from basu.errors import UserError
from basu.scenarios.parameters import Number

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from numpy.typing import NDArray

    from basu.campaigns.settings import Normal
    from basu.scenarios.playable import Playable

FINENESS = 1e-4  # of a range: values that are nearer to each other than this are the same drive
EDGE = 1e-12  # a share stays this far from 0 and 1, where quantiles are infinite


class Dimension(NamedTuple):
    """A number that varies: uniform over its range, or normal and cut off at its ends."""

    name: str
    unit: str
    low: float
    high: float
    mean: float | None = None  # None: uniform
    deviation: float | None = None

    def value_at(self, share: float) -> float:
        """The value below which so large a share of the distribution lies, in steps of ``FINENESS``."""
        held = min(max(share, EDGE), 1.0 - EDGE)
        if self.mean is None or self.deviation is None:
            value = self.low + held * (self.high - self.low)
        else:
            normal = NormalDist(self.mean, self.deviation)
            below, above = normal.cdf(self.low), normal.cdf(self.high)
            value = normal.inv_cdf(min(max(below + held * (above - below), EDGE), 1.0 - EDGE))
        digits = max(0, math.ceil(-math.log10((self.high - self.low) * FINENESS)))
        return min(max(round(value, digits), self.low), self.high)


Space = tuple[Dimension, ...]


def space_of(playable: Playable, vary: Sequence[str], fixed: Mapping[str, Any], normal: Mapping[str, Normal]) -> Space:
    """The numbers of a case that a search varies: those in ``vary``, or all that are not fixed.

    Raises:
        UserError: there is no such number, it is fixed, or none is left.
    """
    known = {each.name: each for each in playable.parameters}
    name = playable.case.name
    for wanted in (*vary, *normal):
        if wanted not in known:
            raise UserError(f"{name} has no parameter '{wanted}' to search over; it has {', '.join(known)}")
        if not isinstance(known[wanted], Number):
            raise UserError(f"a search varies numbers, and '{wanted}' of {name} is a choice; fix it with set = {{...}}")
        if wanted in fixed or (vary and wanted not in vary):
            raise UserError(f"{name}: '{wanted}' does not vary; leave it out of set, and name it in vary")
    numbers = [each for each in known.values() if isinstance(each, Number)]
    chosen = [each for each in numbers if (each.name in vary if vary else each.name not in fixed)]
    if not chosen:
        raise UserError(f"{name} has no number left to search over; shorten set, or drive it without a search")
    return tuple(_dimension(each, normal.get(each.name), name) for each in chosen)


def values_at(space: Space, shares: NDArray[np.float64]) -> dict[str, float]:
    """The values of a point (D,) of the unit cube, by name."""
    return {each.name: each.value_at(float(share)) for each, share in zip(space, shares, strict=True)}


def _dimension(number: Number, normal: Normal | None, case: str) -> Dimension:
    """A number with its distribution.

    Raises:
        UserError: the range holds almost nothing of the distribution.
    """
    if normal is None:
        return Dimension(number.name, number.unit, number.low, number.high)
    there = NormalDist(normal.mean, normal.deviation)
    if there.cdf(number.high) - there.cdf(number.low) < 0.01:
        raise UserError(
            f"{case}: less than 1 % of the normal distribution of '{number.name}' lies in its range, {number.low:g} "
            f"to {number.high:g}; choose another mean or deviation"
        )
    return Dimension(number.name, number.unit, number.low, number.high, normal.mean, normal.deviation)
