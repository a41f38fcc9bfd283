"""Things that stand: oriented boxes of the scenery, binned so that a body finds those around it at once."""

import math
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

F64 = NDArray[np.float64]
I32 = NDArray[np.int32]
I64 = NDArray[np.int64]
U8 = NDArray[np.uint8]

STATIC_BOX = np.dtype(
    [
        ("centre", "f8", 3),  # m, world
        ("half", "f8", 3),  # m
        ("yaw_rad", "f8"),
        ("tag", "u1"),  # values.enums.SemanticTag
        ("id", "i8"),  # whatever the caller knows the thing by
    ]
)

_BIN_M = 16.0
_MOST_BINS = 1_000_000


class Statics(NamedTuple):
    """Boxes as columns, with the bins of the plane that each one's circle touches."""

    centre: F64  # (M, 3)
    half: F64  # (M, 3)
    yaw_rad: F64  # (M,)
    tag: U8
    id: I64
    bin_start: I32
    bin_items: I32
    bin_frame: F64  # (5,): x0, y0, bins per metre, bins in x, bins in y

    @staticmethod
    def of(boxes: NDArray[Any]) -> "Statics":
        """Build from an array of STATIC_BOX.

        Raises:
            ValueError: a box is not finite.
        """
        columns = {name: np.ascontiguousarray(boxes[name]) for name in ("centre", "half", "yaw_rad", "tag", "id")}
        if not all(np.isfinite(columns[name]).all() for name in ("centre", "half", "yaw_rad")):
            raise ValueError("a static box has a place, size or yaw that is not finite")
        return Statics(**columns, **_bins(columns["centre"][:, :2], np.hypot(*columns["half"][:, :2].T)))

    @staticmethod
    def none() -> "Statics":
        """Return an empty scenery."""
        return Statics.of(np.empty(0, STATIC_BOX))


def _bins(centre_m: F64, radius_m: F64) -> dict[str, Any]:
    """Return bin_start, bin_items and bin_frame for circles (M, 2), (M,)."""
    if len(centre_m) == 0:
        frame = np.array([0.0, 0.0, 1.0 / _BIN_M, 1.0, 1.0])
        return {"bin_start": np.zeros(2, np.int32), "bin_items": np.empty(0, np.int32), "bin_frame": frame}
    low = (centre_m - radius_m[:, None]).min(axis=0)
    size = (centre_m + radius_m[:, None]).max(axis=0) - low
    bin_m = max(_BIN_M, math.sqrt(float(size[0] * size[1]) / _MOST_BINS))
    columns, rows = (int(count) for count in np.floor(size / bin_m) + 1.0)
    members: dict[int, list[int]] = {}
    first = np.floor((centre_m - radius_m[:, None] - low) / bin_m).astype(int)
    last = np.floor((centre_m + radius_m[:, None] - low) / bin_m).astype(int)
    for k in range(len(centre_m)):
        for row in range(first[k, 1], min(last[k, 1], rows - 1) + 1):
            for column in range(first[k, 0], min(last[k, 0], columns - 1) + 1):
                members.setdefault(row * columns + column, []).append(k)
    counts = np.zeros(columns * rows + 1, np.int32)
    for number, items in members.items():
        counts[number + 1] = len(items)
    ordered = [item for number in sorted(members) for item in members[number]]
    return {
        "bin_start": np.cumsum(counts, dtype=np.int32),
        "bin_items": np.array(ordered, np.int32),
        "bin_frame": np.array([low[0], low[1], 1.0 / bin_m, float(columns), float(rows)]),
    }
