"""Which outside programs are run, with which arguments, on which map, and how each of them is meant to end."""

from typing import NamedTuple
from xml.etree import ElementTree as ET

from folders import Folders

RECORDING = "outside.log"
ENDLESS_S = 25.0
"""How long a program that never ends by itself is watched before it is interrupted as by Ctrl+C."""


PACE_S = 4.0
"""From one picture of a program's window to the next."""


class Program(NamedTuple):
    """One row of the table. The first of ``arguments`` is the program's file, below the folder of its ``family``."""

    family: str
    arguments: tuple[str, ...]
    town: str = "Linden"
    limit_s: float = 150.0
    is_endless: bool = False
    """Whether the user ends it, so that still running at the limit is right."""
    needs_driver: bool = False
    """Whether somebody else has to drive the vehicle whose role is hero."""
    port: int = 2000
    tells_failure: str = "Traceback"
    """What stands in its output when it failed without an exit status."""
    keys: str = ""
    """What is typed into its window, a key each ``PACE_S``; see ``watched/sitecustomize.py``."""
    keeps_recordings: bool = False
    """Whether it records into a folder below its own, which the server's ``--recordings`` must then name."""


def all_programs(folders: Folders) -> list[Program]:
    """Every row, in the order of the table: a recording is made before it is shown."""
    return [
        *_on(("Linden", "Town01"), EXAMPLES),
        *_on(("Linden", "Town04"), TRAFFIC),
        *_on(("Linden",), UTILITIES),
        *_on(("Town01",), SMOKE),
        *_scenarios(folders),
        _leaderboard(folders, "dummy_agent", "MAP"),
        _leaderboard(folders, "npc_agent", "SENSORS"),
        *SCENIC,
        *SUMO,
        *USERS,
    ]


def _on(towns: tuple[str, ...], programs: tuple[Program, ...]) -> list[Program]:
    return [program._replace(town=town) for town in towns for program in programs]


def _example(*arguments: str, limit_s: float = 150.0) -> Program:
    return Program("examples", arguments, limit_s=limit_s)


def _endless(*arguments: str, limit_s: float = ENDLESS_S, keys: str = "") -> Program:
    return Program("examples", arguments, limit_s=limit_s, is_endless=True, keys=keys)


EVERY_CAMERA = "p 2 3 4 5 6 ctrl+2 ctrl+4 ctrl+5 7 8 ctrl+1 ctrl+3 1 tab tab tab g c c"
"""In manual_control.py: the autopilot, each of its sensors, other places of the camera, the radar, the weather."""

EXAMPLES = (
    _endless("dynamic_weather.py"),
    _endless("vehicle_gallery.py"),
    _example("vehicle_physics.py"),
    _example("get_component_test.py"),
    _endless("no_rendering_mode.py"),
    _example("start_recording.py", "-f", RECORDING, "-n", "10", "-t", "15"),
    _example("show_recorder_file_info.py", "-f", RECORDING),
    _example("show_recorder_file_info.py", "-f", RECORDING, "-a"),
    _example("show_recorder_collisions.py", "-f", RECORDING, "-t", "vv"),
    _example("show_recorder_actors_blocked.py", "-f", RECORDING, "-t", "5", "-d", "10"),
    _example("start_replaying.py", "-f", RECORDING, "-s", "2", "-d", "5"),
    Program("older_examples", ("start_replaying.py", "-f", RECORDING, "-s", "2", "-d", "5")),
    _endless("manual_control.py", limit_s=120.0, keys=EVERY_CAMERA),
    _endless("manual_control.py", "--sync", limit_s=120.0, keys=EVERY_CAMERA),
    _endless("manual_control_fisheye.py"),
    _endless("manual_control_carsim.py"),
    _endless("manual_control_chrono.py"),
    _endless("manual_control_steeringwheel.py"),
    _endless("automatic_control.py", "--sync"),
    _endless("synchronous_mode.py"),
    _endless("sensor_synchronization.py"),
    _example("tutorial.py"),
    _endless("tutorial_gbuffer.py"),
    _endless("bounding_boxes.py", limit_s=40.0, keys="3"),
    _endless("client_bounding_boxes.py"),
    _endless("draw_skeleton.py"),
    _endless("lidar_to_camera.py"),
    _endless("open3d_lidar.py"),
    _endless("visualize_multiple_sensors.py"),
    _endless("V2XDemo.py"),
    _endless("test_addsecondvx.py"),
    _endless("invertedai_traffic.py"),
    _endless("rss/manual_control_rss.py"),
    _endless("ros2/ros2_native.py", "-f", "config/stack.json"),
)

