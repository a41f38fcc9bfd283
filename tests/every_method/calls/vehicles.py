"""carla.Vehicle: control, physics, doors, lamps, wheels, telemetry."""

import carla
import pytest

from every_method.call import Call
from every_method.calls.actors import after, passing
from every_method.calls.traffic_manager import manager
from every_method.stage import Stage

FRONT_LEFT = carla.VehicleWheelLocation.FL_Wheel
LAMPS = carla.VehicleLightState(carla.VehicleLightState.Position | carla.VehicleLightState.LowBeam)


def at_rest(stage: Stage) -> carla.Vehicle:
    """A car that nobody has moved."""
    return stage.once("at rest", lambda: stage.spawn("vehicle.tesla.model3", 40))


def heavier(stage: Stage) -> bool:
    """Whether a vehicle takes another mass."""
    physics = stage.vehicle.get_physics_control()
    physics.mass = 2000.0
    stage.vehicle.apply_physics_control(physics)
    with stage.aside():
        return stage.vehicle.get_physics_control().mass == pytest.approx(2000.0)


def retuned(stage: Stage) -> bool:
    """Whether the controllers behind Ackermann control take other gains."""
    stage.vehicle.apply_ackermann_controller_settings(carla.AckermannControllerSettings(speed_kp=0.5))
    with stage.aside():
        return stage.vehicle.get_ackermann_controller_settings().speed_kp == pytest.approx(0.5)


def lit(stage: Stage) -> bool:
    """Whether lamps are switched on."""
    stage.vehicle.set_light_state(LAMPS)
    stage.tick(1)
    with stage.aside():
        return stage.vehicle.get_light_state() == LAMPS


def shown(stage: Stage) -> carla.Vehicle:
    """A car in a show room: only without physics do wheels turn by order."""

    def make() -> carla.Vehicle:
        found = stage.spawn("vehicle.audi.tt", 10)
        found.set_simulate_physics(False)
        stage.tick(1)
        return found

    return stage.once("shown", make)


def raised(stage: Stage) -> bool:
    """Whether a wheel's pitch is kept."""
    shown(stage).set_wheel_pitch_angle(FRONT_LEFT, 10.0)
    stage.tick(1)
    with stage.aside():
        return shown(stage).get_wheel_pitch_angle(FRONT_LEFT) == pytest.approx(10.0, abs=0.01)


CALLS: dict[str, Call] = {
    "Vehicle.__str__": lambda s: "vehicle.lincoln.mkz_2020" in str(s.vehicle),
    "Vehicle.bounding_box": lambda s: s.vehicle.bounding_box.extent.y > 0.5,
    "Vehicle.apply_control": lambda s: after(
        s,
        lambda: s.vehicle.apply_control(carla.VehicleControl(brake=1.0)),
        lambda: s.vehicle.get_control().brake == 1.0,
    ),
    "Vehicle.get_control": lambda s: s.vehicle.get_control().brake == 1.0,
    "Vehicle.apply_ackermann_control": lambda s: after(
        s,
        lambda: at_rest(s).apply_ackermann_control(carla.VehicleAckermannControl(speed=20.0, acceleration=3.0)),
        lambda: at_rest(s).get_control().throttle > 0.0,
    ),
    "Vehicle.get_ackermann_controller_settings": lambda s: (
        s.vehicle.get_ackermann_controller_settings().speed_kp == pytest.approx(0.15)
    ),
    "Vehicle.apply_ackermann_controller_settings": retuned,
    "Vehicle.get_physics_control": lambda s: 1000.0 < s.vehicle.get_physics_control().mass < 3000.0,
    "Vehicle.apply_physics_control": heavier,
    "Vehicle.get_telemetry_data": lambda s: len(s.vehicle.get_telemetry_data().wheels) == 4,
    "Vehicle.show_debug_telemetry": lambda s: s.vehicle.show_debug_telemetry(True),
    "Vehicle.open_door": lambda s: s.vehicle.open_door(carla.VehicleDoor.FL),
    "Vehicle.close_door": lambda s: s.vehicle.close_door(carla.VehicleDoor.All),
    "Vehicle.set_light_state": lit,
    "Vehicle.get_light_state": lambda s: s.vehicle.get_light_state() == LAMPS,
    "Vehicle.get_failure_state": lambda s: s.vehicle.get_failure_state() == carla.VehicleFailureState.NONE,
    "Vehicle.get_speed_limit": lambda s: 10.0 <= s.vehicle.get_speed_limit() <= 100.0,
    "Vehicle.is_at_traffic_light": lambda s: s.vehicle.is_at_traffic_light() is False,
    "Vehicle.get_traffic_light": lambda s: s.vehicle.get_traffic_light() is None,
    "Vehicle.get_traffic_light_state": lambda s: s.vehicle.get_traffic_light_state() == carla.TrafficLightState.Green,
    "Vehicle.get_wheel_steer_angle": lambda s: abs(s.vehicle.get_wheel_steer_angle(FRONT_LEFT)) < 1.0,
    "Vehicle.set_wheel_steer_direction": lambda s: shown(s).set_wheel_steer_direction(FRONT_LEFT, 5.0),
    "Vehicle.get_wheel_pitch_angle": lambda s: abs(s.vehicle.get_wheel_pitch_angle(FRONT_LEFT)) <= 360.0,
    "Vehicle.set_wheel_pitch_angle": raised,
    "Vehicle.get_vehicle_bone_world_transforms": lambda s: len(s.vehicle.get_vehicle_bone_world_transforms()) >= 4,
    "Vehicle.set_autopilot": lambda s: passing(s).set_autopilot(False, manager(s).get_port()),
    "Vehicle.enable_carsim": lambda s: s.vehicle.enable_carsim("car.sim"),
    "Vehicle.use_carsim_road": lambda s: s.vehicle.use_carsim_road(True),
    "Vehicle.enable_chrono_physics": lambda s: s.vehicle.enable_chrono_physics(5000, 0.002, "v", "p", "t", "b"),
    "Vehicle.restore_physx_physics": lambda s: s.vehicle.restore_physx_physics(),
}
