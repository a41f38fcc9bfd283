"""``linden serve``: open the ports, load the map, make the kernels ready, serve until told to stop."""

import argparse
import gc
import logging
import os
from collections.abc import Iterator
from contextlib import contextmanager
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

from linden.cli.compiling import FirstStart
from linden.cli.process import Ending, allow_connections, background_work_ended, give_up_stdout, write_log
from linden.protocol.values.episode import EpisodeSettings

if TYPE_CHECKING:
    from linden.server.loop import Server

DEFAULT_PORT = 2000
SYNCHRONOUS = EpisodeSettings(synchronous_mode=True, fixed_delta_seconds=0.05)
log = logging.getLogger("linden")

LOG_LEVELS = ("debug", "info", "warning", "error")


def add_parser(commands: "argparse._SubParsersAction[argparse.ArgumentParser]") -> None:
    """Add the command ``serve``."""
    serve = commands.add_parser("serve", help="run the server until Ctrl-C", description=__doc__)
    serve.add_argument("--host", "--bind", default="127.0.0.1", help="address to listen on (default: %(default)s)")
    serve.add_argument(
        "--port", type=int, default=DEFAULT_PORT, help="RPC port, 0 lets the system choose (default: %(default)s)"
    )
    serve.add_argument("--streaming-port", type=int, help="port of the sensor streams (default: the one after --port)")
    serve.add_argument("--map", default="Linden", help="map to begin with (default: %(default)s)")
    serve.add_argument(
        "--maps", type=Path, action="append", default=[], metavar="DIR", help="offer every .xodr of a folder as a map"
    )
    serve.add_argument(
        "--recordings",
        type=Path,
        metavar="DIR",
        help="folder that recordings are written to and replayed from (default: linden/recordings in the user's data)",
    )
    serve.add_argument(
        "--sync",
        action="store_true",
        help="begin in synchronous mode with steps of 0.05 s: no frame before the first tick",
    )
    serve.add_argument(
        "--device",
        default="cpu",
        metavar="NAME",
        help="where rays of cameras, lidars, radars are cast: cpu, or cuda with the extra gpu (default: %(default)s)",
    )
    serve.add_argument("--log-level", choices=LOG_LEVELS, default="warning", help="(default: %(default)s)")
    serve.set_defaults(command=run)


def run(arguments: argparse.Namespace) -> int:
    """Serve until SIGINT or SIGTERM.

    Raises:
        UserError: a port or a map cannot be had.
    """
    write_log(arguments.log_level.upper())
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # numpy would start one a core, and they spin; we are one thread
    allow_connections()
    first_start = FirstStart(_say)
    with background_work_ended(), Ending() as ending:
        try:
            with _collector_paused():
                server = _make_server(arguments, first_start)
            ending.ask_first(server.stop)
            server.run()
        finally:
            first_start.end()
    return 0


def _make_server(arguments: argparse.Namespace, first_start: FirstStart) -> "Server":
    # here, not above: these bring in the compiler, which other commands of this program do not need
    from linden.errors import Refusal, UserError  # noqa: PLC0415 - see above
    from linden.maps.cache import MapCache  # noqa: PLC0415 - see above
    from linden.maps.library import HOME_MAP, MapLibrary  # noqa: PLC0415 - see above
    from linden.maps.navigation.library import MeshLibrary  # noqa: PLC0415 - see above
    from linden.replay.file.folder import RecordingFolder  # noqa: PLC0415 - see above
    from linden.scenery.actors.actor_meshes_cache import bodies_of, keep_bodies  # noqa: PLC0415 - see above
    from linden.scenery.map_mesh_cache import keep_standing, standing_of  # noqa: PLC0415 - see above
    from linden.sensors.casting.caster import CPU  # noqa: PLC0415 - see above
    from linden.server import frames  # noqa: PLC0415 - see above
    from linden.server.loop import Server  # noqa: PLC0415 - see above
    from linden.server.ports import is_loopback, open_ports, port_of  # noqa: PLC0415 - see above
    from linden.server.rpc import registry  # noqa: PLC0415 - see above
    from linden.simulation.walkers import mesh_file  # noqa: PLC0415 - see above
    from linden.world import World  # noqa: PLC0415 - see above

    if arguments.device != CPU:
        from linden.sensors.casting.choose import check_device  # noqa: PLC0415 - see above

        check_device(arguments.device)
    registry.load_handlers()
    if not is_loopback(arguments.host):
        log.warning(
            "every machine that reaches %s can control this server, for CARLA's protocol has no login; "
            "name 127.0.0.1 with --host, or restrict access with a firewall",
            arguments.host,
        )
    ports = open_ports(arguments.host, arguments.port, arguments.streaming_port)
    cache = MapCache.of_user()
    maps, meshes = MapLibrary(arguments.maps, cache.facts_of), MeshLibrary(cache)
    first_start.begin(cache)  # so that a client's first tick takes no longer than the others
    try:
        world_map = maps.load(arguments.map)
    except Refusal as refusal:
        raise UserError(f"--map: {refusal}") from refusal
    simulation = World(world_map, SYNCHRONOUS if arguments.sync else EpisodeSettings())
    simulation.episode.warm_up()
    first_start.step("the world")
    simulation.sensor_scene.device = arguments.device
    simulation.sensor_scene.standing_on = partial(standing_of, cache=cache)
    simulation.sensor_scene.bodies_of = partial(bodies_of, cache=cache)
    simulation.sensor_scene.await_kernels, simulation.sensor_scene.is_compiling = (
        first_start.await_sensors,
        first_start.is_compiling,
    )
    mesh_file(simulation.episode, meshes)  # every client asks for it before anything else
    first_start.step("the walking mesh")
    first_start.finish_physics()
    if not first_start.compile_sensors() or arguments.map != HOME_MAP:
        keep_bodies(simulation.library, cache)
        keep_standing(world_map, simulation.episode.surroundings.scene, cache)  # seconds, if it is not there yet
    server = Server(simulation, maps, frames, ports)
    server.context.recordings = RecordingFolder(arguments.recordings)
    server.context.meshes = meshes
    _say(f"linden: ready, rpc port {port_of(ports.rpc)}, streaming port {port_of(ports.streaming)}")
    return server


@contextmanager
def _collector_paused() -> Iterator[None]:
    """Look for no garbage among what a start makes, nor ever afterwards: nearly all of it stays."""
    gc.disable()
    try:
        yield
        gc.freeze()
    finally:
        gc.enable()


def _say(line: str) -> None:
    """Print a line for programs, at once. A server with closed output goes on serving."""
    try:
        print(line, flush=True)  # noqa: T201 - what a command says to its user
    except OSError as error:  # a closed pipe, a full disk
        log.warning("cannot print %r: %s", line, error)
        give_up_stdout()
