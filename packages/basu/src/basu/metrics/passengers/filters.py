"""The filters of felt accelerations: a low-pass for thresholds, the frequency weightings of ISO 2631-1 for vibration.

**The low-pass** is the low-pass half of the horizontal weighting Wd. ISO 2631-1 weighs horizontal acceleration evenly
up to 2 Hz and less and less above, because the body does not follow a quick rattle. Its weighting Wd also cuts what is
slower than 0.4 Hz, and with it the push of a long braking, against which a standing passenger has to lean. Here the a-v
transition of Wd stands alone (ISO 8041-1, table of parameters: f3 = f4 = 2 Hz, Q4 = 0.63), turned into a digital filter
by the bilinear transform, exact at 2 Hz. A recorded step of 0.05 s can show nothing above 10 Hz. The digital filter
passes 102 % at 1 Hz, 89 % at 2 Hz, 46 % at 4 Hz (the analogue one 51 %), 11 % at 8 Hz (25 %), nothing at 10 Hz. It
answers a sudden push of 1 with 1.06 at most.

**The weightings** Wd (horizontal), Wk (vertical) and Wf (sickness) are defined by analogue transfer functions (annex A
of ISO 2631-1:1997; unrounded parameters in ISO 8041). They are applied in the frequency domain. A digital filter by the
bilinear transform would squeeze the frequencies below 10 Hz: Wd would weigh 6.3 Hz by 0.22, not by 0.32. The tests hold
these weightings against the standard's table, and against such filters at forty times the rate. A record of 20 Hz has
nothing above 10 Hz (Wk runs to 80 Hz and counts most from 4 to 8 Hz).
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

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


PAD_S = 30.0  # of run-out behind a signal: the slowest part, the high-pass at 0.08 Hz, has died out by then


class Weighting(NamedTuple):
    """Parameters as in ISO 2631-1, annex A: corner frequencies in Hz and qualities; inf where a part is absent."""

    f1_hz: float  # band limiting, high-pass
    f2_hz: float  # band limiting, low-pass
    f3_hz: float  # a-v transition: proportional to acceleration below, to velocity above
    f4_hz: float
    q4: float
    f5_hz: float = math.inf  # upward step: towards jerk
    q5: float = 1.0
    f6_hz: float = math.inf
    q6: float = 1.0


BAND_LIMIT_Q = 1.0 / math.sqrt(2.0)  # of both band limits, a Butterworth characteristic
WD = Weighting(0.4, 100.0, 2.0, 2.0, 0.63)
WK = Weighting(0.4, 100.0, 12.5, 12.5, 0.63, 2.37, 0.91, 3.35, 0.91)
WF = Weighting(0.08, 0.63, math.inf, 0.25, 0.86, 0.0625, 0.80, 0.10, 0.80)


def gain(weighting: Weighting, frequency_hz: NDArray[np.float64]) -> NDArray[np.complex128]:
    """The complex gain at each frequency: the product of equations A.1 to A.4 at p = 2 pi i f."""
    p = 2j * np.pi * frequency_hz
    w1, w2, w3, w4, w5, w6 = (2.0 * math.pi * f for f in (*weighting[:4], weighting.f5_hz, weighting.f6_hz))
    high_pass = p**2 / (p**2 + w1 * p / BAND_LIMIT_Q + w1**2)
    low_pass = 1.0 / (1.0 + p / (BAND_LIMIT_Q * w2) + (p / w2) ** 2)
    transition = (1.0 + p / w3) / (1.0 + p / (weighting.q4 * w4) + (p / w4) ** 2)
    step = np.ones_like(p)
    if math.isfinite(w5):
        step = (w5**2 + w5 * p / weighting.q5 + p**2) / (w6**2 + w6 * p / weighting.q6 + p**2)
    whole: NDArray[np.complex128] = high_pass * low_pass * transition * step
    return whole


def weigh(weighting: Weighting, values: NDArray[np.float64], step_s: float) -> NDArray[np.float64]:
    """(T,) the weighted signal; what came before is taken to have been like the first value.

    Behind the end the signal runs out in a line to where it began, so that the transform meets no step.
    """
    pad = round(PAD_S / step_s)
    offset = values - values[0]  # a constant is weighed by zero
    whole = np.concatenate([offset, np.linspace(offset[-1], 0.0, pad)])
    frequency_hz: NDArray[np.float64] = np.fft.rfftfreq(len(whole), step_s).astype(np.float64)
    spectrum: NDArray[np.complex128] = np.fft.rfft(whole).astype(np.complex128)
    spectrum *= gain(weighting, frequency_hz)
    weighed: NDArray[np.float64] = np.fft.irfft(spectrum, len(whole))[: len(values)].astype(np.float64)
    return weighed
