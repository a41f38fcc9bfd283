"""Noise that depends on a place alone: the same spot of a wall or a lawn looks the same in every frame and run."""

import math

import numpy as np

from linden.compiled import shading_part


@shading_part
def hashed(x: int, y: int, salt: int) -> float:
    """Return a number in [0, 1) for a cell of a grid; mixes as Murmur3's finaliser does (Appleby 2011)."""
    mixed = (
        np.uint32(int(x) & 0xFFFFFFFF) * np.uint32(0x8DA6B343)
        ^ np.uint32(int(y) & 0xFFFFFFFF) * np.uint32(0xD8163841)
        ^ np.uint32(salt & 0xFFFFFFFF) * np.uint32(0xCB1AB31F)
    )
    mixed = np.uint32((mixed ^ (mixed >> np.uint32(16))) * np.uint32(0x85EBCA6B))
    mixed = np.uint32((mixed ^ (mixed >> np.uint32(13))) * np.uint32(0xC2B2AE35))
    return np.float64((mixed ^ (mixed >> np.uint32(16))) & np.uint32(0xFFFFFF)) * (1.0 / 16777216.0)


@shading_part
def smooth_noise(x: float, y: float, salt: int) -> float:
    """Return value noise in [0, 1] of wavelength about 2: numbers at whole places, smoothly joined."""
    column, row = math.floor(x), math.floor(y)
    u, v = x - column, y - row
    u, v = u * u * (3.0 - 2.0 * u), v * v * (3.0 - 2.0 * v)
    i, j = int(column), int(row)
    a, b = hashed(i, j, salt), hashed(i + 1, j, salt)
    c, d = hashed(i, j + 1, salt), hashed(i + 1, j + 1, salt)
    return a + (b - a) * u + (c - a) * v + (a - b - c + d) * u * v


@shading_part
def fraction(x: float) -> float:
    """Return what is behind the point, of negative numbers too."""
    return x - math.floor(x)


@shading_part
def ramp(low: float, high: float, x: float) -> float:
    """Return 0 below ``low``, 1 above ``high`` and a straight line between."""
    return min(max((x - low) / (high - low), 0.0), 1.0)
