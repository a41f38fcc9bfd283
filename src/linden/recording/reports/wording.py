"""How CARLA's reports write numbers, and the lines they begin and end with. Source: ``CarlaRecorderQuery.cpp``."""

import math
import time
from collections.abc import Iterable

from linden.recording.packets import Header


def number(value: float) -> str:
    """Return a number as a C++ stream writes it: 6 significant digits; a nan keeps its sign."""
    if math.isnan(value) and math.copysign(1.0, value) < 0.0:
        return "-nan"
    return f"{value:g}"


def triple(values: Iterable[float]) -> str:
    """Return numbers in brackets."""
    return f"({', '.join(map(number, values))})"


def heading(header: Header) -> str:
    """Return the lines that begin every report; the date is that of this machine's time zone, as in CARLA."""
    date = time.strftime("%m/%d/%y %H:%M:%S", time.localtime(header.date_unix_s))
    return f"Version: {header.version}\nMap: {header.map_name}\nDate: {date}\n\n"


def ending(last_number: int, duration: str) -> str:
    """Return the lines that end every report; ``duration`` in s, already written."""
    return f"\nFrames: {last_number}\nDuration: {duration} seconds\n"
