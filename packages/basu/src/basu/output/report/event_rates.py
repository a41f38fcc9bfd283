"""Events for the distance that was driven: per 1,000 km and per million miles, with exact intervals.

The two units are those of reports in Europe and in the United States. An interval of few events on a short way is wide,
and no event on a way of 3 km still allows 1,230 on 1,000 km.
"""

from __future__ import annotations

from basu.intervals import poisson

M_PER_MILE = 1609.344
KM, MILES = 1e6, 1e6 * M_PER_MILE  # m in 1,000 km and in a million miles


def rate_text(events: int, driven_m: float) -> str:
    """Return a number of events with both rates and their 95 % intervals."""
    if not driven_m > 0.0:
        return f"{events}, and no way was driven"
    per_km, per_miles = (poisson(events, driven_m / unit) for unit in (KM, MILES))
    return (
        f"{events}; {_figure(per_km.value)} per 1,000 km ({_figure(per_km.low)} to {_figure(per_km.high)}), "
        f"{_figure(per_miles.value)} per million miles ({_figure(per_miles.low)} to {_figure(per_miles.high)})"
    )


def _figure(value: float) -> str:
    """Return a rate with three digits, and thousands apart."""
    if value == 0.0:
        return "0"
    return f"{float(f'{value:.3g}'):,.0f}" if value >= 100.0 else f"{value:.3g}"
