"""Stop signs, yield signs and traffic lights that govern the route's lane, with where their lines are crossed."""

from __future__ import annotations

from collections import defaultdict
from typing import TYPE_CHECKING

import numpy as np

from basu.routing.model import Control, ControlKind

if TYPE_CHECKING:
    import carla
    from numpy.typing import NDArray

# OpenDRIVE signal types as LibCarla's landmarks carry them (client reference, section "Signals")
KIND_OF_TYPE = {
    "206": ControlKind.STOP_SIGN,
    "205": ControlKind.YIELD_SIGN,
    **{str(code): ControlKind.TRAFFIC_LIGHT for code in (1000001, 1000002, *range(1000007, 1000021))},
}
SAME_LINE_M = 40.0  # a light and a reference to it on the connecting road behind its line lie within this
PASS_SLACK_M = 3.0  # a line this near beyond the end of a stretch on its road still belongs to it


def controls_on(
    landmarks: list[carla.Landmark],
    *,
    road_id: NDArray[np.int64],
    lane_id: NDArray[np.int64],
    road_s_m: NDArray[np.float64],
    s_m: NDArray[np.float64],
    points_m: NDArray[np.float64],
    yaw_rad: NDArray[np.float64],
) -> tuple[Control, ...]:
    """Controls in the order in which the route meets them; one that is met twice appears twice.

    All arrays describe the route's N points; ``road_s_m`` is the place along each point's road, ``landmarks`` are
    ``carla.Landmark`` of the whole map.
    """
    by_road: dict[int, list[carla.Landmark]] = defaultdict(list)
    for landmark in landmarks:
        if landmark.type in KIND_OF_TYPE:
            by_road[landmark.road_id].append(landmark)
    found = []
    changes = np.flatnonzero((np.diff(road_id) != 0) | (np.diff(lane_id) != 0)) + 1
    for first, end in zip([0, *changes.tolist()], [*changes.tolist(), len(road_id)], strict=True):
        lane = int(lane_id[first])
        for landmark in by_road.get(int(road_id[first]), ()):
            at = _nearest(landmark, lane, road_s_m[first:end])
            if at is None:
                continue
            at += first
            ahead_m = (landmark.s - float(road_s_m[at])) * (1.0 if lane < 0 else -1.0)
            found.append(
                Control(
                    kind=KIND_OF_TYPE[landmark.type],
                    landmark_id=landmark.id,
                    s_m=float(s_m[at]) + ahead_m,
                    x_m=float(points_m[at, 0] + ahead_m * np.cos(yaw_rad[at])),
                    y_m=float(points_m[at, 1] + ahead_m * np.sin(yaw_rad[at])),
                    z_m=float(points_m[at, 2]),
                    yaw_rad=float(yaw_rad[at]),
                )
            )
    return _lines(sorted(found, key=lambda control: (control.s_m, control.landmark_id)))


def _lines(found: list[Control]) -> tuple[Control, ...]:
    """Controls without references on connecting roads to a signal whose own line lies a few metres before them."""
    kept: list[Control] = []
    for control in found:
        again = any(
            control.landmark_id == other.landmark_id and control.s_m - other.s_m < SAME_LINE_M for other in kept[-4:]
        )
        if not again:
            kept.append(control)
    return tuple(kept)


def _nearest(landmark: carla.Landmark, lane: int, stretch_m: NDArray[np.float64]) -> int | None:
    """The point of a stretch on the landmark's road that is nearest to its line; None where it does not govern it."""
    if not any(min(pair) <= lane <= max(pair) for pair in landmark.get_lane_validities()):
        return None
    if not stretch_m.min() - PASS_SLACK_M <= landmark.s <= stretch_m.max() + PASS_SLACK_M:
        return None
    return int(np.argmin(np.abs(stretch_m - landmark.s)))
