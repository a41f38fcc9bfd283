"""Signs and lights of OpenDRIVE junctions with the lanelets that they govern, and stop lines of the approaches."""

import math
from collections import defaultdict
from typing import NamedTuple

import numpy as np

from linden.maps.opendrive.evaluate.pieces import F64
from linden.maps.opendrive.evaluate.tables import Tables, tables_of
from linden.maps.opendrive.model import OpenDrive
from linden.maps.opendrive.roadside import STOP_SIGN_TYPE, YIELD_SIGN_TYPE
from linden.maps.opendrive.signals import place
from linden.maps.records import PlacedSignal
from linden_maps.lanelet2.movements import LIGHT, STOP, YIELD
from linden_maps.lanelet2.outlines import outline_of
from linden_maps.lanelet2.stretches import ROAD, LaneletNetwork, Stretch

_SET_BACK_M = 0.5
"""How far before a junction the stop line lies where none is painted."""
_PAINTED_REACH_M = 25.0
_PAINTED_PAST_M = 0.3
_INSIDE_M = 1e-3


class Device(NamedTuple):
    """A sign or light in OpenDRIVE's frame, with the lanelets-to-be it stands before and those it lets go on."""

    signal_id: str
    kind: str  # STOP, YIELD or LIGHT
    foot: tuple[float, float, float]  # on the ground
    approaches: tuple[int, ...]
    movements: tuple[int, ...]
    road_id: int
    controllers: frozenset[str] = frozenset()


class StopLine(NamedTuple):
    """A line across the lanes of one approach, from left to right, (2, 3)."""

    ends: F64
    painted: bool


def devices_of(opendrive: OpenDrive, network: LaneletNetwork) -> list[Device]:
    """Return the stop signs, yield signs and lights that speak to lanes before or in a junction."""
    tables = tables_of(opendrive)
    by_lane: dict[tuple[int, int], list[int]] = defaultdict(list)
    for number, stretch in enumerate(network.stretches):
        if stretch.subtype == ROAD:
            for piece in stretch.pieces:
                by_lane[tables.roads[stretch.road].id, piece.lane_id].append(number)
    origins: dict[int, list[int]] = defaultdict(list)
    for number, after in enumerate(network.successors):
        for following in after:
            origins[following].append(number)
    found = []
    for (_, signal), placed in zip(opendrive.signals(), place(opendrive), strict=True):
        kind = LIGHT if placed.is_light else {STOP_SIGN_TYPE: STOP, YIELD_SIGN_TYPE: YIELD}.get(placed.type)
        if kind is None:
            continue
        x, y, z = placed.transform.location
        movements, approaches = _lanes(network, by_lane, origins, placed)
        foot = (x, -y, z - signal.z_offset_m)
        controllers = frozenset(placed.controllers)
        found.append(Device(signal.id, kind, foot, tuple(approaches), tuple(movements), placed.road_id, controllers))
    return found


def _lanes(
    network: LaneletNetwork,
    by_lane: dict[tuple[int, int], list[int]],
    origins: dict[int, list[int]],
    placed: PlacedSignal,
) -> tuple[list[int], list[int]]:
    """Return the movements that a signal governs, and the lanes before them."""
    movements: dict[int, None] = {}
    approaches: dict[int, None] = {}
    for lane in placed.lanes:
        number = next((n for n in by_lane[lane.road_id, lane.lane_id] if _holds(network.stretches[n], lane.s_m)), None)
        if number is None:
            continue
        if network.stretches[number].junction_id >= 0:
            movements[number] = None
            approaches.update(dict.fromkeys(n for n in origins[number] if network.stretches[n].junction_id < 0))
            continue
        for last, entered in _ahead(network, number):
            approaches[last] = None
            movements.update(dict.fromkeys(entered))
    return list(movements), list(approaches)


def _holds(stretch: Stretch, s_m: float) -> bool:
    return any(piece.start_m - 1e-6 <= s_m <= piece.end_m + 1e-6 for piece in stretch.pieces)


