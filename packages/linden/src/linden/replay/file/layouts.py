"""Packed records of a recording: their layouts, and their lengths in centimetres.

The packets and their records of fixed size are packed little-endian. Source: CARLA's
``Carla/Recorder/CarlaRecorder*.h``, for order and sizes; checked against real recordings. The file holds cm and
degrees; rotations are roll, pitch, yaw.

A recording holds cm as 32-bit floats, which are coarser than the same number of m by up to 28 %. So the writer adds a
packet that CARLA skips. It says by how many last bits the m computed from the cm are off, and no bit is lost.
"""

from enum import IntEnum

import numpy as np
from numpy.typing import NDArray

MAGIC = "CARLA_RECORDER"
VERSION = 1
"""What CARLA 0.9.16 writes."""

SCENERY = 0xFFFFFFFF
"""Id in a collision of what is no actor."""


class PacketId(IntEnum):
    """What a packet holds, as the tree of CARLA 0.9.16 numbers it (``CarlaRecorder.h``).

    An earlier version numbers 21 to 23 as doors, wheels, bikers; ``decode`` tells them apart by their sizes.
    """

    FRAME_START = 0
    FRAME_END = 1
    ADDED = 2
    REMOVED = 3
    PARENTS = 4
    COLLISIONS = 5
    POSITIONS = 6
    LIGHT_STATES = 7
    VEHICLES = 8
    WALKERS = 9
    VEHICLE_LIGHTS = 10
    SCENE_LIGHTS = 11
    KINEMATICS = 12
    BOXES = 13
    PLATFORM_TIME = 14
    PHYSICS = 15
    LIGHT_TIMES = 16
    TRIGGER_VOLUMES = 17
    FRAME_COUNTER = 18
    BONES = 19
    VISUAL_TIME = 20
    WHEELS = 21
    BIKERS = 22
    DOORS = 23
    WEATHER = 24
    LOCATION_ULPS = 240
    """Linden's own; CARLA skips it, as any id it does not know."""


class ActorKind(IntEnum):
    """What an actor is, as the recorder numbers it."""

    OTHER = 0
    VEHICLE = 1
    WALKER = 2
    TRAFFIC_LIGHT = 3
    TRAFFIC_SIGN = 4
    SENSOR = 5


FRAME_START = np.dtype(
    [
        ("number", "<u8"),  # from 1
        ("duration_s", "<f8"),  # until the next frame; -1 in the last
        ("elapsed_s", "<f8"),  # since the recording began
    ]
)
REMOVED = np.dtype([("id", "<u4")])
PARENT = np.dtype([("child", "<u4"), ("parent", "<u4")])
COLLISION = np.dtype(
    [
        ("collision", "<u4"),  # counts the collisions of a recording
        ("first", "<u4"),  # actor, or SCENERY
        ("second", "<u4"),
        ("first_is_hero", "u1"),
        ("second_is_hero", "u1"),
    ]
)
POSITION = np.dtype(
    [
        ("id", "<u4"),
        ("location_cm", "<f4", (3,)),  # x, y, z in CARLA's frame
        ("rotation_deg", "<f4", (3,)),  # roll, pitch, yaw
    ]
)
LIGHT_STATE = np.dtype([("id", "<u4"), ("frozen", "u1"), ("elapsed_s", "<f4"), ("state", "i1")])
VEHICLE = np.dtype(
    [
        ("id", "<u4"),
        ("steer", "<f4"),
        ("throttle", "<f4"),
        ("brake", "<f4"),
        ("hand_brake", "u1"),
        ("gear", "<i4"),  # negative: reverse
    ]
)
WALKER = np.dtype([("id", "<u4"), ("speed_mps", "<f4")])
VEHICLE_LIGHT = np.dtype([("id", "<u4"), ("bits", "<u4")])
SCENE_LIGHT = np.dtype(
    [("id", "<i4"), ("intensity", "<f4"), ("rgba", "<f4", (4,)), ("on", "u1"), ("type", "u1")]  # rgba in [0, 1]
)
KINEMATICS = np.dtype(
    [
        ("id", "<u4"),
        ("velocity_mps", "<f4", (3,)),
        ("angular_velocity_degps", "<f4", (3,)),
    ]
)
BOX = np.dtype([("id", "<u4"), ("origin_cm", "<f4", (3,)), ("extent_cm", "<f4", (3,))])
LIGHT_TIME = np.dtype([("id", "<u4"), ("green_s", "<f4"), ("yellow_s", "<f4"), ("red_s", "<f4")])
DOOR = np.dtype([("id", "<u4"), ("door", "u1"), ("open", "u1")])
WHEEL = np.dtype([("wheel", "u1"), ("steer_deg", "<f4"), ("turn_deg", "<f4")])
BIKER = np.dtype([("id", "<u4"), ("forward_speed", "<f4"), ("engine_share", "<f4")])
WEATHER = np.dtype(
    [
        (name, "<f4")
        for name in (
            "cloudiness",
            "precipitation",
            "precipitation_deposits",
            "wind_intensity",
            "sun_azimuth_angle",
            "sun_altitude_angle",
            "fog_density",
            "fog_distance",
            "fog_falloff",
            "wetness",
            "scattering_intensity",
            "mie_scattering_scale",
            "rayleigh_scattering_scale",
            "dust_storm",
        )
    ]
)

