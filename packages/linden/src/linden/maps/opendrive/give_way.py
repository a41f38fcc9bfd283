"""``give_way_areas``: small squares on the lanes to which traffic at a stop or yield sign gives way.

As in CARLA (StopSignComponent.cpp, YieldSignComponent.cpp) they lie along every way through the junction that the
sign's own ways meet, unless it comes out of the same road, and a little before it. Two things differ: CARLA looks only
where the signal speaks to a road inside the junction, here one on the approach will do; and no square lies before the
line of a vehicle with a sign of its own, so that two waiting vehicles do not wait for each other.
"""

from collections import defaultdict
from collections.abc import Iterable

import numpy as np
from numpy.typing import NDArray

from linden.background import checkpoint
from linden.geometry import from_opendrive
from linden.maps.opendrive.evaluate.tables import Tables, tables_of
from linden.maps.opendrive.limits import MOST_GIVE_WAY, MOST_MEETINGS, refuse_beyond
from linden.maps.opendrive.links import LaneLinks, ends_of_roads, is_forward, lane_links
from linden.maps.opendrive.model import OpenDrive
from linden.maps.opendrive.roadside import STOP_SIGN_TYPE, YIELD_SIGN_TYPE
from linden.maps.records import GIVE_WAY, PlacedSignal
from linden.protocol.values.enums import LaneType
from linden.structured import StructuredArray

F64 = NDArray[np.float64]

COVERED_WIDTHS = 0.9
"""How much of a lane's width the squares cover: CARLA's."""
SAMPLE_M = 1.0
MOST_SAMPLES = 500
"""Of one lane in a junction; a longer one is sampled further apart."""


def give_way_areas(opendrive: OpenDrive, placed: tuple[PlacedSignal, ...]) -> StructuredArray:
    """Return the squares (B,) of ``GIVE_WAY``, signal after signal."""
    ways = _Ways(opendrive)
    guarded = {nth: ways.approached_by(signal) for nth, signal in enumerate(placed) if _gives_way(signal)}
    approaches = {lane for lanes in guarded.values() for entry in lanes for lane in ways.links.predecessors[entry]}
    ways.refuse_many(guarded.values())
    found = []
    for nth, own in guarded.items():
        found += [(nth, *place) for place in ways.crossing(own, approaches)]
        refuse_beyond(len(found), MOST_GIVE_WAY, "squares to which traffic at stop and yield signs gives way")
    areas = np.zeros(len(found), GIVE_WAY)
    if found:
        signal, lane, s_m = (np.array(column) for column in zip(*found, strict=True))
        areas["signal"] = signal
        areas["half_m"] = [ways.half_m(row) for row in lane.tolist()]
        x_m, y_m, z_m, heading_rad, _, _ = ways.tables.lane_centres(lane, s_m)
        poses = [from_opendrive(*map(float, place)) for place in zip(x_m, y_m, z_m, heading_rad, strict=True)]
        areas["centre_m"] = [pose.location for pose in poses]
        areas["yaw_rad"] = np.radians([pose.rotation.yaw for pose in poses])
    return areas


def _gives_way(signal: PlacedSignal) -> bool:
    return signal.type in (STOP_SIGN_TYPE, YIELD_SIGN_TYPE)


