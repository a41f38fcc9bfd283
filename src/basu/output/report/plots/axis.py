"""Axes: round numbers to write beside a chart, and times as people read them."""

from __future__ import annotations

import math

LONG_S = 180.0  # runs longer than this have minutes on their axis
MINUTE_S = 60.0


def ticks(low: float, high: float, about: int = 5) -> list[float]:
    """Round values in ``low`` .. ``high``, about so many: steps of 1, 2 or 5 times a power of ten."""
    if not high > low:
        return [low]
    rough = (high - low) / about
    power = 10.0 ** math.floor(math.log10(rough))
    step = next(factor * power for factor in (1.0, 2.0, 5.0, 10.0) if factor * power >= rough * 0.999)
    first, last = math.ceil(low / step - 1e-9), math.floor(high / step + 1e-9)
    return [number * step for number in range(first, last + 1)]


def time_ticks(low_s: float, high_s: float, about: int = 10) -> list[float]:
    """Round times in s: as :func:`ticks`, on a long axis whole parts of minutes."""
    if high_s - low_s <= LONG_S:
        return ticks(low_s, high_s, about)
    rough_s = (high_s - low_s) / about
    steps_s = (15.0, 30.0, 60.0, 120.0, 300.0, 600.0, 900.0, 1800.0)
    step_s = next((s for s in steps_s if s >= rough_s * 0.999), math.ceil(rough_s / 3600.0) * 3600.0)
    return [number * step_s for number in range(math.ceil(low_s / step_s), math.floor(high_s / step_s) + 1)]


def clock(t_s: float, long: bool) -> str:  # noqa: FBT001 - which of two ways an axis is written
    """A time on an axis: seconds, or minutes and seconds on a long one."""
    if not long:
        return f"{t_s:g}"
    return f"{int(t_s // MINUTE_S)}:{int(t_s % MINUTE_S):02d}"
