"""Controls, physics and telemetry of vehicles and walkers, as the values a script holds."""

import carla

from every_method.call import Call
from every_method.entries import comparisons, fields, vector


def control() -> carla.VehicleControl:
    """Feet and hands, all moved."""
    return carla.VehicleControl(0.5, -0.25, 0.125, hand_brake=True, reverse=True, manual_gear_shift=True, gear=2)


def ackermann() -> carla.VehicleAckermannControl:
    """A target motion."""
    return carla.VehicleAckermannControl(0.1, 0.2, 3.0, 4.0, 5.0)


def gains() -> carla.AckermannControllerSettings:
    """Gains of which none is the default."""
    return carla.AckermannControllerSettings(1.0, 2.0, 3.0, 4.0, 5.0, 6.0)


def gear() -> carla.GearPhysicsControl:
    """A gear."""
    return carla.GearPhysicsControl(ratio=3.0, down_ratio=0.25, up_ratio=0.75)


def wheel() -> carla.WheelPhysicsControl:
    """A wheel of which only the friction is not the default."""
    return carla.WheelPhysicsControl(tire_friction=2.5)


def physics() -> carla.VehiclePhysicsControl:
    """An engine of which only mass, gears and wheels are not the default."""
    return carla.VehiclePhysicsControl(mass=1500.0, forward_gears=[gear()], wheels=[wheel()] * 4)


def wheel_telemetry() -> carla.WheelTelemetryData:
    """What a wheel feels."""
    return carla.WheelTelemetryData(**WHEEL_TELEMETRY)


def telemetry() -> carla.VehicleTelemetryData:
    """What moves a vehicle."""
    return carla.VehicleTelemetryData(
        speed=1.0, steer=0.25, throttle=0.5, brake=0.75, engine_rpm=900.0, gear=3, drag=2.0
    )


WHEEL_TELEMETRY = {
    "tire_friction": 1.0,
    "lat_slip": 2.0,
    "long_slip": 3.0,
    "omega": 4.0,
    "tire_load": 5.0,
    "normalized_tire_load": 6.0,
    "torque": 7.0,
    "long_force": 8.0,
    "lat_force": 9.0,
    "normalized_long_force": 10.0,
    "normalized_lat_force": 11.0,
}

