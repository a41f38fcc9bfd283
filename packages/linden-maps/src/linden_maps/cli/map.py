"""``linden map``: build OpenDRIVE from streets, check, draw and count it, export what is seen, measure it by lidar."""

import argparse
from collections.abc import Callable
from pathlib import Path

from linden_maps.cli.argument_types import angle, count, not_negative, positive
from linden_maps.cli.later import later


def add_parser(commands: "argparse._SubParsersAction[argparse.ArgumentParser]") -> None:
    """Add the command ``map`` with its own commands."""
    maps = commands.add_parser("map", help="build, check, show and count maps", description=__doc__)
    actions = maps.add_subparsers(title="commands", required=True, metavar="COMMAND")
    for name, (add_arguments, text) in _COMMANDS.items():
        parser = actions.add_parser(name, help=text, description=f"{text[0].upper()}{text[1:]}.")
        parser.set_defaults(command=later(f"linden_maps.cli.map_{name}:run"))
        add_arguments(parser)


def _add_file(command: argparse.ArgumentParser) -> None:
    """Add the map alone."""
    command.add_argument("file", help="an OpenDRIVE file, or the name of a built-in map such as Linden")


def _add_nothing(_command: argparse.ArgumentParser) -> None:
    """Leave a command without arguments."""


def _add_check(command: argparse.ArgumentParser) -> None:
    """Add the arguments of ``linden map check``."""
    _add_file(command)
    command.add_argument("--against", metavar="MAP", help="the OpenDRIVE map that a Lanelet2 file was made of")
    command.add_argument("--notes", action="store_true", help="tell also what is odd but allowed")


def _add_show(command: argparse.ArgumentParser) -> None:
    """Add the arguments of ``linden map show``."""
    _add_file(command)
    command.add_argument("--over", metavar="MAP", help="the OpenDRIVE map to draw below a Lanelet2 or Aisan one")
    command.add_argument(
        "--window", nargs=3, type=float, metavar=("X", "Y", "SIDE"), help="draw a square of a Lanelet2 or Aisan map, m"
    )
    command.add_argument("-o", "--output", type=Path, required=True, help="where to write the .svg file")


def _add_export(command: argparse.ArgumentParser) -> None:
    """Add the arguments of ``linden map export``."""
    _add_file(command)
    command.add_argument("-o", "--output", type=Path, required=True, help="where to write the .glb file")


def _add_build(command: argparse.ArgumentParser) -> None:
    """Add the arguments of ``linden map build``."""
    command.add_argument(
        "streets", nargs="?", type=Path, help="GeoJSON file, or OpenStreetMap extract (.osm); default: Linden's streets"
    )
    command.add_argument("-o", "--output", type=Path, required=True, help="where to write the .xodr file")
    command.add_argument(
        "--facts", type=Path, metavar="FILE", help="write the streets of an OpenStreetMap extract as GeoJSON too"
    )
    command.add_argument(
        "--elevation", type=Path, metavar="FILE", help="lay the streets on measured ground: a GeoTIFF, or LAS or LAZ"
    )
    command.add_argument(
        "--without-lights", action="store_true", help="put all-way stops in place of lights, as in Linden_thesis"
    )
    command.add_argument(
        "--route",
        action="append",
        default=[],
        metavar="NAME=FILE",
        help="write the route feature NAME of the streets as a route file, for `basu run --routes`; may be given "
        "several times",
    )


def _add_convert(command: argparse.ArgumentParser) -> None:
    """Add the arguments of ``linden map convert``."""
    command.add_argument("file", help="an OpenDRIVE file, the name of a built-in map, or a Lanelet2 file (for Aisan)")
    command.add_argument("-o", "--output", type=Path, required=True, help="a file that ends in .osm, or a folder")
    command.add_argument(
        "--transverse-mercator",
        action="store_true",
        help="let map_projector_info.yaml name the map's own projection instead of Local",
    )
    _add_choices(command)


def _add_choices(command: argparse.ArgumentParser) -> None:
    """Add what a user can choose of a Lanelet2 map."""
    command.add_argument(
        "--stops", type=Path, metavar="FILE", help="a route file; its stops become bus stops (default: Linden's own)"
    )
    command.add_argument(
        "--walkways", action="store_true", help="write sidewalks as lanelets too; Autoware takes these for crossings"
    )
    command.add_argument(
        "--format", type=int, choices=[1, 2], default=1, help="of Autoware's Lanelet2; 2 has roundabouts (default: 1)"
    )
    command.add_argument(
        "--pairwise-priority",
        action="store_true",
        help="name every way that yields to another, also where other ways do not",
    )


