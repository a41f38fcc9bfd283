"""A controller of Autoware Core drives the shuttle along a route by `basu run autoware`: score, errors, stops.

    python scripts/outside/autoware_core.py PROGRAM MESSAGES TOWN.xodr --routes FILE.xml -o FOLDER [OPTIONS]

PROGRAM is ``autoware_simple_pure_pursuit_exe``, or a program that starts it with its libraries and takes its arguments.
MESSAGES is the folder ``autoware_planning_msgs`` of autoware_msgs. This script takes the place of Autoware's planners.
It publishes the part of the route ahead as a trajectory, with a speed for each point: the posted limit, less in bends,
and 0 m/s before the line of a stop sign until the shuttle has stood there for a second. OPTIONS go to `basu run`.
With ``--smoother`` it publishes ten times a second, without ramps, for Autoware's ``velocity_smoother_node``. That is a
program that adds the node's own parameter files to its arguments. Writes drive.json and the run folder.
"""
# ruff: noqa: ANN401 - messages of ROS

import argparse
import json
import math
import os
import signal
import subprocess
import sys
from contextlib import ExitStack
from pathlib import Path
from typing import Any

import carla
import numpy as np
from drive_figures import figures_of

from basu.records.history.files import read_history
from basu.routing import ControlKind, Route, plan
from basu.routing.route_file import read_routes
from basu_ros.autoware import ACCELERATION, CONTROL, KINEMATIC
from basu_ros.dds import Ros2Node
from linden_ros2 import basic_messages as basic
from linden_ros2 import frames
from linden_ros2.frames import Pose
from linden_ros2.topic import Message, Topic
from linden_ros2.types import Generation, Types

BASU = "from basu.cli import entry_point; entry_point()"
TRAJECTORY = Topic("/planning/trajectory", "autoware_planning_msgs/msg/Trajectory", depth=1)
RAW = Topic("/planning/scenario_planning/scenario_selector/trajectory", TRAJECTORY.type, depth=1)
SPACING_M, BEHIND_M, AHEAD_M, RENEWED_M = 0.5, 5.0, 50.0, 5.0
WHEELBASE_M, FRONT_M = 2.8, 3.41  # of the shuttle; from the rear axle to the front wheels and to the bumper
FAR_M, OFTEN_S = 100.0, 0.1  # for the smoother
BEFORE_LINE_M, STANDS_S, AT_REST_MPS = 1.0, 1.0, 0.05
RAMP_MPS2, ACROSS_MPS2, CREEP_MPS, TOP_MPS = 0.6, 1.0, 0.5, 6.7
PARAMETERS = f"""/**:
  ros__parameters:
    wheel_radius: 0.35
    wheel_width: 0.2
    wheel_base: {WHEELBASE_M}
    wheel_tread: 1.65
    front_overhang: {FRONT_M - WHEELBASE_M:.2f}
    rear_overhang: 0.61
    left_overhang: 0.17
    right_overhang: 0.17
    vehicle_height: 2.87
    max_steer_angle: 0.7
    lookahead_gain: {{gain}}
    lookahead_min_distance: {{least}}
    speed_proportional_gain: 1.0
    use_external_target_vel: false
    external_target_vel: 1.0
"""


