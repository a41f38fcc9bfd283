"""One row per actor of the world snapshot, packed as it goes over the wire: 119 bytes, little-endian, no padding.

Source: ``carla/sensor/data/ActorDynamicState.h``, 0.9.16. The last 54 bytes are read by the class of the actor.
"""

import numpy as np

_POSE = [
    ("id", "<u4"),
    ("actor_state", "u1"),
    ("location", "<f4", (3,)),  # m, world
    ("rotation", "<f4", (3,)),  # pitch, yaw, roll in degrees
    ("velocity", "<f4", (3,)),  # m/s, world
    ("angular_velocity", "<f4", (3,)),  # degrees/s, world
    ("acceleration", "<f4", (3,)),  # m/s², world
]

ROW = np.dtype([*_POSE, ("of_class", "V54")])

VEHICLE_ROW = np.dtype(
    [
        *_POSE,
        ("throttle", "<f4"),
        ("steer", "<f4"),
        ("brake", "<f4"),
        ("hand_brake", "u1"),
        ("reverse", "u1"),
        ("manual_gear_shift", "u1"),
        ("gear", "<i4"),
        ("speed_limit", "<f4"),  # km/h
        ("traffic_light_state", "u1"),
        ("has_traffic_light", "u1"),
        ("traffic_light_id", "<u4"),
        ("failure_state", "u1"),
        ("unused", "V24"),
    ]
)

WALKER_ROW = np.dtype(
    [*_POSE, ("direction", "<f4", (3,)), ("speed", "<f4"), ("jump", "u1"), ("unused", "V37")],
)

TRAFFIC_LIGHT_ROW = np.dtype(
    [
        *_POSE,
        ("sign_id", "S32"),  # of the OpenDRIVE signal
        ("green_time", "<f4"),
        ("yellow_time", "<f4"),
        ("red_time", "<f4"),
        ("elapsed_time", "<f4"),
        ("pole_index", "<u4"),
        ("frozen", "u1"),
        ("state", "u1"),
    ]
)

TRAFFIC_SIGN_ROW = np.dtype([*_POSE, ("sign_id", "S32"), ("unused", "V22")])

for _row in (ROW, VEHICLE_ROW, WALKER_ROW, TRAFFIC_LIGHT_ROW, TRAFFIC_SIGN_ROW):
    assert _row.itemsize == 119, _row
