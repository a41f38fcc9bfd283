"""``basu ros``: bags of runs, runs of bags."""

from __future__ import annotations

import argparse
import shutil
import sys
from pathlib import Path
from typing import TYPE_CHECKING

from basu.errors import UserError

if TYPE_CHECKING:
    import carla

    from basu.routing.route_file import RouteDescription

EZ10_M = (1.97, 1.97, 1.99)  # front, rear and width of vehicle.easymile.ez10, the default vehicle


def add_ros(ros: argparse.ArgumentParser) -> None:
    """Add the commands of ``basu ros``."""
    actions = ros.add_subparsers(title="commands", required=True, metavar="COMMAND")
    bag = actions.add_parser("bag", help="write a run's record as a bag", description=write_bag.__doc__)
    bag.add_argument("folder", type=Path, metavar="RUN", help="a run's folder, such as runs/latest")
    bag.add_argument(
        "-o",
        "--output",
        type=Path,
        required=True,
        metavar="BAG",
        help="where to: a folder (ROS 2), a file that ends in .mcap (ROS 2) or in .bag (ROS 1)",
    )
    bag.set_defaults(command=write_bag)
    read = actions.add_parser("read", help="make a run's record of a bag", description=read_bag.__doc__)
    _add_read(read)


def _add_read(read: argparse.ArgumentParser) -> None:
    """Add the arguments of ``basu ros read``."""
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
    read.set_defaults(command=read_bag)


def write_bag(arguments: argparse.Namespace) -> int:
    """Write a run's record as a ROS bag: state, controls, other actors, events, TF; no sensors, which it has not."""
    from basu.output.ros.record_bag import write_record  # noqa: PLC0415 - numpy, which `--help` does not need
    from basu.records.history.files import read_history  # noqa: PLC0415 - likewise
    from basu.ros.types import Generation  # noqa: PLC0415 - likewise

    output: Path = arguments.output
    if output.exists():
        raise UserError(f"{output} exists already; name another place with --output, or remove it")
    history = read_history(arguments.folder)
    generation = Generation.ROS_1 if output.suffix == ".bag" else Generation.ROS_2
    name = output.stem if output.suffix == ".mcap" else output.name
    draft = output.with_name(f".{output.name}.part")
    shutil.rmtree(draft, ignore_errors=True)
    try:
        draft.mkdir(parents=True)
        messages = write_record(history, draft / name, generation)
        written = draft / name / f"{name}.mcap" if output.suffix == ".mcap" else draft / name
        written.replace(output)
    except OSError as error:
        raise UserError(f"{output} cannot be written: {error.strerror}; name another place with --output") from error
    finally:
        shutil.rmtree(draft, ignore_errors=True)
    print(f"ROS bag           {output} ({messages} messages, {history.frames['t_s'][-1]:.2f} s)")
    return 0


def read_bag(arguments: argparse.Namespace) -> int:
    """Make a run's record of the odometry and the controls in a bag, which `basu score` then judges."""
    from basu.output.report.documents import make_draft, publish  # noqa: PLC0415 - as above
    from basu.output.ros.track_record import Shape, record_of  # noqa: PLC0415 - as above
    from basu.records.history.files import write_history  # noqa: PLC0415 - as above
    from basu.ros.bag_track import read_track  # noqa: PLC0415 - as above

    output: Path = arguments.output
    if output.exists():
        raise UserError(f"{output} exists already; name another place with --output, or remove it")
    town, described = _ground(arguments)
    shape = Shape(arguments.front, arguments.rear, arguments.width, arguments.origin)
    if not min(shape.front_m, shape.rear_m, shape.width_m) > 0.0:
        raise UserError("--front, --rear and --width are lengths in m, above 0")
    track = read_track(arguments.bag, arguments.odometry, arguments.control)
    name = "" if arguments.map is None else arguments.map.stem
    history = record_of(track, shape, carla_map=town, description=described, town=name)
    if town is None:
        print(
            "basu: warning: without --map nothing is known of lanes, limits and lights; read comfort and speed only",
            file=sys.stderr,
        )
    draft = make_draft(output.parent, output.name)
    try:
        write_history(draft, history)
        folder = publish(draft, output.name)
    except BaseException:
        shutil.rmtree(draft, ignore_errors=True)
        raise
    print(
        f"record            {folder} ({len(history.frames)} frames of {track.topic}); `basu score {folder}` judges it"
    )
    return 0


def _ground(arguments: argparse.Namespace) -> tuple[carla.Map | None, RouteDescription | None]:
    """The map and the route that the options name.

    Raises:
        UserError: one of them cannot be used.
    """
    from basu.records.carla_log.sources import read_map  # noqa: PLC0415 - as above
    from basu.routing.route_file import read_routes  # noqa: PLC0415 - as above

    if arguments.routes is not None and arguments.map is None:
        raise UserError("--routes lays a route on a map; give the map with --map FILE.xodr")
    town = None if arguments.map is None else read_map(arguments.map, arguments.map.stem)
    if arguments.routes is None:
        return town, None
    routes = read_routes(arguments.routes)
    chosen = [route for route in routes if arguments.route_id in {None, route.id}]
    if len(chosen) != 1:
        ids = ", ".join(route.id for route in routes)
        raise UserError(f"{arguments.routes} has the routes {ids}; choose one with --route-id")
    return town, chosen[0]
