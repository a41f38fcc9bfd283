"""Arguments of ``basu ros bag``, ``read`` and ``scans``."""

from __future__ import annotations

import argparse
from pathlib import Path

from basu.cli.later import later
from basu.plugins import Command

EZ10_M = (1.97, 1.97, 1.99)  # front, rear and width of vehicle.easymile.ez10, the default vehicle


def add_ros(ros: argparse.ArgumentParser) -> None:
    """Add the commands of ``basu ros``."""
    actions = ros.add_subparsers(title="commands", required=True, metavar="COMMAND")
    bag = actions.add_parser("bag", help="write a run's record as a bag")
    bag.description = (
        "Write a run's record as a ROS bag: state, controls, other actors, events, TF; no sensors, which it has not."
    )
    bag.add_argument("folder", type=Path, metavar="RUN", help="a run's folder, such as runs/latest")
    bag.add_argument(
        "-o",
        "--output",
        type=Path,
        required=True,
        metavar="BAG",
        help="where to: a folder (ROS 2), a file that ends in .mcap (ROS 2) or in .bag (ROS 1)",
    )
    bag.set_defaults(command=later("basu_ros.cli.ros_bag:run"))
    _add_read(actions.add_parser("read", help="make a run's record of a bag"))
    _add_scans(actions.add_parser("scans", help="write the clouds of a bag for a point cloud map"))


def _add_scans(scans: argparse.ArgumentParser) -> None:
    """Add the arguments of ``basu ros scans``."""
    scans.description = (
        "Write the clouds of a lidar in a bag as PCD files with the sensor's poses in the map, which "
        "`linden map pointcloud --from` makes a map of."
    )
    scans.add_argument("bag", type=Path, metavar="BAG", help="a bag of ROS 1 or ROS 2 with a lidar and TF")
    scans.add_argument("-o", "--output", type=Path, required=True, metavar="FOLDER", help="the folder to write")
    scans.add_argument("--topic", metavar="TOPIC", help="the lidar's clouds (default: the only ones)")
    scans.add_argument("--every", type=int, default=1, metavar="N", help="take each Nth cloud (default: %(default)s)")
    scans.set_defaults(command=later("basu_ros.cli.ros_scans:run"))


def _add_read(read: argparse.ArgumentParser) -> None:
    """Add the arguments of ``basu ros read``."""
    read.description = "Make a run's record of the odometry and the controls in a bag, which `basu score` then judges."
    front_m, rear_m, width_m = EZ10_M
    read.add_argument("bag", type=Path, metavar="BAG", help="a bag of ROS 1 or ROS 2")
    read.add_argument("-o", "--output", type=Path, required=True, metavar="RUN", help="the folder to write")
    read.add_argument("--odometry", metavar="TOPIC", help="its odometry (default: the only one)")
    read.add_argument("--control", metavar="TOPIC", help="its controls, CARLA's (default: the only one, or none)")
    read.add_argument("--map", type=Path, metavar="FILE.xodr", help="the map of the drive, for lanes and limits")
    read.add_argument("--routes", type=Path, metavar="FILE.xml", help="a route to hold the drive against, on --map")
    read.add_argument("--route-id", metavar="ID", help="which one of the file (default: the only one)")
    read.add_argument(
        "--front", type=float, default=front_m, metavar="M", help="middle to front (default: %(default)s)"
    )
    read.add_argument("--rear", type=float, default=rear_m, metavar="M", help="middle to rear (default: %(default)s)")
    read.add_argument("--width", type=float, default=width_m, metavar="M", help="of the vehicle (default: %(default)s)")
    read.add_argument(
        "--origin",
        type=float,
        default=0.0,
        metavar="M",
        help="how far the vehicle's middle lies ahead of the point of the odometry, such as a rear axle "
        "(default: %(default)s)",
    )
    read.set_defaults(command=later("basu_ros.cli.ros_read:run"))


ROS = Command("ROS bags of runs, and runs of ROS bags", add_ros)
