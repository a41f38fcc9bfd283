"""A whole map as arrays: reference lines, profiles, lanes; and where lanes lie at given places."""

import math
from collections import defaultdict
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np

from linden.maps.opendrive.evaluate.curves import Curves, curves_of
from linden.maps.opendrive.evaluate.pieces import F64, I64, Pieces, pieces_of
from linden.maps.opendrive.model import Cubic, Lane, LaneSection, OpenDrive, Road, kept
from linden.structured import StructuredArray

LANE = np.dtype(
    [
        ("road", "i4"),  # index of the road, not its id
        ("section", "i4"),  # index within the road
        ("lane_id", "i4"),
        ("inside", "i4"),  # index of the lane next to it towards the centre, -1 for the first one
        ("type_bits", "u4"),
        ("start_m", "f8"),  # the section, from and to
        ("end_m", "f8"),
        ("bordered", "?"),  # given by <border>, not by <width>
    ]
)


class LanePlaces(NamedTuple):
    """Places on lanes, OpenDRIVE's frame: m and rad; all (N,). Heading and slope look along the reference line."""

    x_m: F64
    y_m: F64
    z_m: F64
    heading_rad: F64
    slope: F64
    width_m: F64


@dataclass(frozen=True, eq=False, kw_only=True)
class Tables:
    """The arrays. Roads are known by their index in ``OpenDrive.roads``, lanes (all but lane 0) by their row."""

    roads: tuple[Road, ...]
    road_length_m: F64
    curves: Curves
    elevation: Pieces
    lane_offset: Pieces
    lanes: StructuredArray  # of LANE, in the order of the file, each section from the left to the right
    lane_values: tuple[Lane, ...]  # the same lanes as the file has them
    widths: Pieces
    heights_inner: Pieces
    heights_outer: Pieces
    speeds: Pieces  # m/s, constant by pieces, nan where nothing is said

    def lane_sides(self, lane: I64, s_m: F64, probe_m: F64 | None = None) -> tuple[F64, F64]:
        """Return t in m of each lane's inner and outer edge, measured from the reference line."""
        side = np.sign(self.lanes["lane_id"][lane]).astype(np.float64)
        inner = np.zeros(len(lane))
        width = self.widths.value(lane, s_m, probe_m)
        bordered = self.lanes["bordered"]
        walker, pending = self.lanes["inside"][lane].astype(np.int64), np.arange(len(lane))
        while len(pending := pending[walker[pending] >= 0]):
            at = walker[pending]
            probe = None if probe_m is None else probe_m[pending]
            value = self.widths.value(at, s_m[pending], probe)
            inner[pending] += np.where(bordered[at], value * side[pending], value)
            walker[pending] = np.where(bordered[at], -1, self.lanes["inside"][at])
        outer = np.where(bordered[lane], width * side, inner + width)
        offset = self.lane_offset.value(self.lanes["road"][lane].astype(np.int64), s_m, probe_m)
        return offset + side * inner, offset + side * outer

    def lane_centres(self, lane: I64, s_m: F64) -> LanePlaces:
        """Return the middle of lanes at s. The heading follows the lane's own line, not only the reference line."""
        inner, outer = self.lane_sides(lane, s_m)
        t_m = (inner + outer) / 2.0
        nudge = 1e-4
        s_high = np.minimum(s_m + nudge, self.lanes["end_m"][lane])
        s_low = np.maximum(s_m - nudge, self.lanes["start_m"][lane])
        ahead, behind = self.lane_sides(lane, s_high, s_m), self.lane_sides(lane, s_low, s_m)
        drift = (ahead[0] + ahead[1] - behind[0] - behind[1]) / 2.0 / np.maximum(s_high - s_low, 1e-9)
        road = self.lanes["road"][lane].astype(np.int64)
        pose = self.curves.pose(road, s_m)
        return LanePlaces(
            pose.x_m - np.sin(pose.heading_rad) * t_m,
            pose.y_m + np.cos(pose.heading_rad) * t_m,
            self.elevation.value(road, s_m),
            pose.heading_rad + np.arctan(drift),
            self.elevation.slope(road, s_m),
            np.abs(outer - inner),
        )

    @cached_property
    def lane_row(self) -> dict[tuple[int, int, int], int]:
        """Row of a lane by index of its road, index of its section, and lane id."""
        columns = (self.lanes[name].tolist() for name in ("road", "section", "lane_id"))
        return {key: row for row, key in enumerate(zip(*columns, strict=True))}

    @cached_property
    def sections_of_lane(self) -> dict[tuple[int, int], list[int]]:
        """Indices of the sections with a lane, ascending, by index of the road and lane id."""
        found: dict[tuple[int, int], list[int]] = defaultdict(list)
        for road, section, lane_id in self.lane_row:
            found[road, lane_id].append(section)
        return dict(found)


