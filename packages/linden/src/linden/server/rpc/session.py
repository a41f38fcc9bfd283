"""Functions of a whole session: version, maps, episodes, settings, ticks, streams, files, Traffic Managers.

Source of names and meanings: LibCarla 0.9.16 and ``CarlaServer.cpp``.
"""

import logging
from functools import partial
from typing import NamedTuple

import numpy as np

from linden import CARLA_VERSION
from linden.background import give_memory_back
from linden.errors import Refusal
from linden.maps.library import LoadedMap
from linden.maps.navigation.library import MeshFile
from linden.protocol.values.enums import MapLayer
from linden.protocol.values.episode import EpisodeSettings, MapInfo, OpendriveGenerationParameters
from linden.protocol.values.space import Transform
from linden.protocol.wire.decode import U16
from linden.protocol.wire.stream import WORLD_OBSERVER_ID, Token
from linden.server.frame_clock import LONGEST_STEP_S
from linden.server.rpc.context import Context, PendingLoad
from linden.server.rpc.registry import Long, method
from linden.simulation.walkers import mesh_file
from linden.world import World

log = logging.getLogger("linden")

_HALF_TURN_DEG = 180.0

MAX_FIXED_DELTA_S = 10.0
"""Longest fixed step accepted; CARLA sets none, but a step of minutes can only be a unit mixed up."""

MOST_SUBSTEPS = 100
"""Most substeps of a frame. Unreal's editor offers 16 at most, and a step of 1 s in substeps of 10 ms takes 100.

CARLA takes any number, and then stands still. One vehicle's substep takes up to 0.1 ms here, so a frame of 100 vehicles
takes at most a second.
"""


class EpisodeInfo(NamedTuple):
    """The running episode and where its snapshots come from."""

    id: int
    token: Token


@method("version")
def version(_context: Context) -> str:
    """Return the CARLA release of the protocol; the client compares it with its own."""
    return CARLA_VERSION


@method("get_available_maps")
def get_available_maps(context: Context) -> list[str]:
    """Return the names of the maps that can be loaded."""
    return context.maps.names()


@method("load_new_episode")
def load_new_episode(context: Context, name: str, reset_settings: bool, layers: U16) -> Long[None]:  # noqa: FBT001 - the wire's order
    """Begin a new episode on a map, with some of its layers; an empty name is the map that is loaded now.

    The answer goes out first, and the episode begins with the next call or frame. LibCarla's ``LoadEpisode`` then makes
    a new ``Episode`` by ``get_episode_info`` and resets its Traffic Managers only when a snapshot has another id than
    that one: it must learn the id of the episode before. In CARLA it does, because a load takes seconds.
    """
    simulation, maps = context.world, context.maps
    wanted = name or simulation.map_name
    ready = maps.ready(wanted)
    if ready is None:
        ready = yield lambda: maps.make(wanted)
        maps.keep(ready)
    if ready is not simulation.episode.map:
        yield lambda: simulation.prepare(ready)
    context.begin_pending_load()
    context.pending_load = PendingLoad(partial(_begin, simulation, ready, reset_settings, layers), context.caller)


def _begin(simulation: World, ready: LoadedMap, reset_settings: bool, layers: int) -> None:  # noqa: FBT001
    before = simulation.episode.map
    simulation.load(ready, reset_settings=reset_settings)
    if before is not ready:
        del before
        give_memory_back()
    if layers != MapLayer.ALL:
        simulation.episode.surroundings.unload_layers(~layers & MapLayer.ALL)


@method("copy_opendrive_to_file")
def copy_opendrive_to_file(context: Context, opendrive: str, parameters: OpendriveGenerationParameters) -> Long[None]:
    """Make a map of an OpenDRIVE text; the client then loads it as ``OpenDriveMap``.

    Walls are built as high and as far beyond driving lanes as the parameters say. The others say how a mesh is cut and
    smoothed; here the surface follows from the text alone, and goes on beside the road, so that none of them shows.
    """
    maps, beyond_m = context.maps, max(0.0, parameters.additional_width)
    made = yield lambda: maps.from_opendrive(opendrive, wall_height_m=parameters.wall_height, beyond_m=beyond_m)
    maps.keep(made)


@method("get_map_info")
def get_map_info(context: Context) -> MapInfo:
    """Return the map's name as CARLA writes it, and the recommended spawn points."""
    return MapInfo(context.world.map_name, tuple(map(_in_unreals_turn, context.world.spawn_points)))


def _in_unreals_turn(point: Transform) -> Transform:
    """Return a spawn point with a yaw of 180 where it is -180 in the client's 32 bits, as snapshots have it."""
    if np.float32(point.rotation.yaw) != -_HALF_TURN_DEG:
        return point
    return point._replace(rotation=point.rotation._replace(yaw=_HALF_TURN_DEG))


@method("get_map_data")
def get_map_data(context: Context) -> str:
    """Return the OpenDRIVE text."""
    return context.world.opendrive_text


@method("get_episode_info")
def get_episode_info(context: Context) -> EpisodeInfo:
    """Return the episode's id and the token of the world snapshots."""
    return EpisodeInfo(context.world.episode_id, context.streams.token(WORLD_OBSERVER_ID))


