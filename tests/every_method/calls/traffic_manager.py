"""carla.TrafficManager: it lives in the client, and drives by batches of commands."""

from typing import Any

import carla

from every_method.call import Call
from every_method.entries import missing
from every_method.stage import Stage

PORT = 8030
OF_ITS_THREAD = ("apply_batch", "get_actor_bounding_box", "get_vehicle_light_states", "get_weather_parameters")


def manager(stage: Stage) -> carla.TrafficManager:
    """A Traffic Manager in step with the server, with two cars to drive."""

    def make() -> carla.TrafficManager:
        stage.forget_from_now_on("get_episode_settings")  # its thread asks whether time still goes in steps
        found = stage.client.get_trafficmanager(PORT)
        found.set_synchronous_mode(True)
        found.set_random_device_seed(1)
        for actor in (car(stage), other(stage)):
            actor.set_autopilot(True, PORT)
        stage.tick(3)
        return found

    return stage.once("traffic manager", make)


def car(stage: Stage) -> carla.Vehicle:
    """One that is driven."""
    return stage.once("driven", lambda: stage.spawn("vehicle.tesla.model3", 12))


def other(stage: Stage) -> carla.Vehicle:
    """Another one."""
    return stage.once("driven too", lambda: stage.spawn("vehicle.audi.a2", 14))


def for_car(name: str, *values: Any) -> Call:
    """Return a call of a function that takes a vehicle."""
    return lambda s: getattr(manager(s), name)(car(s), *values)


def for_all(name: str, *values: Any) -> Call:
    """Return a call of a function about all vehicles."""
    return lambda s: getattr(manager(s), name)(*values)


def shut_down(stage: Stage) -> None:
    """End a Traffic Manager, not the one that others need."""
    stage.forget(*OF_ITS_THREAD)  # whether it has made its first step by then is a matter of the load
    ending = stage.once("ending", lambda: stage.client.get_trafficmanager(PORT + 1))
    ending.shut_down()


def drives(stage: Stage) -> bool:
    """Whether a car is under way after a second; the first call of the table, for the rest is asked of a moving car."""
    assert manager(stage).get_port() == PORT
    stage.tick(30)
    return bool(car(stage).get_velocity().length() > 0.1 or other(stage).get_velocity().length() > 0.1)


CALLS: dict[str, Call] = {
    "TrafficManager.get_port": drives,
    "TrafficManager.auto_lane_change": for_car("auto_lane_change", False),
    "TrafficManager.collision_detection": lambda s: manager(s).collision_detection(car(s), other(s), False),
    "TrafficManager.distance_to_leading_vehicle": for_car("distance_to_leading_vehicle", 3.0),
    "TrafficManager.force_lane_change": for_car("force_lane_change", True),
    "TrafficManager.global_lane_offset": for_all("global_lane_offset", 0.1),
    "TrafficManager.global_percentage_speed_difference": for_all("global_percentage_speed_difference", 20.0),
    "TrafficManager.ignore_lights_percentage": for_car("ignore_lights_percentage", 100.0),
    "TrafficManager.ignore_signs_percentage": for_car("ignore_signs_percentage", 100.0),
    "TrafficManager.ignore_vehicles_percentage": for_car("ignore_vehicles_percentage", 10.0),
    "TrafficManager.ignore_walkers_percentage": for_car("ignore_walkers_percentage", 10.0),
    **missing("TrafficManager", {"keep_right_rule_percentage": "the wheel calls it keep_slow_lane_rule_percentage"}),
    "TrafficManager.keep_slow_lane_rule_percentage": for_car("keep_slow_lane_rule_percentage", 50.0),
    "TrafficManager.random_left_lanechange_percentage": for_car("random_left_lanechange_percentage", 10.0),
    "TrafficManager.random_right_lanechange_percentage": for_car("random_right_lanechange_percentage", 10.0),
    "TrafficManager.update_vehicle_lights": for_car("update_vehicle_lights", True),
    "TrafficManager.vehicle_lane_offset": for_car("vehicle_lane_offset", 0.1),
    "TrafficManager.vehicle_percentage_speed_difference": for_car("vehicle_percentage_speed_difference", 10.0),
    "TrafficManager.set_desired_speed": for_car("set_desired_speed", 25.0),
    "TrafficManager.set_global_distance_to_leading_vehicle": for_all("set_global_distance_to_leading_vehicle", 2.0),
    "TrafficManager.set_hybrid_physics_mode": for_all("set_hybrid_physics_mode", False),
    "TrafficManager.set_hybrid_physics_radius": for_all("set_hybrid_physics_radius", 60.0),
    "TrafficManager.set_osm_mode": for_all("set_osm_mode", True),
    "TrafficManager.set_path": lambda s: manager(s).set_path(
        car(s), [s.map.get_waypoint(car(s).get_location()).next(20.0)[0].transform.location]
    ),
    "TrafficManager.set_route": for_car("set_route", ["Straight"]),
    "TrafficManager.set_random_device_seed": for_all("set_random_device_seed", 7),
    "TrafficManager.set_respawn_dormant_vehicles": for_all("set_respawn_dormant_vehicles", False),
    "TrafficManager.set_boundaries_respawn_dormant_vehicles": for_all(
        "set_boundaries_respawn_dormant_vehicles", 25.0, 700.0
    ),
    "TrafficManager.set_synchronous_mode": for_all("set_synchronous_mode", True),
    "TrafficManager.get_next_action": lambda s: len(manager(s).get_next_action(car(s))) == 2,
    "TrafficManager.get_all_actions": lambda s: all(len(action) == 2 for action in manager(s).get_all_actions(car(s))),
    "TrafficManager.shut_down": shut_down,
}