def _add_package(command: argparse.ArgumentParser) -> None:
    """Add the arguments of ``linden map package``."""
    command.add_argument("file", help="an OpenDRIVE file, or the name of a built-in map")
    command.add_argument(
        "--for", dest="user", choices=["autoware", "carla"], required=True, help="the program that reads the folder"
    )
    command.add_argument("-o", "--output", type=Path, required=True, help="a new folder, or one written before")
    command.add_argument(
        "--ros1", action="store_true", help="for autoware: the content folder of carla-autoware (Autoware.AI, ROS 1)"
    )
    command.add_argument("--no-usd", action="store_true", help="for carla: leave out USD, which needs usd-core")
    command.add_argument(
        "--pointcloud", type=Path, metavar="PCD", help="take this cloud instead of driving the streets with a lidar"
    )
    command.add_argument(
        "--voxel", default="0.2", metavar="M", help="width of the cloud's cells (default: %(default)s)"
    )
    _add_choices(command)
    command.add_argument("--every", default="5.0", metavar="M", help="between two scans (default: %(default)s)")
    command.add_argument(
        "--along",
        type=Path,
        metavar="ROUTE",
        help="for autoware: write the Aisan vector map and the cloud only along the first route of this file",
    )
    command.add_argument(
        "--within", type=positive, default=20.0, metavar="M", help="of the route (default: %(default)s)"
    )


def add_pointcloud(command: argparse.ArgumentParser) -> None:
    """Add the arguments of ``linden map pointcloud``."""
    command.add_argument("file", nargs="?", help="an OpenDRIVE file, or the name of a built-in map (default: Linden)")
    command.add_argument("-o", "--output", type=Path, required=True, help="where to write the .pcd file")
    command.add_argument(
        "--voxel",
        type=not_negative,
        default=0.2,
        metavar="M",
        help="width of the cells that keep one point each; 0 keeps all points (default: %(default)s)",
    )
    command.add_argument("--labels", action="store_true", help="give each point CARLA's semantic tag, as field label")
    drive = command.add_argument_group("the drive")
    drive.add_argument(
        "--every", type=positive, default=5.0, metavar="M", help="scan where none is nearer (default: %(default)s)"
    )
    drive.add_argument("--range", type=positive, default=100.0, metavar="M", help="(default: %(default)s)")
    drive.add_argument("--channels", type=count, default=64, metavar="N", help="(default: %(default)s)")
    drive.add_argument(
        "--columns", type=count, default=1800, metavar="N", help="rays of a channel in a turn (default: %(default)s)"
    )
    drive.add_argument("--upper-fov", type=angle, default=15.0, metavar="DEG", help="(default: %(default)s)")
    drive.add_argument("--lower-fov", type=angle, default=-25.0, metavar="DEG", help="(default: %(default)s)")
    drive.add_argument(
        "--height", type=positive, default=2.4, metavar="M", help="of the lidar above the lane (default: %(default)s)"
    )
    drive.add_argument(
        "--device", default="cpu", metavar="NAME", help="where rays are cast: cpu, or cuda (default: %(default)s)"
    )
    drive.add_argument("--scans", type=Path, metavar="DIR", help="keep every scan too, and its pose, in a new folder")
    existing = command.add_argument_group("existing scans, instead of a drive")
    existing.add_argument("--from", dest="source", type=Path, metavar="PATH", help="a folder of .pcd files, or one")
    existing.add_argument(
        "--poses",
        type=Path,
        metavar="FILE",
        help="where each was made (default: poses.txt of the folder; without it they lie in the map's frame)",
    )


def _add_sumo(command: argparse.ArgumentParser) -> None:
    """Add the arguments of ``linden map sumo``."""
    command.add_argument("file", help="an OpenDRIVE file, or the name of a built-in map such as Linden")
    command.add_argument("-o", "--output", type=Path, required=True, help="the folder to write; made where it is not")
    command.add_argument("--hour", type=float, default=9.5, help="hour of the day that the demand fits (default: 9.5)")
    command.add_argument("--duration", type=float, default=3600.0, metavar="S", help="of the demand (default: 3600)")
    command.add_argument("--scale", type=float, default=1.0, help="the demand against the usual one (default: 1)")
    command.add_argument("--seed", type=int, default=0, help="of the demand and of SUMO's drivers (default: 0)")
    command.add_argument("--stops", type=Path, metavar="FILE", help="a route file; its stops become bus stops")
    command.add_argument(
        "--places", type=Path, metavar="FILE", help="GeoJSON points with a kind (school, transit) (default: Linden's)"
    )
    command.add_argument("--no-people", action="store_true", help="without people, crossings and walking areas")
    command.add_argument("--no-riders", action="store_true", help="without passengers that wait for the shuttle")


_COMMANDS: dict[str, tuple[Callable[[argparse.ArgumentParser], None], str]] = {
    "build": (_add_build, "turn streets (GeoJSON, or an OpenStreetMap extract) into OpenDRIVE"),
    "check": (_add_check, "report what a careful reader finds wrong; exit 1 if anything is"),
    "show": (_add_show, "draw a map"),
    "export": (_add_export, "write all that stands on a map as glTF, for any 3D viewer"),
    "list": (_add_nothing, "print the names of the built-in maps"),
    "info": (_add_file, "count roads, junctions, signals, lanes"),
    "convert": (_add_convert, "turn a map into Lanelet2 (.osm) or an Aisan vector map (a folder), for Autoware"),
    "package": (_add_package, "write one folder with all that Autoware (or CARLA built on Unreal) needs of a town"),
    "pointcloud": (
        add_pointcloud,
        "drive the streets with a lidar, or take existing scans, and write one point cloud (.pcd)",
    ),
    "sumo": (_add_sumo, "write a SUMO network of a map with a demand, and compare both; exit 1 where they do not fit"),
}
"""Arguments and help of each command; the module ``map_NAME`` of this package carries it out."""
