"""Records derived from a map: lanes of the road mesh, placed signals, lots, things beside roads. Values only.

A module of its own, so that readers of the records need not import the code that derives them. Lots are the pieces of
land along a street on which houses may stand (:mod:`linden.maps.lot_cutting`).
"""

from typing import NamedTuple

import numpy as np

from linden.protocol.values.space import BoundingBox, Transform

GIVE_WAY = np.dtype(
    [
        ("signal", "i4"),  # place of the sign among the map's signals
        ("centre_m", "f8", (3,)),  # CARLA's frame
        ("half_m", "f8"),  # half the length of the square's sides
        ("yaw_rad", "f8"),
    ]
)
"""A square on the road. Vehicles under the sign give way to vehicles in the square."""


class AffectedLane(NamedTuple):
    """A driving lane that a signal speaks to, and the s at which it does."""

    road_id: int
    lane_id: int
    s_m: float


class StandingBox(NamedTuple):
    """An upright box in CARLA's frame: its middle and half its sizes in m, and its yaw."""

    x_m: float
    y_m: float
    z_m: float
    half_x_m: float
    half_y_m: float
    half_z_m: float
    yaw_rad: float


STREET_NAME_SIGN = "street_name_sign"
NAMES_BETWEEN = " / "
BLADE_LETTER_M = 0.1
"""Capitals of 4 in are the least for streets of 25 mph (Manual on Uniform Traffic Control Devices, section 2D.43)."""
ADVANCE = 0.76
"""From letter to letter on a blade, for letters of height 1."""


class Standing(NamedTuple):
    """A thing that the map says stands beside a road: a building (named, where the map names it), furniture, or a sign.

    ``kind`` is building, bench, bin, mailbox or street_name_sign. A sign's name joins its streets' names, or the lines
    of a place's name, by " / ". Its boxes are the post and one blade for each of them. The place is that of its foot,
    in CARLA's frame.
    """

    kind: str
    name: str
    x_m: float
    y_m: float
    z_m: float
    yaw_rad: float
    boxes: tuple[StandingBox, ...]


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


LANES = np.dtype(
    [
        ("road_id", "i4"),
        ("section", "i4"),
        ("lane_id", "i4"),
        ("junction", "i4"),  # -1 outside of junctions
        ("type_bits", "u4"),  # values.enums.LaneType
        ("speed_limit_mps", "f8"),  # nan where the map says nothing
        ("tag", "u1"),  # values.enums.SemanticTag
    ]
)


LOTS = np.dtype(
    [
        ("front_m", "f8", 2),  # the middle of the side on the street, x and y
        ("yaw_rad", "f8"),  # from the street into the lot
        ("road_id", "i4"),
    ]
)

LOT_WIDTH_M = 11
"""Along the street; lots of South Linden are 33 to 40 feet wide."""
LOT_DEPTH_M = 20
"""Away from the street: as much of a lot as its front yard and its house take; what lies behind is left open."""
