"""NDT matching of Autoware.AI on a bag's lidar scans and our cloud of the town, against the bag's true poses.

    python scripts/outside/autoware_ai/ndt.py OUT CLOUD.pcd BAG [--leaf M] [--resolution M] [--every N] -o FOLDER

OUT has the programs of Autoware.AI (``docs/how-to/ros.md``). BAG is a bag that `basu run ... --rosbag` wrote with a
lidar. Each scan is published when the pose of the one before has come, so no scan is dropped. The first pose is the
true one; every other is NDT's own work. Writes ndt.json and ndt.jpg.
"""
# ruff: noqa: ANN401 - messages of ROS

import argparse
import json
import math
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any, NamedTuple
from xmlrpc.client import ServerProxy

import matplotlib as mpl

mpl.use("Agg")
import ndt_settings
import numpy as np
from matplotlib import pyplot as plt
from numpy.typing import NDArray
from rosbags.highlevel import AnyReader
from stack import Stack, running_stack

from basu.errors import UserError
from basu_ros import vehicle_messages as of_vehicle
from basu_ros.autoware_ai import GNSS_POSE, NDT_POSE, POINTS, POSE
from basu_ros.ros1 import Ros1Node
from basu_ros.topics import TF_STATIC, odometry_of
from linden_ros2 import basic_messages as basic
from linden_ros2.basic_messages import NS_PER_S
from linden_ros2.topic import CLOCK, Message, Topic
from linden_ros2.types import Generation, Types

MAP_STAT = Topic("/pmap_stat", "std_msgs/msg/Bool")
TIME = Topic("/time_ndt_matching", "std_msgs/msg/Float32", depth=10)
LONG_S = 300.0  # wall time: the cloud of a route is read and made into cells
GOAL_CM = 5.0


class Scan(NamedTuple):
    """A scan and the true pose of the vehicle in its moment."""

    at_ns: int
    cloud: Any
    pose: Any


class Match(NamedTuple):
    """What NDT matching found of a scan, against the truth."""

    t_s: float
    along_m: float  # to the front
    across_m: float  # to the left
    up_m: float
    yaw_deg: float
    took_ms: float


