"""Mini-roundabouts: ways round a central island, counter-clockwise, from each entry to each exit.

Every way is one connecting road: a right-hand bend in, an arc round the island, a right-hand bend out. The circulating
lane is where these roads lie on each other; ``docs/decisions/0011-roundabouts.md`` says why it is not a ring of roads.
"""

import itertools
import math

from linden_maps.streets.cross_section import KERB_HEIGHT_M, KERB_M
from linden_maps.streets.curves import (
    Path,
    Piece,
    Point,
    Pose,
    along,
    joined,
    length,
    moved,
    turned_back,
)
from linden_maps.streets.document import Cubic, LaneRecord, Mark, RoadRecord, eased
from linden_maps.streets.junctions import Turn, lane_pairs, pose_in, pose_out
from linden_maps.streets.network import Leg
from linden_maps.streets.rings import ISLAND_RADIUS_M, KERB_RADII_M, LANE_M, LANE_RADII_M, round_ring


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
    return tuple(piece for piece in round_ring(begin, end, centre, KERB_RADII_M) if piece.length_m > 1e-4)


def island(number: int, centre: Point) -> RoadRecord:
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
        speed=None,
        elevation=(),
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
    pieces = round_ring(begin, end, centre, LANE_RADII_M)
    if pieces[2].length_m > LANE_RADII_M[1] * math.radians(300):
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
