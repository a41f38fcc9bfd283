"""Statistics of an OpenDRIVE map: counts of its elements, lengths, heights, steepest grade, named buildings."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from linden.maps.opendrive.evaluate.tables import Tables, tables_of
from linden.maps.opendrive.links import is_forward, lane_links
from linden.maps.opendrive.model import OpenDrive
from linden.maps.opendrive.roadside import SPEED_LIMIT_TYPE, STOP_SIGN_TYPE, YIELD_SIGN_TYPE, RoadObject
from linden.maps.opendrive.spawn_points import spawn_points
from linden.maps.standing import FURNITURE, blades_of
from linden.protocol.values.enums import LaneType
from linden_maps.streets.name_signs import PLACE_NAME


class Counts(NamedTuple):
    """What there is. Lengths are measured along the roads' reference lines, in km."""

    roads: int
    connecting_roads: int  # of those, inside junctions
    junctions: int
    signals: int
    traffic_lights: int
    stop_signs: int
    yield_signs: int
    speed_signs: int
    controllers: int
    crosswalks: int
    objects: int
    buildings: int
    furniture: int  # benches, bins, mailboxes
    street_name_signs: int
    place_name_signs: int
    railroad_crossings: int
    street_names: int
    lanes: int
    spawn_points: int
    topology: int  # pairs that the client's get_topology() returns
    road_km: float
    driving_lane_km: float
    sidewalk_km: float
    lowest_m: float
    highest_m: float
    steepest_percent: float


def _is_paired_with_its_end(tables: Tables, row: int) -> bool:
    """Return whether LibCarla pairs a lane that leads nowhere with its own end (Map.cpp, GenerateTopology).

    It looks for that end in single precision, and finds nothing where rounding puts it beyond the road.
    """
    lane = tables.lanes[row]
    road = tables.roads[lane["road"]]
    return not is_forward(road, int(lane["lane_id"])) or float(np.float32(lane["end_m"])) < road.length_m


def count(opendrive: OpenDrive) -> Counts:
    """Return the counts of a map."""
    tables, links = tables_of(opendrive), lane_links(opendrive)
    signals = [signal for _, signal in opendrive.signals()]
    types = [signal.type for signal in signals]
    kinds = tables.lanes["type_bits"]
    length_m = tables.lanes["end_m"] - tables.lanes["start_m"]
    objects = [thing for road in opendrive.roads for thing in road.objects]
    driving = np.flatnonzero(kinds == int(LaneType.DRIVING))
    return Counts(
        roads=len(opendrive.roads),
        connecting_roads=sum(road.is_in_junction for road in opendrive.roads),
        junctions=len(opendrive.junctions),
        signals=len(signals),
        traffic_lights=sum(signal.is_light for signal in signals),
        stop_signs=types.count(STOP_SIGN_TYPE),
        yield_signs=types.count(YIELD_SIGN_TYPE),
        speed_signs=types.count(SPEED_LIMIT_TYPE),
        controllers=len(opendrive.controllers),
        crosswalks=sum(thing.is_crosswalk for thing in objects),
        objects=len(objects),
        buildings=sum(is_building(thing) for thing in objects),
        furniture=sum(thing.type == "obstacle" and thing.name in FURNITURE for thing in objects),
        street_name_signs=sum(bool(blades_of(thing)) and thing.name != PLACE_NAME for thing in objects),
        place_name_signs=sum(thing.name == PLACE_NAME for thing in objects),
        railroad_crossings=sum(thing.type == "railroadCrossing" for thing in objects),
        street_names=len({road.name for road in opendrive.roads if road.name and not road.is_in_junction}),
        lanes=len(tables.lanes),
        spawn_points=len(spawn_points(opendrive)),
        topology=sum(len(links.successors[row]) or _is_paired_with_its_end(tables, row) for row in driving),
        road_km=float(sum(road.length_m for road in opendrive.roads if not road.is_in_junction)) / 1000.0,
        driving_lane_km=float(length_m[driving].sum()) / 1000.0,
        sidewalk_km=float(length_m[kinds == int(LaneType.SIDEWALK)].sum()) / 1000.0,
        **_profile(opendrive),
    )


def named_places(opendrive: OpenDrive) -> list[str]:
    """Return the buildings of a map with a name of their own, in the order of the map, and their sizes."""
    return [
        f"{thing.name}, {thing.length_m:.0f} m by {thing.width_m:.0f} m, {thing.height_m:.0f} m high"
        for road in opendrive.roads
        for thing in road.objects
        if is_building(thing) and " " in thing.name
    ]


def is_building(thing: RoadObject) -> bool:
    """Return whether an object is a building."""
    return thing.type.lower() == "building"


def is_railroad(thing: RoadObject) -> bool:
    """Return whether an object is a track, or its bed where a street crosses it."""
    return thing.type.startswith("railroad")


def _profile(opendrive: OpenDrive) -> dict[str, float]:
    """Return the least and greatest height of the roads' reference lines, and the steepest grade, every metre."""
    heights: list[NDArray[np.float64]] = []
    grades = [0.0]
    for road in (road for road in opendrive.roads if road.elevations):
        begins = [cubic.start_m for cubic in road.elevations]
        for cubic, end_m in zip(road.elevations, [*begins[1:], road.length_m], strict=True):
            along = np.linspace(0.0, max(end_m - cubic.start_m, 0.0), max(2, int(end_m - cubic.start_m) + 2))
            heights.append(cubic.a + along * (cubic.b + along * (cubic.c + along * cubic.d)))
            grades.append(float(np.abs(cubic.b + along * (2.0 * cubic.c + 3.0 * along * cubic.d)).max()))
    known = np.concatenate(heights) if heights else np.zeros(1)
    return {
        "lowest_m": float(known.min()),
        "highest_m": float(known.max()),
        "steepest_percent": 100.0 * float(max(grades)),
    }
