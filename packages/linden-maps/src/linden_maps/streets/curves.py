"""Plane curves of lines and arcs: rounding a polyline's corners, joining two poses smoothly. Frame: OpenDRIVE's.

x east, y north, headings counter-clockwise from east; curvature positive to the left. A path is a tuple of pieces;
their ends meet with equal headings. Lines and arcs alone, because both have exact lengths and exact parallel curves.
"""

import math
from collections.abc import Sequence
from itertools import pairwise
from typing import NamedTuple

STRAIGHT_PER_M = 2e-5
"""An arc that is flatter becomes its chord: over 20 m the two lie 1 mm apart, and LibCarla, which finds an arc's points
from its centre in single precision, is off by more than that where the radius exceeds 50 km."""
STRAIGHT_RAD = 2e-3
"""An arc that turns by more stays an arc, however flat it is: its chord would leave and arrive at another angle."""


class Pose(NamedTuple):
    """A point and a heading."""

    x_m: float
    y_m: float
    heading_rad: float


class Piece(NamedTuple):
    """A line (curvature 0) or an arc."""

    start: Pose
    length_m: float
    curvature_per_m: float


Path = tuple[Piece, ...]
Point = tuple[float, float]


def wrapped(angle_rad: float) -> float:
    """Return the angle in (-pi, pi]."""
    turned = math.remainder(angle_rad, math.tau)
    return math.pi if turned == -math.pi else turned


def moved(pose: Pose, forward_m: float = 0.0, left_m: float = 0.0) -> Pose:
    """Return the pose shifted in its own frame, heading unchanged."""
    cos, sin = math.cos(pose.heading_rad), math.sin(pose.heading_rad)
    return Pose(pose.x_m + forward_m * cos - left_m * sin, pose.y_m + forward_m * sin + left_m * cos, pose.heading_rad)


def turned_back(pose: Pose) -> Pose:
    """Return the same point, looking the other way."""
    return pose._replace(heading_rad=wrapped(pose.heading_rad + math.pi))


def seen_from(pose: Pose, point: Point) -> Point:
    """Return the point in the pose's frame: metres forward, metres to the left."""
    dx, dy = point[0] - pose.x_m, point[1] - pose.y_m
    cos, sin = math.cos(pose.heading_rad), math.sin(pose.heading_rad)
    return dx * cos + dy * sin, dy * cos - dx * sin


def along(piece: Piece, s_m: float) -> Pose:
    """Return the pose ``s_m`` after the start of a piece."""
    x_m, y_m, heading_rad = piece.start
    turn_rad = piece.curvature_per_m * s_m
    chord_m = s_m if abs(turn_rad) < 1e-12 else s_m * math.sin(turn_rad / 2) / (turn_rad / 2)
    middle_rad = heading_rad + turn_rad / 2
    return Pose(
        x_m + chord_m * math.cos(middle_rad), y_m + chord_m * math.sin(middle_rad), wrapped(heading_rad + turn_rad)
    )


def length(path: Path) -> float:
    """Return the length of a path in m."""
    return math.fsum(piece.length_m for piece in path)


def pose_at(path: Path, s_m: float) -> Pose:
    """Return the pose at ``s_m``; before the start and past the end the first and last piece go on."""
    for piece in path[:-1]:
        if s_m <= piece.length_m:
            return along(piece, s_m)
        s_m -= piece.length_m
    return along(path[-1], s_m)


def trimmed(path: Path, from_m: float, to_m: float) -> Path:
    """Return the part of the path between two distances from its start; slivers under 0.1 mm are left out."""
    kept = []
    at_m = 0.0
    for piece in path:
        first, last = max(from_m - at_m, 0.0), min(to_m - at_m, piece.length_m)
        if last - first > 1e-4:
            kept.append(Piece(along(piece, first), last - first, piece.curvature_per_m))
        at_m += piece.length_m
    return tuple(kept)


def sampled(path: Path, step_m: float, left_m: float = 0.0) -> list[Pose]:
    """Return poses at most ``step_m`` apart along the path and ``left_m`` beside it, both ends included."""
    total_m = length(path)
    count = max(1, math.ceil(total_m / step_m))
    return [moved(pose_at(path, total_m * i / count), left_m=left_m) for i in range(count + 1)]


def rounded(points: Sequence[Point], radius_m: float, ends_kept_m: float) -> Path:
    """Return the polyline with each corner replaced by an arc that touches both its sides.

    ``radius_m`` is used where the sides are long enough; else the arc takes half of each inner side, and of the first
    and last all but ``ends_kept_m`` (but half at least), because a junction will stand there.
    """
    headings = [math.atan2(b[1] - a[1], b[0] - a[0]) for a, b in pairwise(points)]
    sides_m = [math.dist(a, b) for a, b in pairwise(points)]
    room_m = [side / 2 for side in sides_m]
    room_m[0] = max(room_m[0], sides_m[0] - ends_kept_m)
    room_m[-1] = max(room_m[-1], sides_m[-1] - ends_kept_m)
    path = []
    at = Pose(*points[0], headings[0])
    for i, corner in enumerate(points[1:-1]):
        turn_rad = wrapped(headings[i + 1] - headings[i])
        if abs(turn_rad) < 1e-9:
            continue
        half_tan = math.tan(abs(turn_rad) / 2)
        tangent_m = min(radius_m * half_tan, room_m[i], room_m[i + 1])
        straight_m = math.dist((at.x_m, at.y_m), corner) - tangent_m
        if straight_m > 1e-4:
            path.append(Piece(at, straight_m, 0.0))
        arc_radius_m = tangent_m / half_tan
        begin = Pose(
            corner[0] - tangent_m * math.cos(headings[i]), corner[1] - tangent_m * math.sin(headings[i]), headings[i]
        )
        path.append(Piece(begin, arc_radius_m * abs(turn_rad), math.copysign(1 / arc_radius_m, turn_rad)))
        at = Pose(
            corner[0] + tangent_m * math.cos(headings[i + 1]),
            corner[1] + tangent_m * math.sin(headings[i + 1]),
            headings[i + 1],
        )
    last_m = math.dist((at.x_m, at.y_m), points[-1])
    if last_m > 1e-4:
        path.append(Piece(at, last_m, 0.0))
    return tuple(path)


