"""Checks of links: links that are not returned, lanes that lead nowhere, incomplete junctions."""

from collections.abc import Iterator

from linden.maps.opendrive.evaluate.tables import tables_of
from linden.maps.opendrive.links import is_forward, lane_links
from linden.maps.opendrive.model import Connection, Junction, LaneSection, OpenDrive, Road, RoadLink
from linden.protocol.values.enums import LaneType
from linden_maps.checks.finding import Finding, Severity, on_road

_VANISHING_M = 0.5  # a lane that has tapered to less than this may end


def road_links(opendrive: OpenDrive) -> list[Finding]:
    """Find links to what does not exist, links that are not returned, and ids that LibCarla mixes up."""
    tables = tables_of(opendrive)
    found = [
        Finding(
            Severity.ERROR,
            "ids",
            f"junction {junction.id} has the id of a road; LibCarla tells them apart by nothing else",
        )
        for junction in opendrive.junctions
        if junction.id in opendrive.road_by_id
    ]
    for index, road in enumerate(opendrive.roads):
        for end, link in (("start", road.predecessor), ("end", road.successor)):
            s_m = 0.0 if end == "start" else road.length_m
            if link is not None and (text := _wrong_link(opendrive, road, end, link)):
                found.append(on_road(tables, index, s_m, Severity.ERROR, "link", text))
            if link is None and road.is_in_junction:
                text = f"the connecting road's {end} touches nothing"
                found.append(on_road(tables, index, s_m, Severity.ERROR, "link", text))
        if road.is_in_junction and road.junction_id not in opendrive.junction_by_id:
            text = f"the road belongs to junction {road.junction_id}, which does not exist"
            found.append(on_road(tables, index, 0.0, Severity.ERROR, "link", text))
    return found


def _wrong_link(opendrive: OpenDrive, road: Road, end: str, link: RoadLink) -> str:
    """Return what is wrong with the link at a road's end, empty where nothing is."""
    if link.is_junction:
        junction = opendrive.junction_by_id.get(link.id)
        if junction is None:
            return f"its {end} leads into junction {link.id}, which does not exist"
        touching = {
            touched.id
            for connection in junction.connections
            if (connecting := opendrive.road_by_id.get(connection.connecting_road)) is not None
            for touched in (connecting.predecessor, connecting.successor)
            if touched is not None
        }
        return "" if road.id in touching else f"its {end} leads into junction {link.id}, where no road connects to it"
    other = opendrive.road_by_id.get(link.id)
    if other is None:
        return f"its {end} leads into road {link.id}, which does not exist"
    if link.contact not in {"start", "end"}:
        return f"its {end} leads into road {link.id}, but does not say to which end (contactPoint)"
    back = other.predecessor if link.contact == "start" else other.successor
    if road.is_in_junction and back is not None and back.is_junction:
        returned = back.id == road.junction_id
    else:
        returned = back is not None and not back.is_junction and (back.id, back.contact) == (road.id, end)
    return "" if returned else f"its {end} leads into the {link.contact} of road {link.id}, which does not lead back"


def lane_ends(opendrive: OpenDrive) -> list[Finding]:
    """Find driving lanes that lead nowhere or that cannot be reached; note the roads that are dead ends."""
    tables, links = tables_of(opendrive), lane_links(opendrive)
    found = []
    for index, road in enumerate(opendrive.roads):
        ends = (("start", road.predecessor, 0.0), ("end", road.successor, road.length_m))
        for end, link, s_m in ends:
            if link is None and not road.is_in_junction:
                text = f"the {end} of {road.name or 'the road'} is a dead end"
                found.append(on_road(tables, index, s_m, Severity.NOTE, "dead end", text))
    for row, lane in enumerate(tables.lanes):
        road = tables.roads[lane["road"]]
        if lane["type_bits"] != LaneType.DRIVING:
            continue
        forward = is_forward(road, int(lane["lane_id"]))
        for missing, at_exit, what in (
            (not links.successors[row], True, "leads nowhere"),
            (not links.predecessors[row], False, "cannot be reached"),
        ):
            at_end = forward == at_exit
            section: LaneSection = road.sections[lane["section"]]
            if missing and not _may_end(road, section, int(lane["lane_id"]), at_end=at_end):
                s_m = section.end_m if at_end else section.s_m
                text = f"driving lane {lane['lane_id']} {what}"
                found.append(on_road(tables, int(lane["road"]), s_m, Severity.ERROR, "lane", text))
    return found


