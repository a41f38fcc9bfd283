"""A part of a longer run as a record of its own: what the criteria of a scenario met on a route may see."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from basu.routing.stretch import until

if TYPE_CHECKING:
    from basu.records.history import History


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
        facts=replace(history.facts, route=route if until_s_m is None else until(route, until_s_m)),
        frames=frames,
        others=others,
        collisions=tuple(replace(e, tick=e.tick - first) for e in history.collisions if first <= e.tick < end),
        lane_invasions=tuple(replace(e, tick=e.tick - first) for e in history.lane_invasions if first <= e.tick < end),
    )
