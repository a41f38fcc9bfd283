"""A part of a longer run as a record of its own: what the criteria of a scenario met on a route may see."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from basu.history import History
    from basu.routing import Route


def part_of(history: History, first: int, end: int, until_s_m: float | None = None) -> History:
    """The frames from ``first`` to before ``end``, their events, and the route up to ``until_s_m`` (None: all of it).

    Ticks count from the part's first frame; times stay those of the run, and places along the route as well, so that
    who passes ``until_s_m`` has arrived.
    """
    frames = history.frames[first:end].copy()
    frames["tick"] -= first
    others = history.others[(history.others["tick"] >= first) & (history.others["tick"] < end)].copy()
    others["tick"] -= first
    route = history.facts.route
    return replace(
        history,
        facts=replace(history.facts, route=route if until_s_m is None else _up_to(route, until_s_m)),
        frames=frames,
        others=others,
        collisions=tuple(replace(e, tick=e.tick - first) for e in history.collisions if first <= e.tick < end),
        lane_invasions=tuple(replace(e, tick=e.tick - first) for e in history.lane_invasions if first <= e.tick < end),
    )


def _up_to(route: Route, until_s_m: float) -> Route:
    """The route cut off behind its first point at or beyond ``until_s_m``."""
    count = min(int(np.searchsorted(route.s_m, until_s_m)) + 1, len(route.s_m))
    return replace(
        route,
        points_m=route.points_m[:count],
        s_m=route.s_m[:count],
        yaw_rad=route.yaw_rad[:count],
        lane_width_m=route.lane_width_m[:count],
        speed_limit_mps=route.speed_limit_mps[:count],
        is_junction=route.is_junction[:count],
        road_id=route.road_id[:count],
        lane_id=route.lane_id[:count],
        stops=tuple(stop for stop in route.stops if stop.s_m <= route.s_m[count - 1]),
        controls=tuple(control for control in route.controls if control.s_m <= route.s_m[count - 1]),
        waypoints=route.waypoints[:count],
    )
