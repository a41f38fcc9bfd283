"""Which places have something near them: many places and many things at once."""

import numpy as np
from numpy.typing import ArrayLike, NDArray

F64 = NDArray[np.float64]


def nearby(places_m: F64, things_m: F64, reach_m: ArrayLike) -> NDArray[np.bool_]:
    """Return which places (N, 2) have one of the things (M, 2) nearer than its reach, a number or (M,).

    Things are sorted from west to east, so that each place is compared with those of a strip alone.
    """
    order = np.argsort(things_m[:, 0], kind="stable")
    things, reach = things_m[order], np.broadcast_to(np.asarray(reach_m, np.float64), len(things_m))[order]
    widest = reach.max(initial=0.0)
    first = np.searchsorted(things[:, 0], places_m[:, 0] - widest)
    count = np.searchsorted(things[:, 0], places_m[:, 0] + widest) - first
    place = np.repeat(np.arange(len(places_m)), count)
    thing = np.arange(len(place)) + np.repeat(first - np.cumsum(count) + count, count)
    away = places_m[place] - things[thing]
    near = np.zeros(len(places_m), bool)
    near[place[away[:, 0] ** 2 + away[:, 1] ** 2 < reach[thing] ** 2]] = True
    return near
