"""What a placed signal is: a value by itself, so that who only reads one needs none of what computes it."""

from typing import NamedTuple

import numpy as np

from linden.values.space import BoundingBox, Transform

GIVE_WAY = np.dtype(
    [
        ("signal", "i4"),  # place of the sign among the map's signals
        ("centre_m", "f8", (3,)),  # CARLA's frame
        ("half_m", "f8"),  # half the length of the square's sides
        ("yaw_rad", "f8"),
    ]
)
"""A square on the road; whoever stands under the sign lets pass what is in it."""


class AffectedLane(NamedTuple):
    """A driving lane that a signal speaks to, and the s at which it does."""

    road_id: int
    lane_id: int
    s_m: float


class PlacedSignal(NamedTuple):
    """A signal in CARLA's frame.

    ``landmark`` is the pose the client computes; the actor stands at ``transform``: the same place, upright, turned by
    90 degrees as CARLA's models are. ``trigger_volumes`` are local to ``transform``, one for each approach, x across
    the lanes, empty where the signal concerns no driving lane. ``junction_id`` is the junction guarded, else -1.
    """

    signal_id: str
    type: str
    subtype: str
    value: float | None
    unit: str
    name: str
    is_dynamic: bool
    is_light: bool
    road_id: int
    s_m: float
    landmark: Transform
    transform: Transform
    controllers: tuple[str, ...]
    junction_id: int
    lanes: tuple[AffectedLane, ...]
    trigger_volumes: tuple[BoundingBox, ...]
