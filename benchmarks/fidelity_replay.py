"""The same vehicle here: started from a recorded moment and fed with the recorded controls, frame by frame."""

import math
from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
from fidelity_tracks import F64, Track

from linden.blueprints.library import BlueprintLibrary
from linden.maps.ground import Ground
from linden.physics.bodies import Bodies
from linden.physics.contact.statics import Statics
from linden.physics.step import advance
from linden.protocol.values.control import VehicleControl
from linden.protocol.values.space import Rotation, Transform, Vector3D

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


class Double:
    """Our vehicle of a track's kind, alone on flat ground."""

    def __init__(self, track: Track) -> None:
        self.track = track
        self.bodies, self.ground, self.statics = Bodies(), Ground.flat(), Statics.none()
        model = LIBRARY.find(track.type_id).vehicle
        assert model is not None
        (x_m, y_m, _), yaw_rad = track.place_m[0], track.rotation_rad[0, 2]
        pose = Transform(Vector3D(x_m, y_m, 0.0), Rotation(yaw=math.degrees(yaw_rad)))
        self.slot = self.bodies.add_vehicle(model.physics, pose, track.box, model.wheel_offsets_m, model.undercarriage)

    def drive(self, k: int) -> None:
        """Drive from frame ``k`` to the next."""
        self.bodies.set_control(self.slot, control(self.track, k + 1))
        step_s = float(self.track.step_s[k])
        advance(self.bodies, self.ground, self.statics, step_s, max(1, math.ceil(step_s / SUBSTEP_S - 1e-9)))

    def lead(self, k: int) -> None:
        """Set place, motion and gear to those of frame ``k``; engine, springs, wheels and driver stay as they are."""
        state, track = self.bodies.state[self.slot], self.track
        yaw_rad, turn = track.rotation_rad[k, 2], track.turn_radps[k]
        across = turn * state["centre_of_mass"][0] * np.array([-math.sin(yaw_rad), math.cos(yaw_rad)])
        state["position"][:2], state["rotation"][1] = track.place_m[k, :2], yaw_rad
        state["velocity"][:2], state["angular_velocity"][2] = track.velocity_mps[k, :2] - across, turn
        state["resting"] = False
        gear = int(track.gear[k])
        if gear != state["gear"]:
            changing = track.gear[k:][track.gear[k:] != 0]
            state["gear"], state["target_gear"] = gear, gear or (changing[0] if len(changing) else 0)

    def row(self) -> tuple[float, ...]:
        """Return what a Run keeps of this moment."""
        s = self.bodies.state[self.slot]
        pitch_rad, yaw_rad, roll_rad = map(float, s["rotation"])
        speed_mps = s["velocity"][0] * math.cos(yaw_rad) + s["velocity"][1] * math.sin(yaw_rad)
        return (*s["position"], yaw_rad, speed_mps, s["angular_velocity"][2], s["gear"], pitch_rad, roll_rad)


def moments(track: Track) -> list[np.void]:
    """Return our vehicle as it is at every frame when it is led along the track: what windows start from.

    What no recording tells (the engine's speed, the springs, how far the pedals have followed) has then been worked
    out from all that was recorded until that frame.
    """
    double, found = Double(track), []
    for k in range(len(track.time_s)):
        double.lead(k)
        found.append(double.bodies.state[double.slot].copy())
        if k + 1 < len(track.time_s):
            double.drive(k)
    return found


def replay(track: Track, start: int, end: int, moment: np.void) -> Run:
    """Drive from frame ``start``, of which ``moment`` is one of :func:`moments`, to frame ``end``."""
    double = Double(track)
    double.bodies.state[double.slot] = moment
    rows = [double.row()]
    for k in range(start, end):
        double.drive(k)
        rows.append(double.row())
    columns = np.array(rows)
    return Run(start, columns[:, :3], *columns[:, 3:].T)
