"""The table of calls: for each function of CARLA's client, whether an agent behind the gate may call it, and why not.

A function that the table does not name is refused. ``docs/reference/gate.md`` is made of this table.
"""

import enum
from collections.abc import Mapping
from types import MappingProxyType
from typing import NamedTuple

from linden.protocol.wire.client_functions import CARLA_FUNCTIONS


class Track(enum.Enum):
    """What an agent learns of other actors, by the names of the command line."""

    WORLD = "world"
    OBJECTS = "objects"
    SENSORS = "sensors"


class Rule(enum.Enum):
    """When a call is allowed."""

    READ = "always"
    READ_WORLD = "in the track world"
    READ_ACTOR = "for an actor that the agent sees"
    ACTORS = "always; actors that the agent does not see are left out of the answer"
    LISTEN = "for the world's snapshots and the agent's own sensors"
    OWN_SENSOR = "for the agent's own sensors"
    OWN_VEHICLE = "for the agent's own vehicle"
    BATCH = "where each of its commands is allowed; else none is carried out"
    REFUSED = "never"


class Entry(NamedTuple):
    """The rule of one function, and what an agent reads where it is refused."""

    rule: Rule
    why: str


_OTHER = "an agent drives its own vehicle, and no other actor"
_HIDDEN = "the track of this run hides it: it shows what the vehicle does not see"
_UNSEEN = "the track of this run hides that actor"
_ALLOWED: Mapping[Rule, tuple[str, str]] = {
    Rule.READ: (
        """
        version get_available_maps get_map_info get_map_data get_navigation_mesh get_required_files request_file
        get_episode_info get_episode_settings get_actor_definitions get_environment_objects get_names_of_all_objects
        get_weather_parameters get_imui_gravity query_lights_state is_sensor_enabled_for_ros draw_debug_shape
        clear_debug_shape clear_debug_string
        """,
        "",
    ),
    Rule.READ_WORLD: ("get_spectator get_all_level_BBs get_vehicle_light_states cast_ray project_point", _HIDDEN),
    Rule.READ_ACTOR: (
        """
        get_actor_bounding_box get_actor_component_world_transform get_actor_component_relative_transform
        get_actor_bone_world_transforms get_actor_bone_relative_transforms get_actor_socket_world_transforms
        get_actor_socket_relative_transforms get_vehicle_bone_world_transforms get_actor_component_names
        get_actor_bone_names get_actor_socket_names get_bones_transform get_group_traffic_lights get_light_boxes
        get_vehicle_light_state get_wheel_steer_angle get_wheel_pitch_angle get_physics_control
        get_ackermann_controller_settings get_telemetry_data
        """,
        _UNSEEN,
    ),
    Rule.ACTORS: ("get_actors_by_id", ""),
    Rule.LISTEN: (
        "get_sensor_token",
        "that stream is no sensor of this agent; it names its sensors in sensors() or in a sensor file",
    ),
    Rule.OWN_SENSOR: ("send", "that is no sensor of this agent"),
    Rule.OWN_VEHICLE: (
        """
        apply_control_to_vehicle apply_ackermann_control_to_vehicle apply_ackermann_controller_settings
        set_vehicle_light_state open_vehicle_door close_vehicle_door show_vehicle_debug_telemetry
        """,
        _OTHER,
    ),
    Rule.BATCH: ("apply_batch", "one of its commands is not allowed, so none is carried out"),
}
_WORLD = "an agent reads the world and does not change it"
_REFUSED: tuple[tuple[str, str], ...] = (
    ("spawn_actor spawn_actor_with_parent", "the benchmark spawns all actors; an agent names its sensors in sensors()"),
    ("destroy_actor", "the benchmark takes its actors away itself"),
    ("tick_cue", "the benchmark ticks the world"),
    ("set_episode_settings", "the benchmark keeps the clock and the world's settings"),
    (
        "load_new_episode load_map_layer unload_map_layer copy_opendrive_to_file",
        "the benchmark loads the map of the run",
    ),
    (
        """
        start_recorder stop_recorder replay_file stop_replayer set_replayer_time_factor set_replayer_ignore_hero
        set_replayer_ignore_spectator show_recorder_file_info show_recorder_collisions show_recorder_actors_blocked
        """,
        "the benchmark records the run, and an agent reads no recording",
    ),
    (
        """
        set_actor_location set_actor_transform set_actor_target_velocity set_actor_target_angular_velocity
        enable_actor_constant_velocity disable_actor_constant_velocity add_actor_impulse add_actor_force
        add_actor_angular_impulse add_actor_torque add_actor_impulse_at_location add_actor_force_at_location
        set_actor_simulate_physics set_actor_collisions set_actor_dead set_actor_enable_gravity apply_physics_control
        enable_carsim use_carsim_road enable_chrono_physics restore_physx_physics set_wheel_steer_direction
        set_wheel_pitch_angle
        """,
        "an agent moves its own vehicle with controls, and nothing else",
    ),
    ("apply_control_to_walker set_bones_transform blend_pose get_pose_from_animation", _OTHER),
    (
        """
        set_actor_autopilot is_traffic_manager_running get_traffic_manager_running add_traffic_manager_running
        destroy_traffic_manager
        """,
        "the Traffic Manager belongs to the benchmark, and an agent drives its vehicle itself",
    ),
    (
        """
        set_weather_parameters set_imui_gravity set_traffic_light_state set_traffic_light_green_time
        set_traffic_light_yellow_time set_traffic_light_red_time freeze_traffic_light freeze_all_traffic_lights
        reset_traffic_light_group reset_all_traffic_lights update_lights_state update_day_night_cycle
        enable_environment_objects set_annotations_traverse_translucency apply_color_texture_to_objects
        apply_float_color_texture_to_objects console_command
        """,
        _WORLD,
    ),
    (
        """
        enable_sensor_for_ros disable_sensor_for_ros set_ignored_vehicles enable_gbuffers are_gbuffers_enabled
        get_gbuffer_token
        """,
        "an agent's sensors are as the benchmark has spawned them",
    ),
)

