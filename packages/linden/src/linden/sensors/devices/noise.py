"""Noise that depends on the sensor's seed and on which of its measurements it is, and on nothing else.

Measurements draw from Philox streams keyed by seed and number (Salmon et al. 2011, "Parallel Random Numbers: As Easy as
1, 2, 3"), so the same run gives the same noise, whichever clients subscribe.
"""

from collections.abc import Sequence
from functools import lru_cache

import numpy as np

BLOCK = 256
"""Measurements that share a stream: making one costs thirty times what a draw costs."""

_WORD = 0xFFFF_FFFF_FFFF_FFFF


def gaussian(seed: int, number: int, deviations: Sequence[float]) -> tuple[float, ...]:
    """Return one draw for each of the standard deviations, mean 0; zeros, quickly, where all of them are 0.

    Args:
        seed: the sensor's ``noise_seed``; two sensors with the same seed err alike, as in CARLA.
        number: of the measurement, counted from the sensor's first, which is 0.
        deviations: any unit; the draws have the same.
    """
    if not any(deviations):
        return (0.0,) * len(deviations)
    draws = _block(seed, number // BLOCK, len(deviations))[number % BLOCK]
    return tuple(draw * deviation for draw, deviation in zip(draws, deviations, strict=True))


def dice_of(seed: int, number: int) -> np.random.Generator:
    """Return the dice of one measurement, for sensors that need many draws for each."""
    return np.random.Generator(np.random.Philox(key=np.array([seed & _WORD, number & _WORD], np.uint64)))


@lru_cache(maxsize=256)
def _block(seed: int, block: int, count: int) -> list[list[float]]:
    """Return ``count`` standard normal draws for each measurement of a block."""
    draws: list[list[float]] = dice_of(seed, block).standard_normal((BLOCK, count)).tolist()
    return draws