@method("get_episode_settings")
def get_episode_settings(context: Context) -> EpisodeSettings:
    """Return how time passes."""
    return context.world.settings


@method("set_episode_settings")
def set_episode_settings(context: Context, settings: EpisodeSettings) -> int:
    """Change how time passes, from the next frame on; returns the present frame, for which no client has to wait."""
    _check(settings)
    context.world.settings = settings
    return context.world.frame


@method("tick_cue", advances=True)
def tick_cue(context: Context) -> int:
    """Make one frame, in asynchronous mode too, and return its number."""
    return context.advance()


@method("is_traffic_manager_running")
def is_traffic_manager_running(context: Context, port: U16) -> bool:
    """Whether a client has registered a Traffic Manager under a port."""
    return port in context.traffic_managers


@method("get_traffic_manager_running")
def get_traffic_manager_running(context: Context, port: U16) -> tuple[str, int]:
    """Return address and port of a registered Traffic Manager; empty and 0 where there is none."""
    if port not in context.traffic_managers:
        return "", 0
    return context.traffic_managers[port][0], port


@method("add_traffic_manager_running")
def add_traffic_manager_running(context: Context, endpoint: tuple[str, U16]) -> bool:
    """Register a client's Traffic Manager; False where the port is taken."""
    address, port = endpoint
    if port in context.traffic_managers:
        return False
    context.traffic_managers[port] = (address, context.caller)
    return True


@method("destroy_traffic_manager")
def destroy_traffic_manager(context: Context, port: U16) -> bool:
    """Forget a Traffic Manager; False where none was registered."""
    return context.traffic_managers.pop(port, None) is not None


def client_left(context: Context, connection: int) -> None:
    """Forget what only a client that has gone could have served: its Traffic Managers."""
    if context.pending_load is not None and context.pending_load.client == connection:
        context.begin_pending_load()
    gone = [port for port, (_, owner) in context.traffic_managers.items() if owner == connection]
    for port in gone:
        del context.traffic_managers[port]


def _check(settings: EpisodeSettings) -> None:
    """Refuse settings by which time could not pass."""
    fixed_s = settings.fixed_delta_seconds
    if fixed_s is not None and not 0.0 < fixed_s <= MAX_FIXED_DELTA_S:
        raise Refusal(
            f"fixed_delta_seconds must be above 0 and at most {MAX_FIXED_DELTA_S:g} s, not {fixed_s:g}; "
            f"use None for a variable step"
        )
    if not settings.substepping:
        return
    if settings.max_substep_delta_time <= 0.0 or settings.max_substeps < 1:
        raise Refusal(
            f"substepping needs max_substep_delta_time above 0 and max_substeps of at least 1, not "
            f"{settings.max_substep_delta_time:g} and {settings.max_substeps}; or set substepping to False"
        )
    wanted = min(settings.max_substeps, (fixed_s or LONGEST_STEP_S) / settings.max_substep_delta_time)
    if wanted > MOST_SUBSTEPS + 1e-6:  # the quotient is rounded
        raise Refusal(
            f"max_substeps {settings.max_substeps} and max_substep_delta_time {settings.max_substep_delta_time:g} make "
            f"{wanted:.0f} substeps of a frame, and {MOST_SUBSTEPS} are the most; raise max_substep_delta_time, lower "
            "max_substeps or fixed_delta_seconds"
        )
    reach_s = settings.max_substep_delta_time * settings.max_substeps
    if fixed_s is not None and fixed_s > reach_s * (1.0 + 1e-6):
        log.warning(
            "fixed_delta_seconds %g is longer than max_substeps x max_substep_delta_time = %g s; the substeps are "
            "longer than asked for, and the physics coarser",
            fixed_s,
            reach_s,
        )


def _mesh(context: Context) -> Long[MeshFile | None]:
    """Return the mesh of the map that is loaded; where it is not known, it is made in the background."""
    episode = context.world.episode
    if context.meshes.knows(episode.map):
        return mesh_file(episode, context.meshes)
    made: MeshFile | None = yield lambda: mesh_file(episode, context.meshes)
    return made


@method("get_required_files")
def get_required_files(context: Context, folder: str) -> Long[list[str]]:
    """Return the files of a folder that a client should have: "Nav" has the walking mesh, "" all there are.

    There is none in "TM": the Traffic Manager works its map out of the OpenDRIVE text, which ``get_map_data`` returns.
    """
    mesh = (yield from _mesh(context)) if folder.strip("/") in ("", "Nav") else None
    return [mesh.name] if mesh else []


@method("request_file")
def request_file(context: Context, name: str) -> Long[bytes]:
    """Return a file of ``get_required_files``."""
    mesh = yield from _mesh(context)
    if mesh is None or name != mesh.name:
        offered = f"it offers {mesh.name}" if mesh else "its map has no pavements, so it offers none"
        raise Refusal(f"file '{name}' not found on this server; {offered}")
    return mesh.content


@method("get_navigation_mesh")
def get_navigation_mesh(context: Context) -> Long[bytes]:
    """Return the walking mesh; empty where the map has no pavements."""
    mesh = yield from _mesh(context)
    return mesh.content if mesh else b""
