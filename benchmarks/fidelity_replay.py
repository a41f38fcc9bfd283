"""The same vehicle here: started from a recorded moment and fed with the recorded controls, frame by frame."""

import math
from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
from fidelity_tracks import F64, Track

from linden.ground import Ground
from linden.physics.bodies import Bodies
from linden.physics.contact.statics import Statics
from linden.physics.step import advance
from linden.values.space import Rotation, Transform, Vector3D
from linden.values.vehicles import VehicleControl
from linden.world.blueprints import BlueprintLibrary

LIBRARY = BlueprintLibrary.load()
SUBSTEP_S = 0.01  # CARLA's own setting, max_substep_delta_time
EVERY_S = 0.5  # a window starts this often
HORIZONS_S = (1.0, 5.0, 10.0)
LEAST_TRAVEL_M = 0.1  # who stands for the whole window says nothing about driving
FALLING_MPS = 0.05  # who still bounces from being dropped into the world is not driving yet


class Run(NamedTuple):
    """What a vehicle did here from frame ``start`` of a track on; arrays of M frames from that on, m, m/s, rad."""

    start: int
    place_m: F64  # (M, 3)
    yaw_rad: F64
    speed_mps: F64  # of the centre of mass, along the heading
    turn_radps: F64
    gear: F64
    pitch_rad: F64
    roll_rad: F64


def starts(track: Track) -> Iterator[int]:
    """Yield the frames at which windows start: every half second of what the vehicle spends driving."""
    next_s = -math.inf
    for k in range(len(track.time_s)):
        if track.time_s[k] >= next_s and abs(track.velocity_mps[k, 2]) < FALLING_MPS:
            next_s = track.time_s[k] + EVERY_S
            yield k


def last_frame(track: Track, start: int, horizon_s: float) -> int | None:
    """Return the first frame at least ``horizon_s`` after ``start``; None where there is none or nobody moved."""
    end = int(np.searchsorted(track.time_s, track.time_s[start] + horizon_s))
    if end >= len(track.time_s):
        return None
    travel_m = np.linalg.norm(track.place_m[start : end + 1] - track.place_m[start], axis=1).max()
    return end if travel_m >= LEAST_TRAVEL_M else None


def control(track: Track, k: int) -> VehicleControl:
    """Return the controls of frame ``k``; gears are the automatic's, but reverse is the driver's."""
    return VehicleControl(
        throttle=float(track.throttle[k]),
        steer=float(track.steer[k]),
        brake=float(track.brake[k]),
        hand_brake=bool(track.hand_brake[k]),
        reverse=bool(track.gear[k] < 0),
    )


def replay(track: Track, start: int, end: int) -> Run:
    """Drive from frame ``start`` to frame ``end`` on flat ground."""
    bodies, ground, statics = Bodies(), Ground.flat(), Statics.none()
    slot = _put(bodies, track, start)
    rows = [_row(bodies, slot)]
    for k in range(start, end):
        bodies.set_control(slot, control(track, k))
        step_s = float(track.step_s[k])
        advance(bodies, ground, statics, step_s, max(1, math.ceil(step_s / SUBSTEP_S - 1e-9)))
        rows.append(_row(bodies, slot))
    columns = np.array(rows)
    return Run(start, columns[:, :3], *columns[:, 3:].T)


def _put(bodies: Bodies, track: Track, start: int) -> int:
    """Add the vehicle as it was at a frame: place, motion, gear."""
    model = LIBRARY.find(track.type_id).vehicle
    roll_deg, pitch_deg, yaw_deg = np.degrees(track.rotation_rad[start])
    x_m, y_m, _ = track.place_m[start]
    pose = Transform(Vector3D(x_m, y_m, 0.0), Rotation(pitch_deg, yaw_deg, roll_deg))
    slot = bodies.add_vehicle(model.physics, pose, track.box, model.wheel_offsets_m)
    bodies.set_control(slot, control(track, start))
    advance(bodies, Ground.flat(), Statics.none(), 1e-6)  # finds its footing
    gear = int(track.gear[start])
    bodies.state["target_gear"][slot] = bodies.state["gear"][slot] = gear or 1
    ahead_m = bodies.state["centre_of_mass"][slot, 0]
    yaw_rad, turn = track.rotation_rad[start, 2], track.turn_radps[start]
    of_origin = track.velocity_mps[start, :2] - turn * ahead_m * np.array([-math.sin(yaw_rad), math.cos(yaw_rad)])
    bodies.set_target_angular_velocity(slot, (0.0, 0.0, turn))
    bodies.set_target_velocity(slot, (*of_origin, 0.0))
    return slot


def _row(bodies: Bodies, slot: int) -> tuple[float, ...]:
    s = bodies.state[slot]
    yaw_rad = float(s["rotation"][1])
    speed_mps = s["velocity"][0] * math.cos(yaw_rad) + s["velocity"][1] * math.sin(yaw_rad)
    return (
        *s["position"],
        yaw_rad,
        speed_mps,
        s["angular_velocity"][2],
        s["gear"],
        s["rotation"][0],
        s["rotation"][2],
    )
