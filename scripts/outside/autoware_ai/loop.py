"""Autoware.AI's nodes drive the shuttle round a route by `basu run autoware-ai`: score, errors, path.

    python scripts/outside/autoware_ai/loop.py OUT CONTENTS TOWN.xodr --routes FILE.xml [--ndt] -o FOLDER [OPTIONS]

OUT has the programs of Autoware.AI (``docs/how-to/ros.md``). CONTENTS is the folder of ``linden map package ...
--ros1``. OPTIONS go to `basu run`. Writes loop.json, loop.jpg and the run folder.
"""
# ruff: noqa: ANN401 - messages of ROS

import argparse
import json
import math
import subprocess
import sys
from pathlib import Path
from typing import Any

import matplotlib as mpl

mpl.use("Agg")
import ndt_settings
import numpy as np
from matplotlib import pyplot as plt
from stack import running_stack

from basu.records.history.files import read_history
from basu_ros.autoware_ai import NDT_POSE
from basu_ros.ros1 import Ros1Node
from basu_ros.topics import odometry_of
from linden_ros2.basic_messages import NS_PER_S

sys.path.append(str(Path(__file__).parents[1]))
from drive_figures import figures_of

LAUNCH = Path(__file__).parents[3] / "docker" / "autoware" / "autoware_ai.launch"
BASU = "from basu.cli import entry_point; entry_point()"
GOAL_CM = 5.0
TRUTH = odometry_of("hero")._replace(depth=1000)
FOUND = NDT_POSE._replace(depth=1000)


def main() -> int:
    """Drive, and write what came of it."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("out", type=Path)
    parser.add_argument("contents", type=Path)
    parser.add_argument("opendrive", type=Path)
    parser.add_argument("--routes", type=Path, required=True)
    parser.add_argument("--ndt", action="store_true", help="localise by NDT matching instead of the simulator's pose")
    parser.add_argument("-o", "--output", type=Path, required=True)
    parser.add_argument("--rules", action="store_true", help="with decision_maker, lane_rule and lane_stop")
    parser.add_argument("--obstacles", action="store_true", help="with ray_ground_filter: stop for what the lidar sees")
    parser.add_argument("--clusters", action="store_true", help="the same, for points that belong to clusters alone")
    parser.add_argument("--speed-kmph", type=float, default=20.0, help="the highest speed of a plan (default: 20)")
    parser.add_argument("--leaf", type=float, default=ndt_settings.LEAF_M, help="of the scan's voxel grid, m")
    parser.add_argument("--round", action="store_true", help="the route ends where it begins")
    args, others = parser.parse_known_args()
    if not (args.out / "build" / "pure_pursuit").exists():
        print("skipped: Autoware.AI's nodes are not built; see docs/how-to/ros.md")
        return 0
    args.output.mkdir(parents=True, exist_ok=True)
    with running_stack(args.out, args.output / "logs") as stack:
        words = ["--routes", str(args.routes), "--output", str(args.output), *others]
        run = subprocess.Popen([sys.executable, "-c", BASU, "run", "autoware-ai", *words])
        stack.adopt(run)
        options = {"contents": args.contents.resolve(), "town": args.opendrive.stem, "ndt": str(args.ndt).lower()}
        options.update(rules=str(args.rules).lower(), round=str(args.round).lower(), speed_kmph=args.speed_kmph)
        options.update(obstacles=str(args.obstacles).lower(), clusters=str(args.clusters).lower())
        stack.start("roslaunch", "roslaunch", str(LAUNCH), *(f"{name}:={value}" for name, value in options.items()))
        truth, found = listened(run, args.leaf)
    history = read_history(args.output / "latest")
    told = figures_of(args.output / "latest", history)
    errors = ndt_errors(truth, found)
    if errors:
        away = np.array([each[1] for each in errors]) * 100.0
        told["ndt"] = {
            "scans": len(away),
            "mean_cm": round(float(away.mean()), 2),
            "p95_cm": round(float(np.percentile(away, 95)), 2),
            "max_cm": round(float(away.max()), 2),
        }
    print(json.dumps(told, indent=1))
    (args.output / "loop.json").write_text(json.dumps(told, indent=1), encoding="utf-8")
    draw(history, errors, args.output / "loop.jpg")
    return 0


def listened(run: "subprocess.Popen[bytes]", leaf_m: float) -> tuple[dict[int, Any], dict[int, Any]]:
    """The true and the found poses by time, until the run ends; voxel_grid_filter gets its setting before."""
    node = Ros1Node("loop")
    types = ndt_settings.types()
    node.publish_as(types, ndt_settings.voxel(types, leaf_m))
    node.listen(TRUTH, FOUND)
    truth: dict[int, Any] = {}
    found: dict[int, Any] = {}
    while run.poll() is None:
        node.wait_any([TRUTH], 0.5)
        for odometry in node.received(TRUTH):
            truth[time_ns(odometry)] = odometry.pose.pose
        for pose in node.received(FOUND):
            found[time_ns(pose)] = pose.pose
    node.close()
    return truth, found


def time_ns(message: Any) -> int:
    """The time of a message, to the microsecond."""
    stamp = message.header.stamp
    return int(round((stamp.sec * NS_PER_S + stamp.nanosec) / 1000.0) * 1000)


def ndt_errors(truth: dict[int, Any], found: dict[int, Any]) -> list[tuple[float, float]]:
    """Time in s and horizontal error in m of each pose that NDT found, against the pose of its scan's frame."""
    made = []
    for at_ns, pose in sorted(found.items()):
        true = truth.get(at_ns)
        if true is not None:
            away = math.dist((pose.position.x, pose.position.y), (true.position.x, true.position.y))
            made.append((at_ns / NS_PER_S, away))
    return made


def draw(history: Any, errors: list[tuple[float, float]], file: Path) -> None:
    """Draw the path over the route, and the errors over the time."""
    frames, route = history.frames, history.facts.route
    figure, (plan, graph) = plt.subplots(2, 1, figsize=(9, 11), height_ratios=(3, 1))
    plan.plot(route.points_m[:, 0], -route.points_m[:, 1], color="0.7", linewidth=4, label="route")
    plan.plot(frames["x_m"], -frames["y_m"], color="tab:red", linewidth=1.2, label="driven by Autoware.AI")
    plan.set_aspect("equal")
    plan.set_xlabel("east, m")
    plan.set_ylabel("north, m")
    plan.legend()
    graph.plot(frames["t_s"], np.abs(frames["lateral_m"]) * 100.0, color="tab:red", label="cross-track error")
    if errors:
        times_s, away_cm = np.array([(t_s - 1.0, away * 100.0) for t_s, away in errors]).T
        graph.plot(times_s, away_cm, color="tab:blue", label="NDT error")
        graph.axhline(GOAL_CM, color="0.6", linewidth=0.8)
    graph.set_xlabel("time, s")
    graph.set_ylabel("cm")
    graph.legend()
    figure.savefig(file, dpi=110, bbox_inches="tight")


if __name__ == "__main__":
    sys.exit(main())
