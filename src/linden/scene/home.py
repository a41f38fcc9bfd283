"""What stands in South Linden besides its signals: houses and their yards, trees, lamps, poles, shelters."""

import numpy as np
from numpy.typing import NDArray

from linden.ground import Ground
from linden.scene.groves import groves
from linden.scene.neighbourhood import furnish
from linden.scene.objects import Scene, join
from linden.scene.streetside import clear_of, poles, shelters
from linden.scene.surveyed import surveyed
from linden.scene.yards import yards


def home(lots: NDArray[np.void], ground: Ground, origin_deg: tuple[float, float]) -> Scene:
    """Return the scene of Linden, whose origin lies at this latitude and longitude."""
    known = surveyed(origin_deg)
    free = clear_of(lots, known.railroad_m)
    houses = furnish(free, ground)
    standing = join([houses, yards(free, houses, ground), poles(free, ground)])
    standing = join([standing, shelters(known.stops_m, known.kerbs, standing, ground)])
    return join([standing, groves(free, standing, known.railroad_m, ground)])
