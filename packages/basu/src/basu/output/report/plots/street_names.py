"""Names of streets on the map of a run, along their streets, and the street at a place in words."""

from __future__ import annotations

import math
from itertools import pairwise, product
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from numpy.typing import NDArray

    from basu.output.report.streets import Bounds, Line, Streets

LETTER_PX, HEIGHT_PX = 6.4, 13.0  # of a name on the map; report.css has the size of its letters
PHONE_PX = 350.0  # width of a map on a telephone
GAP_PX = 6.0  # between two names
BESIDE_PX = (-10.0, 10.0, -24.0, 24.0)  # of the middle of a name from its street: above, below, and beyond marks
MARK_PX = 13.0  # about the middle of a mark, on either side
NEAR_M = 25.0  # a place farther from the centre lines of a street is not on it
STEP_M = 8.0  # between places that a name may take along its street


class PlacedName(NamedTuple):
    """A name on the map."""

    name: str
    x_m: float
    y_m: float
    angle_deg: float  # clockwise, -90 to 90: never upside down
    beside_px: float  # from the street, downwards before the turn
    is_minor: bool  # there is no room for it on a telephone


class MarkPlace(NamedTuple):
    """A mark, shown so far above its place."""

    x_m: float
    y_m: float
    up_px: float


class _NameBox(NamedTuple):
    """A rectangle about a name or a mark, in px of the map."""

    x_px: float
    y_px: float
    half_width_px: float
    half_height_px: float

    def meets(self, other: _NameBox) -> bool:
        """Return whether both touch."""
        return (
            abs(self.x_px - other.x_px) < self.half_width_px + other.half_width_px
            and abs(self.y_px - other.y_px) < self.half_height_px + other.half_height_px
        )


def placed_names(streets: Streets, bounds: Bounds, width_px: float, taken: Sequence[MarkPlace]) -> list[PlacedName]:
    """Return a place for the name of each street where it touches no other name and no mark.

    Args:
        streets: the lanes around a run.
        bounds: the rectangle that the map shows.
        width_px: width of the map on a desk's screen.
        taken: the marks of the map.
    """
    large = _placed(streets, bounds, width_px, taken)
    small = {each.name: each for each in _placed(streets, bounds, min(width_px, PHONE_PX), taken)}
    return [small.get(each.name, each._replace(is_minor=True)) for each in large]


def street_at(streets: Streets, x_m: float, y_m: float) -> str:
    """Return the name of the street nearest to a place; empty if none is near."""
    nearest, least_m = "", NEAR_M
    for line, name in zip(*streets, strict=True):
        if name and (away_m := _distance(np.array(line), x_m, y_m)) < least_m:
            nearest, least_m = name, away_m
    return nearest


def _placed(streets: Streets, bounds: Bounds, width_px: float, taken: Sequence[MarkPlace]) -> list[PlacedName]:
    """Return the names that have room on a map of this width, those of the longest streets first."""
    px_per_m = width_px / bounds.width_m
    boxes = [
        _NameBox((x_m - bounds.west_m) * px_per_m, (y_m - bounds.north_m) * px_per_m - up_px, MARK_PX, MARK_PX)
        for x_m, y_m, up_px in taken
    ]
    found = []
    for name, lines in _by_length(streets):
        for each in _candidates(name, lines, bounds):
            box = _box(each, bounds, px_per_m)
            if _is_within(box, bounds, px_per_m) and not any(box.meets(other) for other in boxes):
                boxes.append(box)
                found.append(each)
                break
    return found


def _by_length(streets: Streets) -> list[tuple[str, list[Line]]]:
    """Return the lines of each name, the longest street first."""
    named: dict[str, list[Line]] = {}
    for line, name in zip(*streets, strict=True):
        if name and len(line) > 1:
            named.setdefault(name, []).append(line)
    return sorted(named.items(), key=lambda each: (-sum(map(_length, each[1])), each[0]))


def _candidates(name: str, lines: Sequence[Line], bounds: Bounds) -> Iterator[PlacedName]:
    """Yield places along a street, those nearest to the middle of the map first."""
    middle = np.array([(bounds.west_m + bounds.east_m) / 2.0, (bounds.north_m + bounds.south_m) / 2.0])
    found = []
    for line in lines:
        points = np.array(line)
        for (x1, y1), (x2, y2) in pairwise(points):
            angle_deg = math.degrees(math.atan2(y2 - y1, x2 - x1))
            angle_deg = (angle_deg + 90.0) % 180.0 - 90.0
            for share in np.linspace(0.0, 1.0, 2 + int(math.hypot(x2 - x1, y2 - y1) / STEP_M))[1:-1]:
                at = np.array([x1 + share * (x2 - x1), y1 + share * (y2 - y1)])
                found.append((float(np.hypot(*(at - middle))), float(at[0]), float(at[1]), angle_deg))
    for beside_px, (_, x_m, y_m, angle_deg) in product(BESIDE_PX, sorted(found)):
        yield PlacedName(name, x_m, y_m, angle_deg, beside_px, is_minor=False)


def _box(each: PlacedName, bounds: Bounds, px_per_m: float) -> _NameBox:
    """Return the rectangle about a turned name."""
    turn_rad = math.radians(each.angle_deg)
    long_px, cos, sin = LETTER_PX * len(each.name), abs(math.cos(turn_rad)), abs(math.sin(turn_rad))
    return _NameBox(
        (each.x_m - bounds.west_m) * px_per_m - each.beside_px * math.sin(turn_rad),
        (each.y_m - bounds.north_m) * px_per_m + each.beside_px * math.cos(turn_rad),
        (long_px * cos + HEIGHT_PX * sin + GAP_PX) / 2.0,
        (long_px * sin + HEIGHT_PX * cos + GAP_PX) / 2.0,
    )


def _is_within(box: _NameBox, bounds: Bounds, px_per_m: float) -> bool:
    """Return whether a rectangle lies on the map as a whole."""
    return (
        box.half_width_px <= box.x_px <= bounds.width_m * px_per_m - box.half_width_px
        and box.half_height_px <= box.y_px <= bounds.height_m * px_per_m - box.half_height_px
    )


def _length(line: Line) -> float:
    """Return the length of a line in m."""
    return float(np.hypot(*np.diff(np.array(line), axis=0).T).sum())


def _distance(points: NDArray[np.float64], x_m: float, y_m: float) -> float:
    """Return the distance of a place from a polyline (K, 2) in m."""
    at = np.array([x_m, y_m])
    if len(points) < 2:
        return float(np.hypot(*(points[0] - at)))
    ahead = np.diff(points, axis=0)
    squared = np.maximum((ahead**2).sum(axis=1), 1e-9)
    share = (((at - points[:-1]) * ahead).sum(axis=1) / squared).clip(0.0, 1.0)
    return float(np.hypot(*(points[:-1] + share[:, None] * ahead - at).T).min())
