"""All moving bodies of the world: slots that stay put, columns to read, and what a client may do to one of them."""

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

from linden.geometry import rotation_matrix
from linden.physics.columns import finite
from linden.physics.state import BODY, PROP, VEHICLE, WALKER, Rows
from linden.physics.vehicle.api import VehicleApi
from linden.physics.vehicle.parameters import check, default_wheel_offsets, local_wheels, yaw_inertia_kgm2
from linden.protocol.values.control import (
    UNKNOWN_UNDERCARRIAGE,
    AckermannSettings,
    Undercarriage,
    VehiclePhysicsControl,
    WalkerControl,
)
from linden.protocol.values.space import BoundingBox, Transform, Vector3D

FARTHEST_M = 1e7
"""No body gets further from the origin along any axis."""
_MOST_PUSH = 1e9  # N·s, N, N·m·s or N·m


class Bodies(VehicleApi):
    """Structure of arrays with stable slots; a freed slot is given out again, the lowest first.

    What only vehicles have (controls, physics control, telemetry) stands in ``vehicle.cockpit``. Numbers of a client
    may be anything: nan counts as 0 and the rest is held within limits, so that no body's state ever becomes nan.
    """

    # -- slots ---------------------------------------------------------------------------------------------------------

    def _add(self, kind: int, pose: Transform, box: BoundingBox, mass_kg: float) -> int:
        free = np.flatnonzero(~self.alive[: self.count])
        slot = int(free[0]) if len(free) else self.count
        if slot == len(self.alive):
            self.table.grow()
        self.table.counts[self.world] = max(self.count, slot + 1)
        self.state[slot] = np.zeros((), BODY)
        s = self.state
        s["alive"][slot] = s["simulate"][slot] = s["gravity"][slot] = s["collides"][slot] = True
        s["kind"][slot], s["mass_kg"][slot], s["support_mps2"][slot] = kind, mass_kg, 0.0
        s["road_friction"][slot], s["friction_here"][slot] = 1.0, -1.0
        s["sticky"][slot] = True
        s["box_centre"][slot] = box.location
        s["half_extent"][slot] = np.maximum(box.extent, 1e-3)
        s["ackermann_gains"][slot] = AckermannSettings()
        self.set_pose(slot, pose)
        return slot

    def add_vehicle(
        self,
        control: VehiclePhysicsControl,
        pose: Transform,
        box: BoundingBox,
        wheel_offsets_m: Sequence[Vector3D] | None = None,
        undercarriage: Undercarriage = UNKNOWN_UNDERCARRIAGE,
    ) -> int:
        """Add a vehicle at ``pose`` and return its slot.

        ``wheel_offsets_m``: contact points in the vehicle's frame (m), in the wheels' order, or of the front and the
        back wheel where the four of ``control`` stand for those of a two-wheeler; without it they are taken from
        ``control.wheels`` (cm, world), and where those all lie at the world's origin, from the box.

        Raises:
            Refusal: the physics control describes nothing that can drive.
        """
        check(control)
        if wheel_offsets_m is None:
            count = len(control.wheels)
            wheel_offsets_m = local_wheels(control, pose, count) or default_wheel_offsets(box, count)
        slot = self._add(VEHICLE, pose, box, control.mass)
        self._fit(slot, control, wheel_offsets_m, undercarriage)
        return slot

    def add_walker(self, pose: Transform, box: BoundingBox, mass_kg: float) -> int:
        """Add a walker and return its slot. Its origin is the middle of its body."""
        slot = self._add(WALKER, pose, box, mass_kg)
        self.state["yaw_inertia_kgm2"][slot] = math.inf
        return slot

    def add_prop(self, pose: Transform, box: BoundingBox, mass_kg: float | None) -> int:
        """Add a box that slides when it is hit, or with mass None one that nothing moves; return its slot."""
        slot = self._add(PROP, pose, box, mass_kg if mass_kg is not None else 1.0)
        self.state["immovable"][slot] = mass_kg is None
        self.state["yaw_inertia_kgm2"][slot] = yaw_inertia_kgm2(float(self.mass_kg[slot]), box)
        return slot

    def remove(self, slot: int) -> None:
        """Free a slot; its number is given out again."""
        self.state[slot], self.spec_of[slot] = np.zeros((), BODY), 0
        alive = np.flatnonzero(self.alive[: self.count])
        self.table.counts[self.world] = alive[-1] + 1 if len(alive) else 0

    # -- place and motion ----------------------------------------------------------------------------------------------

    def set_pose(self, slot: int, pose: Transform) -> None:
        """Put the actor there; it keeps its velocity (as CARLA does) and finds its footing anew."""
        s = self.state
        s["position"][slot] = [finite(x, -FARTHEST_M, FARTHEST_M) for x in pose.location]
        s["rotation"][slot] = [
            math.radians(math.remainder(angle, 360.0)) if math.isfinite(angle) else 0.0 for angle in pose.rotation
        ]
        s["footing"][slot] = 0.0
        s["velocity"][slot, 2] -= s["heave_mps"][slot]
        s["heave_mps"][slot] = 0.0
        s["tilt_radps"][slot] = 0.0
        s["tumbling"][slot] = False
        self.wake(slot)

    def set_poses(self, slots: NDArray[np.integer], poses: NDArray[np.float64]) -> None:
        """Put many actors somewhere as ``set_pose`` does: (K,) slots, each once; (K, 6) m, then degrees."""
        place_rows(self.state, slots, poses)

    def set_simulate(self, slot: int, *, simulate: bool) -> None:
        """Switch the physics of one body; without it the body stays where it is put, and others collide with it.

        A vehicle's wheels point straight ahead when it is switched, until they are steered or set (as CARLA does).
        """
        if bool(self.simulate[slot]) == simulate:
            return
        self.state["simulate"][slot] = simulate
        self.state["footing"][slot] = 0.0
        self.state["wheel_steer"][slot] = self.state["wheel_turned"][slot] = 0.0
        self.wake(slot)

    def set_gravity(self, slot: int, *, falls: bool) -> None:
        """Let a body fall, or float."""
        self.state["gravity"][slot] = falls
        self.wake(slot)

    def set_target_velocity(self, slot: int, velocity_mps: Sequence[float]) -> None:
        """Set the velocity of the origin, world frame; it changes from there on as forces will have it.

        A vehicle's wheels and engine then turn as if it had driven there at that speed.
        """
        self.state["velocity"][slot] = [finite(v, -1e3, 1e3) for v in velocity_mps]
        self.state["heave_mps"][slot] = 0.0
        if self.kind[slot] == VEHICLE:
            self._roll_along(slot)
        self.wake(slot)

    def set_target_angular_velocity(self, slot: int, angular_velocity_radps: Sequence[float]) -> None:
        """Set the angular velocity about the world's axes."""
        x, y, z = (finite(v, -1e2, 1e2) for v in angular_velocity_radps)
        yaw = float(self.rotation[slot, 1])
        self.state["angular_velocity"][slot] = (x, y, z)
        self.state["tilt_radps"][slot] = (
            x * math.sin(yaw) - y * math.cos(yaw),
            -x * math.cos(yaw) - y * math.sin(yaw),
        )
        self.wake(slot)

    def enable_constant_velocity(self, slot: int, local_mps: Sequence[float]) -> None:
        """Hold the velocity (in the body's own frame) from now on; a vehicle can still be steered."""
        self.state["constant_velocity"][slot] = [finite(v, -1e3, 1e3) for v in local_mps]
        self.state["constant_velocity_on"][slot] = True

    def disable_constant_velocity(self, slot: int) -> None:
        """Let forces have their way again."""
        self.state["constant_velocity_on"][slot] = False

    def add_impulse(self, slot: int, impulse_ns: Sequence[float], at_m: Sequence[float] | None = None) -> None:
        """Push once at the start of the next step: N·s in the world frame, at a point or the centre of mass."""
        self._add_push(slot, self.state["impulse"], self.state["angular_impulse"], impulse_ns, at_m)

    def add_force(self, slot: int, force_n: Sequence[float], at_m: Sequence[float] | None = None) -> None:
        """Push throughout the next advance: N in the world frame."""
        self._add_push(slot, self.state["force"], self.state["torque"], force_n, at_m)

    def add_angular_impulse(self, slot: int, impulse_nms: Sequence[float]) -> None:
        """Turn once: N·m·s about the world's axes."""
        self.state["angular_impulse"][slot] += [finite(v, -_MOST_PUSH, _MOST_PUSH) for v in impulse_nms]

    def add_torque(self, slot: int, torque_nm: Sequence[float]) -> None:
        """Turn throughout the next advance: N·m."""
        self.state["torque"][slot] += [finite(v, -_MOST_PUSH, _MOST_PUSH) for v in torque_nm]

    def _add_push(
        self,
        slot: int,
        linear: NDArray[np.float64],
        angular: NDArray[np.float64],
        push: Sequence[float],
        at_m: Sequence[float] | None,
    ) -> None:
        vector = np.array([finite(v, -_MOST_PUSH, _MOST_PUSH) for v in push])
        linear[slot] += vector
        if at_m is not None:
            arm = np.array([finite(v, -FARTHEST_M, FARTHEST_M) for v in at_m]) - self._mass_point(slot)
            angular[slot] += np.cross(arm, vector)

    def _mass_point(self, slot: int) -> NDArray[np.float64]:
        """Return where the centre of mass is, world, m."""
        arm = rotation_matrix(self.pose(slot).rotation) @ self.state["centre_of_mass"][slot]
        point: NDArray[np.float64] = self.position[slot] + arm
        return point

    # -- wheels, as they are seen --------------------------------------------------------------------------------------

    def point_wheel(self, slot: int, wheel: int, angle_deg: float) -> None:
        """Let a wheel of a vehicle without physics point ``angle_deg`` to the right."""
        self.state["wheel_steer"][slot, wheel] = math.radians(finite(angle_deg, -1e6, 1e6))

    def wheel_pitch_deg(self, slot: int, wheel: int) -> float:
        """Return how far a wheel has rolled, degrees; forward is negative, as Unreal's pitch has it."""
        return -math.degrees(float(self.wheel_turned[slot, wheel]))

    def roll_wheel(self, slot: int, wheel: int, angle_deg: float) -> None:
        """Turn a wheel of a vehicle without physics about its axle; forward is negative."""
        self.state["wheel_turned"][slot, wheel] = -math.radians(finite(angle_deg, -1e6, 1e6))

    # -- walkers -------------------------------------------------------------------------------------------------------

    def set_walker_control(self, slot: int, control: WalkerControl) -> None:
        """Tell a walker where to go, how fast, and whether to jump (once)."""
        s = self.state
        s["walker_direction"][slot] = [finite(x, -1e3, 1e3) for x in control.direction]
        s["walker_speed"][slot] = finite(control.speed, 0.0, 50.0)
        s["jump"][slot] = s["jump_pending"][slot] = bool(control.jump)

    def set_walker_courses(self, slots: NDArray[np.integer], yaws_deg: Sequence[float], speeds_mps: ArrayLike) -> None:
        """Let many walkers go straight on: (K,) slots, directions as yaws in degrees, and speeds in m/s."""
        s = self.state
        yaws_rad = [math.radians(yaw_deg) if math.isfinite(yaw_deg) else 0.0 for yaw_deg in yaws_deg]
        s["walker_direction"][slots] = [(math.cos(yaw_rad), math.sin(yaw_rad), 0.0) for yaw_rad in yaws_rad]
        s["walker_speed"][slots] = np.clip(np.nan_to_num(speeds_mps), 0.0, 50.0)
        s["jump"][slots] = s["jump_pending"][slots] = False

    def walker_control(self, slot: int) -> WalkerControl:
        """Return what the walker was told last."""
        direction = Vector3D(*map(float, self.walker_direction[slot]))
        return WalkerControl(direction, float(self.walker_speed[slot]), bool(self.jump[slot]))


def place_rows(s: Rows, rows: NDArray[np.integer], poses: NDArray[np.float64]) -> None:
    """Put the bodies of ``rows`` (K,) of ``s``, each once, at ``poses`` (K, 6): m, then degrees."""
    s["position"][rows] = np.clip(np.nan_to_num(poses[:, :3]), -FARTHEST_M, FARTHEST_M)
    turn_deg = np.fmod(np.where(np.isfinite(poses[:, 3:]), poses[:, 3:], 0.0), 360.0)
    s["rotation"][rows] = np.radians(turn_deg - 360.0 * (turn_deg > 180.0) + 360.0 * (turn_deg < -180.0))
    s["footing"][rows] = 0.0
    s["velocity"][rows, 2] -= s["heave_mps"][rows]
    s["heave_mps"][rows] = 0.0
    s["tilt_radps"][rows] = 0.0
    s["tumbling"][rows] = False
    s["resting"][rows] = False
