"""Kerbs that bound no lanelet, such as those round the corners of junctions: ways of their own."""

from linden.authoring.lanelet2.bounds import Edge
from linden.authoring.lanelet2.markings import beside_boundary, is_step
from linden.authoring.lanelet2.stretches import WALKWAY, Network, Side, subtype_of
from linden.maps.opendrive.evaluate.strips import sections_before
from linden.maps.opendrive.evaluate.tables import Tables
from linden.maps.opendrive.model import Lane


def loose_kerbs(tables: Tables, network: Network) -> dict[Side, tuple[Edge, ...]]:
    """Return every edge between a paved lane and a raised one that is no side of a lanelet."""
    taken = {
        (side.road, piece[0], piece[1])
        for stretch in network.stretches
        for side in (stretch.left, stretch.right)
        if side.family == "road"
        for piece in side.pieces
    }
    before = sections_before(tables)
    found: dict[Side, tuple[Edge, ...]] = {}
    for index, road in enumerate(tables.roads):
        for number, section in enumerate(road.sections):
            for boundary in {lane.id for lane in section.lanes}:
                pair = [section.lane(lane_id) for lane_id in beside_boundary(boundary)]
                paved = next((lane for lane in pair if _is_paved(lane)), None)
                if paved is None or (index, number, boundary) in taken or not is_step(pair):
                    continue
                row = tables.lane_row[index, number, paved.id]
                edge = Edge(row, paved.id == boundary, int(before[index]) + number, section.s_m, section.end_m)
                found[Side(index, "road", ((number, boundary, section.s_m, section.end_m),))] = (edge,)
    return found


def _is_paved(lane: Lane | None) -> bool:
    return lane is not None and lane.id != 0 and subtype_of(lane.type) not in {None, WALKWAY}
