"""What a simulation needs to know of a map, and how it is derived from the OpenDRIVE text."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from linden.maps.ground import Ground
from linden.maps.opendrive.roadside import Controller
from linden.maps.records import PlacedSignal, Standing
from linden.protocol.values.space import Transform


@dataclass(frozen=True, eq=False, repr=False, kw_only=True)
class MapFacts:
    """Everything derived from a map. It never changes: all episodes on the map share it.

    Attributes:
        ground: the height under any point.
        lane_of_triangle: (T,) row in ``lanes`` of each triangle of the ground.
        lanes: (L,) of ``opendrive.lane_table.LANES``.
        spawn_points: recommended ones.
        signals: lights and signs, in the order of the map.
        give_way: (B,) of ``opendrive.placed.GIVE_WAY``: squares that stop and yield signs protect, by sign.
        controllers: what switches lights together, in the order of the map.
        geo_origin_deg: latitude and longitude of the map's origin.
        lots: (N,) of ``map_lots.LOTS``: where beside the streets something may stand.
        standing: the buildings and the furniture that the map itself has.
    """

    ground: Ground
    lane_of_triangle: NDArray[np.int32]
    lanes: NDArray[np.void]
    spawn_points: tuple[Transform, ...]
    signals: tuple[PlacedSignal, ...]
    give_way: NDArray[np.void]
    controllers: tuple[Controller, ...]
    geo_origin_deg: tuple[float, float]
    lots: NDArray[np.void]
    standing: tuple[Standing, ...]


def derive(text: str) -> MapFacts:
    """Derive everything from an OpenDRIVE text; about a second for a town.

    Raises:
        MapError: the text is no OpenDRIVE that can be used.
    """
    # here, not above: with a map out of the cache a start does not pay for them
    from linden.maps.lot_cutting import cut_lots  # noqa: PLC0415 - see above
    from linden.maps.opendrive.give_way import give_way_areas  # noqa: PLC0415 - see above
    from linden.maps.opendrive.mesh import road_mesh  # noqa: PLC0415 - see above
    from linden.maps.opendrive.parse import parse  # noqa: PLC0415 - see above
    from linden.maps.opendrive.signals import place  # noqa: PLC0415 - see above
    from linden.maps.opendrive.spawn_points import spawn_points  # noqa: PLC0415 - see above
    from linden.maps.standing import standing_on  # noqa: PLC0415 - see above

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
