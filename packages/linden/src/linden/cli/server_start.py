"""The start of a server: ports, map, world, walking mesh, compiled kernels."""

import argparse
import logging
from functools import partial
from typing import NamedTuple

from linden.background import share_one_heap
from linden.cli.compiling import FirstStart
from linden.errors import Refusal, UserError
from linden.maps.cache import MapCache
from linden.maps.library import HOME_MAP, MapLibrary
from linden.maps.navigation.library import MeshLibrary
from linden.protocol.values.episode import EpisodeSettings
from linden.protocol.wire.packed import warm_up as warm_batches
from linden.replay.file.folder import RecordingFolder
from linden.scenery.map_mesh_cache import has_standing, keep_standing, standing_of
from linden.sensors.casting.caster import CPU
from linden.server import frames
from linden.server.loop import Server
from linden.server.ports import is_loopback, open_ports, port_of
from linden.server.rpc import registry
from linden.simulation.walkers import mesh_file
from linden.world import World

SYNCHRONOUS = EpisodeSettings(synchronous_mode=True, fixed_delta_seconds=0.05)
log = logging.getLogger("linden")


class Started(NamedTuple):
    """A server that is ready to serve."""

    server: Server
    rpc_port: int
    streaming_port: int


def make_server(arguments: argparse.Namespace, first_start: FirstStart) -> Started:
    """Open the ports, load the map and make everything that a first tick needs.

    Raises:
        UserError: a port, a map or the device cannot be had.
    """
    if arguments.device != CPU:
        from linden.sensors.casting.choose import check_device  # noqa: PLC0415 - Embree, for which a start need not wait

        check_device(arguments.device)
    share_one_heap()
    registry.load_handlers()
    if not is_loopback(arguments.host):
        log.warning(
            "every machine that reaches %s can control this server, for CARLA's protocol has no login; "
            "name 127.0.0.1 with --host, or restrict access with a firewall",
            arguments.host,
        )
    ports = open_ports(arguments.host, arguments.port, arguments.streaming_port)
    cache = MapCache.of_user()
    maps, meshes = MapLibrary(arguments.maps, cache.read), MeshLibrary(cache)
    first_start.begin(cache)  # so that a client's first tick takes no longer than the others
    try:
        world_map = maps.load(arguments.map)
    except Refusal as refusal:
        raise UserError(f"--map: {refusal}") from refusal
    simulation = World(world_map, SYNCHRONOUS if arguments.sync else EpisodeSettings())
    simulation.episode.warm_up()
    warm_batches()
    first_start.step("the world")
    simulation.sensor_scene.device = arguments.device
    simulation.sensor_scene.standing_on = partial(standing_of, cache=cache)
    simulation.sensor_scene.await_kernels, simulation.sensor_scene.is_compiling = (
        first_start.await_sensors,
        first_start.is_compiling,
    )
    mesh_file(simulation.episode, meshes)  # every client asks for it before anything else
    first_start.step("the walking mesh")
    first_start.finish_physics()
    scene = simulation.episode.surroundings.scene
    is_home, is_kept = arguments.map == HOME_MAP, has_standing(world_map, scene, cache)
    first_start.compile_sensors(scenery=is_home and not is_kept)
    if not is_home:
        keep_standing(world_map, scene, cache)  # seconds, if it is not there yet
    server = Server(simulation, maps, frames, ports)
    server.context.recordings = RecordingFolder(arguments.recordings)
    server.context.meshes = meshes
    return Started(server, port_of(ports.rpc), port_of(ports.streaming))
