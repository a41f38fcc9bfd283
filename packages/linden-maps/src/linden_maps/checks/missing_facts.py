"""Checks for missing data: readable georeference, speed limits of driving lanes, ``laneChange`` of road marks."""

from linden.maps.opendrive.evaluate.tables import tables_of
from linden.maps.opendrive.georeference import DEFAULT_LATITUDE_DEG, DEFAULT_LONGITUDE_DEG, read_origin
from linden.maps.opendrive.model import OpenDrive, Road
from linden.protocol.values.enums import LaneType
from linden_maps.checks.finding import Finding, Severity, on_road


def georeference(opendrive: OpenDrive) -> list[Finding]:
    """Find a georeference that LibCarla cannot read."""
    if read_origin(opendrive.geo_reference).is_readable:
        return []
    text = (
        f"LibCarla cannot read {opendrive.geo_reference.strip()[:60]!r} and takes {DEFAULT_LATITUDE_DEG:g} N, "
        f"{DEFAULT_LONGITUDE_DEG:g} E; write +lat_0=... and +lon_0=... between single spaces"
    )
    return [Finding(Severity.WARNING, "georeference", text)]


def speed_limits(opendrive: OpenDrive) -> list[Finding]:
    """Find roads with driving lanes that have no speed limit, neither their own nor one of the road."""
    tables = tables_of(opendrive)
    found = []
    for index, road in enumerate(opendrive.roads):
        if road.types and all(kind.has_speed for kind in road.types) and road.types[0].s_m <= 0.0:
            continue
        silent = [lane for section in road.sections for lane in section.lanes if _drives(lane.type) and not lane.speeds]
        if silent:
            text = f"driving lane {silent[0].id} has no speed limit, neither its own nor the road's"
            found.append(on_road(tables, index, 0.0, Severity.WARNING, "speed", text))
    return found


def lane_changes(opendrive: OpenDrive) -> list[Finding]:
    """Find marks beside driving lanes that do not say whether one may change lanes across them."""
    tables = tables_of(opendrive)
    found = []
    for index, road in enumerate(opendrive.roads):
        if silent := _silent_marks(road):
            text = f"{silent} road marks say nothing of laneChange; LibCarla then allows it both ways"
            found.append(on_road(tables, index, 0.0, Severity.WARNING, "road mark", text, float(silent)))
    return found


def _silent_marks(road: Road) -> int:
    return sum(
        mark.lane_change is None
        for section in road.sections
        for lane in section.lanes
        if lane.id == 0 or _drives(lane.type)
        for mark in lane.marks
    )


def _drives(kind: LaneType) -> bool:
    return kind is LaneType.DRIVING
