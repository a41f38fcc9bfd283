"""What stands in a recorder file of CARLA 0.9.16: packets, and the records of fixed size in them.

Everything is little-endian and packed. A packet is a byte of kind, four of size, the content; one that holds records
begins with their number as u16. Places are in cm, angles in degrees, rotations stand as roll, pitch, yaw.
Source: CARLA's ``Plugins/Carla/Source/Carla/Recorder``, the ``Write`` functions.
"""

from __future__ import annotations

from enum import IntEnum

import numpy as np

MAGIC = b"CARLA_RECORDER"
VERSIONS = (1, 2)  # 1: all releases; 2: of development after 0.9.16, the same but for how attributes' types count
NOBODY = 0xFFFFFFFF  # an actor's id in a collision with scenery


class Kind(IntEnum):
    """The packets that are read; the others (bones, wheels, doors, clocks, weather) answer none of the queries."""

    FRAME_START = 0
    FRAME_END = 1
    CREATED = 2
    DESTROYED = 3
    PARENTS = 4
    COLLISIONS = 5
    POSITIONS = 6
    LIGHT_STATES = 7
    CONTROLS = 8
    WALKER_SPEEDS = 9
    VEHICLE_LIGHTS = 10
    SCENE_LIGHTS = 11
    VELOCITIES = 12
    BOXES = 13
    PLATFORM_TIME = 14
    PHYSICS = 15
    LIGHT_TIMES = 16
    TRIGGER_VOLUMES = 17
    LAST_BITS = 240  # of places in m, by Linden: how many last bits they are off those in cm over 100


BOX = np.dtype([("id", "<u4"), ("centre_cm", "<f4", (3,)), ("extent_cm", "<f4", (3,))])

RECORDS: dict[Kind, np.dtype[np.void]] = {
    Kind.DESTROYED: np.dtype([("id", "<u4")]),
    Kind.PARENTS: np.dtype([("id", "<u4"), ("parent_id", "<u4")]),
    Kind.COLLISIONS: np.dtype(
        [("number", "<u4"), ("id", "<u4"), ("other_id", "<u4"), ("is_hero", "?"), ("other_is_hero", "?")]
    ),
    Kind.POSITIONS: np.dtype([("id", "<u4"), ("location_cm", "<f4", (3,)), ("rotation_deg", "<f4", (3,))]),
    Kind.LIGHT_STATES: np.dtype([("id", "<u4"), ("frozen", "?"), ("elapsed_s", "<f4"), ("state", "i1")]),
    Kind.CONTROLS: np.dtype(
        [
            ("id", "<u4"),
            ("steer", "<f4"),
            ("throttle", "<f4"),
            ("brake", "<f4"),
            ("hand_brake", "?"),
            ("gear", "<i4"),  # negative: reverse
        ]
    ),
    Kind.WALKER_SPEEDS: np.dtype([("id", "<u4"), ("speed_mps", "<f4")]),
    Kind.VEHICLE_LIGHTS: np.dtype([("id", "<u4"), ("bits", "<u4")]),
    Kind.SCENE_LIGHTS: np.dtype(
        [("id", "<i4"), ("intensity", "<f4"), ("rgba", "<f4", (4,)), ("on", "?"), ("group", "u1")]
    ),
    Kind.VELOCITIES: np.dtype([("id", "<u4"), ("velocity_mps", "<f4", (3,)), ("angular_degps", "<f4", (3,))]),
    Kind.BOXES: BOX,
    Kind.LIGHT_TIMES: np.dtype([("id", "<u4"), ("green_s", "<f4"), ("yellow_s", "<f4"), ("red_s", "<f4")]),
    Kind.TRIGGER_VOLUMES: BOX,
    Kind.LAST_BITS: np.dtype([("off", "i1", (3,))]),
}
