"""Roads by themselves: is the reference line in one piece, are height, offset and widths without jumps?"""

import math

import numpy as np

from linden.maps.opendrive.evaluate.pieces import Pieces
from linden.maps.opendrive.evaluate.tables import Tables, tables_of
from linden.maps.opendrive.model import Lane, LaneSection, OpenDrive
from linden_maps.checks.finding import (
    GAP_M,
    JUMP_M,
    KINK_DEG,
    STEEPEST_PERCENT,
    STEP_M,
    Finding,
    Severity,
    on_road,
)


def reference_lines(opendrive: OpenDrive) -> list[Finding]:
    """Find gaps and kinks between the geometries of a road, and lengths that do not add up."""
    tables = tables_of(opendrive)
    curves = tables.curves
    road_of = np.repeat(np.arange(len(opendrive.roads)), np.diff(np.append(curves.first, len(curves.key_m))))
    before = np.flatnonzero(road_of[1:] == road_of[:-1])
    joint_m = curves.start_m[before + 1]
    end, start = curves.pose_on(before, joint_m), curves.pose_on(before + 1, joint_m)
    gap_m = np.hypot(end.x_m - start.x_m, end.y_m - start.y_m)
    kink_deg = np.degrees(np.abs(np.angle(np.exp(1j * (end.heading_rad - start.heading_rad)))))
    found = []
    for nth, geometry in enumerate(before):
        at = (tables, int(road_of[geometry]), float(joint_m[nth]), Severity.ERROR)
        if gap_m[nth] > GAP_M:
            found.append(on_road(*at, "gap", f"the reference line jumps by {gap_m[nth]:.3f} m", float(gap_m[nth])))
        if kink_deg[nth] > KINK_DEG:
            found.append(
                on_road(*at, "kink", f"the reference line turns by {kink_deg[nth]:.2f}°", float(kink_deg[nth]))
            )
    return found + _lengths(tables)


def _lengths(tables: Tables) -> list[Finding]:
    found = []
    for index, road in enumerate(tables.roads):
        geometries = sorted(road.geometries, key=lambda geometry: geometry.s_m)
        ends_m = [geometry.s_m + geometry.length_m for geometry in geometries]
        starts_m = [*(geometry.s_m for geometry in geometries[1:]), road.length_m]
        if geometries[0].s_m > GAP_M:
            text = f"the first geometry begins at s={geometries[0].s_m:.3f}, not 0"
            found.append(on_road(tables, index, 0.0, Severity.ERROR, "length", text, geometries[0].s_m))
        for end_m, start_m in zip(ends_m, starts_m, strict=True):
            if (size := abs(end_m - start_m)) > GAP_M:
                text = f"a geometry ends at s={end_m:.3f}, but what follows (or the road's end) is at {start_m:.3f}"
                found.append(on_road(tables, index, end_m, Severity.ERROR, "length", text, size))
    return found


def profiles(opendrive: OpenDrive) -> list[Finding]:
    """Find jumps of a road's height and of its lane offset where one record follows another."""
    tables = tables_of(opendrive)
    found = []
    for pieces, limit_m, kind, what in (
        (tables.elevation, STEP_M, "step", "the road's height"),
        (tables.lane_offset, JUMP_M, "jump", "the lane offset"),
    ):
        for owner, s_m, size_m in _jumps(pieces, limit_m):
            text = f"{what} jumps by {size_m:.3f} m"
            found.append(on_road(tables, owner, s_m, Severity.ERROR, kind, text, size_m))
    return found


def grades(opendrive: OpenDrive) -> list[Finding]:
    """Find roads that rise or fall by more than ``STEEPEST_PERCENT``, each at its steepest place."""
    tables = tables_of(opendrive)
    found = []
    for index, road in enumerate(tables.roads):
        if not road.elevations:
            continue
        begins = [cubic.start_m for cubic in road.elevations]
        worst = (0.0, 0.0)
        for cubic, end_m in zip(road.elevations, [*begins[1:], road.length_m], strict=True):
            along = np.linspace(0.0, max(end_m - cubic.start_m, 0.0), max(2, int(end_m - cubic.start_m) + 2))
            percent = 100.0 * np.abs(cubic.b + along * (2.0 * cubic.c + 3.0 * along * cubic.d))
            steepest = int(percent.argmax())
            worst = max(worst, (float(percent[steepest]), float(cubic.start_m + along[steepest])))
        if worst[0] > STEEPEST_PERCENT:
            text = f"the road has a grade of {worst[0]:.0f} %; streets have {STEEPEST_PERCENT:g} % at most"
            found.append(on_road(tables, index, worst[1], Severity.WARNING, "grade", text, worst[0]))
    return found


