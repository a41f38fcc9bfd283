"""Plans of Autoware.AI's op_global_planner on an Aisan map of ours: pairs of random places, and the LEAP route's ends.

    python scripts/outside/autoware_ai/plan.py OUT CONTENTS TOWN.xodr [--pairs 8] [--route FILE.xml] -o FOLDER

OUT has the programs of Autoware.AI (``docs/how-to/ros.md``). CONTENTS is the folder of ``linden map package ...
--ros1``. A plan counts when it begins within 5 m of the start and ends within 5 m of the goal. Writes plans.json and
plan.jpg.
"""
# ruff: noqa: ANN401 - messages of ROS

import argparse
import json
import math
import random
import sys
import time
from pathlib import Path
from typing import Any, NamedTuple

import carla
import matplotlib as mpl

mpl.use("Agg")
import numpy as np
from matplotlib import pyplot as plt
from stack import Stack, running_stack

from basu.routing import plan as joined
from basu.routing.route_file import read_routes
from basu_ros import vehicle_messages as of_vehicle
from basu_ros.autoware_ai import GOAL, INITIAL_POSE, still_messages
from basu_ros.moment import Vehicle
from basu_ros.ros1 import Ros1Node
from linden_ros2 import basic_messages as basic
from linden_ros2 import frames
from linden_ros2.frames import Pose
from linden_ros2.topic import Message, Topic

PATHS = Topic("/global_waypoints_rviz", "visualization_msgs/msg/MarkerArray")
MAP_STAT = Topic("/vmap_stat", "std_msgs/msg/Bool")
LONG_S = 240.0
NEAR_M = 5.0
PARAMETERS = {
    "pathDensity": "0.75", "enableSmoothing": "true", "enableLaneChange": "false", "enableRvizInput": "true",
    "enableReplan": "false", "velocitySource": "1", "mapSource": "0", "enableDynamicMapUpdate": "false",
}  # fmt: skip


class Place(NamedTuple):
    """A place in CARLA's axes."""

    x_m: float
    y_m: float
    z_m: float
    yaw_rad: float


def main() -> int:
    """Plan, and write what came of it."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("out", type=Path)
    parser.add_argument("contents", type=Path)
    parser.add_argument("opendrive", type=Path)
    parser.add_argument("--pairs", type=int, default=8)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--only", nargs="*", metavar="NAME", help="plan these missions alone, such as 'pair 3'")
    parser.add_argument("--route", type=Path, help="a route whose start and end are planned as well")
    parser.add_argument("-o", "--output", type=Path, required=True)
    args = parser.parse_args()
    if not (args.out / "build" / "op_global_planner").exists():
        print("skipped: op_global_planner is not built; see docs/how-to/ros.md")
        return 0
    town = args.opendrive.stem
    carla_map = carla.Map(town, args.opendrive.read_text(encoding="utf-8"))
    missions = [(f"pair {number}", *pair) for number, pair in enumerate(pairs(carla_map, args.pairs, args.seed), 1)]
    if args.route is not None:
        missions.append(("the route's ends", *ends_of(carla_map, args.route)))
    if args.only:
        missions = [mission for mission in missions if mission[0] in args.only]
    args.output.mkdir(parents=True, exist_ok=True)
    plans = []
    for name, start, goal in missions:
        with running_stack(args.out, args.output / "logs" / name.replace(" ", "-")) as stack:
            points = planned(stack, args.contents / "maps/vector_maps/asian" / town, start, goal)
        told = judged(carla_map, start, goal, points)
        plans.append({"name": name, "start": start, "goal": goal, "points": points, **told})
        print({key: value for key, value in plans[-1].items() if key != "points"}, flush=True)
    found = sum(plan["planned"] for plan in plans if plan["name"].startswith("pair"))
    wanted = sum(plan["name"].startswith("pair") for plan in plans)
    print(f"{found} of {wanted} pairs planned")
    (args.output / "plans.json").write_text(json.dumps(plans), encoding="utf-8")
    draw(carla_map, plans, args.output / "plan.jpg")
    return 0 if found == wanted else 1


def pairs(carla_map: carla.Map, count: int, seed: int) -> list[tuple[Place, Place]]:
    """Random places on driving lanes, at least 100 m apart."""
    rng = random.Random(seed)
    lanes = [point for point in carla_map.generate_waypoints(5.0) if not point.is_junction]
    made: list[tuple[Place, Place]] = []
    while len(made) < count:
        start, goal = (place_of(rng.choice(lanes)) for _ in range(2))
        if math.dist(start[:2], goal[:2]) > 100.0:
            made.append((start, goal))
    return made


def ends_of(carla_map: carla.Map, file: Path) -> tuple[Place, Place]:
    """The first point of a route, and its last; of a round, the point farthest from the first."""
    route = joined(carla_map, read_routes(file)[0])
    rows = [Place(*point, yaw) for point, yaw in zip(route.points_m.tolist(), route.yaw_rad.tolist(), strict=True)]
    is_round = math.dist(rows[0][:2], rows[-1][:2]) < NEAR_M
    return rows[0], max(rows, key=lambda row: math.dist(rows[0][:2], row[:2])) if is_round else rows[-1]


def place_of(waypoint: carla.Waypoint) -> Place:
    """The place of a way point."""
    at, turn = waypoint.transform.location, waypoint.transform.rotation
    return Place(at.x, at.y, at.z, math.radians(turn.yaw))


def planned(stack: Stack, asian: Path, start: Place, goal: Place) -> list[tuple[float, float]]:
    """The points of the plan in CARLA's axes; empty without one."""
    stack.load_vector_map(asian)
    node = Ros1Node("plan")
    try:
        types = node.types
        node.listen(MAP_STAT, PATHS, any_version=True)
        while node.wait(MAP_STAT, LONG_S) and not any(message.data for message in node.received(MAP_STAT)):
            pass
        node.publish(*still_messages(types, Vehicle("hero"), 0.0))  # the planner looks up map in world
        words = [f"_{name}:={value}" for name, value in PARAMETERS.items()]
        stack.node("op_global_planner", "__name:=op_global_planner", *words)
        header = basic.header(types, 0.0, of_vehicle.MAP)
        covered = types.message("geometry_msgs/msg/PoseWithCovariance", pose=pose_message(types, start))
        node.publish(Message(INITIAL_POSE, types.message(INITIAL_POSE.type, header=header, pose=covered)))
        node.wait_for_peers(INITIAL_POSE, LONG_S)
        node.publish(Message(GOAL, types.message(GOAL.type, header=header, pose=pose_message(types, goal))))
        until_s = time.monotonic() + LONG_S
        while time.monotonic() < until_s:
            node.wait(PATHS, 1.0)
            for message in node.received(PATHS):
                points = longest(message)
                if points:
                    return points
    finally:
        node.close()
    return []


