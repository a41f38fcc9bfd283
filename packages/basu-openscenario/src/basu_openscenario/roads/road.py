"""A road: its reference line, heights, lanes with their widths, and links."""

from __future__ import annotations

import bisect
import math
from dataclasses import dataclass, field
from typing import NamedTuple

from basu_openscenario.roads.geometry import Cubic, Curve, LinePoint, cubic, slope

MARGIN_M = 1e-6
STEEPEST = 0.05
"""The least cosine of a superelevation by which a place of the plan is laid on the banked surface."""


class Piece(NamedTuple):
    """A cubic function from ``s_m`` on."""

    s_m: float
    coefficients: Cubic


@dataclass(frozen=True, slots=True)
class Profile:
    """A function of s in cubic pieces; zero where there are none."""

    pieces: tuple[Piece, ...] = ()

    def piece(self, s_m: float) -> Piece | None:
        """Return the piece at ``s_m``; the first one also before its begin."""
        if not self.pieces:
            return None
        index = bisect.bisect_right(self.pieces, s_m + MARGIN_M, key=lambda piece: piece.s_m) - 1
        return self.pieces[max(index, 0)]

    def value(self, s_m: float) -> float:
        """Return the function's value."""
        piece = self.piece(s_m)
        return 0.0 if piece is None else cubic(piece.coefficients, s_m - piece.s_m)

    def slope(self, s_m: float) -> float:
        """Return the function's derivative."""
        piece = self.piece(s_m)
        return 0.0 if piece is None else slope(piece.coefficients, s_m - piece.s_m)


@dataclass(frozen=True, slots=True)
class Lane:
    """A lane of a section: its type, its width from the section's begin, and the lanes that it continues."""

    number: int
    kind: str
    width: Profile
    heights: tuple[tuple[float, float, float], ...] = ()
    """From s on, in the section: how far its inner and its outer edge lie above the road; m."""
    predecessor: int | None = None
    successor: int | None = None


@dataclass(frozen=True, slots=True)
class LaneSection:
    """The lanes from ``s_m`` on, by number: positive to the left of the reference line."""

    s_m: float
    end_m: float
    lanes: dict[int, Lane]

    def width_m(self, number: int, s_m: float) -> float:
        """Return the width of a lane; 0 for the centre."""
        return 0.0 if number == 0 else self.lanes[number].width.value(s_m - self.s_m)

    def _inner(self, number: int) -> range:
        """Return the lanes between a lane and the centre."""
        side = 1 if number > 0 else -1
        return range(side, number, side)

    def centre_m(self, number: int, s_m: float) -> float:
        """Return where the middle of a lane is: m to the left of lane 0."""
        if number == 0:
            return 0.0
        side = 1.0 if number > 0 else -1.0
        inner = sum(self.width_m(one, s_m) for one in self._inner(number) if one in self.lanes)
        return side * (inner + 0.5 * self.width_m(number, s_m))

    def height_m(self, number: int, s_m: float, offset_m: float) -> float:
        """Return how far a point of a lane lies above the road: between its inner and its outer edge."""
        lane = self.lanes.get(number)
        if lane is None or not lane.heights:
            return 0.0
        at_m = s_m - self.s_m
        inner, outer = next(
            (one[1:] for one in reversed(lane.heights) if at_m >= one[0] - MARGIN_M), lane.heights[0][1:]
        )
        if abs(outer - inner) < MARGIN_M:
            return inner
        outwards = offset_m if number > 0 else -offset_m
        share = 0.5 + outwards / max(self.width_m(number, s_m), MARGIN_M)
        return inner + min(max(share, 0.0), 1.0) * (outer - inner)

    def centre_slope(self, number: int, s_m: float) -> float:
        """Return how the middle of a lane drifts to the left, in m a metre."""
        if number == 0:
            return 0.0
        side = 1.0 if number > 0 else -1.0
        at_m = s_m - self.s_m
        inner = sum(self.lanes[one].width.slope(at_m) for one in self._inner(number) if one in self.lanes)
        return side * (inner + 0.5 * self.lanes[number].width.slope(at_m))

    def edges_m(self, s_m: float) -> tuple[float, float]:
        """Return the right and the left edge of all lanes: m to the left of lane 0."""
        right = -sum(self.width_m(number, s_m) for number in self.lanes if number < 0)
        left = sum(self.width_m(number, s_m) for number in self.lanes if number > 0)
        return right, left

    def paved_edges_m(self, s_m: float) -> tuple[float, float]:
        """Return the outer edges of the outermost lanes with a type other than ``none``: m to the left of lane 0."""
        paved = [number for number, lane in self.lanes.items() if lane.kind != "none" and number]
        right, left = min([0, *paved]), max([0, *paved])
        return (
            self.centre_m(right, s_m) - 0.5 * self.width_m(right, s_m),
            self.centre_m(left, s_m) + 0.5 * self.width_m(left, s_m),
        )


