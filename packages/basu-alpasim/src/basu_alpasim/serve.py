"""``basu serve egodriver``: listen, and answer until Ctrl-C."""

from __future__ import annotations

import math
import signal
import threading
from typing import TYPE_CHECKING

from carla_driver_interface.server import serving

from basu.agents.builtin.perception import OTHERS_TOP_MPS
from basu.agents.builtin.scene import VehicleGeometry
from basu.errors import UserError
from basu.records.recording_files import read_map
from basu.routing import plan
from basu.routing.route_file import read_routes
from basu_alpasim.basic_policy import BasicPolicy, Known

if TYPE_CHECKING:
    import argparse

    from carla_driver_interface.service import ServiceMode

    from basu.routing import Route


def run(arguments: argparse.Namespace) -> int:
    """Offer the agent as a policy until Ctrl-C or SIGTERM.

    Raises:
        UserError: a route, a length or an address cannot be used.
    """
    known = Known(_body(arguments), _route(arguments), _cruise_mps(arguments.cruise), arguments.agent)
    ended = end_of_service()
    mode: ServiceMode = "alpasim" if arguments.alpasim else "carla"  # what lies in ``renderer_data``
    try:
        with serving(BasicPolicy(known), arguments.port, arguments.host, mode=mode) as port:
            print(f"the policy 'basu-{known.agent}' listens at {arguments.host}:{port}; end it with Ctrl-C", flush=True)
            ended.wait()
    except RuntimeError as error:
        raise UserError(
            f"nothing can listen at {arguments.host}:{arguments.port} ({error}); choose another --port"
        ) from None
    return 0


def end_of_service() -> threading.Event:
    """Return an event that Ctrl-C and SIGTERM set."""
    ended = threading.Event()
    for number in (signal.SIGTERM, signal.SIGINT):
        signal.signal(number, lambda _number, _frame: ended.set())
    return ended


def _body(arguments: argparse.Namespace) -> VehicleGeometry:
    """The vehicle that is driven.

    Raises:
        UserError: a length is none.
    """
    lengths = (arguments.wheelbase, arguments.rear_axle, arguments.front, arguments.rear, arguments.width)
    if not all(math.isfinite(length) and length > 0.0 for length in lengths):
        raise UserError("--wheelbase, --rear-axle, --front, --rear and --width are lengths in m, above 0")
    wheelbase_m, axle_m, front_m, rear_m, width_m = lengths
    return VehicleGeometry(wheelbase_m, axle_m, front_m, rear_m, width_m / 2.0)


def _cruise_mps(given: float | None) -> float:
    """The greatest speed.

    Raises:
        UserError: it is none.
    """
    if given is None:
        return OTHERS_TOP_MPS
    if not (math.isfinite(given) and given > 0.0):
        raise UserError(f"--cruise {given:g} is no speed in m/s above 0")
    return given


def _route(arguments: argparse.Namespace) -> Route | None:
    """The route that the policy knows beforehand.

    Raises:
        UserError: it cannot be read, or not be laid on the map.
    """
    if arguments.routes is None:
        if arguments.map is not None:
            raise UserError("--map has the lanes of a route; give the route with --routes FILE.xml, or leave it out")
        return None
    if arguments.map is None:
        raise UserError("--routes lays a route on a map; give the map with --map FILE.xodr")
    routes = read_routes(arguments.routes)
    chosen = [route for route in routes if arguments.route_id in {None, route.id}]
    if len(chosen) != 1:
        ids = ", ".join(route.id for route in routes)
        raise UserError(f"{arguments.routes} has the routes {ids}; choose one with --route-id")
    return plan(read_map(arguments.map, arguments.map.stem), chosen[0])
