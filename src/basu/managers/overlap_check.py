"""`OverlapCheck` reports an actor that the run's vehicle overlaps without a contact of the collision sensor."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from basu.metrics.boxes import touching

if TYPE_CHECKING:
    import carla

    from basu.managers.base_manager import Ego, Frame, WorldChanges
    from basu.managers.observations import Neighbours

HEARD_TICKS = 4  # after which a contact has been reported
INSIDE_M, INSIDE_TICKS = 0.3, 5
"""How deep, and in how many steps in a row, the vehicle may overlap another box without a reported contact."""
ABOVE_M = 2.0  # between the heights of two bodies, one of which passes over the other


class _OwnBox(NamedTuple):
    """The box of the run's vehicle, read once: each reading is a call to the simulator."""

    middle_m: float  # ahead of the vehicle's origin
    half_diagonal_m: float  # of the whole box
    half_length_m: float  # of the smaller box that must not overlap another
    half_width_m: float

    @classmethod
    def of(cls, vehicle: carla.Vehicle) -> _OwnBox:
        box = vehicle.bounding_box
        half_m = box.extent.x, box.extent.y
        return cls(box.location.x, math.hypot(*half_m), *(max(0.1, each - INSIDE_M) for each in half_m))


class OverlapCheck:
    """Checks that the vehicle is not inside another body while the collision sensor reports no contact."""

    def __init__(self, vehicle: carla.Vehicle, neighbours: Neighbours, changes: WorldChanges) -> None:
        """Check ``vehicle`` against ``neighbours``; ``changes`` knows the contacts."""
        self._box, self._neighbours, self._changes = _OwnBox.of(vehicle), neighbours, changes
        self._inside: dict[int, int] = {}  # steps in a row, by the actor that the vehicle overlaps

    def fault(self, frame: Frame) -> str | None:
        """Return half a sentence where the vehicle has driven through a body, else None."""
        inside: dict[int, int] = {}
        for row in self._neighbours.near(frame):
            key = int(row[1])
            if _is_inside(frame.ego, self._box, row, self._neighbours.sizes[key]):
                inside[key] = self._inside.get(key, 0) + 1
        self._inside = inside
        for key, ticks in inside.items():
            if ticks < INSIDE_TICKS + HEARD_TICKS:
                continue
            if not any(contact.other_id == key for contact in self._changes.contacts(0)):
                return f"drove through the actor {key} ({self._neighbours.met[key]}) without a contact"
        return None


def _is_inside(ego: Ego, box: _OwnBox, row: tuple[float, ...], half_m: tuple[float, float]) -> bool:
    """Whether the vehicle's box, made smaller, overlaps that of a row of ``history.OTHER``."""
    reach_m = box.half_diagonal_m + math.hypot(*half_m)
    if math.hypot(row[2] - ego.x_m, row[3] - ego.y_m) > reach_m or abs(row[4] - ego.z_m) > ABOVE_M:
        return False
    cos, sin = math.cos(ego.yaw_rad), math.sin(ego.yaw_rad)
    x_m, y_m = ego.x_m + box.middle_m * cos, ego.y_m + box.middle_m * sin
    own = np.array([[x_m, y_m, ego.yaw_rad, box.half_length_m, box.half_width_m]])
    return bool(touching(own, np.array([[row[2], row[3], row[5], *half_m]]))[0])