class Link(NamedTuple):
    """What is at an end of a road: a road with its contact point, or a junction."""

    kind: str
    number: str
    contact: str | None


class RoadPoint(NamedTuple):
    """A point of the road's surface in the world: m and rad; pitch is positive downhill."""

    x_m: float
    y_m: float
    z_m: float
    h_rad: float
    p_rad: float
    r_rad: float
    twist_rad: float
    """The pitch that a change of the superelevation gives beside the reference line, in the banked surface."""


@dataclass(frozen=True, slots=True)
class Road:
    """A road of the network."""

    number: str
    length_m: float
    junction: str | None
    curves: tuple[Curve, ...]
    elevation: Profile
    superelevation: Profile
    lane_offset: Profile
    sections: tuple[LaneSection, ...]
    predecessor: Link | None = None
    successor: Link | None = None
    left_hand: bool = False
    limits: tuple[tuple[float, float | None], ...] = ()
    """From s on, in m: the posted speed in m/s; None where the file posts none."""
    _starts: list[float] = field(default_factory=list)

    def line(self, s_m: float) -> LinePoint:
        """Return the point of the reference line at ``s_m``."""
        if not self._starts:
            self._starts.extend(curve.s_m for curve in self.curves)
        index = max(bisect.bisect_right(self._starts, s_m) - 1, 0)
        curve = self.curves[index]
        return curve.at(s_m - curve.s_m)

    def section(self, s_m: float) -> LaneSection:
        """Return the section of lanes at ``s_m``."""
        for section in reversed(self.sections):
            if s_m >= section.s_m - MARGIN_M:
                return section
        return self.sections[0]

    def limit_mps(self, s_m: float) -> float | None:
        """Return the posted speed at ``s_m``; None where there is none."""
        return next((limit for from_m, limit in reversed(self.limits) if s_m >= from_m - MARGIN_M), None)

    def lane_t_m(self, lane: int, s_m: float) -> float:
        """Return where the middle of a lane is: m to the left of the reference line."""
        return self.lane_offset.value(s_m) + self.section(s_m).centre_m(lane, s_m)

    def lane_heading(self, lane: int, s_m: float) -> float:
        """Return how far the middle of a lane is turned to the left of the reference line, in rad."""
        return math.atan(self.section(s_m).centre_slope(lane, s_m) + self.lane_offset.slope(s_m))

    def point(self, s_m: float, t_m: float, above_m: float = 0.0) -> RoadPoint:
        """Return the point of the surface at ``s_m``, ``t_m`` to the left of the reference line, or above it."""
        line = self.line(s_m)
        p = -math.atan(self.elevation.slope(s_m))
        r = self.superelevation.value(s_m)
        across, side = math.sin(p) * math.sin(r) * t_m, math.cos(r) * t_m
        cos, sin = math.cos(line.h_rad), math.sin(line.h_rad)
        return RoadPoint(
            line.x_m + cos * across - sin * side,
            line.y_m + sin * across + cos * side,
            self.elevation.value(s_m) + math.cos(p) * (math.sin(r) * t_m + math.cos(r) * above_m),
            line.h_rad,
            p,
            r,
            -math.atan(self.superelevation.slope(s_m) * t_m),
        )

    def from_plan(self, s_m: float, plan_m: float) -> tuple[float, float]:
        """Return t on the banked surface, and how far its point lies ahead of ``s_m`` in the plan; m.

        Args:
            s_m: along the road.
            plan_m: to the left of the reference line in the plan.
        """
        r = self.superelevation.value(s_m)
        if r == 0.0:
            return plan_m, 0.0
        t_m = plan_m / max(math.cos(r), STEEPEST)
        return t_m, -math.sin(math.atan(self.elevation.slope(s_m))) * math.sin(r) * t_m

    def lane_at(self, s_m: float, t_m: float, kinds: frozenset[str] | None = None) -> tuple[int, float]:
        """Return the lane at a place and the offset from its middle in m; the nearest one beside the lanes.

        Args:
            s_m: along the road.
            t_m: to the left of the reference line.
            kinds: types of lanes that count; None: all.
        """
        section, from_centre = self.section(s_m), t_m - self.lane_offset.value(s_m)
        best: tuple[int, float] | None = None
        for number in sorted(section.lanes, reverse=True):
            lane = section.lanes[number]
            width = section.width_m(number, s_m)
            if number == 0 or width < MARGIN_M or (kinds is not None and lane.kind not in kinds):
                continue
            offset = from_centre - section.centre_m(number, s_m)
            if abs(offset) < width / 2.0:
                return number, offset
            if best is None or abs(offset) < abs(best[1]):
                best = number, offset
        return best or (0, from_centre)
