"""Where traffic begins and how much of it: pure functions over places in the plane (m, CARLA frame)."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

REACH_M = 300.0
"""Traffic begins within this of the route: about half a minute's drive, so that who is there can be met."""

CLEAR_M = 30.0
"""Nobody begins nearer to the vehicle under test: a stop from 25 mph with time to see it coming."""

COARSE_M = 10.0  # between the points of the route that distances are taken from; nothing next to REACH_M


def distance_m(places_m: NDArray[np.float64], route_m: NDArray[np.float64]) -> NDArray[np.float64]:
    """(N,) how far each of the places (N, 2) lies from the nearest of a route's points (M, 2), a metre apart."""
    nearest = np.full(len(places_m), np.inf)
    for point in route_m[:: round(COARSE_M)]:
        np.minimum(nearest, np.hypot(places_m[:, 0] - point[0], places_m[:, 1] - point[1]), out=nearest)
    return nearest


def suitable(
    places_m: NDArray[np.float64], route_m: NDArray[np.float64], ego_m: tuple[float, float]
) -> NDArray[np.int64]:
    """The indices of the places (N, 2) within reach of the route and away from the vehicle under test."""
    away_m = np.hypot(places_m[:, 0] - ego_m[0], places_m[:, 1] - ego_m[1])
    return np.flatnonzero((distance_m(places_m, route_m) <= REACH_M) & (away_m >= CLEAR_M))


def vehicles_for(density_per_km: float, lane_km: float) -> int:
    """How many vehicles make up a density on so many km of driving lane."""
    return round(density_per_km * lane_km)
