"""Paths round a ring: a right-hand bend in, an arc counter-clockwise, a right-hand bend out; where they fit.

Mini-roundabouts and turning circles are made of them.
"""

import math
from collections.abc import Iterable
from typing import NamedTuple

from linden.errors import UserError
from linden_maps.streets.curves import Piece, Point, Pose, along, moved, seen_from

ISLAND_RADIUS_M = 4.3
LANE_M = 4.6
"""Island and lane give an inscribed circle of 17.8 m; mini-roundabouts have 15 to 27 m (FHWA, Public Roads 11/2012)."""

KERB_RADII_M = (5.0, ISLAND_RADIUS_M + LANE_M + 0.3)
"""Of the kerb about a turning circle: of its bends, and of the circle."""

BEND_RADIUS_M = 7.5
"""Of the middle of the lane in the bends in and out: at 1 m/s² sideways, 10 km/h."""

LANE_RADII_M = (BEND_RADIUS_M, ISLAND_RADIUS_M + LANE_M / 2)
"""Of the middle of a lane: of its bends, and of the ring."""


class _Approach(NamedTuple):
    """A straight and a right-hand bend that ends on the ring, seen in the direction of entry (or left, mirrored)."""

    straight_m: float
    turn_rad: float


def round_ring(begin: Pose, end: Pose, centre: Point, radii_m: tuple[float, float]) -> tuple[Piece, ...]:
    """Return straight, bend, ring, bend, straight; ``radii_m`` of the bends and of the ring.

    Raises:
        UserError: a straight leads past the ring.
    """
    entry = _approach(seen_from(begin, centre), radii_m)
    ahead_m, left_m = seen_from(end, centre)
    leave = _approach((-ahead_m, left_m), radii_m)
    if entry is None or leave is None:
        raise UserError(
            "a street leads past the middle of a roundabout, not to it; straighten its last 20 m or change the control"
        )
    on_ring_rad = (end.heading_rad - begin.heading_rad + entry.turn_rad + leave.turn_rad) % math.tau
    pieces = [Piece(begin, entry.straight_m, 0.0)]
    at = moved(begin, forward_m=entry.straight_m)
    for turn_rad, radius_m in (
        (-entry.turn_rad, radii_m[0]),
        (on_ring_rad, radii_m[1]),
        (-leave.turn_rad, radii_m[0]),
    ):
        piece = Piece(at, abs(turn_rad) * radius_m, math.copysign(1 / radius_m, turn_rad))
        pieces.append(piece)
        at = along(piece, piece.length_m)
    pieces.append(Piece(at, leave.straight_m, 0.0))
    return tuple(pieces)


def leads_in(pose: Pose, centre: Point, lefts_m: Iterable[float], radii_m: tuple[float, float]) -> bool:
    """Return whether all lines along a pose, so far to its left, reach the ring: right ones in, left ones out."""
    for left_m in lefts_m:
        ahead_m, centre_left_m = seen_from(moved(pose, left_m=left_m), centre)
        if _approach((ahead_m, centre_left_m if left_m < 0.0 else -centre_left_m), radii_m) is None:
            return False
    return True


def _approach(centre: Point, radii_m: tuple[float, float]) -> _Approach | None:
    """Return the way in for a centre so far ahead and to the left: the bend touches the ring's middle from outside.

    The bend's centre is its radius to the right; its distance to the island's centre is the sum of the radii. None
    where the line leads past the ring.
    """
    ahead_m, left_m = centre
    apart_m = sum(radii_m)
    beside_m = left_m + radii_m[0]
    before_m = math.sqrt(max(apart_m**2 - beside_m**2, 0.0))
    if before_m == 0.0 or ahead_m < before_m:
        return None
    return _Approach(ahead_m - before_m, math.atan2(before_m, beside_m))
