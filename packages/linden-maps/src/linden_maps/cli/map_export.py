"""``linden map export``: the standing mesh of a map as glTF."""

import argparse

from linden.maps.opendrive.parse import parse
from linden.scenery.gltf import glb
from linden.scenery.map_mesh import standing
from linden.simulation.surroundings import scenery_of
from linden_maps.cli.map_source import world_map_of
from linden_maps.cli.output import say
from linden_maps.output import write_output


def run(arguments: argparse.Namespace) -> int:
    """Write the standing mesh of the map as binary glTF."""
    world_map = world_map_of(arguments.file)
    mesh = standing(parse(world_map.text), world_map, scenery_of(world_map).scene)
    write_output(arguments.output, glb(mesh, world_map.name))
    say(f"{arguments.output}: {len(mesh.triangles):,} triangles, {arguments.output.stat().st_size:,} bytes")
    return 0
