"""``MapFacts``: ground, lanes, signals and other data for the simulation, derived from OpenDRIVE text."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from linden.maps.ground import Ground
from linden.maps.opendrive.roadside import Controller
from linden.maps.records import PlacedSignal, Standing
from linden.protocol.values.space import Transform
from linden.structured import StructuredArray


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
    lanes: StructuredArray
    spawn_points: tuple[Transform, ...]
    signals: tuple[PlacedSignal, ...]
    give_way: StructuredArray
    controllers: tuple[Controller, ...]
    geo_origin_deg: tuple[float, float]
    lots: StructuredArray
    standing: tuple[Standing, ...]


def derive(text: str) -> MapFacts:
    """Derive everything from an OpenDRIVE text; about a second for a town.

    Raises:
        MapError: the text is no OpenDRIVE that can be used.
    """
    from linden.maps.derivation import facts_of  # noqa: PLC0415 - 48 ms that a start with a cached map does without

    return facts_of(text)
