"""What a report plots against time: speed and its limit, acceleration, jerk, distance from the lane's middle."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from basu.metrics.passengers import felt
from basu.metrics.speeding import limits_mps

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from basu.records.history import History

STANDING_MPS = 0.1  # slower than this the vehicle stands, as for stop signs


class Signals(NamedTuple):
    """All (T,), one value a tick."""

    t_s: NDArray[np.float64]
    speed_mps: NDArray[np.float64]
    limit_mps: NDArray[np.float64]  # nan where none is posted
    along_mps2: NDArray[np.float64]  # acceleration, + forward
    across_mps2: NDArray[np.float64]  # + to the right
    jerk_mps3: NDArray[np.float64]  # of the acceleration along
    offset_m: NDArray[np.float64]  # off the lane's middle, + to the right; nan where there is no lane
    manual: NDArray[np.bool_]  # a person drives


def signals(history: History) -> Signals:
    """The signals of a record; accelerations and jerk are those at a standing passenger's place, filtered."""
    frames = history.frames
    sensed = felt(history)
    unknown = np.full(len(frames), np.nan)  # a record too short to feel anything
    limit_mps = limits_mps(history)
    return Signals(
        t_s=frames["t_s"].astype(np.float64),
        speed_mps=history.speed_mps(),
        limit_mps=np.where(np.isfinite(limit_mps), limit_mps, np.nan),
        along_mps2=unknown if sensed is None else sensed.filtered_along_mps2,
        across_mps2=unknown if sensed is None else sensed.filtered_across_mps2,
        jerk_mps3=unknown if sensed is None else sensed.jerk_along_mps3,
        offset_m=frames["lane_offset_m"].astype(np.float64),
        manual=frames["manual"].astype(np.bool_),
    )


def stretches(holds: NDArray[np.bool_], t_s: NDArray[np.float64]) -> list[tuple[float, float]]:
    """From when to when ``holds`` (T,) holds: (first, last) in s of each stretch."""
    edges = np.flatnonzero(np.diff(np.concatenate([[False], holds, [False]]).astype(np.int8))).reshape(-1, 2)
    return [(float(t_s[first]), float(t_s[end - 1])) for first, end in edges.tolist()]