CALLS: dict[str, Call] = {
    "VehicleControl.__init__": lambda _: carla.VehicleControl(steer=0.5).throttle == 0.0,
    **fields(
        "VehicleControl",
        lambda _: control(),
        throttle=0.5,
        steer=-0.25,
        brake=0.125,
        hand_brake=True,
        reverse=True,
        manual_gear_shift=True,
        gear=2,
    ),
    **comparisons("VehicleControl", control, carla.VehicleControl),
    "VehicleAckermannControl.__init__": lambda _: carla.VehicleAckermannControl(speed=2.0).steer == 0.0,
    **fields(
        "VehicleAckermannControl",
        lambda _: ackermann(),
        steer=0.1,
        steer_speed=0.2,
        speed=3.0,
        acceleration=4.0,
        jerk=5.0,
    ),
    **comparisons("VehicleAckermannControl", ackermann, carla.VehicleAckermannControl),
    "AckermannControllerSettings.__init__": lambda _: carla.AckermannControllerSettings(speed_kp=1.0).speed_kp == 1.0,
    **fields(
        "AckermannControllerSettings",
        lambda _: gains(),
        speed_kp=1.0,
        speed_ki=2.0,
        speed_kd=3.0,
        accel_kp=4.0,
        accel_ki=5.0,
        accel_kd=6.0,
    ),
    **comparisons("AckermannControllerSettings", gains, carla.AckermannControllerSettings),
    "GearPhysicsControl.__init__": lambda _: carla.GearPhysicsControl().down_ratio == 0.5,
    **fields("GearPhysicsControl", lambda _: gear(), ratio=3.0, down_ratio=0.25, up_ratio=0.75),
    **comparisons("GearPhysicsControl", gear, carla.GearPhysicsControl),
    "WheelPhysicsControl.__init__": lambda _: carla.WheelPhysicsControl().tire_friction == 2.0,
    **fields(
        "WheelPhysicsControl",
        lambda _: wheel(),
        tire_friction=2.5,
        damping_rate=0.25,
        max_steer_angle=70.0,
        radius=30.0,
        max_brake_torque=1500.0,
        max_handbrake_torque=3000.0,
        position=carla.Vector3D(),
        long_stiff_value=1000.0,
        lat_stiff_max_load=2.0,
        lat_stiff_value=17.0,
    ),
    **comparisons("WheelPhysicsControl", wheel, carla.WheelPhysicsControl),
    "VehiclePhysicsControl.__init__": lambda _: carla.VehiclePhysicsControl(mass=2.0).max_rpm == 5000.0,
    **fields(
        "VehiclePhysicsControl",
        lambda _: physics(),
        max_rpm=5000.0,
        moi=1.0,
        damping_rate_full_throttle=0.15,
        damping_rate_zero_throttle_clutch_engaged=2.0,
        damping_rate_zero_throttle_clutch_disengaged=0.35,
        use_gear_autobox=True,
        gear_switch_time=0.5,
        clutch_strength=10.0,
        final_ratio=4.0,
        mass=1500.0,
        drag_coefficient=0.3,
        center_of_mass=carla.Vector3D(),
        use_sweep_wheel_collision=False,
        forward_gears=lambda gears: list(gears) == [gear()],
        wheels=lambda wheels: list(wheels) == [wheel()] * 4,
        torque_curve=lambda curve: [(point.x, point.y) for point in curve] == [(0.0, 500.0), (5000.0, 500.0)],
        steering_curve=lambda curve: [(point.x, point.y) for point in curve] == [(0.0, 1.0), (10.0, 0.5)],
    ),
    **comparisons("VehiclePhysicsControl", physics, carla.VehiclePhysicsControl),
    "WheelTelemetryData.__init__": lambda _: carla.WheelTelemetryData(omega=2.0).omega == 2.0,
    **fields("WheelTelemetryData", lambda _: wheel_telemetry(), **WHEEL_TELEMETRY),
    **comparisons("WheelTelemetryData", wheel_telemetry, carla.WheelTelemetryData),
    "VehicleTelemetryData.__init__": lambda _: carla.VehicleTelemetryData().gear == 0,
    **fields(
        "VehicleTelemetryData",
        lambda _: telemetry(),
        speed=1.0,
        steer=0.25,
        throttle=0.5,
        brake=0.75,
        engine_rpm=900.0,
        gear=3,
        drag=0.0,  # what the constructor is told of it, the client forgets
        wheels=lambda wheels: len(wheels) == 0,
    ),
    **comparisons("VehicleTelemetryData", telemetry, carla.VehicleTelemetryData),
    "WalkerControl.__init__": lambda _: carla.WalkerControl(speed=1.4).jump is False,
    **fields(
        "WalkerControl",
        lambda _: carla.WalkerControl(carla.Vector3D(y=1.0), 1.5, jump=True),
        direction=carla.Vector3D(y=1.0),
        speed=1.5,
        jump=True,
    ),
    **comparisons("WalkerControl", lambda: carla.WalkerControl(speed=1.4), carla.WalkerControl),
    **vector("vector_of_gears", lambda _: carla.vector_of_gears(), gear),
    **vector("vector_of_wheels", lambda _: carla.vector_of_wheels(), wheel),
    **vector("vector_of_wheels_telemetry", lambda _: carla.vector_of_wheels_telemetry(), wheel_telemetry),
    **vector("vector_of_vector2D", lambda _: carla.vector_of_vector2D(), carla.Vector2D),
    **vector("vector_of_transform", lambda _: carla.vector_of_transform(), carla.Transform),
    **vector("vector_of_ints", lambda _: carla.vector_of_ints(), lambda: 7),
    **vector("vector_of_bones", lambda _: carla.vector_of_bones(), carla.bone_transform),
    **vector("vector_of_bones_out", lambda _: carla.vector_of_bones_out(), carla.bone_transform_out),
}
