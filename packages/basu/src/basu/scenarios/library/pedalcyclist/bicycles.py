"""Bicycles, the room that they are owed, and a parked car's door as something one can drive into.

An open door takes no space in the simulator (`docs/reference/physics.md`). A sheet of its size stands in for it: one of
the library's street signs, which lies in the car's side, above its roof, as long as the door is shut.
"""

from __future__ import annotations

import math

from basu.scenarios.actions import CloseDoor, InTurn, OpenDoor, PutAt, Wait
from basu.scenarios.stage import ActorSpec, Pose

BICYCLE = "vehicle.diamondback.century"
HALF_WIDTH_M = 0.3
PASSING_M = 0.9  # three feet, to be kept from an overtaken bicycle: Ohio Revised Code 4511.27 (A)(1)
SWAY_M = 0.5  # left to a crossing cyclist: nearer is luck
EASY_MPS2 = 1.5  # how one gets going on a bicycle


CAR = "vehicle.lincoln.mkz_2020"  # a model with doors that open
CAR_HALF_WIDTH_M = 0.92
SHEET = "static.prop.streetsign04"  # 1.17 m by 0.12 m, and stands fast
HALF_DOOR_M = 0.585
HINGE_M = 0.9  # ahead of the car's middle
OPENS_DEG = (25.0, 45.0, 65.0)  # three frames of its swing
FRAME_S = 0.1
ABOVE_M = 4.0


def in_car(car: Pose, forward_m: float, right_m: float, turned_rad: float = 0.0, up_m: float = 0.0) -> Pose:
    """A pose seen from the car's."""
    cos, sin = math.cos(car.yaw_rad), math.sin(car.yaw_rad)
    return Pose(
        car.x_m + forward_m * cos - right_m * sin,
        car.y_m + forward_m * sin + right_m * cos,
        car.z_m + up_m,
        car.yaw_rad + turned_rad,
    )


def door_at(car: Pose, open_deg: float, up_m: float = 0.0) -> Pose:
    """The driver's door: hinged in front, it swings out to the left."""
    open_rad = math.radians(open_deg)
    return in_car(
        car,
        HINGE_M - HALF_DOOR_M * math.cos(open_rad),
        -CAR_HALF_WIDTH_M - HALF_DOOR_M * math.sin(open_rad),
        open_rad,
        up_m,
    )


def shut(car: Pose) -> Pose:
    """Where the sheet is as long as the door is shut."""
    return in_car(car, HINGE_M - HALF_DOOR_M, 0.1 - CAR_HALF_WIDTH_M, up_m=ABOVE_M)


def car_with_door(car: Pose) -> list[ActorSpec]:
    """The parked car and its door, roles `parked` and `door`."""
    return [ActorSpec("parked", CAR, car), ActorSpec("door", SHEET, shut(car), on_ground=False)]


def opens_and_shuts(car: Pose, stays_s: float) -> InTurn:
    """The driver throws the door open, and pulls it shut again after a while."""
    swing = [step for open_deg in OPENS_DEG for step in (PutAt("door", door_at(car, open_deg)), Wait(FRAME_S))]
    return InTurn(
        OpenDoor("parked"), *swing, Wait(stays_s), PutAt("door", shut(car)), CloseDoor("parked"), name="the door"
    )
