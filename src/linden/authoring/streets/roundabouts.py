"""Mini-roundabouts: ways round a central island, counter-clockwise, from each entry to each exit.

Every way is one connecting road: a right-hand bend in, an arc round the island, a right-hand bend out. The circulating
lane is where these roads lie on each other; ``docs/decisions/0011-roundabouts.md`` says why it is not a ring of roads.
"""

import itertools
import math
from typing import NamedTuple

from linden.authoring.streets.cross_section import KERB_HEIGHT_M, KERB_M
from linden.authoring.streets.curves import (
    Path,
    Piece,
    Point,
    Pose,
    along,
    joined,
    length,
    moved,
    seen_from,
    turned_back,
)
from linden.authoring.streets.document import Cubic, LaneRecord, Mark, RoadRecord, eased
from linden.authoring.streets.junctions import Turn, lane_pairs, pose_in, pose_out
from linden.authoring.streets.network import Leg
from linden.errors import UserError

ISLAND_RADIUS_M = 4.3
LANE_M = 4.6
"""Island and lane give an inscribed circle of 17.8 m; mini-roundabouts have 15 to 27 m (FHWA, Public Roads 11/2012)."""

KERB_RADII_M = (5.0, ISLAND_RADIUS_M + LANE_M + 0.3)
"""Of the kerb about a turning circle: of its bends, and of the circle."""

RING_RADIUS_M = ISLAND_RADIUS_M + LANE_M / 2
BEND_RADIUS_M = 7.5
"""Of the middle of the lane in the bends in and out: at 1 m/s² sideways, 10 km/h."""


class _Approach(NamedTuple):
    """A straight and a right-hand bend that ends on the ring, seen in the direction of entry (or left, mirrored)."""

    straight_m: float
    turn_rad: float


def turns(legs: tuple[Leg, ...], centre: Point) -> tuple[Turn, ...]:
    """Return the ways through a roundabout; a right turn that leaves no room for the ring goes directly."""
    found = []
    for come, lane_in, go, lane_out in lane_pairs(legs):
        begin, end = pose_in(legs[come], lane_in), pose_out(legs[go], lane_out)
        widths_m = legs[come].view.lane(lane_in).width_m, legs[go].view.lane(lane_out).width_m
        path, widths = _way(begin, end, centre, widths_m)
        found.append(Turn(legs[come], lane_in, legs[go], lane_out, path, widths))
    return tuple(found)


def turning_circle(leg: Leg, centre: Point) -> tuple[Turn, ...]:
    """Return the paths for turning back at the end of a street: each lane into its opposite, a spare one beside it."""
    found = []
    ins, outs = leg.view.driving(right=True), leg.view.driving(right=False)
    for place in range(max(len(ins), len(outs)) if ins and outs else 0):
        lane_in, lane_out = ins[min(place, len(ins) - 1)], outs[min(place, len(outs) - 1)]
        widths_m = leg.view.lane(lane_in).width_m, leg.view.lane(lane_out).width_m
        path, widths = _way(pose_in(leg, lane_in), pose_out(leg, lane_out), centre, widths_m)
        found.append(Turn(leg, lane_in, leg, lane_out, path, widths))
    return tuple(found)


def circle_kerb(leg: Leg, centre: Point) -> Path:
    """Return the kerb line round a turning circle, from the right side of its street to the left."""
    begin = moved(leg.pose, left_m=leg.view.kerb_m(right=True))
    end = turned_back(moved(leg.pose, left_m=leg.view.kerb_m(right=False)))
    return tuple(piece for piece in _round(begin, end, centre, KERB_RADII_M) if piece.length_m > 1e-4)


def island(number: int, centre: Point, height_m: float) -> RoadRecord:
    """Return the central island: a kerb and grass to the left of a circle without traffic."""
    start = Pose(centre[0] + ISLAND_RADIUS_M, centre[1], math.pi / 2)
    first = Piece(start, math.pi * ISLAND_RADIUS_M, 1 / ISLAND_RADIUS_M)
    second = first._replace(start=along(first, first.length_m))
    return RoadRecord(
        id=number,
        name="roundabout island",
        junction=-1,
        path=(first, second),
        predecessor=None,
        successor=None,
        speed_mph=None,
        elevation=(Cubic(0.0, height_m),),
        axis=(),
        left=(
            LaneRecord(id=1, kind="border", widths=(Cubic(0.0, KERB_M),), height_m=KERB_HEIGHT_M),
            LaneRecord(
                id=2, kind="none", widths=(Cubic(0.0, ISLAND_RADIUS_M - KERB_M - 0.05),), height_m=KERB_HEIGHT_M
            ),
        ),
        right=(),
        centre=Mark("curb"),
    )


def _way(begin: Pose, end: Pose, centre: Point, widths_m: tuple[float, float]) -> tuple[Path, tuple[Cubic, ...]]:
    """Return the path of the lane's middle, and the lane's width along it."""
    pieces = _round(begin, end, centre, (BEND_RADIUS_M, RING_RADIUS_M))
    if pieces[2].length_m > RING_RADIUS_M * math.radians(300):
        path = joined(begin, end)
        return path, (eased(0.0, length(path), widths_m),)
    lengths_m = [piece.length_m for piece in pieces]
    ends_m = list(itertools.accumulate(lengths_m))
    widths = (
        Cubic(0.0, widths_m[0]),
        eased(ends_m[0], lengths_m[1], (widths_m[0], LANE_M)),
        Cubic(ends_m[1], LANE_M),
        eased(ends_m[2], lengths_m[3], (LANE_M, widths_m[1])),
        Cubic(ends_m[3], widths_m[1]),
    )
    return tuple(piece for piece in pieces if piece.length_m > 1e-4), widths


def _round(begin: Pose, end: Pose, centre: Point, radii_m: tuple[float, float]) -> tuple[Piece, ...]:
    """Return straight, bend, ring, bend, straight; ``radii_m`` of the bends and of the ring."""
    entry = _approach(seen_from(begin, centre), radii_m)
    ahead_m, left_m = seen_from(end, centre)
    leave = _approach((-ahead_m, left_m), radii_m)
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


def _approach(centre: Point, radii_m: tuple[float, float]) -> _Approach:
    """Return the way in for a centre so far ahead and to the left: the bend touches the ring's middle from outside.

    The bend's centre is its radius to the right; its distance to the island's centre is the sum of the radii.
    """
    ahead_m, left_m = centre
    apart_m = sum(radii_m)
    beside_m = left_m + radii_m[0]
    before_m = math.sqrt(max(apart_m**2 - beside_m**2, 0.0))
    if before_m == 0.0 or ahead_m < before_m:
        raise UserError(
            "a street leads past the middle of a roundabout, not to it; straighten its last 20 m or change the control"
        )
    return _Approach(ahead_m - before_m, math.atan2(before_m, beside_m))
