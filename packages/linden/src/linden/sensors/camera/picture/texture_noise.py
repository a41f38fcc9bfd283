"""Noise that depends on a place alone: the same spot of a wall or a lawn looks the same in every frame and run.

All of it can be worked on eight places at a time: nothing here calls what a compiler does not know.
"""

from collections.abc import Callable
from typing import cast

import numpy as np

from linden.compiled import shading_part

narrow = cast("Callable[[float], float]", np.float32)
"""Makes a float of 32 bits, and"""
narrow_whole = cast("Callable[[float], int]", np.int32)
"""a whole number: both under types that mypy takes for those of their literals."""


@shading_part
def whole(x: float) -> int:
    """Return the largest whole number below, of 32 bits; for numbers below 2^31."""
    cut = narrow_whole(x)
    return narrow_whole(cut - narrow_whole(x < narrow(cut)))


@shading_part
def hashed(x: int, y: int, salt: int) -> float:
    """Return a number in [0, 1) for a cell of a grid; mixes as Murmur3's finaliser does (Appleby 2011)."""
    column = np.uint32(np.uint32(int(x) & 0xFFFFFFFF) * np.uint32(0x8DA6B343))
    row = np.uint32(np.uint32(int(y) & 0xFFFFFFFF) * np.uint32(0xD8163841))
    mixed = np.uint32(column ^ row ^ np.uint32(np.uint32(int(salt) & 0xFFFFFFFF) * np.uint32(0xCB1AB31F)))
    mixed = np.uint32(np.uint32(mixed ^ np.uint32(mixed >> np.uint32(16))) * np.uint32(0x85EBCA6B))
    mixed = np.uint32(np.uint32(mixed ^ np.uint32(mixed >> np.uint32(13))) * np.uint32(0xC2B2AE35))
    share = narrow_whole(int(mixed ^ np.uint32(mixed >> np.uint32(16))) & 0xFFFFFF)
    return narrow(share) * narrow(1.0 / 16777216.0)


@shading_part
def smooth_noise(x: float, y: float, salt: int) -> float:
    """Return value noise in [0, 1] of wavelength about 2: numbers at whole places, smoothly joined."""
    i, j = whole(x), whole(y)
    u, v = x - narrow(i), y - narrow(j)
    u, v = u * u * (3.0 - 2.0 * u), v * v * (3.0 - 2.0 * v)
    right, below = narrow_whole(i + 1), narrow_whole(j + 1)
    a, b = hashed(i, j, salt), hashed(right, j, salt)
    c, d = hashed(i, below, salt), hashed(right, below, salt)
    return a + (b - a) * u + (c - a) * v + (a - b - c + d) * u * v


@shading_part
def fraction(x: float) -> float:
    """Return what is behind the point, of negative numbers too."""
    return x - narrow(whole(x))


@shading_part
def ramp(low: float, high: float, x: float) -> float:
    """Return 0 below ``low``, 1 above ``high`` and a straight line between."""
    return min(max((x - low) / (high - low), 0.0), 1.0)


@shading_part
def fading(x: float) -> float:
    """Return e to the power of a number, -30 to 30, to four digits up to 10.

    Five terms of its series for a 32nd of the number, squared five times.
    """
    t = min(max(x, -30.0), 30.0) * 0.03125
    power = 1.0 + t * (1.0 + t * (0.5 + t * (0.16666667 + t * (0.041666668 + t * 0.008333334))))
    power *= power
    power *= power
    power *= power
    power *= power
    return power * power