class Planner:
    """The part of a route ahead as trajectories, with stops at its stop signs."""

    def __init__(self, route: Route, types: Types, *, with_ramps: bool) -> None:
        """Sample the route every ``SPACING_M``, and compute the speed that limits and bends allow."""
        self._types, self._with_ramps = types, with_ramps
        self.s_m = np.arange(0.0, route.length_m, SPACING_M)
        self.points_m = np.stack([np.interp(self.s_m, route.s_m, route.points_m[:, k]) for k in range(3)], axis=1)
        self.yaw_rad = np.interp(self.s_m, route.s_m, np.unwrap(route.yaw_rad))
        bend_1pm = np.abs(np.gradient(self.yaw_rad, self.s_m))
        bend_1pm = np.convolve(np.pad(bend_1pm, 6, mode="edge"), np.full(13, 1.0 / 13.0), mode="valid")  # over 6 m
        limit_mps = np.interp(self.s_m, route.s_m, np.nan_to_num(route.speed_limit_mps, nan=TOP_MPS))
        self._most_mps = np.minimum(np.minimum(limit_mps, TOP_MPS), np.sqrt(ACROSS_MPS2 / np.maximum(bend_1pm, 1e-3)))
        lines = [each.s_m for each in route.controls if each.kind is ControlKind.STOP_SIGN]
        self._halts_m = [line - FRONT_M - BEFORE_LINE_M for line in lines]
        self._at, self._sent_s = 0, -math.inf
        self._sent_m = -math.inf
        self._stood_s = 0.0
        self._last_s = math.nan

    def step(self, odometry: Any) -> Any:
        """Return a trajectory if the odometry makes a new one due; None otherwise."""
        place = odometry.pose.pose.position
        window = slice(max(0, self._at - 20), self._at + 60)
        away = np.hypot(self.points_m[window, 0] - place.x, self.points_m[window, 1] + place.y)
        self._at = window.start + int(away.argmin())
        stamp = odometry.header.stamp
        now_s = stamp.sec + stamp.nanosec * 1e-9
        at_m = float(self.s_m[self._at])
        if self._halts_m and abs(at_m - self._halts_m[0]) < BEFORE_LINE_M and self._is_at_rest(odometry):
            self._stood_s += 0.0 if math.isnan(self._last_s) else now_s - self._last_s
            if self._stood_s >= STANDS_S:
                self._halts_m.pop(0)
                self._stood_s, self._sent_m = 0.0, -math.inf
        self._last_s = now_s
        is_due = at_m >= self._sent_m + RENEWED_M if self._with_ramps else now_s > self._sent_s + OFTEN_S - 0.01
        if not is_due:
            return None
        self._sent_s = now_s
        return self.trajectory(odometry)

    def trajectory(self, odometry: Any) -> Any:
        """Return the trajectory from some metres behind to ``AHEAD_M`` or ``FAR_M`` before the vehicle."""
        self._sent_m = float(self.s_m[self._at])
        first = max(0, self._at - int(BEHIND_M / SPACING_M))
        some = slice(first, self._at + int((AHEAD_M if self._with_ramps else FAR_M) / SPACING_M))
        speed_mps = self._speeds_mps(some)
        types, points = self._types, []
        for (x_m, y_m, z_m), yaw_rad, mps in zip(self.points_m[some], self.yaw_rad[some], speed_mps, strict=True):
            pose = Pose(frames.vector(x_m, y_m, z_m), frames.attitude(0.0, 0.0, float(yaw_rad)))
            made = types.message(
                "autoware_planning_msgs/msg/TrajectoryPoint",
                pose=basic.pose_message(types, pose),
                longitudinal_velocity_mps=float(mps),
            )
            points.append(made)
        return types.message(TRAJECTORY.type, header=odometry.header, points=points)

    def _speeds_mps(self, some: slice) -> Any:
        """Return the speeds of some points: stops, and ramps towards them and away from the vehicle's place."""
        s_m, speed_mps = self.s_m[some], self._most_mps[some].copy()
        speed_mps[self.s_m[some] >= self.s_m[-1] - SPACING_M / 2.0] = 0.0
        for halt_m in self._halts_m[:1]:
            speed_mps[s_m >= halt_m] = 0.0
        if not self._with_ramps:
            return speed_mps
        for index in range(len(speed_mps) - 2, -1, -1):
            ramp_mps = math.sqrt(speed_mps[index + 1] ** 2 + 2.0 * RAMP_MPS2 * SPACING_M)
            speed_mps[index] = min(speed_mps[index], ramp_mps)
        return speed_mps

    @staticmethod
    def _is_at_rest(odometry: Any) -> bool:
        """Return whether the vehicle stands."""
        return bool(abs(odometry.twist.twist.linear.x) < AT_REST_MPS)