TRAFFIC = (
    _endless("generate_traffic.py", "-n", "30", "-w", "20", "--seed", "7", "--seedw", "7", limit_s=40.0),
    _endless("generate_traffic.py", "-n", "30", "-w", "20", "--asynch", limit_s=40.0),
    _endless("generate_traffic.py", "-n", "30", "-w", "10", "--hybrid", "--respawn", "--hero", limit_s=40.0),
    _endless("generate_traffic.py", "-n", "20", "--safe", "--car-lights-on", "--no-rendering", limit_s=40.0),
)


def _utility(*arguments: str, limit_s: float = 150.0, is_endless: bool = False) -> Program:
    return Program("util", arguments, limit_s=limit_s, is_endless=is_endless)


UTILITIES = (
    _utility("test_connection.py"),
    _utility("config.py", "--list"),
    _utility("config.py", "--inspect"),
    _utility("config.py", "-b", "vehicle.*"),
    _utility("config.py", "-m", "Town01"),
    _utility("config.py", "-x", "{towns}/Town02.xodr"),
    _utility("config.py", "--delta-seconds", "0.05", "--weather", "HardRainNoon"),
    _utility("config.py", "--no-rendering", "--no-sync"),
    _utility("environment.py", "--sun", "sunset", "--weather", "overcast"),
    _utility("extract_spawn_points.py", "-o", "{out}"),
    _utility("lane_explorer.py", "-t", "0.05", limit_s=20.0, is_endless=True),
    _utility("check_map.py"),
    _utility("osm_to_xodr.py", "-i", "{osm}", "-o", "{out}/made.xodr"),
    _utility("check_collisions_substepping.py", limit_s=420.0),
    _utility("vehicle_physics_tester.py", limit_s=300.0),
    _utility("apply_texture.py", "-o", "SM_House"),
    _utility("performance_benchmark.py"),
    _utility("raycast_sensor_testing.py", limit_s=ENDLESS_S, is_endless=True),
    _utility("check_lidar_bb.py"),
    _utility("check_raycast_sensors_determinism.py", limit_s=900.0),
)


def _smoke(name: str, limit_s: float = 200.0) -> Program:
    return Program("test", ("-m", "unittest", "-v", f"smoke.test_{name}"), limit_s=limit_s, port=3654)


SMOKE = (
    _smoke("blueprint"),
    _smoke("client"),
    _smoke("world"),
    _smoke("map", 400.0),
    _smoke("snapshot"),
    _smoke("sync"),
    _smoke("spawnpoints", 900.0),
    _smoke("props_loading"),
    _smoke("geoconversion"),
    _smoke("streamming"),
    _smoke("sensor_tick_time"),
    _smoke("collision_sensor"),
    _smoke("collision_determinism", 400.0),
    _smoke("vehicle_physics", 400.0),
    _smoke("determinism", 900.0),
    _smoke("lidar"),
    _smoke("sensor_determinism"),
)


def _scenario(*arguments: str, town: str, limit_s: float = 150.0, needs_driver: bool = True) -> Program:
    arguments = ("scenario_runner.py", "--timeout", "60", "--output", *arguments)
    return Program(
        "scenario_runner", arguments, town, limit_s, needs_driver=needs_driver, tells_failure="SCENARIO_FAILED"
    )


def _endless_scenario(row: Program) -> Program:
    return row._replace(limit_s=ENDLESS_S, is_endless=True)


NEVER_ENDING = ("ChangingWeather", "LaneOffsetActionExample", "OscControllerExample")
"""The first has no stop trigger, those of the others come after 20 km."""


