"""Regulatory elements: traffic lights, stop signs, all-way stops, and the right of way where ways meet."""

import math
from collections import defaultdict
from collections.abc import Sequence

import numpy as np

from linden.maps.opendrive.evaluate.pieces import F64
from linden.maps.opendrive.model import OpenDrive
from linden.scenery.scene.posts import HEAD_HALF_M, PLATE_BOTTOM_M, PLATE_HALF_M, POST_HEIGHT_M
from linden_maps.lanelet2.approaches import (
    Device,
    devices_of,
    heading_before,
    painted_stop_lines,
    stop_line,
)
from linden_maps.lanelet2.claims import complete_claims
from linden_maps.lanelet2.draft import LaneletDraft
from linden_maps.lanelet2.model import Member
from linden_maps.lanelet2.movements import FREE, LIGHT, STOP, YIELD, Movement, yields

_BULBS = ("red", "yellow", "green")
_STRICTEST = (LIGHT, STOP, YIELD, FREE)


def add_controls(
    opendrive: OpenDrive, draft: LaneletDraft, movements: dict[int, list[Movement]], *, pairwise: bool = False
) -> int:
    """Add all of them; return how many signs and lights speak to no lane.

    ``pairwise``: name each way that yields to another, not only where :mod:`.claims` finds an element complete.
    """
    devices = devices_of(opendrive, draft.network)
    heard = [device for device in devices if device.approaches or device.movements]
    lines = _stop_lines(draft, heard)
    ways = {device.signal_id: _device_way(draft, device) for device in heard}
    _add_lights(draft, [device for device in heard if device.kind == LIGHT], lines, ways)
    stops = [device for device in heard if device.kind == STOP]
    _add_stop_signs(draft, stops, lines, ways)
    controls, phases, lit = _controls(heard), _phases(heard), _lit(draft)
    for junction, found in movements.items():
        _add_all_way_stop(draft, junction, found, stops, lines, ways)
        waiting = yields(opendrive.junction_by_id.get(junction), found, controls, phases)
        if not pairwise:
            rings = {movement.stretch: _ring(draft, movement.stretch) for movement in found}
            waiting = complete_claims(found, rings, waiting, lit)
        _add_right_of_way(draft, junction, waiting, heard, ways)
    return len(devices) - len(heard)


def _controls(devices: list[Device]) -> dict[int, str]:
    """Return the strictest of what stands before each movement."""
    found: dict[int, str] = {}
    for device in devices:
        for movement in device.movements:
            found[movement] = min(found.get(movement, FREE), device.kind, key=_STRICTEST.index)
    return found


def _phases(devices: list[Device]) -> dict[int, frozenset[str]]:
    """Return the controllers of the lights before each movement; CARLA shows green to one of a junction at a time."""
    found: dict[int, frozenset[str]] = {}
    for device in devices:
        for movement in device.movements if device.kind == LIGHT else ():
            found[movement] = found.get(movement, frozenset()) | device.controllers
    return found


def _lit(draft: LaneletDraft) -> frozenset[int]:
    """Return the movements (stretches) with a light."""
    lights = {number for number, _ in draft.target.elements("traffic_light")}
    return frozenset(
        number for number, lanelet in enumerate(draft.lanelet_of) if not lights.isdisjoint(draft.elements[lanelet])
    )


def _ring(draft: LaneletDraft, stretch: int) -> F64:
    """Return the outline (N, 2) of a stretch's lanelet."""
    bounds = draft.bounds[draft.lanelet_of[stretch]]
    return np.array([draft.target.nodes[node][:2] for node in (*bounds.left, *bounds.right[::-1])])


def _approach_key(draft: LaneletDraft, approaches: tuple[int, ...]) -> tuple[int, bool]:
    stretch = draft.network.stretches[approaches[0]]
    return stretch.road, stretch.forward


def _stop_lines(draft: LaneletDraft, devices: list[Device]) -> dict[tuple[int, bool], int]:
    """Add a stop line for each approach with a light or a stop sign; return their ways by road and direction."""
    painted = painted_stop_lines(draft.tables)
    lanes: dict[tuple[int, bool], dict[int, None]] = defaultdict(dict)
    for device in devices:
        if device.kind == YIELD:
            continue
        for approach in device.approaches:
            lanes[_approach_key(draft, (approach,))][approach] = None
    lines = {}
    for key, approaches in lanes.items():
        line = stop_line(draft.tables, draft.network, tuple(approaches), painted)
        road = draft.tables.roads[key[0]].id
        lines[key] = draft.add_line(line.ends, {"type": "stop_line", "subtype": "solid"}, "stop line", road, key[1])
    return lines


def _device_way(draft: LaneletDraft, device: Device) -> int:
    """Add the way of a light or sign: its lower edge, from left to right as its traffic sees it; return its id."""
    lanes = device.approaches or device.movements
    headings = [heading_before(draft.tables, draft.network.stretches[number]) for number in lanes]
    heading = math.atan2(sum(map(math.sin, headings)), sum(map(math.cos, headings)))
    aside = np.array([math.sin(heading), -math.cos(heading), 0.0])
    half = HEAD_HALF_M if device.kind == LIGHT else PLATE_HALF_M
    bottom = _raised(device.foot, POST_HEIGHT_M if device.kind == LIGHT else PLATE_BOTTOM_M)
    edge = np.stack([bottom - half[0] * aside, bottom + half[0] * aside])
    if device.kind == LIGHT:
        tags = {"type": "traffic_light", "subtype": "red_yellow_green"}
    else:
        tags = {"type": "traffic_sign", "subtype": "stop_sign" if device.kind == STOP else "yield_sign"}
    tags["height"] = f"{2.0 * half[2]:g}"
    key = device.kind, device.road_id, device.signal_id
    way = draft.add_line(edge, tags, *key, small_id=device.kind == LIGHT)
    if device.kind == LIGHT:
        _add_bulbs(draft, device, bottom, way)
    return way


