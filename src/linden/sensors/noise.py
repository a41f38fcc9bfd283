"""Noise that depends on the sensor's seed and on which of its measurements it is, and on nothing else.

Each measurement draws from a Philox stream of its own, keyed by seed and number (Salmon et al. 2011, "Parallel Random
Numbers: As Easy as 1, 2, 3"). So the same run gives the same noise whoever listened from when on.
"""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

WORD = 0xFFFF_FFFF_FFFF_FFFF


def gaussian(seed: int, number: int, deviations: Sequence[float]) -> NDArray[np.float64]:
    """Return one draw for each of the standard deviations, mean 0; zeros, quickly, where all of them are 0.

    Args:
        seed: the sensor's ``noise_seed``; two sensors with the same seed err alike, as in CARLA.
        number: of the measurement, counted from the sensor's first.
        deviations: any unit; the draws have the same.
    """
    if not any(deviations):
        return np.zeros(len(deviations))
    stream = np.random.Generator(np.random.Philox(key=np.array([seed & WORD, number & WORD], np.uint64)))
    return stream.standard_normal(len(deviations)) * np.asarray(deviations, np.float64)
