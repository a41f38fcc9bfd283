"""Records of a vehicle that meets another in its own direction: cut-ins, cut-outs, vehicles that brake, and cheats."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace

from basu.metrics.boxes import other_boxes, own_boxes, touching
from basu.records.history import Facts, History
from fakes.drives import STEP_S, hit, straight_route
from fakes.rides import Row, ride

Place = Callable[[float], tuple[float, float]]
OTHER, LEADER = 9, 8
CAR = "vehicle.audi.tt"
LANE_M = 3.5


def meeting(
    own: Place,
    other: Place,
    *,
    leader: Place | None = None,
    limit_mps: float = 20.0,
    kind: str = CAR,
    seconds: float = 20.0,
) -> History:
    """The record of two or three vehicles, which ends 0.2 s after the first contact with the other."""
    others = [(OTHER, _row(other))] + ([] if leader is None else [(LEADER, _row(leader))])
    sizes = dict.fromkeys((OTHER, LEADER), (2.0, 0.9))
    history = ride(seconds, _own_row(own), others=others, sizes=sizes, route=straight_route(400.0, limit_mps))
    facts: Facts = replace(history.facts, actor_types={OTHER: kind, LEADER: CAR})
    history = replace(history, facts=facts)
    rows = history.others[history.others["id"] == OTHER]
    touched = touching(own_boxes(facts, history.frames), other_boxes(facts, rows)).nonzero()[0]
    if len(touched) == 0:
        return history
    last = int(touched[0])
    end = min(len(history.frames), last + round(0.2 / STEP_S))
    return replace(
        history,
        frames=history.frames[:end],
        others=history.others[history.others["tick"] < end],
        collisions=(hit(last, kind, OTHER),),
    )


def steady(speed_mps: float, from_m: float = 0.0, across_m: float = 0.0) -> Place:
    """Straight on, in a lane."""
    return lambda t_s: (from_m + speed_mps * t_s, across_m)


def braking(speed_mps: float, from_m: float, at_s: float, braking_mps2: float) -> Place:
    """In the lane, with a braking to rest from a time on."""

    def place(t_s: float) -> tuple[float, float]:
        over_s = min(max(0.0, t_s - at_s), speed_mps / braking_mps2)
        return from_m + speed_mps * (min(t_s, at_s) + over_s) - braking_mps2 * over_s**2 / 2.0, 0.0

    return place


def sideways(speed_mps: float, from_m: float, across_m: tuple[float, float], at_s: float, over_s: float) -> Place:
    """From one lateral place to another, evenly within ``over_s``."""

    def place(t_s: float) -> tuple[float, float]:
        share = min(1.0, max(0.0, (t_s - at_s) / over_s))
        return from_m + speed_mps * t_s, across_m[0] + share * (across_m[1] - across_m[0])

    return place


def cut_in(own_mps: float, other_mps: float, gap_m: float, *, at_s: float = 3.0, side: float = -1.0) -> Place:
    """Another that begins to move into the lane ``gap_m`` ahead at ``at_s``; -1 is from the left."""
    from_m = (own_mps - other_mps) * at_s + gap_m + 4.0
    return sideways(other_mps, from_m, (side * LANE_M, 0.0), at_s, 2.0)


def _velocity(place: Place, t_s: float) -> tuple[float, float]:
    (x_m, y_m), (x1_m, y1_m) = place(t_s), place(t_s + 0.01)
    return (x1_m - x_m) / 0.01, (y1_m - y_m) / 0.01


def _row(place: Place) -> Callable[[float], Row]:
    """Return the record's row of the other vehicle at each time."""

    def row(t_s: float) -> Row:
        (x_m, y_m), (vx_mps, vy_mps) = place(t_s), _velocity(place, t_s)
        yaw_rad = math.atan2(vy_mps, vx_mps) if math.hypot(vx_mps, vy_mps) > 0.01 else 0.0
        return {"x_m": x_m, "y_m": y_m, "yaw_rad": yaw_rad, "velocity_x_mps": vx_mps, "velocity_y_mps": vy_mps}

    return row


def _own_row(place: Place) -> Callable[[float], Row]:
    """The frame of the vehicle under test by time."""

    def row(t_s: float) -> Row:
        lane = {"lane_type": 2.0, "lane_width_m": LANE_M, "lane_id": -1.0, "road_id": 1.0}
        return {**_row(place)(t_s), "route_s_m": place(t_s)[0], "lateral_m": place(t_s)[1], **lane}

    return row
