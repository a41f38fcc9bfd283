"""``basu ros read``: the record of a run, made of the odometry and the controls in a ROS bag."""

from __future__ import annotations

import argparse
import shutil
import sys
from pathlib import Path
from typing import TYPE_CHECKING

from basu.errors import UserError
from basu.output.report.documents import make_draft, publish
from basu.records.history.files import write_history
from basu.records.recording_files import read_map
from basu.routing.route_file import read_routes
from basu_ros.bag_track import read_track
from basu_ros.output.track_record import Shape, record_of

if TYPE_CHECKING:
    import carla

    from basu.routing.route_file import RouteDescription


def run(arguments: argparse.Namespace) -> int:
    """Make a run's record of the odometry and the controls in a bag, which `basu score` then judges."""
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