def _jumps(pieces: Pieces, limit_m: float) -> list[tuple[int, float, float]]:
    """Return (owner, s, size) wherever a record begins at another value than the one before it ends with."""
    owner = np.repeat(np.arange(len(pieces.first)), np.diff(np.append(pieces.first, len(pieces.key_m))))
    after = np.flatnonzero(owner[1:] == owner[:-1]) + 1
    a, b, c, d = pieces.coefficients[after - 1].T
    along = pieces.start_m[after] - pieces.start_m[after - 1]
    size = np.abs(a + along * (b + along * (c + along * d)) - pieces.coefficients[after, 0])
    return [
        (int(owner[row]), float(pieces.start_m[row]), float(jump))
        for row, jump in zip(after, size, strict=True)
        if jump > limit_m
    ]


def lane_widths(opendrive: OpenDrive) -> list[Finding]:
    """Find lanes without a width, with a negative one, or one that jumps; and lane ids with holes."""
    tables = tables_of(opendrive)
    found = []
    for owner, s_m, size_m in _jumps(tables.widths, JUMP_M):
        row = tables.lanes[owner]
        text = f"lane {row['lane_id']} changes its width by {size_m:.3f} m at once"
        found.append(on_road(tables, int(row["road"]), s_m, Severity.ERROR, "width jump", text, size_m))
    for index, road in enumerate(opendrive.roads):
        for section in road.sections:
            found += [
                on_road(tables, index, section.s_m, Severity.ERROR, "width", text)
                for lane in section.lanes
                if lane.id != 0 and (text := _missing_width(lane))
            ]
            if holes := _missing_ids(section):
                text = f"the section has no lane {holes[0]} between lane 0 and the outermost one"
                found.append(on_road(tables, index, section.s_m, Severity.ERROR, "lane ids", text))
    return found + _negative_widths(tables)


def _missing_width(lane: Lane) -> str:
    if not lane.widths:
        instead = "only a <border>, which LibCarla does not use" if lane.borders else "no <width>"
        return f"lane {lane.id} has {instead}; LibCarla takes its width for 0"
    if lane.widths[0].start_m > 0.0:
        return f"lane {lane.id} has no <width> before sOffset={lane.widths[0].start_m:g}; LibCarla stops there"
    return ""


def _missing_ids(section: LaneSection) -> list[int]:
    ids = [lane.id for lane in section.lanes]
    return [lane_id for lane_id in range(min(ids), max(ids) + 1) if lane_id not in ids]


def _negative_widths(tables: Tables) -> list[Finding]:
    if not len(tables.lanes):
        return []
    shares = np.linspace(0.0, 1.0, 9)
    lanes = np.repeat(np.flatnonzero(~tables.lanes["bordered"]), len(shares))
    start_m, end_m = tables.lanes["start_m"][lanes], tables.lanes["end_m"][lanes]
    s_m = start_m + np.tile(shares, len(lanes) // len(shares)) * (end_m - start_m)
    width_m = tables.widths.value(lanes, s_m, np.clip(s_m, start_m, np.nextafter(end_m, -math.inf)))
    found: dict[int, Finding] = {}
    for nth in np.flatnonzero(width_m < -JUMP_M):
        lane = int(lanes[nth])
        row, size_m = tables.lanes[lane], -float(width_m[nth])
        text = f"lane {row['lane_id']} is {size_m:.3f} m narrower than nothing"
        found.setdefault(
            lane, on_road(tables, int(row["road"]), float(s_m[nth]), Severity.ERROR, "width", text, size_m)
        )
    return list(found.values())
