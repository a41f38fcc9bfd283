"""`Starts` gives the states of vehicles that begin at places along a route; `settled` puts vehicles at rest there."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from basu.conditions import STEP_S
from basu.episode.world import DROP_M, SETTLE_TICKS
from basu.errors import UserError
from linden.maps.library import MapLibrary
from linden.simulation.episode import DEFAULT_SPEED_LIMIT_KMH
from linden.worlds import Worlds

if TYPE_CHECKING:
    from collections.abc import Sequence

    import carla
    from numpy.typing import ArrayLike, NDArray

    from basu.routing import Route
    from linden.maps.library import LoadedMap
    from linden.structured import StructuredArray

    F64 = NDArray[np.float64]

LAST_M = 20.0
"""Before the end of the route, no episode begins: it would be over before it was driven."""


def settled(worlds: Worlds, vehicle: str, waypoints: Sequence[carla.Waypoint]) -> F64:
    """Put the vehicle at rest at waypoints, as a run does: one for each world, or one for all.

    Returns the limits (W,), km/h, that are posted there. A reset of the worlds brings this state back.

    Raises:
        LindenError: there is no such vehicle, or no room for it.
    """
    poses = []
    for waypoint in waypoints:
        pose = waypoint.transform
        pose.location.z += DROP_M  # in numbers of 32 bits, as a run does
        at, turned = pose.location, pose.rotation
        poses.append([at.x, at.y, at.z, turned.pitch, turned.yaw, turned.roll])
    worlds.spawn(vehicle, poses if len(poses) > 1 else poses[0])
    worlds.set_controls([0.0, 0.0, 1.0])
    limits_kmh = np.full(worlds.count, DEFAULT_SPEED_LIMIT_KMH)
    for _ in range(SETTLE_TICKS + 1):
        worlds.step()
        worlds.heed_limits(limits_kmh)
    worlds.keep()
    return limits_kmh


class Range(NamedTuple):
    """Places along a route between which episodes begin at random."""

    low_m: float
    high_m: float

    def draw(self, dice: np.random.Generator, count: int) -> F64:
        """Return ``count`` places; draws nothing where there is but one."""
        if self.low_m == self.high_m:
            return np.full(count, self.low_m)
        return dice.uniform(self.low_m, self.high_m, count)


class Starts:
    """The points of a route at which a vehicle can begin.

    The vehicles settle when the first episode begins elsewhere than at the route's beginning. That takes some seconds.
    """

    def __init__(self, route: Route, world_map: LoadedMap, vehicle: str) -> None:
        self._route, self._map, self._vehicle = route, world_map, vehicle
        self._last_m = max(0.0, route.length_m - LAST_M)
        self._points_m = route.s_m[route.s_m <= self._last_m]
        self._settled: tuple[StructuredArray, F64] | None = None

    def range_m(self, start_m: float | tuple[float, float]) -> Range:
        """Return the range of a setting: a place, or the lowest and the highest one; inf is the last possible one.

        Raises:
            UserError: it is neither, or lies beyond the route.
        """
        try:
            low_m, high_m = np.broadcast_to(np.asarray(start_m, np.float64), (2,)).tolist()
        except (TypeError, ValueError):
            raise UserError(f"start_m is a place along the route in m, or two, not {start_m!r}") from None
        high_m = self._last_m if high_m == math.inf and low_m < math.inf else high_m
        self._check(np.array([low_m, high_m]))
        if low_m > high_m:
            raise UserError(
                f"start_m begins at {low_m:g} m and ends before that, at {high_m:g} m; give the lower first"
            )
        return Range(low_m, high_m)

    def places_m(self, start_m: ArrayLike, count: int) -> F64:
        """Return the places (N,) of an option: numbers (N,), or one for all.

        Raises:
            UserError: it is neither, or a place lies beyond the route.
        """
        try:
            places_m = np.asarray(start_m, np.float64)
        except (TypeError, ValueError):
            places_m = np.zeros((0, 0))
        if places_m.shape not in {(), (count,)}:
            raise UserError(f"start_m needs an array ({count},) of places along the route in m, or one number")
        self._check(np.atleast_1d(places_m))
        return np.broadcast_to(places_m, (count,)).copy()

    def _check(self, places_m: F64) -> None:
        wrong = places_m[~((places_m >= 0.0) & (places_m <= self._last_m))]  # nan is wrong as well
        if len(wrong):
            raise UserError(
                f"an episode cannot begin at {wrong[0]:g} m of the route; "
                f"choose a place from 0 to {self._last_m:.1f} m, which is {LAST_M:g} m before its end"
            )

    def at(self, places_m: F64) -> tuple[F64, StructuredArray, F64]:
        """Return the places (K,) of the points nearest to ``places_m``, the states of BODY and the limits, km/h."""
        if self._settled is None:
            maps = MapLibrary()
            maps.keep(self._map)
            worlds = Worlds(self._map.name, len(self._points_m), dt_s=STEP_S, maps=maps)
            limits_kmh = settled(worlds, self._vehicle, self._route.waypoints[: len(self._points_m)])
            self._settled = worlds.state[:, 0].copy(), limits_kmh
        nearest = np.abs(self._points_m[:, None] - places_m).argmin(axis=0)
        states, limits_kmh = self._settled
        return self._points_m[nearest], states[nearest], limits_kmh[nearest]
