"""Figures between entities: distances by system of coordinates, time to collision, overlap of boxes."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from basu_openscenario.playing.transition import SMALL, sign

if TYPE_CHECKING:
    from basu_openscenario.playing.mover import Mover
    from basu_openscenario.roads.place import Place

Corners = list[tuple[float, float]]
HIGHEST_M = 3.0
"""Entities on levels further apart than this do not touch."""


def gaps_m(first: Mover, second: Mover) -> tuple[float, float, bool]:
    """Return the gap ahead and to the left of the first box's axes, and whether the boxes overlap; m.

    By the separating axes of both boxes. A gap is positive ahead and to the left, and 0 where the projections overlap.
    """
    apart = False
    along = aside = 0.0
    boxes = (first.corners_m(), second.corners_m())
    for nth, mover in enumerate((first, second)):
        for is_along in (False, True):
            angle = mover.place.h_rad + (0.0 if is_along else math.pi / 2.0)
            axis = (math.cos(angle), math.sin(angle))
            own, other = (_span(boxes[which], axis) for which in (nth, 1 - nth))
            gap = 0.0
            if own[1] < other[0] - SMALL:
                gap = other[0] - own[1]
            elif own[0] > other[1] + SMALL:
                gap = -(own[0] - other[1])
            apart = apart or gap != 0.0
            if nth == 0 and is_along:
                along = gap
            elif nth == 0:
                aside = gap
    return along, aside, not apart


def _span(corners: Corners, axis: tuple[float, float]) -> tuple[float, float]:
    """Return the least and the greatest projection of corners on an axis."""
    values = [x * axis[0] + y * axis[1] for x, y in corners]
    return min(values), max(values)


def touch(first: Mover, second: Mover) -> bool:
    """Return whether two boxes overlap on one level."""
    return abs(first.place.z_m - second.place.z_m) <= HIGHEST_M and gaps_m(first, second)[2]


def _edge_distance(point: tuple[float, float], corners: Corners) -> float:
    """Return the distance of a point from the edges of a box."""
    return math.hypot(*_from_edges(point, corners))


def _from_edges(point: tuple[float, float], corners: Corners) -> tuple[float, float]:
    """Return the vector in the world from the nearest point of the edges of a box to a point."""
    best = (math.inf, math.inf)
    for (ax, ay), (bx, by) in zip(corners, [*corners[1:], corners[0]], strict=True):
        dx, dy = bx - ax, by - ay
        length2 = dx * dx + dy * dy
        share = 0.0 if length2 < SMALL * SMALL else ((point[0] - ax) * dx + (point[1] - ay) * dy) / length2
        share = min(max(share, 0.0), 1.0)
        found = (point[0] - ax - share * dx, point[1] - ay - share * dy)
        if math.hypot(*found) < math.hypot(*best):
            best = found
    return best


def free_distance_m(first: Mover, second: Mover) -> float:
    """Return the distance between two boxes; 0 where they overlap."""
    if gaps_m(first, second)[2]:
        return 0.0
    one, other = first.corners_m(), second.corners_m()
    return min(*(_edge_distance(p, other) for p in one), *(_edge_distance(p, one) for p in other))


def distance_m(first: Mover, second: Mover, *, system: str, kind: str, freespace: bool) -> float | None:
    """Return the signed distance from one entity to another; None where no road leads there.

    Args:
        first: from here.
        second: to there.
        system: ``entity``, ``lane``, ``road``, ``trajectory`` or ``world``.
        kind: ``longitudinal``, ``lateral``, or over the air.
        freespace: between the boxes instead of the reference points.
    """
    if not freespace:
        return point_distance_m(first, second.place, system=system, kind=kind, target=second)
    over_air = kind not in {"longitudinal", "lateral"}
    along, aside, _ = gaps_m(first, second)
    if over_air:
        return free_distance_m(first, second) * sign(along)
    if system in {"road", "lane"}:
        if touch(first, second):
            return 0.0
        return _free_road_distance(first, [_corner_place(second, corner) for corner in second.corners_m()], kind)
    return along if kind == "longitudinal" else aside


def point_distance_m(
    first: Mover, there: Place, *, system: str, kind: str, target: Mover | None = None
) -> float | None:
    """Return the signed distance from an entity's reference point to a place; None where no road leads there."""
    ahead, left = first.place.seen_from(there.x_m, there.y_m)
    if kind not in {"longitudinal", "lateral"}:
        return math.hypot(ahead, left) * (1.0 if ahead > 0.0 else -1.0)
    if system == "trajectory" and first.follower is not None:
        return _along_trajectory(first, there, target, kind)
    if system in {"road", "lane"}:
        way = first.place.to(there)
        if way is None:
            return None
        return way.ds_m if kind == "longitudinal" else way.dt_m
    return ahead if kind == "longitudinal" else left


