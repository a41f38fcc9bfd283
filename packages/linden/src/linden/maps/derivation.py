"""The derivation of a map's facts from its OpenDRIVE text."""

from linden.maps.facts import MapFacts
from linden.maps.ground import Ground
from linden.maps.lot_cutting import cut_lots
from linden.maps.opendrive.give_way import give_way_areas
from linden.maps.opendrive.mesh import road_mesh
from linden.maps.opendrive.parse import parse
from linden.maps.opendrive.signals import place
from linden.maps.opendrive.spawn_points import spawn_points
from linden.maps.standing import standing_on


def facts_of(text: str) -> MapFacts:
    """Return the facts of a map; see :func:`linden.maps.facts.derive`.

    Raises:
        MapError: the text is no OpenDRIVE that can be used.
    """
    opendrive = parse(text)
    mesh = road_mesh(opendrive)
    signals = place(opendrive)
    ground = Ground.from_triangles(mesh.vertices, mesh.triangles)
    return MapFacts(
        ground=ground,
        lane_of_triangle=mesh.lane_of_triangle,
        lanes=mesh.lanes,
        spawn_points=spawn_points(opendrive),
        signals=signals,
        give_way=give_way_areas(opendrive, signals),
        controllers=opendrive.controllers,
        geo_origin_deg=opendrive.geo_origin,
        lots=cut_lots(opendrive, ground),
        standing=standing_on(opendrive, ground),
    )
