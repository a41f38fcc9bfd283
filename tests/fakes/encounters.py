"""Ten encounters that end in a contact, for claims about fault and for the page that shows them."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from basu.metrics.fault import responsibility
from basu.metrics.infraction import CollisionKind
from basu.metrics.lanes import within_one_lane
from basu.records.history import History
from basu.records.history.model import NO_LIGHT
from basu.routing import Route, RouteControl
from fakes.drives import STEP_S, hit, stop_sign, straight_route, traffic_light
from fakes.rides import Row, moving, ride

OTHER = 9
GREEN, RED = 2, 0
DRIVING, PARKING = 2, 256  # carla.LaneType
WALKER = "walker.pedestrian.0001"
CROSSING_M, HALF_JUNCTION_M = 60.0, 7.0  # the middle of the junction on the straight route
Path = Callable[[float], tuple[float, float]]
Lane = tuple[float, float, int]  # y of its middle, width, type; east is its direction


class Road(NamedTuple):
    """A straight band of road to draw, from one end to the other in m."""

    ends_m: tuple[tuple[float, float], tuple[float, float]]
    width_m: float
    is_lane_line: bool = False


class Encounter(NamedTuple):
    """A contact in the last frame of a record, with the roads round it."""

    title: str
    history: History
    roads: tuple[Road, ...]
    at_fault: bool  # the verdict that stays
    at_fault_by_nuplan: bool


def by_nuplan(history: History) -> bool:
    """Return nuPlan's verdict: its kinds are those of `basu.metrics.fault`, its clauses fewer.

    The front of the ego and a standing other are the ego's fault, its side where the ego is not within one lane.
    A standing ego and one that is struck from behind never are.
    """
    event = history.collisions[0]
    kind = responsibility(history, event).kind
    if kind is CollisionKind.LATERAL:
        return not within_one_lane(history, event.tick - 1)
    return kind in {CollisionKind.STOPPED_OTHER, CollisionKind.FRONT}


LANE: Lane = (0.0, 3.5, DRIVING)
LEFT_LANE: Lane = (-3.5, 3.5, DRIVING)
BAY: Lane = (3.0, 2.5, PARKING)
TWO_LANES = (Road(((-40.0, -1.75), (140.0, -1.75)), 7.0), Road(((-40.0, -1.75), (140.0, -1.75)), 0.15, True))
WITH_BAY = (Road(((-40.0, 3.0), (140.0, 3.0)), 2.5), *TWO_LANES, Road(((-40.0, 1.75), (140.0, 1.75)), 0.15, True))
CROSS = (
    Road(((CROSSING_M, -70.0), (CROSSING_M, 70.0)), 7.0),
    *(
        Road(((x_m, -1.75), (end_m, -1.75)), width_m, is_line)
        for width_m, is_line in ((7.0, False), (0.15, True))
        for x_m, end_m in ((-40.0, 53.0 if is_line else 140.0), (67.0, 140.0))
    ),
)


def drive(
    seconds: float,
    path: Path,
    other: Callable[[float], Row],
    *,
    lanes: Sequence[Lane] = (LANE,),
    route: Route | None = None,
    light: int = NO_LIGHT,
    backwards: bool = False,
    kind: str = "vehicle.audi.tt",
) -> History:
    """The record of an ego on ``path`` (x and y in m by time) that an actor touches in the last frame."""
    planned = route or straight_route()

    def state(t_s: float) -> Row:
        (x_m, y_m), (x1_m, y1_m) = path(t_s), path(t_s + 0.01)
        vx_mps, vy_mps = (x1_m - x_m) / 0.01, (y1_m - y_m) / 0.01
        moves = math.hypot(vx_mps, vy_mps) > 0.01
        (xa_m, ya_m), (xb_m, yb_m) = path(t_s - 0.25), path(t_s + 0.25)
        sign = -1.0 if backwards else 1.0
        yaw_rad = math.atan2(sign * (yb_m - ya_m), sign * (xb_m - xa_m)) if moves else 0.0
        nearest = int(np.argmin(np.hypot(planned.points_m[:, 0] - x_m, planned.points_m[:, 1] - y_m)))
        heading_rad = float(planned.yaw_rad[nearest])
        dx_m, dy_m = (np.array([x_m, y_m]) - planned.points_m[nearest, :2]).tolist()
        s_m = float(planned.s_m[nearest]) + dx_m * math.cos(heading_rad) + dy_m * math.sin(heading_rad)
        lateral_m = dy_m * math.cos(heading_rad) - dx_m * math.sin(heading_rad)
        middle_m, width_m, type_ = min(lanes, key=lambda lane: abs(y_m - lane[0]) - lane[1] / 2.0)
        return {
            "x_m": x_m,
            "y_m": y_m,
            "yaw_rad": yaw_rad,
            "velocity_x_mps": vx_mps,
            "velocity_y_mps": vy_mps,
            "route_s_m": s_m,
            "lateral_m": lateral_m,
            "route_light": light,
            "road_id": 1,
            "lane_id": -1 - list(lanes).index((middle_m, width_m, type_)),
            "lane_type": type_,
            "lane_offset_m": y_m - middle_m,
            "lane_heading_rad": yaw_rad,
            "lane_width_m": width_m,
            "in_junction": float(planned.is_junction[nearest]),
        }

    size = (0.25, 0.25) if kind == WALKER else (2.0, 0.9)
    history = ride(seconds, state, others=[(OTHER, other)], sizes={OTHER: size}, route=planned)
    facts = replace(history.facts, actor_types={OTHER: kind})
    return replace(history, facts=facts, collisions=(hit(len(history.frames) - 1, kind, OTHER),))


def ends_at(seconds: float, x_m: float, y_m: float, vx_mps: float, vy_mps: float) -> Callable[[float], Row]:
    """An actor in steady motion that is at a place in the last frame."""
    last_s = seconds - STEP_S
    return moving(x_m - vx_mps * last_s, y_m - vy_mps * last_s, vx_mps, vy_mps)


def along(speed_mps: float, from_m: float = 0.0) -> Path:
    """Straight east, or west below 0."""
    return lambda t_s: (from_m + speed_mps * t_s, 0.0)


def sideways(speed_mps: float, from_y_m: float, at_s: float, over_s: float) -> Path:
    """East, and within ``over_s`` from a line beside the lane into its middle."""

    def path(t_s: float) -> tuple[float, float]:
        share = min(1.0, max(0.0, (t_s - at_s) / over_s))
        return speed_mps * t_s, from_y_m * (1.0 - share * share * (3.0 - 2.0 * share))

    return path


def out_of_bay(t_s: float) -> tuple[float, float]:
    """From rest in the bay into the lane, at 1.5 m/s² from 1 s on."""
    x_m = 0.75 * max(0.0, t_s - 1.0) ** 2
    share = min(1.0, x_m / 7.0)
    return 20.0 + x_m, 3.0 * (1.0 - share * share * (3.0 - 2.0 * share))


def crossing(*controls: RouteControl) -> Route:
    """A straight route over a junction."""
    route = straight_route(120.0, controls=controls)
    return replace(route, is_junction=np.abs(route.s_m - CROSSING_M) <= HALF_JUNCTION_M)


RADIUS_M = 9.0  # of the left turn that begins with the junction
TURN_M = RADIUS_M * math.pi / 2.0


def left(s_m: float) -> tuple[float, float]:
    """A place on the route that turns left in the junction."""
    begin_m = CROSSING_M - HALF_JUNCTION_M
    turned_rad = min(max(0.0, s_m - begin_m), TURN_M) / RADIUS_M
    on_m, up_m = min(s_m, begin_m), max(0.0, s_m - begin_m - TURN_M)
    return on_m + RADIUS_M * math.sin(turned_rad), -RADIUS_M * (1.0 - math.cos(turned_rad)) - up_m


def left_turn() -> Route:
    """A route that turns left in the junction."""
    begin_m = CROSSING_M - HALF_JUNCTION_M
    route = straight_route(100.0)
    points_m = np.array([(*left(s_m), 0.0) for s_m in route.s_m.tolist()])
    yaw_rad = -np.clip(route.s_m - begin_m, 0.0, TURN_M) / RADIUS_M
    inside = (route.s_m > begin_m) & (route.s_m < begin_m + TURN_M)
    return replace(route, points_m=points_m, yaw_rad=yaw_rad, is_junction=inside)


def side_struck(route: Route, light: int = NO_LIGHT) -> History:
    """An ego that crosses a junction at 6 m/s; a vehicle from the right strikes its side."""
    ends = ends_at(5.0, 61.5, 2.95, 0.0, -8.0)
    return drive(5.0, along(6.0, 61.0 - 6.0 * 4.95), ends, route=route, light=light)


def encounters() -> tuple[Encounter, ...]:
    """All ten, in the order of the page."""
    line_m = CROSSING_M - HALF_JUNCTION_M - 1.0
    return (
        Encounter(
            "A car comes head-on into the lane of the ego",
            drive(4.0, along(5.0), ends_at(4.0, 19.75 + 3.9, 0.0, -8.0, 0.8)),
            TWO_LANES,
            at_fault=False,
            at_fault_by_nuplan=True,
        ),
        Encounter(
            "The ego reverses into a person that walks away",
            drive(
                4.0,
                along(-2.0, 30.0),
                ends_at(4.0, 30.0 - 7.9 - 2.2, 0.2, -1.0, 0.0),
                backwards=True,
                kind=WALKER,
            ),
            TWO_LANES,
            at_fault=True,
            at_fault_by_nuplan=False,
        ),
        Encounter(
            "The ego pulls out of a bay before a car, which strikes it from behind",
            drive(4.5, out_of_bay, ends_at(4.5, 20.0 + 0.75 * 3.45**2 - 3.95, 0.0, 11.0, 0.0), lanes=(LANE, BAY)),
            WITH_BAY,
            at_fault=True,
            at_fault_by_nuplan=False,
        ),
        Encounter(
            "The ego opens a gap: it changes lanes close before a faster car",
            drive(
                4.0,
                sideways(6.0, -3.5, 1.0, 2.0),
                ends_at(4.0, 23.7 - 3.95, 0.0, 11.0, 0.0),
                lanes=(LANE, LEFT_LANE),
            ),
            TWO_LANES,
            at_fault=True,
            at_fault_by_nuplan=False,
        ),
        Encounter(
            "The ego changes lanes well before a car, which runs into it later",
            drive(
                6.0,
                sideways(5.0, -3.5, 0.5, 2.0),
                ends_at(6.0, 5.0 * 5.95 - 3.95, 0.0, 7.0, 0.0),
                lanes=(LANE, LEFT_LANE),
            ),
            TWO_LANES,
            at_fault=False,
            at_fault_by_nuplan=False,
        ),
        Encounter(
            "The ego passes a stop sign before a car with the right of way",
            side_struck(crossing(stop_sign(line_m))),
            CROSS,
            at_fault=True,
            at_fault_by_nuplan=False,
        ),
        Encounter(
            "The ego enters a junction on red",
            side_struck(crossing(traffic_light(line_m)), RED),
            CROSS,
            at_fault=True,
            at_fault_by_nuplan=False,
        ),
        Encounter(
            "The ego crosses on green; a car from the side runs into it",
            side_struck(crossing(traffic_light(line_m)), GREEN),
            CROSS,
            at_fault=False,
            at_fault_by_nuplan=False,
        ),
        Encounter(
            "The ego turns left across the path of an oncoming car, which strikes its side",
            _turned_left(),
            CROSS,
            at_fault=True,
            at_fault_by_nuplan=False,
        ),
        Encounter(
            "The ego runs into a slower car ahead",
            drive(4.0, along(8.0), ends_at(4.0, 8.0 * 3.95 + 3.95, 0.0, 3.0, 0.0)),
            TWO_LANES,
            at_fault=True,
            at_fault_by_nuplan=True,
        ),
    )


def _turned_left() -> History:
    """A left turn at 4 m/s across the lane to the west, at y = -3.5."""
    speed_mps, last_s, reached_m = 4.0, 4.95, CROSSING_M - HALF_JUNCTION_M + 0.68 * TURN_M
    return drive(
        5.0,
        lambda t_s: left(reached_m + speed_mps * (t_s - last_s)),
        ends_at(5.0, CROSSING_M + 3.75, -3.5, -9.0, 0.0),
        route=left_turn(),
    )