def main() -> int:
    """Match all scans, and write what came of it."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("out", type=Path)
    parser.add_argument("cloud", type=Path)
    parser.add_argument("bag", type=Path)
    parser.add_argument("--sensor", default="top", help="ID of the lidar in the bag")
    parser.add_argument("--ahead", type=float, default=2.0, help="of the lidar ahead of the vehicle's middle, m")
    parser.add_argument("--height", type=float, default=2.9, help="of the lidar above the ground, m")
    parser.add_argument(
        "--leaf", type=float, default=ndt_settings.LEAF_M, help="of the scan's voxel grid, m (default: Autoware.AI's)"
    )
    parser.add_argument(
        "--resolution", type=float, default=ndt_settings.RESOLUTION_M, help="of NDT's cells, m (default: Autoware.AI's)"
    )
    parser.add_argument("--every", type=int, default=1, help="take every Nth scan")
    parser.add_argument("--until", type=float, default=math.inf, metavar="S", help="end of the drive that is taken")
    parser.add_argument("-o", "--output", type=Path, required=True)
    args = parser.parse_args()
    if not (args.out / "build" / "ndt_matching").exists():
        print("skipped: ndt_matching is not built; see docs/how-to/ros.md")
        return 0
    args.output.mkdir(parents=True, exist_ok=True)
    with running_stack(args.out, args.output / "logs") as stack:
        node = started(stack, args)
        try:
            scans = scans_of(args.bag, args.sensor, args.every, args.until)
            matches = list(matched(node, scans))
        finally:
            node.close()
    told = {"leaf_m": args.leaf, "resolution_m": args.resolution, **summary(matches)}
    print(json.dumps(told, indent=1))
    (args.output / "ndt.json").write_text(json.dumps(told, indent=1), encoding="utf-8")
    draw(matches, args.output / "ndt.jpg")
    return 0 if told["p95_cm"] < GOAL_CM else 1


def started(stack: Stack, args: argparse.Namespace) -> Ros1Node:
    """A node beside NDT matching, which has its settings and the cloud."""
    master = ServerProxy(stack.environment["ROS_MASTER_URI"])
    values = {"localizer": "velodyne", "tf_x": args.ahead, "tf_y": 0.0, "tf_z": args.height}
    for name, value in {**values, "tf_roll": 0.0, "tf_pitch": 0.0, "tf_yaw": 0.0}.items():
        master.setParam("/ndt", f"/{name}", value)
    node = Ros1Node("ndt")
    node.listen(NDT_POSE, TIME, MAP_STAT)
    node.announce(POINTS, GNSS_POSE, CLOCK, TF_STATIC)
    stack.node("voxel_grid_filter", "__name:=voxel_grid_filter", "_points_topic:=/points_raw")
    words = ("_method_type:=1", "_use_gnss:=1", "_use_odom:=false", "_use_imu:=false", "_offset:=linear")
    stack.node("ndt_matching", "__name:=ndt_matching", *words)
    types = ndt_settings.types()
    node.publish_as(types, ndt_settings.voxel(types, args.leaf), ndt_settings.matching(types, args.resolution))
    for topic in (ndt_settings.VOXEL, ndt_settings.MATCHING, POINTS, GNSS_POSE):
        if not node.wait_for_peers(topic, LONG_S):
            raise UserError(f"no node of Autoware.AI listens on {topic.name}; see {args.output / 'logs'}")
    # The cloud comes after the settings, for the cells are made once, with the resolution of that moment.
    stack.node("points_map_loader", "__name:=points_map_loader", "noupdate", str(args.cloud.resolve()))
    if not node.wait(MAP_STAT, LONG_S):
        raise UserError(f"points_map_loader does not read {args.cloud}; see {args.output / 'logs'}")
    return node


def scans_of(bag: Path, sensor: str, every: int, until_s: float) -> Iterator[Scan]:
    """The scans of a bag with the poses of their moments."""
    truth, cloud = odometry_of("hero").name, f"/carla/hero/{sensor}"
    waiting: dict[int, Any] = {}
    number = 0
    with AnyReader([bag], default_typestore=Types(Generation.ROS_2).store) as reader:
        wanted = [each for each in reader.connections if each.topic in {truth, cloud}]
        poses: dict[int, Any] = {}
        for connection, at_ns, data in reader.messages(connections=wanted):
            if at_ns > until_s * NS_PER_S:
                return
            message = reader.deserialize(data, connection.msgtype)
            (poses if connection.topic == truth else waiting)[time_ns(message)] = message
            for key in sorted(poses.keys() & waiting.keys()):
                if number % every == 0:
                    yield Scan(key, waiting[key], poses[key].pose.pose)
                number += 1
                del poses[key], waiting[key]


def matched(node: Ros1Node, scans: Iterator[Scan]) -> Iterator[Match]:
    """What NDT finds of each scan."""
    types = node.types
    for number, scan in enumerate(scans):
        header = basic.header(types, scan.at_ns / NS_PER_S, of_vehicle.MAP)
        if number == 0:
            node.publish(Message(GNSS_POSE, types.message(POSE, header=header, pose=copied(types, scan.pose))))
        node.publish(Message(POINTS, cloud_message(types, scan)))
        found = found_pose(node, scan, first=number == 0)
        if found is None:
            return
        took = [message.data for message in node.received(TIME)]
        yield compared(scan, found, took[-1] if took else math.nan)
        if number % 100 == 0:
            print(f"{scan.at_ns / NS_PER_S:.1f} s", file=sys.stderr, flush=True)


def found_pose(node: Ros1Node, scan: Scan, *, first: bool) -> Any:
    """The pose of a scan; None where it does not come. The first scan is repeated until the cloud is loaded."""
    for _ in range(100 if first else 20):
        node.wait(NDT_POSE, 3.0)
        for message in node.received(NDT_POSE):
            if abs(time_ns(message) - scan.at_ns) < NS_PER_S // 1000:
                return message.pose
        if first:
            node.publish(Message(POINTS, cloud_message(node.types, scan)))
    print(f"NDT matching gave no pose for the scan of {scan.at_ns / NS_PER_S:.2f} s", flush=True)
    return None


def cloud_message(types: Types, scan: Scan) -> Any:
    """A scan as a message of ROS 1."""
    names = ("height", "width", "is_bigendian", "point_step", "row_step", "is_dense")
    rows = ("name", "offset", "datatype", "count")
    values = {name: getattr(scan.cloud, name) for name in names}
    fields = [
        types.message("sensor_msgs/msg/PointField", **{row: getattr(field, row) for row in rows})
        for field in scan.cloud.fields
    ]
    header = basic.header(types, scan.at_ns / NS_PER_S, "velodyne")
    return types.message(POINTS.type, header=header, fields=fields, data=scan.cloud.data, **values)


def copied(types: Types, pose: Any) -> Any:
    """A pose of a bag as one of ROS 1."""
    at, turn = pose.position, pose.orientation
    return types.message(
        "geometry_msgs/msg/Pose",
        position=types.message("geometry_msgs/msg/Point", x=at.x, y=at.y, z=at.z),
        orientation=types.message("geometry_msgs/msg/Quaternion", x=turn.x, y=turn.y, z=turn.z, w=turn.w),
    )


def time_ns(message: Any) -> int:
    """The time of a message, to the microsecond."""
    stamp = message.header.stamp
    return int(round((stamp.sec * NS_PER_S + stamp.nanosec) / 1000.0) * 1000)


def yaw_rad(turn: Any) -> float:
    """The yaw of an attitude."""
    return math.atan2(2.0 * (turn.w * turn.z + turn.x * turn.y), 1.0 - 2.0 * (turn.y**2 + turn.z**2))


def compared(scan: Scan, found: Any, took_ms: float) -> Match:
    """The error of a found pose in the vehicle's axes."""
    true, heading = scan.pose.position, yaw_rad(scan.pose.orientation)
    x, y = found.position.x - true.x, found.position.y - true.y
    turned = yaw_rad(found.orientation) - heading
    return Match(
        scan.at_ns / NS_PER_S,
        x * math.cos(heading) + y * math.sin(heading),
        y * math.cos(heading) - x * math.sin(heading),
        found.position.z - true.z,
        math.degrees(math.atan2(math.sin(turned), math.cos(turned))),
        took_ms,
    )