UNKNOWN = Entry(Rule.REFUSED, "CARLA 0.9.16 has no such function")


def _table() -> dict[str, Entry]:
    table = {name: Entry(rule, why) for rule, (names, why) in _ALLOWED.items() for name in names.split()}
    table |= {name: Entry(Rule.REFUSED, why) for names, why in _REFUSED for name in names.split()}
    missing = CARLA_FUNCTIONS.keys() ^ table.keys()
    assert not missing, f"the gate has to decide about {sorted(missing)}"
    return table


CALLS: Mapping[str, Entry] = MappingProxyType(_table())
"""The entry of each function of CARLA 0.9.16 by its name on the wire."""

COMMANDS: Mapping[int, str] = MappingProxyType(
    {
        0: "spawn_actor",
        1: "destroy_actor",
        2: "apply_control_to_vehicle",
        3: "apply_ackermann_control_to_vehicle",
        4: "apply_control_to_walker",
        5: "apply_physics_control",
        6: "set_actor_transform",
        7: "apply_control_to_walker",
        8: "set_actor_target_velocity",
        9: "set_actor_target_angular_velocity",
        10: "add_actor_impulse",
        11: "add_actor_force",
        12: "add_actor_angular_impulse",
        13: "add_actor_torque",
        14: "set_actor_simulate_physics",
        15: "set_actor_enable_gravity",
        16: "set_actor_autopilot",
        17: "show_vehicle_debug_telemetry",
        18: "set_vehicle_light_state",
        19: "set_actor_location",
        20: "console_command",
        21: "set_traffic_light_state",
    }
)
"""The function that each command of a batch stands for, by its index on the wire."""


def sentence(method: str, why: str) -> str:
    """Return what the agent reads of a refused call."""
    return f"{method} is refused by the gate: {why}"