def joined(begin: Pose, end: Pose, share: float = 1.0) -> Path:
    """Return a smooth path from one pose to another: line and arc where a single turn fits, else two arcs.

    Of the two the one with the larger smallest radius is taken; a single turn uses a ``share`` of the room. The
    end must not lie right behind the beginning.
    """
    single = _one_turn(begin, end, share)
    double = _two_arcs(begin, end)
    found = single if single is not None and sharpest(single) * share <= sharpest(double) + 1e-9 else double
    return tuple(_chord(piece) if _is_straight(piece) else piece for piece in found)


def sharpest(path: Path) -> float:
    """Return the largest absolute curvature in 1/m."""
    return max(abs(piece.curvature_per_m) for piece in path)


def _is_straight(piece: Piece) -> bool:
    """Return whether a chord may stand for the piece."""
    curvature_per_m = abs(piece.curvature_per_m)
    return curvature_per_m < STRAIGHT_PER_M and curvature_per_m * piece.length_m < STRAIGHT_RAD


def _chord(piece: Piece) -> Piece:
    """Return the line between the ends of a piece."""
    end = along(piece, piece.length_m)
    dx, dy = end.x_m - piece.start.x_m, end.y_m - piece.start.y_m
    return Piece(piece.start._replace(heading_rad=math.atan2(dy, dx)), math.hypot(dx, dy), 0.0)


def _one_turn(begin: Pose, end: Pose, share: float) -> Path | None:
    """Return line, arc, line where the tangents of both poses meet between them; None where they do not."""
    forward_m, left_m = seen_from(begin, (end.x_m, end.y_m))
    turn_rad = wrapped(end.heading_rad - begin.heading_rad)
    if abs(turn_rad) < 1e-6:
        return (Piece(begin, forward_m, 0.0),) if abs(left_m) < 1e-6 and forward_m > 0 else None
    after_m = left_m / math.sin(turn_rad) if abs(math.sin(turn_rad)) > 1e-9 else math.inf
    before_m = forward_m - after_m * math.cos(turn_rad)
    if not (1e-3 < before_m < 1e4 and 1e-3 < after_m < 1e4):
        return None
    tangent_m = min(before_m, after_m) * share
    radius_m = tangent_m / math.tan(abs(turn_rad) / 2)
    pieces = [Piece(begin, before_m - tangent_m, 0.0)]
    pieces.append(
        Piece(moved(begin, before_m - tangent_m), radius_m * abs(turn_rad), math.copysign(1 / radius_m, turn_rad))
    )
    pieces.append(Piece(moved(end, tangent_m - after_m), after_m - tangent_m, 0.0))
    return tuple(piece for piece in pieces if piece.length_m > 1e-4)


def _two_arcs(begin: Pose, end: Pose) -> Path:
    """Return the biarc with equal tangent lengths. Source: Bolton 1975, "Biarc curves", Computer-Aided Design 7(2)."""
    bx, by = math.cos(begin.heading_rad), math.sin(begin.heading_rad)
    ex, ey = math.cos(end.heading_rad), math.sin(end.heading_rad)
    vx, vy = end.x_m - begin.x_m, end.y_m - begin.y_m
    v_dot_t = vx * (bx + ex) + vy * (by + ey)
    v_dot_v = vx * vx + vy * vy
    apart = 2 * (1 - (bx * ex + by * ey))
    reach_m = 0.0  # of no account where the headings agree: then the arcs meet half way
    if apart > 1e-9:
        reach_m = (math.sqrt(v_dot_t * v_dot_t + apart * v_dot_v) - v_dot_t) / apart
    middle = (
        (begin.x_m + end.x_m + reach_m * (bx - ex)) / 2,
        (begin.y_m + end.y_m + reach_m * (by - ey)) / 2,
    )
    first = _arc_to(begin, middle)
    return first, _arc_to(along(first, first.length_m), (end.x_m, end.y_m))


def _arc_to(begin: Pose, point: Point) -> Piece:
    """Return the arc that leaves ``begin`` along its heading and ends in ``point``."""
    forward_m, left_m = seen_from(begin, point)
    chord_m = math.hypot(forward_m, left_m)
    half_turn_rad = math.atan2(left_m, forward_m)
    curvature = 2 * math.sin(half_turn_rad) / chord_m
    if abs(curvature) < 1e-12:
        return Piece(begin, chord_m, 0.0)
    return Piece(begin, 2 * half_turn_rad / curvature, curvature)
