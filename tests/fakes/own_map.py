"""Worlds made of OpenDRIVE texts, begun before the official client comes.

One that has just begun to listen and then loads an episode drops its stream while that is being opened, and on a busy
machine now and then ends its process (LibCarla's ``streaming::detail::tcp::Client``). Claims that are not about loading
need no such client.
"""

import carla

from fakes.raw_client import RawClient

TIMEOUT_S = 20.0


def world_of(port: int, opendrive: str, *, wall_height_m: float = 0.0) -> carla.World:
    """Return the world, asynchronous and empty, of a server that has been told to make it of a text."""
    with RawClient(port) as raw:
        raw.call("copy_opendrive_to_file", opendrive, [2.0, 50.0, wall_height_m, 0.6, True, True, True])
        raw.call("load_new_episode", "OpenDriveMap", True, 0xFFFF)
    client = carla.Client("127.0.0.1", port)
    client.set_timeout(TIMEOUT_S)
    return client.get_world()
