"""Checks of linked lanes (gaps, height steps, kinks, width changes) and of linked reference lines (gaps)."""

from typing import NamedTuple

import numpy as np

from linden.maps.opendrive.evaluate.pieces import F64, I64
from linden.maps.opendrive.evaluate.tables import Tables, tables_of
from linden.maps.opendrive.links import lane_links
from linden.maps.opendrive.model import OpenDrive, RoadLink
from linden_maps.checks.finding import (
    GAP_M,
    KINK_DEG,
    STEP_M,
    Finding,
    Severity,
    on_road,
    worst_of_each,
)


class _Ends(NamedTuple):
    """Ends of lanes, looked at in the direction of travel; OpenDRIVE's frame."""

    left: F64  # (N, 2), m
    right: F64  # (N, 2), m
    z_m: F64
    heading_rad: F64
    s_m: F64


def lane_joints(opendrive: OpenDrive) -> list[Finding]:
    """Find gaps, steps, kinks and changes of width between a lane and those it leads into."""
    tables, links = tables_of(opendrive), lane_links(opendrive)
    pairs = [(row, after) for row, successors in enumerate(links.successors) for after in successors]
    if not pairs:
        return []
    before, after = np.asarray(pairs, dtype=np.int64).T
    end, start = _ends(tables, before, at_exit=True), _ends(tables, after, at_exit=False)
    edge_m = np.maximum(np.linalg.norm(end.left - start.left, axis=1), np.linalg.norm(end.right - start.right, axis=1))
    middle_m = np.linalg.norm((end.left + end.right - start.left - start.right) / 2.0, axis=1)
    step_m = np.abs(end.z_m - start.z_m)
    kink_deg = np.degrees(np.abs(np.angle(np.exp(1j * (end.heading_rad - start.heading_rad)))))
    found: list[tuple[object, Finding]] = []
    for nth, (row, next_row) in enumerate(pairs):
        lane, ahead = tables.lanes[row], tables.lanes[next_row]
        into = f"lane {lane['lane_id']} and lane {ahead['lane_id']} of road {tables.roads[ahead['road']].id}"
        at = (tables, int(lane["road"]), float(end.s_m[nth]), Severity.ERROR)
        key = (lane["road"], end.s_m[nth], ahead["road"])
        gap_kind = "gap" if middle_m[nth] > GAP_M else "width jump"
        for kind, size, limit, what in (
            (gap_kind, edge_m[nth], GAP_M, f"the edges of {into} lie {edge_m[nth]:.3f} m apart"),
            ("step", step_m[nth], STEP_M, f"{into} differ in height by {step_m[nth]:.3f} m"),
            ("kink", kink_deg[nth], KINK_DEG, f"{into} meet at an angle of {kink_deg[nth]:.2f}°"),
        ):
            if size > limit:
                found.append(((kind, *key), on_road(*at, kind, what, float(size))))
    return worst_of_each(found)


def _ends(tables: Tables, rows: I64, *, at_exit: bool) -> _Ends:
    """Return where traffic leaves (or enters) each lane."""
    lanes = tables.lanes[rows]
    right_hand = np.asarray([road.is_right_hand for road in tables.roads])[lanes["road"]]
    forward = (lanes["lane_id"] < 0) == right_hand
    at_end = forward if at_exit else ~forward
    s_m = np.where(at_end, lanes["end_m"], lanes["start_m"])
    inside_m = np.minimum(1e-6, (lanes["end_m"] - lanes["start_m"]) / 2.0)
    probe_m = np.where(at_end, s_m - inside_m, s_m + inside_m)  # the records that hold just inside the section
    inner, outer = tables.lane_sides(rows, s_m, probe_m)
    road = lanes["road"].astype(np.int64)
    pose = tables.curves.pose(road, s_m, probe_m)
    sides = []
    for t_m in (np.maximum(inner, outer), np.minimum(inner, outer)):
        x_m = pose.x_m - np.sin(pose.heading_rad) * t_m
        y_m = pose.y_m + np.cos(pose.heading_rad) * t_m
        sides.append(np.stack([x_m, y_m], axis=1))
    turned = forward[:, None]
    centres = tables.lane_centres(rows, probe_m)
    return _Ends(
        left=np.where(turned, sides[0], sides[1]),
        right=np.where(turned, sides[1], sides[0]),
        z_m=tables.elevation.value(road, s_m, probe_m),
        heading_rad=centres.heading_rad + np.where(forward, 0.0, np.pi),
        s_m=s_m,
    )


def road_joints(opendrive: OpenDrive) -> list[Finding]:
    """Find reference lines of linked ordinary roads that do not touch. Inside junctions only lanes have to."""
    tables = tables_of(opendrive)
    index_of = {road.id: index for index, road in enumerate(opendrive.roads)}
    found = []
    for index, road in enumerate(opendrive.roads):
        for s_m, link in ((0.0, road.predecessor), (road.length_m, road.successor)):
            other = _ordinary_neighbour(opendrive, link)
            if road.is_in_junction or other is None or link is None:
                continue
            other_m = 0.0 if link.contact == "start" else opendrive.road_by_id[other].length_m
            pose = tables.curves.pose(np.array([index, index_of[other]]), np.array([s_m, other_m]))
            gap_m = float(np.hypot(np.diff(pose.x_m), np.diff(pose.y_m))[0])
            if gap_m > GAP_M and road.id < other:
                text = f"the reference line ends {gap_m:.3f} m from that of road {other}"
                found.append(on_road(tables, index, s_m, Severity.ERROR, "gap", text, gap_m))
    return found


def _ordinary_neighbour(opendrive: OpenDrive, link: RoadLink | None) -> int | None:
    if link is None or link.contact is None or link.id not in opendrive.road_by_id:
        return None
    return None if opendrive.road_by_id[link.id].is_in_junction else link.id
