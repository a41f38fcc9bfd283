"""The place on a lane's middle that is nearest to a point, among lanes of chosen types."""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from linden.maps.opendrive.evaluate.pieces import F64, I64
from linden.maps.opendrive.evaluate.strips import strips_of
from linden.maps.opendrive.evaluate.tables import Tables
from linden.protocol.values.enums import LaneType

REACH_M = 30.0  # lanes further away than this are not looked at


class Nearest(NamedTuple):
    """A lane (row of Tables.lanes), the s along its road, and how far away that is."""

    lane: int
    s_m: float
    distance_m: float


@dataclass(frozen=True, eq=False, kw_only=True)
class MiddleLines:
    """The middles of lanes as chords in OpenDRIVE's frame, sorted by the x of their starts."""

    lane: I64  # (N,)
    start: F64  # (N, 3), m
    step: F64  # (N, 3), m
    start_s_m: F64
    step_s_m: F64

    def nearest(self, x_m: float, y_m: float, z_m: float) -> Nearest | None:
        """Return the nearest place in space, None where no lane lies within ``REACH_M``."""
        low, high = np.searchsorted(self.start[:, 0], [x_m - REACH_M, x_m + REACH_M])
        near = low + np.flatnonzero(np.abs(self.start[low:high, 1] - y_m) < REACH_M)
        if not len(near):
            return None
        away = np.array([x_m, y_m, z_m]) - self.start[near]
        step = self.step[near]
        share = np.clip((away * step).sum(axis=1) / np.maximum((step * step).sum(axis=1), 1e-12), 0.0, 1.0)
        distance = np.linalg.norm(away - share[:, None] * step, axis=1)
        best = int(np.argmin(distance))
        row = near[best]
        s_m = float(self.start_s_m[row] + share[best] * self.step_s_m[row])
        return Nearest(int(self.lane[row]), s_m, float(distance[best]))


def middle_lines(tables: Tables, types: LaneType) -> MiddleLines:
    """Return the middles of all lanes of the given ``types``."""
    strips = strips_of(tables, np.flatnonzero(tables.lanes["type_bits"] & int(types)))
    s_m = strips.s_m
    centres = tables.lane_centres(strips.lane, s_m)
    points = np.stack([centres.x_m, centres.y_m, centres.z_m], axis=1)
    chords = np.flatnonzero(strips.continues)
    chords = chords[np.argsort(points[chords, 0], kind="stable")]
    return MiddleLines(
        lane=strips.lane[chords],
        start=points[chords],
        step=points[chords + 1] - points[chords],
        start_s_m=s_m[chords],
        step_s_m=s_m[chords + 1] - s_m[chords],
    )
