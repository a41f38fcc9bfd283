"""The walking mesh of a map: its surfaces, and the mesh that is built of them."""

from linden.maps.facts import MapFacts
from linden.maps.navigation.areas import surfaces_of
from linden.maps.navigation.build import build
from linden.maps.navigation.detour import Obstacles, WalkingMesh
from linden.maps.opendrive.parse import parse


def mesh_of(facts: MapFacts, text: str, obstacles: Obstacles) -> WalkingMesh:
    """Return the walking mesh of a map with this OpenDRIVE text; it has no tiles where there is no place to walk."""
    surfaces = surfaces_of(parse(text), facts.ground, facts.lane_of_triangle, facts.lanes["type_bits"])
    return build(surfaces, obstacles)
