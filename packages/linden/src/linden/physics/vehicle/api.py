"""Vehicle API of clients: controls, physics control, Ackermann targets, telemetry."""

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from linden.physics.columns import Columns, VehicleDesign, finite
from linden.physics.state import VEHICLE
from linden.physics.vehicle.controls import set_controls
from linden.physics.vehicle.parameters import (
    HULL_INERTIA,
    centre_of_mass,
    check,
    local_wheels,
    specification,
    world_wheels,
    yaw_inertia_kgm2,
)
from linden.physics.vehicle.powertrain import RPM_PER_RADPS
from linden.protocol.values.control import (
    AckermannControl,
    AckermannSettings,
    Undercarriage,
    VehicleControl,
    VehiclePhysicsControl,
    VehicleTelemetry,
    WheelTelemetry,
)
from linden.protocol.values.space import BoundingBox, Rotation, Transform, Vector3D

F64 = NDArray[np.float64]


class VehicleApi(Columns):
    """The part of the bodies that concerns vehicles. Slots given here must hold one."""

    def pose(self, slot: int) -> Transform:
        """Return where the actor's origin is, m and degrees."""
        location = Vector3D(*map(float, self.position[slot]))
        return Transform(location, Rotation(*(math.degrees(angle) for angle in self.rotation[slot])))

    # -- controls ------------------------------------------------------------------------------------------------------

    def set_control(self, slot: int, control: VehicleControl) -> None:
        """Set pedals, wheel and gear lever from now on; ends Ackermann control."""
        s = self.state
        s["throttle"][slot] = finite(control.throttle, 0.0, 1.0)
        s["steer"][slot] = finite(control.steer, -1.0, 1.0)
        s["brake"][slot] = finite(control.brake, 0.0, 1.0)
        s["hand_brake"][slot], s["reverse"][slot] = control.hand_brake, control.reverse
        s["manual_gear_shift"][slot] = control.manual_gear_shift
        s["gear_command"][slot] = max(-1, min(99, int(control.gear)))
        s["ackermann_on"][slot] = False
        s["controlled"][slot] = True

    def set_controls(self, slots: NDArray[np.integer], controls: F64) -> None:
        """Set many at once: ``controls`` (K, 7) in the order of VehicleControl's fields; the last of a slot holds."""
        set_controls(self.state, slots.astype(np.int32, copy=False), np.ascontiguousarray(controls))

    def control(self, slot: int) -> VehicleControl:
        """Return the control in force; ``gear`` is the one engaged, -1 in reverse, 0 while the gearbox changes."""
        s = self.state
        return VehicleControl(
            throttle=float(s["throttle"][slot]),
            steer=float(s["steer"][slot]),
            brake=float(s["brake"][slot]),
            hand_brake=bool(s["hand_brake"][slot]),
            reverse=bool(s["reverse"][slot]),
            manual_gear_shift=bool(s["manual_gear_shift"][slot]),
            gear=int(s["gear"][slot]),
        )

    def set_ackermann(self, slot: int, target: AckermannControl) -> None:
        """Drive towards a target from now on, until :meth:`set_control` is called."""
        s = self.state
        if not s["ackermann_on"][slot]:
            s["ackermann_memory"][slot] = 0.0
        s["ackermann"][slot] = [finite(value, -1e3, 1e3) for value in target]
        s["ackermann_on"][slot] = s["controlled"][slot] = True

    def set_sticky(self, slot: int, *, sticky: bool) -> None:
        """Let every control stay until the next (as at first), or act in one frame only."""
        self.state["sticky"][slot] = sticky

    def set_autopilot(self, slot: int, *, on: bool) -> None:
        """Note the kind of control of a vehicle; a change releases the pedals, unless a control came in this frame.

        After CARLA's AWheeledVehicleAIController: a client's own control goes before.
        """
        s = self.state
        if bool(s["autopilot"][slot]) == on:
            return
        s["autopilot"][slot] = on
        if not s["controlled"][slot]:
            s["throttle"][slot] = s["steer"][slot] = s["brake"][slot] = 0.0
            s["hand_brake"][slot] = s["reverse"][slot] = s["ackermann_on"][slot] = False

    def ackermann_settings(self, slot: int) -> AckermannSettings:
        """Return the gains of the two controllers."""
        return AckermannSettings(*map(float, self.state["ackermann_gains"][slot]))

    def set_ackermann_settings(self, slot: int, settings: AckermannSettings) -> None:
        """Set the gains of the two controllers."""
        self.state["ackermann_gains"][slot] = [finite(value, -1e6, 1e6) for value in settings]

    # -- what it is ----------------------------------------------------------------------------------------------------

    def physics_control(self, slot: int) -> VehiclePhysicsControl:
        """Return the vehicle's dynamics, with the wheels where they are now (cm, world)."""
        design = self.design(slot)
        return design.control._replace(wheels=world_wheels(design.control, self.pose(slot), design.offsets_m))

    def set_physics_control(self, slot: int, control: VehiclePhysicsControl) -> None:
        """Change the vehicle's dynamics while it drives; wheels at the world's origin stay where they are on it.

        Raises:
            Refusal: the physics control describes nothing that can drive, or changes the number of wheels.
        """
        design = self.design(slot)
        check(control, wheel_count=len(design.control.wheels))
        offsets_m = local_wheels(control, self.pose(slot), len(design.offsets_m)) or design.offsets_m
        self._fit(slot, control, offsets_m, design.undercarriage)

    def _fit(
        self, slot: int, control: VehiclePhysicsControl, offsets_m: Sequence[Vector3D], under: Undercarriage
    ) -> None:
        s = self.state
        box = BoundingBox(Vector3D(*map(float, s["box_centre"][slot])), Vector3D(*map(float, s["half_extent"][slot])))
        com_m = centre_of_mass(control, box, offsets_m, under)
        design = VehicleDesign(control, tuple(offsets_m), under, com_m)
        self.spec_of[slot] = self.table.row_of(design, lambda: specification(control, offsets_m, com_m, under))
        s["mass_kg"][slot] = control.mass
        s["yaw_inertia_kgm2"][slot] = HULL_INERTIA * yaw_inertia_kgm2(control.mass, box)
        s["centre_of_mass"][slot] = com_m
        s["target_gear"][slot] = min(s["target_gear"][slot], len(control.forward_gears))
        s["footing"][slot] = 0.0
        self.wake(slot)

    def _roll_along(self, slot: int) -> None:
        """Let the wheels roll with the body, in the lowest gear that suits, the engine with them."""
        s, spec = self.state, self.spec(slot)
        count = int(spec["wheel_count"])
        yaw = float(s["rotation"][slot, 1])
        ahead = float(s["velocity"][slot, 0] * math.cos(yaw) + s["velocity"][slot, 1] * math.sin(yaw))
        s["wheel_omega"][slot, :count] = ahead / spec["wheel_radius_m"][:count]
        radps = float(s["wheel_omega"][slot, :count].mean())
        gear = int(s["target_gear"][slot])
        if spec["autobox"] and gear > 0:
            use = radps * spec["gear_ratio"][: spec["gear_count"]] / spec["engine_max_radps"]
            fitting = np.flatnonzero(use <= spec["gear_up"][: spec["gear_count"]])
            gear = int(fitting[0]) + 1 if len(fitting) else int(spec["gear_count"])
            s["target_gear"][slot] = s["gear"][slot] = gear
            s["shift_left_s"][slot] = 0.0
        ratio = (0.0, *spec["gear_ratio"], spec["reverse_ratio"])[gear]
        s["engine_rpm"][slot] = np.clip(radps * ratio, 0.0, spec["engine_max_radps"]) * RPM_PER_RADPS

    # -- what it does --------------------------------------------------------------------------------------------------

    def wheel_steer_deg(self, slot: int, wheel: int) -> float:
        """Return the steering angle of one wheel, degrees, positive to the right."""
        return math.degrees(float(self.wheel_steer[slot, wheel]))

    def telemetry(self, slot: int) -> VehicleTelemetry:
        """Return speeds, forces and slips as they were at the end of the last step, in CARLA's units.

        As CARLA has it: the speed is the one forward, the lateral slip in degrees, a normalised force the size of the
        force over the wheel's load at rest, and the friction what the tyre finds here, not what it has of its own.
        """
        assert self.kind[slot] == VEHICLE
        s = self.state
        cosine, sine = math.cos(s["rotation"][slot, 1]), math.sin(s["rotation"][slot, 1])
        ahead = float(s["velocity"][slot, 0] * cosine + s["velocity"][slot, 1] * sine)
        return VehicleTelemetry(
            speed=ahead,
            steer=float(s["steer"][slot]),
            throttle=float(s["throttle"][slot]),
            brake=float(s["brake"][slot]),
            engine_rpm=float(s["engine_rpm"][slot]),
            gear=int(s["gear"][slot]),
            drag=float(self.spec(slot)["drag_kgpm"]) * ahead * ahead,
            wheels=self._wheels_telemetry(slot),
        )

    def _wheels_telemetry(self, slot: int) -> tuple[WheelTelemetry, ...]:
        """Return as many as the physics control has wheels; two that stand for one share its load and forces."""
        design = self.design(slot)
        wheels = tuple(self._wheel_telemetry(slot, k) for k in range(len(design.offsets_m)))
        if len(wheels) == len(design.control.wheels):
            return wheels
        return tuple(
            wheel._replace(
                tire_load=0.5 * wheel.tire_load,
                torque=0.5 * wheel.torque,
                long_force=0.5 * wheel.long_force,
                lat_force=0.5 * wheel.lat_force,
            )
            for wheel in wheels
            for _ in range(2)
        )

    def _wheel_telemetry(self, slot: int, k: int) -> WheelTelemetry:
        s, spec = self.state, self.spec(slot)
        load_n = float(s["wheel_load"][slot, k])
        rest_n = float(spec["load_share"][k]) * float(s["mass_kg"][slot]) * 9.81
        here = float(s["friction_here"][slot])
        long_n, lat_n = float(s["wheel_long_force"][slot, k]), float(s["wheel_lat_force"][slot, k])
        return WheelTelemetry(
            tire_friction=(float(spec["friction"][k]) if here < 0.0 else here) * float(s["road_friction"][slot]),
            lat_slip=math.degrees(float(s["wheel_lat_slip"][slot, k])),
            long_slip=float(s["wheel_long_slip"][slot, k]),
            omega=float(s["wheel_omega"][slot, k]),
            tire_load=load_n,
            normalized_tire_load=load_n / rest_n if rest_n > 0.0 else 0.0,
            torque=float(s["wheel_torque"][slot, k]),
            long_force=long_n,
            lat_force=lat_n,
            normalized_long_force=abs(long_n) / rest_n if rest_n > 0.0 else 0.0,
            normalized_lat_force=abs(lat_n) / rest_n if rest_n > 0.0 else 0.0,
        )