def longest(markers: Any) -> list[tuple[float, float]]:
    """The longest line of markers, in CARLA's axes."""
    lines = [[(point.x, -point.y) for point in marker.points] for marker in markers.markers]
    return max(lines, key=len, default=[])


def pose_message(types: Any, place: Place) -> Any:
    """A pose in ROS's axes."""
    turn = frames.attitude(0.0, 0.0, place.yaw_rad)
    return basic.pose_message(types, Pose(frames.vector(*place[:3]), turn))


def judged(carla_map: carla.Map, start: Place, goal: Place, points: list[tuple[float, float]]) -> dict[str, Any]:
    """How a plan fits: its length, its ends, and how far its points lie from the middle of a lane."""
    if not points:
        return {"planned": False}
    lengths = np.hypot(*np.diff(np.array(points), axis=0).T)
    away = [away_m(carla_map, x, y, start.z_m) for x, y in points]
    ends = math.dist(points[0], start[:2]), math.dist(points[-1], goal[:2])
    return {
        "planned": max(ends) < NEAR_M,
        "length_m": round(float(lengths.sum()), 1),
        "from_start_m": round(ends[0], 2),
        "from_goal_m": round(ends[1], 2),
        "off_lane_mean_m": round(float(np.mean(away)), 3),
        "off_lane_max_m": round(float(np.max(away)), 3),
    }


def away_m(carla_map: carla.Map, x_m: float, y_m: float, z_m: float) -> float:
    """How far a point lies from the middle of the nearest driving lane."""
    nearest = carla_map.get_waypoint(carla.Location(x_m, y_m, z_m)).transform.location
    return math.hypot(nearest.x - x_m, nearest.y - y_m)


def draw(carla_map: carla.Map, plans: list[dict[str, Any]], file: Path) -> None:
    """Draw the plans over the lanes, north up."""
    figure, axes = plt.subplots(figsize=(9, 9))
    lanes = np.array([place_of(point)[:2] for point in carla_map.generate_waypoints(4.0)])
    axes.plot(lanes[:, 0], -lanes[:, 1], ",", color="0.75")
    for plan in plans:
        if plan["points"]:
            points = np.array(plan["points"])
            is_route = not plan["name"].startswith("pair")
            width = 2.5 if is_route else 1.2
            axes.plot(points[:, 0], -points[:, 1], linewidth=width, label=f"{plan['name']}: {plan.get('length_m')} m")
        axes.plot(plan["start"][0], -plan["start"][1], "o", color="0.2", markersize=3)
        axes.plot(plan["goal"][0], -plan["goal"][1], "x", color="0.2", markersize=5)
    axes.set_aspect("equal")
    axes.set_xlabel("east, m")
    axes.set_ylabel("north, m")
    axes.set_title("Plans of Autoware.AI's op_global_planner on the Aisan map (o start, x goal)")
    axes.legend(fontsize=7, loc="best")
    figure.savefig(file, dpi=110, bbox_inches="tight")


if __name__ == "__main__":
    sys.exit(main())