def _may_end(road: Road, section: LaneSection, lane_id: int, *, at_end: bool) -> bool:
    """Return whether a lane may begin or end there: at a dead end of a street, or where it has tapered off."""
    border = road.sections[-1] if at_end else road.sections[0]
    if section is border:
        return (road.successor if at_end else road.predecessor) is None and not road.is_in_junction
    lane = section.lane(lane_id)
    assert lane is not None
    if not lane.widths:
        return False
    along_m = section.end_m - section.s_m if at_end else 0.0
    start_m, a, b, c, d = next((width for width in reversed(lane.widths) if width.start_m <= along_m), lane.widths[0])
    along_m -= start_m
    return a + along_m * (b + along_m * (c + along_m * d)) < _VANISHING_M


def lane_links_returned(opendrive: OpenDrive) -> list[Finding]:
    """Find lanes that name a next lane that does not name them back. Inside junctions the junction tells."""
    tables, links = tables_of(opendrive), lane_links(opendrive)
    found = []
    for row, successors in enumerate(links.successors):
        lane = tables.lanes[row]
        road = tables.roads[lane["road"]]
        for after in successors:
            ahead = tables.lanes[after]
            other = tables.roads[ahead["road"]]
            if road.is_in_junction or other.is_in_junction:
                continue
            target = other.sections[ahead["section"]].lane(int(ahead["lane_id"]))
            assert target is not None
            back = target.predecessor if is_forward(other, target.id) else target.successor
            if back != lane["lane_id"]:
                text = f"lane {lane['lane_id']} leads into lane {target.id} of road {other.id}, which names {back}"
                s_m = float(lane["end_m"] if is_forward(road, int(lane["lane_id"])) else lane["start_m"])
                found.append(on_road(tables, int(lane["road"]), s_m, Severity.ERROR, "lane link", text))
    return found


def junctions(opendrive: OpenDrive) -> list[Finding]:
    """Find connections that contradict the roads they connect."""
    found = []
    for junction in opendrive.junctions:
        if not junction.connections:
            found.append(Finding(Severity.ERROR, "junction", f"junction {junction.id} connects nothing"))
        for connection in junction.connections:
            found += [
                Finding(Severity.ERROR, "junction", f"junction {junction.id}, connection {connection.id}: {text}")
                for text in _wrong_connection(opendrive, junction, connection)
            ]
        connecting = {connection.connecting_road for connection in junction.connections}
        found += [
            Finding(
                Severity.ERROR,
                "priority",
                f"junction {junction.id} gives priority to or over road {road_id}, "
                "which is none of its connecting roads",
            )
            for pair in junction.priorities
            for road_id in pair
            if road_id not in connecting
        ]
    return found


def _wrong_connection(opendrive: OpenDrive, junction: Junction, connection: Connection) -> Iterator[str]:
    incoming = opendrive.road_by_id.get(connection.incoming_road)
    connecting = opendrive.road_by_id.get(connection.connecting_road)
    if incoming is None or connecting is None:
        missing = connection.incoming_road if incoming is None else connection.connecting_road
        yield f"road {missing} does not exist"
        return
    if connecting.junction_id != junction.id:
        yield f"connecting road {connecting.id} says it belongs to junction {connecting.junction_id}"
    if connection.contact not in {"start", "end"}:
        yield "contactPoint is missing"
        return
    at_start = connection.contact == "start"
    link = connecting.predecessor if at_start else connecting.successor
    if link is None or link.is_junction or link.id != incoming.id:
        yield f"the {connection.contact} of road {connecting.id} does not touch incoming road {incoming.id}"
        return
    if not connection.lane_links:
        yield "it has no laneLink"
    entrance = connecting.sections[0 if at_start else -1]
    source = incoming.sections[0 if link.contact == "start" else -1]
    for from_lane, to_lane in connection.lane_links:
        lane = entrance.lane(to_lane)
        if lane is None or source.lane(from_lane) is None:
            yield f"laneLink {from_lane} -> {to_lane} names a lane that does not exist"
        elif (lane.predecessor if at_start else lane.successor) != from_lane:
            yield f"laneLink {from_lane} -> {to_lane}, but that lane of road {connecting.id} does not link back"
