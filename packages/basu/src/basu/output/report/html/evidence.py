"""The evidence of each event: the sentence, the figures, the place seen from above and the speed around it."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from basu.output.report import events
from basu.output.report.plots.chart import Curve, Flag, chart
from basu.output.report.plots.street_names import street_at
from basu.output.report.plots.town_map import box, view
from basu.output.report.streets import Bounds
from basu.output.report.templates import DASH, TIMES, e, figure, number, render
from basu.routing.planned_route import ControlKind

if TYPE_CHECKING:
    from collections.abc import Sequence
    from xml.etree.ElementTree import Element

    from markupsafe import Markup

    from basu.output.report.events import MarkedEvent
    from basu.output.report.plots.signals import Signals
    from basu.output.report.streets import Streets
    from basu.records.history import History

PICTURED = 60  # events with pictures; further events have words only
CLOSE_M = (36.0, 24.0)  # half the width and half the height of a close-up
LEAD_S = 2.0  # from where the replay begins to an event
AROUND_S = 8.0  # of speed, before and after
SIGN_M, SIGN_BESIDE_M = 1.3, 2.2  # a sign's radius in close-ups, and its distance from the lane's edge
SIGNS = {  # corners of a sign's outline, and the direction of the first as seen from its middle
    ControlKind.STOP_SIGN: (8, math.pi / 8.0),
    ControlKind.YIELD_SIGN: (3, math.pi / 2.0),  # with the tip below
    ControlKind.TRAFFIC_LIGHT: (4, math.pi / 4.0),
}
BROKEN = {"stop_sign": ControlKind.STOP_SIGN, "red_light": ControlKind.TRAFFIC_LIGHT}  # by kind of infraction
UNKNOWN_HALF_M = (1.0, 0.5)  # length and width of others without a recorded size


def evidence(history: History, felt: Signals, found: Sequence[MarkedEvent], streets: Streets) -> Markup:
    """Return the infractions, and what is not scored, each one to be opened and linked to."""
    scored: list[tuple[MarkedEvent, Element, list[Element], list[tuple[str, str]]]] = []
    rest: list[tuple[MarkedEvent, Element, list[Element], list[tuple[str, str]]]] = []
    so_far = 1.0
    for order, event in enumerate(found):
        so_far *= 1.0 if event.factor is None else event.factor
        pictures = [close_up(history, event), _speed(felt, event)] if order < PICTURED else []
        symbol = events.symbol(event.kind, event.label, scored=event.factor is not None)
        (rest if event.factor is None else scored).append(
            (event, symbol, pictures, _facts(event, so_far, street_at(streets, event.x_m, event.y_m)))
        )
    sections = [("Infractions", "infractions", scored, False), ("Seen, not scored", "events", rest, True)]
    return render("templates/evidence.j2", sections=sections, LEAD_S=LEAD_S)


def close_up(history: History, event: MarkedEvent) -> Element:
    """Return the place from above: the vehicle under test, dark, and the actors near it in that tick."""
    x_m, y_m = event.x_m, event.y_m
    bounds = Bounds(x_m - CLOSE_M[0], y_m - CLOSE_M[1], x_m + CLOSE_M[0], y_m + CLOSE_M[1])
    frame, vehicle = history.frames[event.tick], history.facts.vehicle
    picture = e(
        "svg",
        e("title", f"The place from above, {2 * CLOSE_M[0]:g} m by {2 * CLOSE_M[1]:g} m, north is up"),
        e("use", href="#map-streets"),
        e("use", href="#map-paths"),
        viewBox=view(bounds),
        role="img",
    )
    picture.extend(_controls(history, bounds, event))
    for other in history.others[history.others["tick"] == event.tick]:
        half_m = history.facts.actor_sizes.get(int(other["id"]), UNKNOWN_HALF_M)
        kind = history.facts.actor_types.get(int(other["id"]), "")
        picture.append(
            _body(other["x_m"], other["y_m"], other["yaw_rad"], half_m[0], half_m[0], half_m[1], f"other {kind[:6]}")
        )
    half_width_m = vehicle.width_m / 2.0
    picture.append(
        _body(frame["x_m"], frame["y_m"], frame["yaw_rad"], vehicle.front_m, vehicle.rear_m, half_width_m, "own")
    )
    caption = e(
        "figcaption",
        e("b", "Place"),
        f", {2 * CLOSE_M[0]:g} m across; the vehicle is dark, others are light; lines to stop at have their signs",
    )
    return e("figure", caption, e("div", picture, class_="map", style=box(bounds, 480.0)))


def _controls(history: History, bounds: Bounds, event: MarkedEvent) -> list[Element]:
    """Return the lines to stop at within the bounds, each across the route's lane with its sign at the right edge.

    The ones of the kind that the event breaks are red.
    """
    route, found = history.facts.route, []
    for control in route.controls:
        if not (bounds.west_m < control.x_m < bounds.east_m and bounds.north_m < control.y_m < bounds.south_m):
            continue
        broken = " broken" if event.factor is not None and BROKEN.get(event.kind) is control.kind else ""
        half_m = 0.5 * float(np.interp(control.s_m, route.s_m, route.lane_width_m))
        right = np.array([-math.sin(control.yaw_rad), math.cos(control.yaw_rad)])  # CARLA's y points south
        middle = np.array([control.x_m, control.y_m])
        (x1, y1), (x2, y2) = middle - half_m * right, middle + half_m * right
        title = e("title", f"{control.kind.value.replace('_', ' ')} {control.landmark_id}")
        line = e("path", d=f"M{number(x1)} {number(y1)}L{number(x2)} {number(y2)}", class_=f"stop-line{broken}")
        corners, turn_rad = SIGNS[control.kind]
        angles = turn_rad + np.arange(corners) * math.tau / corners
        sign = middle + (half_m + SIGN_BESIDE_M) * right + SIGN_M * np.column_stack([np.cos(angles), np.sin(angles)])
        points = " ".join(f"{number(x)},{number(y)}" for x, y in sign.tolist())
        found.append(e("g", title, line, e("polygon", points=points, class_=f"road-sign {control.kind.value}{broken}")))
    return found


def _body(
    x_m: float, y_m: float, yaw_rad: float, front_m: float, rear_m: float, half_width_m: float, style: str
) -> Element:
    """Return a vehicle or walker from above, pointed at its front."""
    outline = [
        (front_m, 0.0),
        (front_m * 0.6, half_width_m),
        (-rear_m, half_width_m),
        (-rear_m, -half_width_m),
        (front_m * 0.6, -half_width_m),
    ]
    cos, sin = math.cos(yaw_rad), math.sin(yaw_rad)
    places = (
        f"{number(x_m + ahead_m * cos - right_m * sin)},{number(y_m + ahead_m * sin + right_m * cos)}"
        for ahead_m, right_m in outline
    )
    return e("polygon", points=" ".join(places), class_=style)


def _speed(felt: Signals, event: MarkedEvent) -> Element:
    """Speed and limit around the moment."""
    near = np.flatnonzero(np.abs(felt.t_s - event.t_s) <= AROUND_S)
    curves: Sequence[Curve] = (
        Curve("driven", felt.speed_mps[near], "first"),
        Curve("limit", felt.limit_mps[near], "limit", steps=True),
    )
    moment = Flag(event.t_s, event.label, event.title, f"#{event.anchor}", event.factor is not None)
    return chart(felt.t_s[near], curves, title="Speed", unit="m/s", marks=(moment,))


def _facts(event: MarkedEvent, so_far: float, street: str) -> list[tuple[str, str]]:
    """Return the figures, each with its name."""
    return [
        ("time", f"{event.t_s:.2f} s, tick {event.tick}"),
        ("speed", DASH if event.speed_mps is None else f"{event.speed_mps:.2f} m/s"),
        ("along the route", f"{event.route_s_m:.1f} m"),
        *([("street", street)] if street else []),
        ("place", f"x {event.x_m:.2f} m, y {event.y_m:.2f} m"),
        ("other party", event.other or "none"),
        ("costs", _cost(event.factor, so_far)),
    ]


def _cost(factor: float | None, so_far: float) -> str:
    """Return what an event does to the score."""
    if factor is None:
        return "nothing in the driving score"
    return f"{TIMES} {factor:g}; infraction score so far {figure(so_far)}"
