"""The filter that lets through what a standing body answers: the low-pass half of the horizontal weighting Wd.

ISO 2631-1 weighs horizontal acceleration evenly up to 2 Hz and less and less above, for the body follows a quick rattle
no longer. Its weighting Wd also cuts what is slower than 0.4 Hz, and with it the push of a long braking, which is just
what a standing passenger has to lean against. Here the a-v transition of Wd stands alone (ISO 8041-1, table of
parameters: f3 = f4 = 2 Hz, Q4 = 0.63), turned into a digital filter by the bilinear transform, exact at 2 Hz.

A recorded step of 0.05 s can show nothing above 10 Hz. The digital filter passes 102 % at 1 Hz, 89 % at 2 Hz, 46 % at
4 Hz (the analogue one 51 %), 11 % at 8 Hz (25 %), nothing at 10 Hz; a sudden push of 1 is answered with 1.06 at most.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

CORNER_HZ, QUALITY = 2.0, 0.63


def lowpass(values: NDArray[np.float64], step_s: float) -> NDArray[np.float64]:
    """Filter (T,) values a ``step_s`` apart; what came before is taken to have been like the first value.

    H(s) = (1 + s / w) / (1 + s / (Q w) + (s / w)^2), with s / w = c (1 - 1/z) / (1 + 1/z).
    """
    c = 1.0 / math.tan(math.pi * CORNER_HZ * step_s)
    scale = 1.0 + c / QUALITY + c * c
    b0, b1, b2 = (1.0 + c) / scale, 2.0 / scale, (1.0 - c) / scale
    a1, a2 = 2.0 * (1.0 - c * c) / scale, (1.0 - c / QUALITY + c * c) / scale
    out = []
    x1 = x2 = y1 = y2 = float(values[0]) if len(values) else 0.0
    for x in values.tolist():
        y = b0 * x + b1 * x1 + b2 * x2 - a1 * y1 - a2 * y2
        out.append(y)
        x1, x2, y1, y2 = x, x1, y, y1
    return np.array(out, dtype=np.float64)


def moving_mean(values: NDArray[np.float64], width: int) -> NDArray[np.float64]:
    """(T,) mean over ``width`` values around each, over fewer at both ends."""
    total = np.concatenate([[0.0], np.cumsum(values)])
    index = np.arange(len(values))
    first, end = np.maximum(index - width // 2, 0), np.minimum(index + (width + 1) // 2, len(values))
    mean: NDArray[np.float64] = (total[end] - total[first]) / (end - first)
    return mean
