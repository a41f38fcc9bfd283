"""Units at the ends of names, as in ``timeout_s``: for options, columns of tables, schemas and pages alike."""

from __future__ import annotations

UNITS = {
    "mps175": "m/s^1.75",
    "mps15": "m/s^1.5",
    "mps3": "m/s³",
    "mps2": "m/s²",
    "mps": "m/s",
    "miles": "mi",
    "km": "km",
    "m": "m",
    "ns": "N s",
    "s": "s",
    "radps": "rad/s",
    "rad": "rad",
    "deg": "°",
    "gb": "GB",
}


def parted(name: str) -> tuple[str, str]:
    """Return a name without its unit, and the unit; the whole name and an empty text if it ends with none."""
    stem, _, end = name.rpartition("_")
    return (stem, UNITS[end]) if stem and end in UNITS else (name, "")
