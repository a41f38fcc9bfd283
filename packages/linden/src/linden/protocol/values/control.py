"""Values that clients send to vehicles and walkers and read from vehicles.

Source: ``carla/rpc/Vehicle*.h`` and ``carla/rpc/WalkerControl.h``; units as in CARLA's Python API reference.
"""

from typing import NamedTuple

from linden.protocol.values.space import Vector2D, Vector3D


class VehicleControl(NamedTuple):
    """The driver's feet and hands: throttle and brake in [0, 1], steer in [-1, 1], positive to the right."""

    throttle: float = 0.0
    steer: float = 0.0
    brake: float = 0.0
    hand_brake: bool = False
    reverse: bool = False
    manual_gear_shift: bool = False
    gear: int = 0


class AckermannControl(NamedTuple):
    """A target motion: steer in rad (positive right), rad/s, m/s, m/s², m/s³."""

    steer: float = 0.0
    steer_speed: float = 0.0
    speed: float = 0.0
    acceleration: float = 0.0
    jerk: float = 0.0


class AckermannSettings(NamedTuple):
    """Gains of the two PID controllers behind Ackermann control. Defaults: ``AckermannController.h`` of CARLA."""

    speed_kp: float = 0.15
    speed_ki: float = 0.0
    speed_kd: float = 0.25
    accel_kp: float = 0.01
    accel_ki: float = 0.0
    accel_kd: float = 0.01


class Gear(NamedTuple):
    """One forward gear; it is left downwards below ``down_ratio`` and upwards above ``up_ratio`` of max_rpm."""

    ratio: float = 1.0
    down_ratio: float = 0.5
    up_ratio: float = 0.65


class Wheel(NamedTuple):
    """One wheel. Radius and position are in **cm**, the position in the world frame; N·m; degrees."""

    tire_friction: float = 2.0
    damping_rate: float = 0.25
    max_steer_angle: float = 70.0
    radius: float = 30.0
    max_brake_torque: float = 1500.0
    max_handbrake_torque: float = 3000.0
    lat_stiff_max_load: float = 2.0
    lat_stiff_value: float = 17.0
    long_stiff_value: float = 1000.0
    position: Vector3D = Vector3D()


class VehiclePhysicsControl(NamedTuple):
    """Everything about a vehicle's dynamics that a client may read and set. Wheels: FL, FR, BL, BR."""

    torque_curve: tuple[Vector2D, ...] = (Vector2D(0.0, 500.0), Vector2D(5000.0, 500.0))  # rpm -> N·m
    max_rpm: float = 5000.0
    moi: float = 1.0  # kg·m², of the engine
    damping_rate_full_throttle: float = 0.15
    damping_rate_zero_throttle_clutch_engaged: float = 2.0
    damping_rate_zero_throttle_clutch_disengaged: float = 0.35
    use_gear_autobox: bool = True
    gear_switch_time: float = 0.5  # s
    clutch_strength: float = 10.0
    final_ratio: float = 4.0
    forward_gears: tuple[Gear, ...] = ()
    mass: float = 1000.0  # kg
    drag_coefficient: float = 0.3
    center_of_mass: Vector3D = Vector3D()  # m, offset in the vehicle's frame
    steering_curve: tuple[Vector2D, ...] = (Vector2D(0.0, 1.0), Vector2D(10.0, 0.5))  # km/h -> fraction
    wheels: tuple[Wheel, ...] = ()
    use_sweep_wheel_collision: bool = False


class Undercarriage(NamedTuple):
    """What CARLA's vehicle blueprints hold besides the physics control, which has no fields for it.

    ``sway_m``: how far below the centre of mass the tyres push (Unreal's suspension force offset), which is what the
    body leans by; None: from the ground. ``hull_x_m``: the middle of the hull in the vehicle's frame, to which
    ``center_of_mass`` is added; None: that of its box. ``reverse_ratio``: that of PhysX by default. ``tyres_lag``:
    whether the wheels turn by the tyres' torque of the moment before, as CARLA's do, or by that of the same moment.
    """

    sway_m: float | None = None
    hull_x_m: float | None = None
    reverse_ratio: float = -4.0
    tyres_lag: bool = False


UNKNOWN_UNDERCARRIAGE = Undercarriage()


class WheelTelemetry(NamedTuple):
    """One wheel's forces and slips, N, N·m, rad/s."""

    tire_friction: float = 0.0
    lat_slip: float = 0.0
    long_slip: float = 0.0
    omega: float = 0.0
    tire_load: float = 0.0
    normalized_tire_load: float = 0.0
    torque: float = 0.0
    long_force: float = 0.0
    lat_force: float = 0.0
    normalized_long_force: float = 0.0
    normalized_lat_force: float = 0.0


class VehicleTelemetry(NamedTuple):
    """What drives the vehicle now: m/s, rpm, N."""

    speed: float = 0.0
    steer: float = 0.0
    throttle: float = 0.0
    brake: float = 0.0
    engine_rpm: float = 0.0
    gear: int = 0
    drag: float = 0.0
    wheels: tuple[WheelTelemetry, ...] = ()


class WalkerControl(NamedTuple):
    """Unit direction in the world, speed in m/s, and whether to jump."""

    direction: Vector3D = Vector3D(1.0, 0.0, 0.0)
    speed: float = 0.0
    jump: bool = False