@kept
def tables_of(opendrive: OpenDrive) -> Tables:
    """Return the arrays of a map."""
    roads = opendrive.roads
    lengths_m = [road.length_m for road in roads]
    cells = [
        (road_index, section_index, road, section, lane)
        for road_index, road in enumerate(roads)
        for section_index, section in enumerate(road.sections)
        for lane in section.lanes
        if lane.id != 0
    ]
    ends_m = [road.length_m for _, _, road, _, _ in cells]
    origins_m = [section.s_m for _, _, _, section, _ in cells]
    lanes = [cell[4] for cell in cells]
    return Tables(
        roads=roads,
        road_length_m=np.asarray(lengths_m, dtype=np.float64),
        curves=curves_of([road.geometries for road in roads], lengths_m),
        elevation=pieces_of([(0.0, road.elevations) for road in roads], lengths_m),
        lane_offset=pieces_of([(0.0, road.lane_offsets) for road in roads], lengths_m),
        lanes=_lane_rows(cells),
        lane_values=tuple(lanes),
        widths=pieces_of(zip(origins_m, [lane.widths or lane.borders for lane in lanes], strict=True), ends_m),
        heights_inner=pieces_of(
            zip(origins_m, [[Cubic(h.offset_m, h.inner_m) for h in lane.heights] for lane in lanes], strict=True),
            ends_m,
        ),
        heights_outer=pieces_of(
            zip(origins_m, [[Cubic(h.offset_m, h.outer_m) for h in lane.heights] for lane in lanes], strict=True),
            ends_m,
        ),
        speeds=pieces_of([_speeds(road, section, lane) for _, _, road, section, lane in cells], ends_m),
    )


def _lane_rows(cells: list[tuple[int, int, Road, LaneSection, Lane]]) -> StructuredArray:
    rows = np.zeros(len(cells), dtype=LANE)
    place = {(cell[0], cell[1], cell[4].id): index for index, cell in enumerate(cells)}
    columns = [
        (
            road_index,
            section_index,
            lane.id,
            place.get((road_index, section_index, lane.id - (1 if lane.id > 0 else -1)), -1),
            int(lane.type),
            section.s_m,
            section.end_m,
            bool(lane.borders) and not lane.widths,
        )
        for road_index, section_index, _, section, lane in cells
    ]
    if columns:
        for name, column in zip(LANE.names or (), zip(*columns, strict=True), strict=True):
            rows[name] = column
    return rows


def _speeds(road: Road, section: LaneSection, lane: Lane) -> tuple[float, list[Cubic]]:
    """Return a lane's own limits, else its road's, as constants; nan where nothing is said or nothing limits."""
    if lane.speeds:
        return section.s_m, [Cubic(start_m, _or_nan(limit)) for start_m, limit in lane.speeds]
    types = [Cubic(kind.s_m, _or_nan(kind.limit_mps)) for kind in road.types]
    return 0.0, types or [Cubic(0.0, math.nan)]


def _or_nan(limit_mps: float | None) -> float:
    return math.nan if limit_mps is None else limit_mps
