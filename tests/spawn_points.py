"""Spawn points of Linden for tests of the official client, which reads the map once a process for them."""

import carla

_known: list[carla.Transform] = []


def spawn_point(world: carla.World, number: int) -> carla.Transform:
    """Return one of Linden's spawn points, to be changed at will; each new client takes 0.3 s to read the map."""
    if not _known:
        _known.extend(world.get_map().get_spawn_points())
    point = _known[number]
    return carla.Transform(point.location, point.rotation)