def _raised(place: Sequence[float] | F64, by_m: float) -> F64:
    return np.array([place[0], place[1], place[2] + by_m])


def _add_bulbs(draft: LaneletDraft, device: Device, bottom: F64, light: int) -> None:
    """Add the way of a light's bulbs, from the top down."""
    height_m = 2.0 * HEAD_HALF_M[2]
    rises = [height_m * (2 * (3 - nth) - 1) / 6.0 for nth in range(3)]
    points = np.stack([_raised(bottom, rise) for rise in rises])
    key = ("bulbs", device.road_id, device.signal_id)
    way = draft.add_line(points, {"type": "light_bulbs", "traffic_light_id": str(light)}, *key)
    for node, colour in zip(draft.target.ways[way].nodes, _BULBS, strict=True):
        draft.target.nodes[node] = draft.target.nodes[node]._replace(tags={"color": colour})
    draft.bulbs_of[light] = way


def _add_lights(
    draft: LaneletDraft, devices: list[Device], lines: dict[tuple[int, bool], int], ways: dict[str, int]
) -> None:
    """Add one element for each stop line and set of movements, with all lights over it."""
    groups: dict[tuple[tuple[int, bool] | None, tuple[int, ...]], list[Device]] = defaultdict(list)
    for device in devices:
        by_approach: dict[tuple[int, bool] | None, set[int]] = defaultdict(set)
        for movement in device.movements:
            before = [a for a in device.approaches if movement in draft.network.successors[a]]
            by_approach[_approach_key(draft, tuple(before)) if before else None].add(movement)
        for approach, inside in by_approach.items():
            groups[approach, tuple(sorted(inside))].append(device)
    for (approach, governed), members in groups.items():
        if approach is None:
            continue
        lights = [ways[device.signal_id] for device in members]
        parts = [Member("way", light, "refers") for light in lights]
        parts.append(Member("way", lines[approach], "ref_line"))
        parts += [Member("way", draft.bulbs_of[light], "light_bulbs") for light in lights]
        lanelets = [draft.lanelet_of[number] for number in governed]
        draft.add_element("traffic_light", parts, lanelets, *lanelets)


def _add_stop_signs(
    draft: LaneletDraft, devices: list[Device], lines: dict[tuple[int, bool], int], ways: dict[str, int]
) -> None:
    """Add one element for each stop line with a sign; the lanes before the line refer to it."""
    groups: dict[tuple[int, bool], list[Device]] = defaultdict(list)
    for device in devices:
        for key in dict.fromkeys(_approach_key(draft, (number,)) for number in device.approaches):
            groups[key].append(device)
    for key, members in groups.items():
        parts = [Member("way", ways[device.signal_id], "refers") for device in members]
        parts.append(Member("way", lines[key], "ref_line"))
        lanelets = [
            draft.lanelet_of[number]
            for device in members
            for number in device.approaches
            if _approach_key(draft, (number,)) == key
        ]
        draft.add_element("traffic_sign", parts, lanelets, draft.tables.roads[key[0]].id, key[1])


def _add_all_way_stop(
    draft: LaneletDraft,
    junction: int,
    movements: list[Movement],
    stops: list[Device],
    lines: dict[tuple[int, bool], int],
    ways: dict[str, int],
) -> None:
    """Add an all-way stop where every lane that leads into a junction has a stop sign, and more than one does."""
    before = {number for movement in movements for number in movement.origins}
    signed = {number for device in stops for number in device.approaches} & before
    legs = {_approach_key(draft, (number,)) for number in before}
    if len(legs) < 2 or signed != before:
        return
    entered = sorted(before, key=lambda number: draft.lanelet_of[number])
    parts = [Member("relation", draft.lanelet_of[number], "yield") for number in entered]
    parts += [Member("way", lines[_approach_key(draft, (number,))], "ref_line") for number in entered]
    signs = [ways[device.signal_id] for device in stops if set(device.approaches) & before]
    parts += [Member("way", sign, "refers") for sign in signs]
    draft.add_element("all_way_stop", parts, [draft.lanelet_of[number] for number in entered], junction)


def _add_right_of_way(
    draft: LaneletDraft, junction: int, waiting: dict[int, list[int]], devices: list[Device], ways: dict[str, int]
) -> None:
    """Add one element for each way that others let go first; it alone refers to it, as Autoware wants (vm-03-11)."""
    for first, others in waiting.items():
        lanelet = draft.lanelet_of[first]
        parts = [Member("relation", lanelet, "right_of_way")]
        parts += [Member("relation", draft.lanelet_of[number], "yield") for number in others]
        signs = [device for device in devices if device.kind == YIELD and set(device.movements) & set(others)]
        parts += [Member("way", ways[device.signal_id], "refers") for device in signs]
        draft.add_element("right_of_way", parts, [lanelet], junction, lanelet)
