"""Lines painted along the lanes, from the map's road marks: each stripe where the mark says, to the millimetre."""

from collections.abc import Iterator
from itertools import pairwise
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from linden.geometry import points_from_opendrive
from linden.maps.opendrive.evaluate.strips import sections_before
from linden.maps.opendrive.evaluate.tables import Tables
from linden.maps.opendrive.model import RoadMark
from linden.protocol.values.enums import SemanticTag
from linden.scenery.mesh import Material, Mesh
from linden.scenery.patches import PatchLook, strips
from linden.scenery.streets.simplified_lanes import SimplifiedLanes

F64 = NDArray[np.float64]

PAINT_HEIGHT_M = 0.006
"""Thick paint; far enough above the road that a ray from a hundred metres meets one of the two and not both."""

WHITE = (226, 226, 220)
COLOURS = {
    "yellow": (228, 178, 38),
    "red": (178, 40, 36),
    "blue": (44, 82, 160),
    "green": (46, 120, 70),
    "orange": (226, 120, 36),
}
_WIDTH_M = 0.12  # where the map says none; 4 to 6 inches, MUTCD 2009, section 3A.06
_BOLD = 2.0
_LARGEST_TURN_RAD = 0.05  # 3 degrees between two pieces of a line
_UNPAINTED = frozenset({"none", "curb", "grass", "edge", "custom"})
_DASHES = {"broken": (3.05, 9.14), "botts": (0.12, 1.2)}
"""Stripe and gap, m: 10 and 30 feet (section 3A.06); raised dots every 4 feet."""


class _Stripe(NamedTuple):
    """A painted piece: along which edge of which lane, from where to where, how far to the left of it, how wide."""

    lane: int  # row of Tables.lanes
    is_outer: bool
    start_m: float
    end_m: float
    left_m: float
    width_m: float
    colour: tuple[int, int, int]


def lines(simplified_lanes: SimplifiedLanes) -> Mesh:
    """Return all painted lines."""
    tables = simplified_lanes.tables
    stripes = list(_stripes(tables))
    owner, s_m, continues = _places(simplified_lanes, stripes)
    lane = np.array([stripe.lane for stripe in stripes], np.int64)[owner]
    is_outer = np.array([stripe.is_outer for stripe in stripes], bool)[owner]
    left_m = np.array([stripe.left_m for stripe in stripes])[owner]
    half_m = np.array([0.5 * stripe.width_m for stripe in stripes])[owner]
    colour = np.array([stripe.colour for stripe in stripes], np.uint8).reshape(-1, 3)[owner]
    look = PatchLook(Material.PAINT, SemanticTag.ROAD_LINES, colour)
    first, second = (_edge_at(tables, lane, is_outer, s_m, left_m + side * half_m) for side in (1.0, -1.0))
    return strips(first, second, continues, look, np.broadcast_to([0.0, 0.0, 1.0], first.shape))


def _stripes(tables: Tables) -> Iterator[_Stripe]:
    for road_index, road in enumerate(tables.roads):
        for section_index, section in enumerate(road.sections):
            for lane in section.lanes:
                # the middle line is the inner edge of the first lane on either side
                own = [lane.id] if lane.id else [-1, 1]
                rows = [tables.lane_row.get((road_index, section_index, number)) for number in own]
                row = next((row for row in rows if row is not None), None)
                if row is None or not lane.marks:
                    continue
                starts = [section.s_m + mark.offset_m for mark in lane.marks]
                for mark, (start_m, end_m) in zip(lane.marks, pairwise([*starts, section.end_m]), strict=True):
                    if mark.type not in _UNPAINTED and end_m > start_m:
                        left = (
                            1.0 if lane.id >= 0 else -1.0
                        )  # the first of two lines is the inner one, in the middle...
                        yield from _of_mark(mark, row, lane.id != 0, start_m, end_m, left if lane.id <= 0 else -left)