def _ahead(network: LaneletNetwork, number: int) -> list[tuple[int, list[int]]]:
    """Return the last lanelets before the junction ahead on the same road, and those inside that they lead into."""
    road = network.stretches[number].road
    found, waiting, seen = [], [number], {number}
    while waiting:
        at = waiting.pop()
        inner = [n for n in network.successors[at] if network.stretches[n].junction_id >= 0]
        if inner:
            found.append((at, inner))
        for after in network.successors[at]:
            if after not in seen and network.stretches[after].road == road:
                seen.add(after)
                waiting.append(after)
    return found


def stop_line(tables: Tables, network: LaneletNetwork, approaches: tuple[int, ...], painted: list[F64]) -> StopLine:
    """Return the line that those on given lanes of one approach stop at.

    ``painted`` are the middles (2,) of the map's painted stop lines; where none lies on the approach, the line lies
    half a metre before the lanes' end.
    """
    lefts, rights = [], []
    chosen_m = _SET_BACK_M
    is_painted = False
    ends = [_end(tables, network.stretches[number], 0.0) for number in approaches]
    direction = np.mean([end[2] for end in ends], axis=0)
    middle = np.mean([(end[0] + end[1]) / 2.0 for end in ends], axis=0)[:2]
    half_m = max(float(np.linalg.norm(end[0][:2] - middle)) for end in ends) + 1.0
    for spot in painted:
        along = float((spot - middle) @ direction)
        off_m = float(abs(direction[0] * (spot - middle)[1] - direction[1] * (spot - middle)[0]))
        if -_PAINTED_REACH_M <= along <= _PAINTED_PAST_M and off_m < half_m and (not is_painted or -along < chosen_m):
            chosen_m, is_painted = max(0.0, -along), True
    for number in approaches:
        left, right, _ = _end(tables, network.stretches[number], chosen_m)
        lefts.append(left)
        rights.append(right)
    aside = np.array([direction[1], -direction[0]])
    return StopLine(
        np.stack([min(lefts, key=lambda p: float(p[:2] @ aside)), max(rights, key=lambda p: float(p[:2] @ aside))]),
        is_painted,
    )


def _end(tables: Tables, stretch: Stretch, back_m: float) -> tuple[F64, F64, F64]:
    """Return the left and right edge of a lane some way before its end, and the direction of its traffic (2,)."""
    piece = stretch.pieces[-1 if stretch.forward else 0]
    back_m = min(back_m, piece.end_m - piece.start_m)
    s_m = np.array([piece.end_m - back_m if stretch.forward else piece.start_m + back_m])
    row = np.array([piece.row])
    road = np.array([stretch.road])
    pose = tables.curves.pose(road, s_m)
    s_m = np.clip(s_m, piece.start_m + _INSIDE_M, piece.end_m - _INSIDE_M)  # not in the records of what comes next
    inner, outer = tables.lane_sides(row, s_m)
    z_m = float(tables.elevation.value(road, s_m)[0])
    heading = float(pose.heading_rad[0])
    edges = [
        np.array([float(pose.x_m[0]) - math.sin(heading) * t, float(pose.y_m[0]) + math.cos(heading) * t, z_m])
        for t in sorted((float(inner[0]), float(outer[0])), reverse=stretch.forward)
    ]
    sign = 1.0 if stretch.forward else -1.0
    return edges[0], edges[1], sign * np.array([math.cos(heading), math.sin(heading)])


def heading_before(tables: Tables, stretch: Stretch) -> float:
    """Return the heading of a lane's traffic at its end."""
    _, _, direction = _end(tables, stretch, 0.0)
    return math.atan2(direction[1], direction[0])


def painted_stop_lines(tables: Tables) -> list[F64]:
    """Return the middles of all painted stop lines."""
    found = []
    for index, road in enumerate(tables.roads):
        for thing in road.objects:
            if "stopline" in thing.name.lower().replace(" ", "") or thing.type.lower() == "stopline":
                outline = outline_of(tables, index, thing)
                found.append(outline[:, :2].mean(axis=0))
    return found
