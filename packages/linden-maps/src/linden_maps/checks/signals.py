"""Checks of signals, controllers and crosswalks: affected lanes, place beside the road, references."""

import math
from collections import Counter

from linden.maps.opendrive.evaluate.tables import tables_of
from linden.maps.opendrive.landmarks import landmark_transforms, unmoved_transforms
from linden.maps.opendrive.model import OpenDrive, Road
from linden.maps.opendrive.roadside import (
    SPEED_LIMIT_TYPE,
    STOP_SIGN_TYPE,
    YIELD_SIGN_TYPE,
    RoadObject,
    Signal,
)
from linden.maps.opendrive.signals import place
from linden.maps.records import PlacedSignal
from linden_maps.checks.finding import (
    CLOSURE_M,
    SIGNAL_REACH_M,
    SIGNAL_SHIFT_M,
    Finding,
    Severity,
    on_road,
)

_GUARDING_TYPES = {STOP_SIGN_TYPE, YIELD_SIGN_TYPE}


def signals(opendrive: OpenDrive) -> list[Finding]:
    """Find signals that concern no lane, stand off the road or in it, or share their id."""
    tables = tables_of(opendrive)
    index_of = {road.id: index for index, road in enumerate(opendrive.roads)}
    ids = Counter(signal.id for _, signal in opendrive.signals())
    found = []
    for (road, signal), placed in zip(opendrive.signals(), place(opendrive), strict=True):
        at = (tables, index_of[road.id], signal.s_m)
        name = f"signal {signal.id} (type {signal.type})"
        if ids[signal.id] > 1:
            found.append(on_road(*at, Severity.ERROR, "signal id", f"{name}: {ids[signal.id]} signals have this id"))
        found += [
            on_road(*at, severity, kind, f"{name} {text}") for severity, kind, text in _wrong(road, signal, placed)
        ]
    return found + _moved_signals(opendrive, index_of)


def _wrong(road: Road, signal: Signal, placed: PlacedSignal) -> list[tuple[Severity, str, str]]:
    wrong = []
    if not signal.validities:
        text = "has no <validity>; by its orientation LibCarla takes the lanes opposite to the usual reading"
        wrong.append((Severity.WARNING, "signal lanes", text))
    lanes = [lane.id for lane in road.section_at(signal.s_m).lanes if lane.id != 0]
    for validity in signal.validities:
        elsewhere = validity == (0, 0)  # as LibCarla has it: speaks only where a <signalReference> says so
        if not elsewhere and not any(min(validity) <= lane_id <= max(validity) for lane_id in lanes):
            text = f"speaks to lanes {validity.from_lane} to {validity.to_lane}, of which the road has none"
            wrong.append((Severity.ERROR, "signal lanes", text))
    if (signal.is_light or signal.type in _GUARDING_TYPES) and not placed.lanes:
        wrong.append((Severity.ERROR, "signal lanes", "concerns no driving lane"))
    if signal.is_light and not signal.is_dynamic:
        wrong.append((Severity.WARNING, "signal", 'is a light but says dynamic="no"'))
    if signal.is_light and not placed.controllers:
        wrong.append((Severity.WARNING, "controller", "is a light that no <controller> switches"))
    if signal.type == SPEED_LIMIT_TYPE and signal.value is None:
        wrong.append((Severity.ERROR, "signal", "is a speed limit without a value"))
    if not 0.0 <= signal.s_m <= road.length_m:
        text = f"stands at s={signal.s_m:.2f} of a road of {road.length_m:.2f} m"
        stops = "; LibCarla ends the program there" if signal.s_m < 0.0 else ""
        wrong.append((Severity.ERROR, "signal place", text + stops))
    return wrong


def _moved_signals(opendrive: OpenDrive, index_of: dict[int, int]) -> list[Finding]:
    """Find signals far from any lane of their road, and signals that LibCarla moves because they stand in a lane."""
    tables = tables_of(opendrive)
    found = []
    written, moved = unmoved_transforms(opendrive), landmark_transforms(opendrive)
    for (road, signal), before, after in zip(opendrive.signals(), written, moved, strict=True):
        at = (tables, index_of[road.id], signal.s_m, Severity.WARNING, "signal place")
        shift_m = math.dist(before.location, after.location)
        if shift_m > SIGNAL_SHIFT_M:
            text = f"signal {signal.id} stands in or too near a lane; LibCarla moves it by {shift_m:.2f} m"
            found.append(on_road(*at, text, shift_m))
        reach_m = _half_width_m(road, signal.s_m) + SIGNAL_REACH_M
        if abs(signal.t_m) > reach_m and signal.inertial is None:
            text = f"signal {signal.id} stands {abs(signal.t_m):.1f} m from its road's middle, off the road"
            found.append(on_road(*at, text, abs(signal.t_m) - reach_m))
    return found


def _half_width_m(road: Road, s_m: float) -> float:
    """Return an upper bound of how far the lanes reach from the reference line."""
    section = road.section_at(s_m)
    sides = [
        sum(max((width.a for width in lane.widths), default=0.0) for lane in section.lanes if lane.id * side > 0)
        for side in (-1, 1)
    ]
    return max(sides) + max((abs(offset.a) for offset in road.lane_offsets), default=0.0)


def controllers(opendrive: OpenDrive) -> list[Finding]:
    """Find controllers of signals that do not exist, and controllers that no junction has."""
    known = {signal.id for _, signal in opendrive.signals()}
    in_junctions = {name for junction in opendrive.junctions for name in junction.controllers}
    declared = {controller.id for controller in opendrive.controllers}
    found = []
    for controller in opendrive.controllers:
        name = f"controller {controller.id}"
        found += [
            Finding(Severity.ERROR, "controller", f"{name} switches signal {signal_id}, which does not exist")
            for signal_id in controller.signals
            if signal_id not in known
        ]
        if not controller.signals:
            found.append(Finding(Severity.ERROR, "controller", f"{name} switches nothing"))
        if controller.id not in in_junctions:
            found.append(
                Finding(Severity.WARNING, "controller", f"{name} belongs to no junction, so to no light group")
            )
    found += [
        Finding(Severity.ERROR, "controller", f"junction {junction.id} has controller {name}, which does not exist")
        for junction in opendrive.junctions
        for name in junction.controllers
        if name not in declared
    ]
    return found


def objects(opendrive: OpenDrive) -> list[Finding]:
    """Find crosswalks that are no area, and objects beyond the ends of their road."""
    tables = tables_of(opendrive)
    found = []
    for index, road in enumerate(opendrive.roads):
        for thing in road.objects:
            at = (tables, index, thing.s_m, Severity.ERROR)
            if not 0.0 <= thing.s_m <= road.length_m:
                text = f"object {thing.id} stands at s={thing.s_m:.2f} of a road of {road.length_m:.2f} m"
                found.append(on_road(*at, "object place", text))
            if thing.is_crosswalk and (text := _wrong_outline(thing)):
                found.append(on_road(*at, "crosswalk", f"crosswalk {thing.id} {text}"))
    return found


def _wrong_outline(crosswalk: RoadObject) -> str:
    corners = crosswalk.outline
    if len(corners) < 4:
        return f"has an outline of {len(corners)} corners; a closed one has four or more, the last like the first"
    if any(corner.is_along_road for corner in corners):
        return "has corners along the road (cornerRoad); LibCarla reads cornerLocal only"
    open_m = math.dist(corners[0][:2], corners[-1][:2])
    return f"has an open outline: the last corner lies {open_m:.2f} m from the first" if open_m > CLOSURE_M else ""
