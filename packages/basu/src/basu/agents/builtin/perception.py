"""CARLA data for built-in agents: motion (`see_ego`), traffic lights (`Lights`), vehicle parameters (`read_facts`)."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from basu.agents.builtin.driving.controllers import DriveModel
from basu.agents.builtin.rules.stopping_lines import Light
from basu.agents.builtin.scene import DrivenVehicle, VehicleGeometry

if TYPE_CHECKING:
    from collections.abc import Iterable

    import carla


def see_ego(snapshot: carla.WorldSnapshot, own: carla.ActorSnapshot, applied: carla.VehicleControl) -> DrivenVehicle:
    """The driven vehicle of a snapshot; ``applied`` is its control in the last step, with gear and parking brake."""
    pose, velocity = own.get_transform(), own.get_velocity()
    yaw_rad = math.radians(pose.rotation.yaw)
    speed_mps = velocity.x * math.cos(yaw_rad) + velocity.y * math.sin(yaw_rad)
    place = pose.location
    gear, parked = applied.gear, applied.hand_brake
    return DrivenVehicle(snapshot.timestamp.elapsed_seconds, place.x, place.y, yaw_rad, speed_mps, gear, parked)


class Lights:
    """The traffic lights on the way, by the id of their OpenDRIVE signal."""

    def __init__(self, world: carla.World, landmark_ids: Iterable[str]) -> None:
        found = {landmark_id: world.get_traffic_light_from_opendrive_id(landmark_id) for landmark_id in landmark_ids}
        self._actors = {landmark_id: actor for landmark_id, actor in found.items() if actor is not None}

    def shows(self, landmark_id: str) -> Light:
        """What a light shows; one that the server does not have is dark."""
        actor = self._actors.get(landmark_id)
        return Light.DARK if actor is None else _LIGHT_OF_NAME.get(str(actor.get_state()), Light.DARK)


_LIGHT_OF_NAME = {"Green": Light.GREEN, "Yellow": Light.YELLOW, "Red": Light.RED}


SHUTTLE = "vehicle.easymile.ez10"
# the operators' figures for the shuttle in Linden: never above 15 mph (St. Stephen's Community House; govlaunch)
SHUTTLE_TOP_MPS = 15 * 0.44704
OTHERS_TOP_MPS = 25.0  # the agent is made for streets
TYRES_MPS2 = 9.0  # more than this no brake gives, whatever its torque
GAIN_SPEEDS_MPS = tuple(float(v) for v in range(0, 41, 2))
USUAL_WHEELBASE_SHARE = 0.6  # of the length, for a server that does not tell where the wheels are


class Steering(NamedTuple):
    """What the wheel does: ``steer = 1`` turns the front wheels by ``full_rad`` times a factor for the speed."""

    full_rad: float
    speeds_kmh: tuple[float, ...]
    factors: tuple[float, ...]

    def command(self, angle_rad: float, speed_mps: float) -> float:
        """CARLA's steer in [-1, 1] for an angle of the front wheels."""
        factor = float(np.interp(3.6 * abs(speed_mps), self.speeds_kmh, self.factors)) if self.factors else 1.0
        return max(-1.0, min(1.0, angle_rad / max(self.full_rad * factor, 0.05)))


class VehicleFacts(NamedTuple):
    """All that is known of a vehicle."""

    body: VehicleGeometry
    model: DriveModel
    steering: Steering
    top_mps: float


def read_facts(vehicle: carla.Vehicle, pose: carla.Transform) -> VehicleFacts:
    """Read the server's data once; ``pose`` is the vehicle's at this moment, the frame of the wheels' places."""
    control = vehicle.get_physics_control()
    box = vehicle.bounding_box
    front_x_m, rear_x_m = _axles_m(control, pose, box)
    curve = [(float(p.x), float(p.y)) for p in control.steering_curve]
    full_deg = max((float(wheel.max_steer_angle) for wheel in control.wheels), default=70.0)
    return VehicleFacts(
        VehicleGeometry(
            wheelbase_m=front_x_m - rear_x_m,
            rear_axle_m=max(-rear_x_m, 0.3),
            front_m=float(box.location.x + box.extent.x),
            rear_m=float(box.extent.x - box.location.x),
            half_width_m=float(box.extent.y),
        ),
        _drive_model(control),
        Steering(math.radians(full_deg), tuple(x for x, _ in curve), tuple(y for _, y in curve)),
        SHUTTLE_TOP_MPS if vehicle.type_id == SHUTTLE else OTHERS_TOP_MPS,
    )


def _axles_m(
    control: carla.VehiclePhysicsControl, pose: carla.Transform, box: carla.BoundingBox
) -> tuple[float, float]:
    """How far the front and the rear axle lie ahead of the vehicle's origin (the rear one: negative)."""
    yaw_rad = math.radians(pose.rotation.yaw)
    ahead_m = sorted(
        (0.01 * wheel.position.x - pose.location.x) * math.cos(yaw_rad)
        + (0.01 * wheel.position.y - pose.location.y) * math.sin(yaw_rad)
        for wheel in control.wheels
    )
    half = len(ahead_m) // 2
    if half:
        rear_m, front_m = sum(ahead_m[:half]) / half, sum(ahead_m[-half:]) / half
        if 0.5 < front_m - rear_m < 2.2 * box.extent.x and abs(front_m + rear_m) < box.extent.x:
            return front_m, rear_m
    half_base_m = USUAL_WHEELBASE_SHARE * float(box.extent.x)
    return half_base_m, -half_base_m


def _drive_model(control: carla.VehiclePhysicsControl) -> DriveModel:
    """Full pedals in m/s²: the engine in the gear that pulls best at each speed, all brakes together."""
    radius_m = 0.01 * float(np.mean([wheel.radius for wheel in control.wheels]))
    mass_kg = max(float(control.mass), 1.0)
    rpms, torques_nm = [float(p.x) for p in control.torque_curve], [float(p.y) for p in control.torque_curve]
    ratios = [float(g.ratio) * float(control.final_ratio) for g in control.forward_gears if g.ratio > 0.0]

    def pull_mps2(speed_mps: float) -> float:
        turns_rpm = speed_mps / radius_m * 60.0 / math.tau
        forces_n = [
            float(np.interp(turns_rpm * ratio, rpms, torques_nm)) * ratio / radius_m
            for ratio in ratios
            if turns_rpm * ratio <= control.max_rpm
        ]
        return max(forces_n, default=0.0) / mass_kg

    brake_mps2 = sum(float(wheel.max_brake_torque) for wheel in control.wheels) / radius_m / mass_kg
    return DriveModel(
        GAIN_SPEEDS_MPS, tuple(pull_mps2(v) for v in GAIN_SPEEDS_MPS), min(max(brake_mps2, 0.5), TYRES_MPS2)
    )