class _Ways:
    """The lanes through a map's junctions, and which of them meet."""

    def __init__(self, opendrive: OpenDrive) -> None:
        self.tables: Tables = tables_of(opendrive)
        self.links: LaneLinks = lane_links(opendrive)
        self._ends = ends_of_roads(self.tables, self.links)
        lanes = self.tables.lanes
        self._road_index = {road.id: index for index, road in enumerate(self.tables.roads)}
        self._of_junction: dict[int, list[int]] = defaultdict(list)
        for row in np.flatnonzero(lanes["type_bits"] == int(LaneType.DRIVING)).tolist():
            if self._in_junction(row):
                self._of_junction[self.tables.roads[lanes["road"][row]].junction_id].append(row)
        self._line: dict[int, tuple[F64, float]] = {}

    def _in_junction(self, row: int) -> bool:
        return bool(self.tables.roads[self.tables.lanes["road"][row]].is_in_junction)

    def approached_by(self, signal: PlacedSignal) -> set[int]:
        """Return the lanes in a junction that traffic under a sign is about to enter, by their rows."""
        entered: set[int] = set()
        for road_id, lane_id, s_m in signal.lanes:
            index = self._road_index[road_id]
            road = self.tables.roads[index]
            row = self.tables.lane_row[index, road.section_index_at(s_m), lane_id]
            ahead = (row,) if road.is_in_junction else self.links.successors[self._ends[row]]
            entered |= {row for row in ahead if self._in_junction(row)}
        return entered

    def refuse_many(self, guarded: Iterable[set[int]]) -> None:
        """Raise a MapError where the lanes that signs guard have to be compared with very many others."""
        pairs = sum(len(own) * len(self._of_junction[junction]) for own in guarded for junction in self._junctions(own))
        refuse_beyond(pairs, MOST_MEETINGS, "pairs of lanes in junctions with stop and yield signs")

    def _junctions(self, rows: set[int]) -> list[int]:
        return sorted({self.tables.roads[self.tables.lanes["road"][row]].junction_id for row in rows})

    def crossing(self, own: set[int], guarded: set[int]) -> Iterable[tuple[int, float]]:
        """Yield the places (row, s) of the squares on the lanes that meet these, and one before each."""
        origins = self._origins(own)
        for other in [row for junction in self._junctions(own) for row in self._of_junction[junction]]:
            checkpoint()
            if other in own or self._origins({other}) & origins or not any(self._meet(row, other) for row in own):
                continue
            yield from ((other, s_m) for s_m in self._places(other))
            for before in self.links.predecessors[other]:
                if before not in guarded:
                    yield before, self._last_place(before)

    def _origins(self, rows: set[int]) -> set[int]:
        return {int(self.tables.lanes["road"][before]) for row in rows for before in self.links.predecessors[row]}

    def _meet(self, one: int, other: int) -> bool:
        (line, width_m), (other_line, other_width_m) = self._middle(one), self._middle(other)
        gap_m = np.linalg.norm(line[:, None, :] - other_line[None, :, :], axis=2)
        return bool(gap_m.min() < COVERED_WIDTHS * (width_m + other_width_m) / 2.0)

    def _middle(self, row: int) -> tuple[F64, float]:
        """Return points (P, 2) along the middle of a lane, m, and its mean width."""
        if row not in self._line:
            lane = self.tables.lanes[row]
            count = min(max(2, int((lane["end_m"] - lane["start_m"]) / SAMPLE_M) + 1), MOST_SAMPLES)
            s_m = np.linspace(lane["start_m"], lane["end_m"], count)
            places = self.tables.lane_centres(np.full(count, row), s_m)
            self._line[row] = np.column_stack([places.x_m, places.y_m]), float(places.width_m.mean())
        return self._line[row]

    def half_m(self, row: int) -> float:
        """Return half the size of the squares on a lane."""
        return max(0.01, COVERED_WIDTHS * self._middle(row)[1] / 2.0)

    def _places(self, row: int) -> list[float]:
        """Return s of squares that cover a lane from end to end."""
        start_m, end_m = float(self.tables.lanes["start_m"][row]), float(self.tables.lanes["end_m"][row])
        count = max(1, round((end_m - start_m) / (2.0 * self.half_m(row))))
        refuse_beyond(count, MOST_GIVE_WAY, "squares to which traffic at stop and yield signs gives way")
        return [start_m + (nth + 0.5) * (end_m - start_m) / count for nth in range(count)]

    def _last_place(self, row: int) -> float:
        """Return s of the last square on a lane before the junction."""
        lane = self.tables.lanes[row]
        forward = is_forward(self.tables.roads[lane["road"]], int(lane["lane_id"]))
        half_m = min(self.half_m(row), (float(lane["end_m"]) - float(lane["start_m"])) / 2.0)
        return float(lane["end_m"]) - half_m if forward else float(lane["start_m"]) + half_m