def _along_trajectory(first: Mover, there: Place, target: Mover | None, kind: str) -> float:
    """Return the distance along or beside the trajectory that an entity follows."""
    follower = first.follower
    assert follower is not None, "it follows one"
    if target is not None and target.follower is not None and target.follower.curve.name == follower.curve.name:
        return target.follower.s_m - follower.s_m if kind == "longitudinal" else 0.0
    s_m, beside_m = follower.curve.nearest(there.x_m, there.y_m)
    return s_m - follower.s_m if kind == "longitudinal" else beside_m


def position_distance_m(first: Mover, there: Place, *, system: str, kind: str, freespace: bool) -> float | None:
    """Return the signed distance from an entity to a place; None where no road leads there.

    ``freespace`` measures from the box of the entity instead of its reference point.
    """
    if not freespace:
        return point_distance_m(first, there, system=system, kind=kind)
    ahead, left = first.place.seen_from(there.x_m, there.y_m)
    box = first.entity.box
    if abs(ahead - box.centre_m[0]) <= box.length_m / 2.0 and abs(left - box.centre_m[1]) <= box.width_m / 2.0:
        return 0.0
    if kind in {"longitudinal", "lateral"} and system in {"road", "lane"}:
        return _free_road_distance(first, [there], kind)
    ahead, left = first.along((*_from_edges((there.x_m, there.y_m), first.corners_m()), 0.0))
    if kind in {"longitudinal", "lateral"}:
        return ahead if kind == "longitudinal" else left
    return math.hypot(ahead, left) * sign(ahead)


def _free_road_distance(first: Mover, there: list[Place], kind: str) -> float | None:
    """Return the distance from the corners of a box to places along or across the road; 0 between two corners."""
    found: list[list[float]] = []
    for corner in first.corners_m():
        here = _corner_place(first, corner)
        row = []
        for other in there:
            way = here.to(other)
            if way is None:
                return None
            row.append(way.ds_m if kind == "longitudinal" else way.dt_m)
        found.append(row)
    rows = found if len(there) > 1 else [[value for row in found for value in row]]
    if any(len({sign(value) for value in row}) > 1 for row in rows):
        return 0.0
    return min((value for row in found for value in row), key=abs)


def _corner_place(mover: Mover, corner: tuple[float, float]) -> Place:
    """Return the place of a corner on the roads that lead on from the entity's."""
    place = mover.place.copy()
    place.x_m, place.y_m = corner
    place.attach()
    place.h_rel_rad = mover.place.h_rel_rad
    return place


def time_to_collision_s(first: Mover, second: Mover, distance: float | None) -> float:
    """Return the time until a distance is used up at the present speeds in s; -1 where it is not."""
    gap = 1e10 if distance is None else distance
    vx, vy, _ = second.velocity_mps
    if abs(vx) < SMALL and abs(vy) < SMALL:
        closing = first.speed_mps
    else:
        own = (first.velocity_mps[0] * vx + first.velocity_mps[1] * vy) / math.hypot(vx, vy)
        closing = sign(first.speed_mps) * sign(own) * (own - abs(second.speed_mps))
    if abs(gap) < SMALL or abs(closing) < SMALL:
        return -1.0
    time_s = gap / closing
    return time_s if time_s >= 0.0 else -1.0
