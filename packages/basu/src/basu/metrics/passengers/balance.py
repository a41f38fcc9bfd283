"""The share of standing passengers that lose their balance at an acceleration, with the brackets of its parameters.

A passenger loses balance when the filtered horizontal acceleration (`basu.metrics.passengers.felt`) exceeds a value of
its own. The values of persons are log-normal. The sources of the brackets are in `basu_service.falls` and in
`docs/reference/service.md`.
"""

from __future__ import annotations

from statistics import NormalDist
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

FREE_MPS2, HOLDING_MPS2 = (1.62, 2.5), (2.26, 2.65)  # the brackets of the medians
SPREAD = (0.15, 0.35)  # bracket of the standard deviation of the logarithm
STANDARD = NormalDist()


def share_that_falls(
    felt_mps2: float, medians_mps2: NDArray[np.float64], spreads: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Return the share of persons with a limit below what is felt, (N,) for (N,) medians and spreads."""
    if felt_mps2 <= 0.0:
        return np.zeros(len(medians_mps2))
    from scipy.special import ndtr  # noqa: PLC0415 - 0.2 s, which most commands do without

    shares: NDArray[np.float64] = ndtr((np.log(felt_mps2) - np.log(medians_mps2)) / spreads)
    return shares