LOCATION_ULPS = np.dtype([("ulps", "i1", (3,))])
"""By how many last bits the location in m differs from that in cm over 100; see ``metres``."""

RECORDS: dict[PacketId, np.dtype[np.void]] = {
    PacketId.REMOVED: REMOVED,
    PacketId.PARENTS: PARENT,
    PacketId.COLLISIONS: COLLISION,
    PacketId.POSITIONS: POSITION,
    PacketId.LIGHT_STATES: LIGHT_STATE,
    PacketId.VEHICLES: VEHICLE,
    PacketId.WALKERS: WALKER,
    PacketId.VEHICLE_LIGHTS: VEHICLE_LIGHT,
    PacketId.SCENE_LIGHTS: SCENE_LIGHT,
    PacketId.KINEMATICS: KINEMATICS,
    PacketId.BOXES: BOX,
    PacketId.LIGHT_TIMES: LIGHT_TIME,
    PacketId.TRIGGER_VOLUMES: BOX,
    PacketId.DOORS: DOOR,
    PacketId.BIKERS: BIKER,
    PacketId.WEATHER: WEATHER,
    PacketId.LOCATION_ULPS: LOCATION_ULPS,
}
"""Packets that are a u16 count and as many records of one size."""

_SIZES = {"POSITION": 28, "LIGHT_STATE": 10, "VEHICLE": 21, "SCENE_LIGHT": 26, "KINEMATICS": 28, "COLLISION": 14}
for _name, _size in _SIZES.items():
    assert globals()[_name].itemsize == _size, _name


F32 = NDArray[np.float32]

_CM_PER_M = np.float32(100.0)


def to_file(location_m: F32) -> tuple[F32, NDArray[np.int8]]:
    """Return the location (N, 3) in cm and the correction, in last bits of the location in m."""
    location_cm = location_m * _CM_PER_M
    off = location_m.view(np.int32) - _plain_m(location_cm).view(np.int32)
    return location_cm, off.astype(np.int8)


def from_file(location_cm: F32, ulps: NDArray[np.int8] | None) -> F32:
    """Return the location (N, 3) in m; ``ulps`` None where the file has no corrections, being CARLA's."""
    location_m = _plain_m(np.ascontiguousarray(location_cm))
    if ulps is None:
        return location_m
    exact: F32 = (location_m.view(np.int32) + ulps).view(np.float32)
    return exact


def _plain_m(location_cm: F32) -> F32:
    location_m: F32 = location_cm / _CM_PER_M
    return location_m
