"""``MapReading``: what a server takes from an OpenDRIVE text, which are its facts and walls beside its roads."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from linden.maps.facts import MapFacts, derive

NO_WALLS = np.empty((0, 2, 3))


class MapReading(NamedTuple):
    """What was read of one text.

    Attributes:
        facts: of the map.
        wall_feet_m: (N, 2, 3) feet of the pieces of walls, from and to, m, in CARLA's frame; none unless asked for.
    """

    facts: MapFacts
    wall_feet_m: NDArray[np.float64] = NO_WALLS


def read(text: str, walls_beyond_m: float | None = None, facts: MapFacts | None = None) -> MapReading:
    """Return what an OpenDRIVE text says; about a second for a town.

    Args:
        text: the OpenDRIVE text.
        walls_beyond_m: how far outside of driving lanes walls stand; None for a map without walls.
        facts: of this text, where they are known already; else they are derived.

    Raises:
        MapError: the text is no OpenDRIVE that can be used.
    """
    if walls_beyond_m is None:
        return MapReading(facts or derive(text))
    from linden.maps.opendrive.parse import parse  # noqa: PLC0415 - needed only for maps that a client sends
    from linden.maps.road_walls import walls_along  # noqa: PLC0415 - needed only for maps that a client sends

    opendrive = parse(text)  # the text is parsed once, because ``parse`` returns what is referenced here
    facts = facts or derive(text)
    return MapReading(facts, walls_along(opendrive, facts.ground, walls_beyond_m))
