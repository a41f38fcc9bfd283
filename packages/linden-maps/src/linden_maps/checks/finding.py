"""A finding: what is wrong, how badly, where, and by how much; with the sizes from which on it counts."""

import math
from enum import Enum
from typing import NamedTuple

import numpy as np

from linden.maps.opendrive.evaluate.tables import Tables

GAP_M = 0.01  # in plan, between ends that should touch
STEP_M = 0.02  # in height, likewise
KINK_DEG = 1.5  # between headings that should agree
JUMP_M = 0.01  # of a lane's width or place where one record follows another
OVERLAP_M = 0.10  # how deep two surfaces reach into each other
KERB_REACH_M = 0.20  # of a kerb or pavement into a lane: wheels keep further than that from the lane's edge
LAYER_M = 2.0  # surfaces further apart in height are a bridge and a road under it
SIGNAL_REACH_M = 12.0  # beyond the outermost lane; a signal further away belongs to no road
SIGNAL_SHIFT_M = 0.05  # how far LibCarla may move a signal out of a lane before it counts
STEEPEST_PERCENT = 15.0  # of a road; AASHTO's Green Book (2018) allows local streets as much
CLOSURE_M = 0.001  # between the first and the last corner of a closed outline


class Severity(Enum):
    """How bad it is. A note tells what is odd but allowed."""

    ERROR = "error"
    WARNING = "warning"
    NOTE = "note"


class Finding(NamedTuple):
    """One thing found. ``x_m`` and ``y_m`` are CARLA's; where nothing fits, road is None and places are nan."""

    severity: Severity
    kind: str
    what: str
    size: float = math.nan  # in the unit the text names
    road_id: int | None = None
    s_m: float = math.nan
    x_m: float = math.nan
    y_m: float = math.nan

    def __str__(self) -> str:
        place = "" if self.road_id is None else f" road {self.road_id}"
        if math.isfinite(self.s_m):
            place += f" s={self.s_m:.2f}"
        if math.isfinite(self.x_m):
            place += f" (x={self.x_m:.2f}, y={self.y_m:.2f})"
        return f"{self.severity.value} {self.kind}{place}: {self.what}"


def on_road(
    tables: Tables, road_index: int, s_m: float, severity: Severity, kind: str, what: str, size: float = math.nan
) -> Finding:
    """Return a finding at a place of a road's reference line."""
    road = tables.roads[road_index]
    at_m = min(max(s_m, 0.0), road.length_m) if math.isfinite(s_m) else 0.0
    pose = tables.curves.pose(np.array([road_index]), np.array([at_m]))
    return Finding(severity, kind, what, size, road.id, s_m, float(pose.x_m[0]), -float(pose.y_m[0]))


def worst_of_each(findings: list[tuple[object, Finding]]) -> list[Finding]:
    """Return the largest finding for each key, in the order in which the keys first came."""
    worst: dict[object, Finding] = {}
    for key, finding in findings:
        if key not in worst or finding.size > worst[key].size:
            worst[key] = finding
    return list(worst.values())
