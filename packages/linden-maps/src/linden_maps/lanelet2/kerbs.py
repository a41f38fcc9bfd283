"""Kerbs that bound no lanelet, such as those round the corners of junctions: ways of their own."""

from linden.maps.opendrive.evaluate.strips import sections_before
from linden.maps.opendrive.evaluate.tables import Tables
from linden.maps.opendrive.model import Lane
from linden_maps.lanelet2.bounds import LaneEdge
from linden_maps.lanelet2.markings import beside_boundary, is_step
from linden_maps.lanelet2.stretches import WALKWAY, LaneletNetwork, Side, subtype_of


def loose_kerbs(tables: Tables, network: LaneletNetwork) -> dict[Side, tuple[LaneEdge, ...]]:
    """Return every edge of a raised lane, beside a paved one or at the road's edge, that is no side of a lanelet."""
    taken = {
        (side.road, piece[0], piece[1])
        for stretch in network.stretches
        for side in (stretch.left, stretch.right)
        if side.family == "road"
        for piece in side.pieces
    }
    before = sections_before(tables)
    found: dict[Side, tuple[LaneEdge, ...]] = {}
    for index, road in enumerate(tables.roads):
        for number, section in enumerate(road.sections):
            for boundary in {lane.id for lane in section.lanes}:
                pair = [section.lane(lane_id) for lane_id in beside_boundary(boundary)]
                lane = next((lane for lane in pair if _is_paved(lane)), None) or _alone(pair)
                if lane is None or (index, number, boundary) in taken or not is_step(pair):
                    continue
                row = tables.lane_row[index, number, lane.id]
                at = int(before[index]) + number
                outer = lane.id == boundary
                edge = LaneEdge(row, outer, at, section.s_m, section.end_m, lifted=_is_paved(lane))
                found[Side(index, "road", ((number, boundary, section.s_m, section.end_m),))] = (edge,)
    return found


def _alone(pair: list[Lane | None]) -> Lane | None:
    """Return the raised lane at a road's own edge, as round the corners of junctions and on islands."""
    beside = [lane for lane in pair if lane is not None and lane.id != 0]
    return beside[0] if len(beside) == 1 and len(pair) == 2 and None in pair else None


def _is_paved(lane: Lane | None) -> bool:
    return lane is not None and lane.id != 0 and subtype_of(lane.type) not in {None, WALKWAY}