def _of_mark(mark: RoadMark, row: int, is_outer: bool, start_m: float, end_m: float, first: float) -> Iterator[_Stripe]:  # noqa: FBT001 - one call, in order
    """Yield the stripes of a mark; of two lines the first lies on the hand ``first`` (1 left, -1 right)."""
    width_m = mark.width_m or _WIDTH_M * (_BOLD if mark.weight == "bold" else 1.0)
    kinds = mark.type.split()[:2]
    if kinds[0] == "botts":
        kinds = kinds[:1]
    colour = COLOURS.get(mark.colour, WHITE)
    for nth, kind in enumerate(kinds):
        left_m = first * width_m * (1.0 - 2.0 * nth) if len(kinds) == 2 else 0.0  # as far apart as they are wide
        stripe_m, gap_m = _DASHES.get(kind, (end_m - start_m, 0.0))
        for begin_m in np.arange(start_m, end_m, stripe_m + gap_m).tolist():
            yield _Stripe(row, is_outer, begin_m, min(begin_m + stripe_m, end_m), left_m, width_m, colour)


def _places(
    simplified_lanes: SimplifiedLanes, stripes: list[_Stripe]
) -> tuple[NDArray[np.int64], F64, NDArray[np.bool_]]:
    """Return owner, s and whether the stripe goes on: its ends, and all places between that the surface has."""
    samples, tables = simplified_lanes.samples, simplified_lanes.tables
    before = sections_before(tables)
    begins = np.searchsorted(samples.section, np.arange(before[-1] + 1))
    rows = tables.lanes
    owners, places, goes_on = [], [], []
    for number, stripe in enumerate(stripes):
        section = before[rows["road"][stripe.lane]] + rows["section"][stripe.lane]
        known = samples.s_m[begins[section] : begins[section + 1]]
        between = known[(known > stripe.start_m + 1e-3) & (known < stripe.end_m - 1e-3)]
        s_m = _finer(tables, rows["road"][stripe.lane], np.concatenate([[stripe.start_m], between, [stripe.end_m]]))
        owners.append(np.full(len(s_m), number))
        places.append(s_m)
        goes_on.append(np.arange(len(s_m)) < len(s_m) - 1)
    if not stripes:
        return np.empty(0, np.int64), np.empty(0), np.empty(0, np.bool_)
    return np.concatenate(owners), np.concatenate(places), np.concatenate(goes_on)


def _finer(tables: Tables, road: int, s_m: F64) -> F64:
    """Return places along a road and as many between them as it takes for no piece to turn by a visible angle."""
    heading = tables.curves.pose(np.full(len(s_m), road, np.int64), s_m).heading_rad
    turn = np.abs((np.diff(heading) + np.pi) % (2.0 * np.pi) - np.pi)
    pieces = np.maximum(np.ceil(turn / _LARGEST_TURN_RAD), 1.0).astype(np.int64)
    piece = np.repeat(np.arange(len(pieces)), pieces)
    share = (np.arange(len(piece)) - np.repeat(np.cumsum(pieces) - pieces, pieces)) / pieces[piece]
    return np.append(s_m[piece] + share * np.diff(s_m)[piece], s_m[-1])


def _edge_at(tables: Tables, lane: NDArray[np.int64], is_outer: NDArray[np.bool_], s_m: F64, left_m: F64) -> F64:
    """Return places (N, 3) in the world, so far to the left of edges of lanes, on the paint."""
    inner, outer = tables.lane_sides(lane, s_m)
    lifted = np.where(is_outer, tables.heights_outer.value(lane, s_m), tables.heights_inner.value(lane, s_m))
    lifted = np.where(is_outer, lifted, np.minimum(lifted, 0.0))
    road = tables.lanes["road"][lane].astype(np.int64)
    pose = tables.curves.pose(road, s_m)
    t_m = np.where(is_outer, outer, inner) + left_m
    z_m = tables.elevation.value(road, s_m) + lifted + PAINT_HEIGHT_M
    places = np.stack(
        [pose.x_m - np.sin(pose.heading_rad) * t_m, pose.y_m + np.cos(pose.heading_rad) * t_m, z_m], axis=1
    )
    return points_from_opendrive(places)