def _scenarios(folders: Folders) -> list[Program]:
    """ScenarioRunner's own examples in all its three languages, one in asynchronous mode, and one of its routes."""
    examples = folders.of("scenario_runner") / "srunner" / "examples"
    rows = []
    for path in sorted(examples.glob("*.xml")):
        for scenario in ET.parse(path).getroot().iter("scenario"):
            name, town = scenario.get("name", ""), scenario.get("town", "")
            row = _scenario("--sync", "--reloadWorld", "--scenario", name, town=town)
            is_endless = scenario.get("type") == "FreeRide"  # the user drives for as long as they like
            rows.append(_endless_scenario(row) if is_endless else row)
    for path in sorted(examples.glob("*.xosc")):
        logic = ET.parse(path).getroot().find(".//LogicFile")
        town = "" if logic is None else logic.get("filepath", "")
        row = _scenario("--sync", "--reloadWorld", "--openscenario", f"srunner/examples/{path.name}", town=town)
        rows.append(_endless_scenario(row) if path.stem in NEVER_ENDING else row)
    rows += [
        _scenario("--sync", "--reloadWorld", "--openscenario2", f"srunner/examples/{path.name}", town="Town04")
        for path in sorted(examples.glob("*.osc"))
        if path.name != "basic.osc"  # only there to be imported
    ]
    rows.append(_scenario("--reloadWorld", "--scenario", "FollowLeadingVehicle_1", town="Town01"))
    route = ("--route", "srunner/data/routes_town10.xml", "--route-id", "0")
    agent = ("--agent", "srunner/autoagents/npc_agent.py")
    rows.append(_scenario(*route, *agent, town="Town10HD_Opt", limit_s=300.0, needs_driver=False))
    return rows


def _leaderboard(folders: Folders, agent: str, track: str) -> Program:
    """The leaderboard's evaluator, with one of its own agents on ScenarioRunner's route through a public town."""
    routes = folders.of("scenario_runner") / "srunner" / "data" / "routes_town10.xml"
    arguments = (
        *("leaderboard/leaderboard_evaluator.py", "--routes", str(routes), "--routes-subset", "0"),
        *("--agent", f"leaderboard/autoagents/{agent}.py", "--track", track, "--debug", "0"),
        *("--checkpoint", "{out}/" + agent + ".checkpoint.json", "--debug-checkpoint", "{out}/" + agent + ".live.txt"),
    )
    return Program("leaderboard", arguments, "Town10HD_Opt", limit_s=600.0)


def _scenic(path: str) -> Program:
    """Scenic draws one scene of a scenario, and lets it run for ten simulated seconds, watched by its own camera."""
    choices = ("--2d", "--model", "scenic.simulators.carla.model", "--simulate", "--count", "1", "--time", "100")
    return Program("scenic", ("-m", "scenic", f"examples/{path}.scenic", *choices), "Town01", limit_s=240.0)


SCENIC = (
    _scenic("carla/car"),
    _scenic("driving/pedestrian"),
    _scenic("carla/trafficLights"),
    _scenic("driving/pedestrianAcrossRoad"),
    _scenic("driving/pedestrianJaywalking"),
    _scenic("carla/NHTSA_Scenarios/pedestrian/pedestrian_01"),
)


def _sumo(town: str, *arguments: str) -> Program:
    arguments = ("run_synchronization.py", f"examples/{town}.sumocfg", *arguments)
    return Program("sumo", arguments, town, limit_s=90.0, is_endless=True)


SUMO = (
    _sumo("Town01"),
    _sumo("Town04"),
    _sumo("Town04", "--tls-manager", "sumo", "--sync-vehicle-all"),
    _sumo("Town01", "--tls-manager", "carla", "--sync-vehicle-all"),
    _sumo("Town05"),
)

USERS = (
    Program("kitti", ("KITTI_data_generator.py",), "Town01", limit_s=240.0, is_endless=True, keeps_recordings=True),
    Program("boxes", ("collectData.py", "-n", "30"), "Town01", limit_s=120.0, is_endless=True),
    Program("gym", ("test.py",), "Town03", limit_s=90.0, is_endless=True),
)
"""Programs of single users: data sets and an environment for learning."""