def summary(matches: list[Match]) -> dict[str, Any]:
    """Mean, 95th percentile and greatest of the errors; ``cm`` is the horizontal distance."""
    values = np.array(matches)
    away = np.hypot(values[:, 1], values[:, 2]) * 100.0
    told: dict[str, Any] = {"scans": len(matches), "to_s": round(float(values[-1, 0]), 2)}
    rows: dict[str, NDArray[np.float64]] = {
        "cm": away,
        "along_cm": np.abs(values[:, 1]) * 100.0,
        "across_cm": np.abs(values[:, 2]) * 100.0,
        "up_cm": np.abs(values[:, 3]) * 100.0,
        "yaw_deg": np.abs(values[:, 4]),
        "took_ms": values[:, 5],
    }
    for name, row in rows.items():
        told[f"mean_{name}"] = round(float(np.nanmean(row)), 3)
        told[f"p95_{name}"] = round(float(np.nanpercentile(row, 95)), 3)
        told[f"max_{name}"] = round(float(np.nanmax(row)), 3)
    return told


def draw(matches: list[Match], file: Path) -> None:
    """Draw the errors over the time."""
    values = np.array(matches)
    figure, axes = plt.subplots(figsize=(9, 3.5))
    axes.plot(values[:, 0], values[:, 1] * 100.0, label="along the vehicle", linewidth=0.9)
    axes.plot(values[:, 0], values[:, 2] * 100.0, label="across", linewidth=0.9)
    for edge in (-GOAL_CM, GOAL_CM):
        axes.axhline(edge, color="0.6", linewidth=0.8)
    axes.set_xlabel("time, s")
    axes.set_ylabel("error of NDT matching, cm")
    axes.legend()
    figure.savefig(file, dpi=110, bbox_inches="tight")


if __name__ == "__main__":
    sys.exit(main())
