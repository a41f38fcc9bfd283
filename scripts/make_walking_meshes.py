"""Make the walking meshes of the shipped maps anew: needed where a map or linden.maps.navigation has changed.

.venv/bin/python scripts/make_walking_meshes.py
"""

from linden.maps.cache import MapCache
from linden.maps.library import HOME_MAPS, MapLibrary
from linden.maps.navigation.library import made
from linden.maps.navigation.shipped import write_mesh
from linden.simulation.walkers import obstacles_of


def main() -> None:
    """Write a file for each map, and print its place and size."""
    maps = MapLibrary([], MapCache.of_user().read)
    for name in sorted(HOME_MAPS):
        world_map = maps.load(name)
        file = write_mesh(world_map, made(world_map, obstacles_of(world_map)))
        print(f"{file.name}: {file.stat().st_size} bytes")


if __name__ == "__main__":
    main()
