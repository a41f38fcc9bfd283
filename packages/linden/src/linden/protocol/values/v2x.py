"""Messages between vehicles: the cooperative awareness message (CAM) and CARLA's custom message, as named tuples.

Units and ranges of a CAM are those of its ASN.1: ETSI EN 302 637-2 V1.4.1 (the message) and ETSI TS 102 894-2 V1.3.1
(the fields), which protocol version 2 names. CARLA's ``LibITS.h`` has an older limit in one place: an unavailable
curvature is 30001 there and 1023 in version 2.
"""

from enum import IntEnum
from typing import NamedTuple

PROTOCOL_VERSION = 2


class MessageId(IntEnum):
    """What follows the header of a message (LibITS.h); ETSI gives 0 to nothing."""

    CUSTOM = 0
    CAM = 2


class StationType(IntEnum):
    """What sends a message (TS 102 894-2); only what a world here has."""

    UNKNOWN = 0
    PEDESTRIAN = 1
    CYCLIST = 2
    MOTORCYCLE = 4
    PASSENGER_CAR = 5
    BUS = 6
    LIGHT_TRUCK = 7
    SPECIAL_VEHICLE = 10
    ROAD_SIDE_UNIT = 15


class VehicleRole(IntEnum):
    """What a vehicle does (TS 102 894-2); only what a world here has."""

    DEFAULT = 0
    PUBLIC_TRANSPORT = 1
    EMERGENCY = 6
    TAXI = 12


class DriveDirection(IntEnum):
    """Whether a vehicle drives forwards (TS 102 894-2)."""

    FORWARD = 0
    BACKWARD = 1


class VehicleState(NamedTuple):
    """The high-frequency container of vehicles: how one moves. Left is positive, other than in CARLA's frame."""

    heading: int  # 0.1°, 0 is north, growing clockwise
    heading_confidence: int  # 0.1°, half width of the 95 % interval; 126 beyond 12.5°
    speed: int  # 0.01 m/s
    speed_confidence: int  # 0.01 m/s, likewise; 126 beyond 1.25 m/s
    drive_direction: DriveDirection
    length: int  # 0.1 m
    width: int  # 0.1 m
    longitudinal_acceleration: int  # 0.1 m/s², forwards
    lateral_acceleration: int  # 0.1 m/s², to the left
    vertical_acceleration: int  # 0.1 m/s², upwards, 0 at rest
    yaw_rate: int  # 0.01°/s, to the left
    acceleration_control: int  # the highest bit is the brake pedal, the next the gas pedal


class VehicleFacts(NamedTuple):
    """The low-frequency container of vehicles without a path history: what changes seldom."""

    role: VehicleRole
    exterior_lights: int  # from the highest bit: low beam, high beam, left, right, day, reverse, fog, parking


class CooperativeAwarenessMessage(NamedTuple):
    """A CAM; of a road side unit where ``state`` is None."""

    station_id: int  # the actor's
    station_type: StationType
    generation_delta_time: int  # ms of simulated time, modulo 65,536
    latitude: int  # 1e-7°
    longitude: int  # 1e-7°
    altitude: int  # 0.01 m
    state: VehicleState | None = None
    facts: VehicleFacts | None = None


class CustomMessage(NamedTuple):
    """A text that a script sent; at most ``LONGEST_TEXT_BYTES`` of UTF-8."""

    station_id: int  # the actor's
    text: str


LONGEST_TEXT_BYTES = 99
"""Of a custom message: CARLA's record has 100 bytes, and the last ends the text."""


class ReceivedCam(NamedTuple):
    """A CAM, and the power at the receiver's antenna in dBm."""

    power_dbm: float
    message: CooperativeAwarenessMessage


class ReceivedText(NamedTuple):
    """A custom message, and the power at the receiver's antenna in dBm."""

    power_dbm: float
    message: CustomMessage
