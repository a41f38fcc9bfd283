"""Things that stand: oriented boxes of the scenery, binned so that a body finds those around it at once."""

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from linden.plane_bins import Bins, bins_of, items_near
from linden.protocol.values.enums import SemanticTag

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
        bins = bins_of(columns["centre"][:, :2], np.hypot(*columns["half"][:, :2].T))
        return Statics(**columns, bin_start=bins.start, bin_items=bins.items, bin_frame=bins.frame)

    def near(self, x_m: float, y_m: float, reach_m: float) -> NDArray[np.int64]:
        """Return the numbers of all boxes that may reach into a square of this half size, ascending."""
        return items_near(Bins(self.bin_start, self.bin_items, self.bin_frame), x_m, y_m, reach_m)

    @staticmethod
    def none() -> "Statics":
        """Return an empty scenery."""
        return Statics.of(np.empty(0, STATIC_BOX))


NAMELESS = (SemanticTag.NONE, SemanticTag.OTHER, SemanticTag.ANY)


def scenery_type(tag: int) -> str:
    """Return CARLA's type id of scenery: "static." and the tag's name without its plural (ActorRegistry.cpp)."""
    label = SemanticTag(tag)
    if label in NAMELESS:
        return "static.unknown"
    word = label.name.lower().replace("_", "")
    return f"static.{word.removesuffix('s')}"
