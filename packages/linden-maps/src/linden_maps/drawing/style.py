"""Colours of map drawings, and functions that write points, paths and groups as SVG text."""

from collections.abc import Iterable

import numpy as np
from numpy.typing import NDArray

from linden.protocol.values.enums import LaneType

GRASS = "#e8ecdc"
ASPHALT = "#71777d"
INK = "#2f3437"
PAINT = "#fbfaf5"
YELLOW = "#e8b93a"
RED = "#c8352e"
GREEN = "#3a9a56"
SPAWN = "#2f78c4"
BUILDING = "#b9a98c"
RAILROAD = "#7a5c48"

# in the order of drawing: what comes later lies on top
SURFACES: dict[LaneType, tuple[str, str]] = {
    LaneType.NONE: ("verge", "#cdd8b6"),
    LaneType.MEDIAN: ("median", "#c3d1a6"),
    LaneType.RESTRICTED: ("restricted", "#b7b3aa"),
    LaneType.SIDEWALK: ("pavement", "#d9d2c3"),
    LaneType.SHOULDER: ("shoulder", "#83898e"),
    LaneType.PARKING: ("parking", "#8d9499"),
    LaneType.BIKING: ("biking", "#a4655a"),
    LaneType.DRIVING: ("driving", ASPHALT),
    LaneType.BORDER: ("kerb", "#a79f8f"),
}
OTHER_SURFACE = ("other lanes", "#999d9f")


def points(corners: NDArray[np.float64]) -> str:
    """Write (N, 2) points in m, to the centimetre."""
    rounded = np.round(corners, 2) + 0.0  # no negative zeros
    return " ".join(f"{x:.2f},{y:.2f}" for x, y in rounded.tolist())


def path(rings: Iterable[NDArray[np.float64]], *, closed: bool) -> str:
    """Write the data of a <path>: one piece for each (N, 2) array."""
    end = "Z" if closed else ""
    return "".join(f"M{points(ring)}{end}" for ring in rings)


def group(name: str, style: str, parts: Iterable[str]) -> list[str]:
    """Return a <g> with its parts; nothing where there are none."""
    inner = list(parts)
    return [f'<g id="{name}" {style}>', *inner, "</g>"] if inner else []