def main() -> int:
    """Drive, and write the results."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program", type=Path)
    parser.add_argument("messages", type=Path)
    parser.add_argument("opendrive", type=Path)
    parser.add_argument("--routes", type=Path, required=True)
    parser.add_argument("--smoother", type=Path, metavar="PROGRAM", help="velocity_smoother_node with its parameters")
    parser.add_argument("--lookahead", nargs=2, type=float, default=[1.0, 1.0], metavar=("S", "M"))
    parser.add_argument("--domain", type=int, default=1 + os.getpid() % 90, help="of ROS 2 (default: by the process)")
    parser.add_argument("-o", "--output", type=Path, required=True)
    args, others = parser.parse_known_args()
    for given in (args.program, args.messages / "msg" / "Trajectory.msg", args.opendrive, args.routes, args.smoother):
        if given is not None and not given.exists():
            print(f"{given} does not exist; see docs/how-to/ros.md, section Autoware", file=sys.stderr)
            return 2
    args.output.mkdir(parents=True, exist_ok=True)
    os.environ.update(ROS_DOMAIN_ID=str(args.domain), ROS_LOCALHOST_ONLY="1")
    texts = {file.stem: file.read_text(encoding="utf-8") for file in (args.messages / "msg").glob("Trajectory*.msg")}
    types = Types(Generation.ROS_2, {f"autoware_planning_msgs/msg/{name}": text for name, text in texts.items()})
    town = carla.Map(args.opendrive.stem, args.opendrive.read_text(encoding="utf-8"))
    planner = Planner(plan(town, read_routes(args.routes)[0]), types, with_ramps=args.smoother is None)
    gain, least = args.lookahead
    settings = args.output / "parameters.yaml"
    settings.write_text(PARAMETERS.format(gain=gain, least=least), encoding="utf-8")
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(1))  # so that the programs end with this one
    with ExitStack() as stack:
        words = ["--routes", str(args.routes), "--output", str(args.output), *others]
        run = started(stack, args.output / "run.txt", sys.executable, "-c", BASU, "run", "autoware", *words)
        renamed = {"input/odometry": KINEMATIC, "input/trajectory": TRAJECTORY, "output/control_command": CONTROL}
        remaps = [word for name, topic in renamed.items() for word in ("-r", f"~/{name}:={topic.name}")]
        ros = ["--ros-args", "--params-file", str(settings), *remaps]
        started(stack, args.output / "controller.txt", str(args.program), *ros)
        if args.smoother is not None:
            renamed = {"input/trajectory": RAW, "output/trajectory": TRAJECTORY, "input/acceleration": ACCELERATION}
            remaps = [word for name, topic in renamed.items() for word in ("-r", f"~/{name}:={topic.name}")]
            ros = ["--ros-args", "--params-file", str(settings), *remaps]
            started(stack, args.output / "smoother.txt", str(args.smoother), *ros)
        publish(run, planner, types, TRAJECTORY if args.smoother is None else RAW)
    told = figures_of(args.output / "latest", read_history(args.output / "latest"))
    print(json.dumps(told, indent=1))
    (args.output / "drive.json").write_text(json.dumps(told, indent=1), encoding="utf-8")
    return 0


def publish(run: "subprocess.Popen[bytes]", planner: Planner, types: Types, topic: Topic) -> None:
    """Publish trajectories until the run ends; the last one once more if no frame comes, for a late listener."""
    node = Ros2Node("planner")
    node.types = types
    node.listen(KINEMATIC)
    node.announce(topic)
    last: Any = None
    while run.poll() is None:
        if not node.wait(KINEMATIC, 0.5):
            if last is not None:
                node.publish(Message(topic, planner.trajectory(last)))
            continue
        for odometry in node.received(KINEMATIC):
            last = odometry
            made = planner.step(odometry)
            if made is not None:
                node.publish(Message(topic, made))
    node.close()


def started(stack: ExitStack, log: Path, *words: str) -> "subprocess.Popen[bytes]":
    """Start a program with its output in a file; it ends with the stack."""
    process = subprocess.Popen(words, stdout=stack.enter_context(log.open("wb")), stderr=subprocess.STDOUT)
    stack.callback(process.wait)
    stack.callback(process.terminate)
    return process


if __name__ == "__main__":
    sys.exit(main())
