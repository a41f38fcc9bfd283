"""The view from above: lanes, route, controls, stops, neighbours and the way driven, with the vehicle's way up."""

from __future__ import annotations

import math
from itertools import groupby
from typing import TYPE_CHECKING, NamedTuple

import carla
import numpy as np

from basu.routing import ControlKind
from basu_window.hud.canvas import BLUE, GREEN, GREY, RED, WHITE, YELLOW

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from numpy.typing import NDArray

    from basu.managers.base_manager import Ego, Frame, Run
    from basu.metrics.infraction import Evidence
    from basu_window.hud.canvas import Canvas, Colour

SPACING_M = 2.0  # between the points of a lane's edges
PIECE = 20  # points of a lane that are drawn or left out together
STRAIGHT_RAD, SAME_WIDTH_M = 0.02, 0.05  # changes too small to see
ACROSS_M = 110.0  # of street from the top to the bottom of the window
EGO_AT = 0.66  # of the window's height: more is seen ahead than behind
TRAIL_M = 1.0  # between the points of the way driven
ROUTE_M = 1.2  # the width of the plan as it is drawn
LAND, ASPHALT, EDGE, ROUTE, TRAIL = (48, 62, 50), (82, 84, 90), (128, 130, 136), (70, 110, 190), (240, 150, 60)
LIGHTS: dict[str, Colour] = {"Red": RED, "Yellow": YELLOW, "Green": GREEN}
SIGNS: dict[ControlKind, Colour] = {ControlKind.STOP_SIGN: RED, ControlKind.YIELD_SIGN: YELLOW}


class Lanes(NamedTuple):
    """All lanes in pieces, each as a band: there on the left edge, back on the right one. R pieces."""

    outlines_m: tuple[NDArray[np.float64], ...]  # each (2 K, 2), CARLA frame
    middles_m: NDArray[np.float64]  # (R, 2)
    reaches_m: NDArray[np.float64]  # (R,) no point is farther than this from the middle


class Body(NamedTuple):
    """An actor on the road."""

    x_m: float
    y_m: float
    yaw_rad: float
    half_length_m: float
    half_width_m: float
    walks: bool


class View(NamedTuple):
    """From metres to pixels."""

    x_m: float
    y_m: float
    yaw_rad: float
    scale: float  # pixels a metre
    centre: tuple[float, float]

    def pixels(self, points_m: NDArray[np.float64]) -> NDArray[np.float64]:
        """(N, 2) in CARLA's frame as (N, 2) in the window: the vehicle's way is up."""
        turn = -self.yaw_rad - math.pi / 2
        cos, sin = math.cos(turn), math.sin(turn)
        x, y = points_m[:, 0] - self.x_m, points_m[:, 1] - self.y_m
        return np.column_stack(
            [self.centre[0] + self.scale * (x * cos - y * sin), self.centre[1] + self.scale * (x * sin + y * cos)]
        )


class TopDown:
    """Draws the surroundings of the vehicle."""

    def __init__(self, run: Run) -> None:
        self._run = run
        self._lanes = lanes_of(run.carla_map)
        half = 0.5 * float(np.median(run.route.lane_width_m))
        self._route_m, self._route_yaw_rad = run.route.points_m[:, :2], run.route.yaw_rad
        self._lights = [
            (control, run.world.get_traffic_light_from_opendrive_id(control.landmark_id))
            for control in run.route.controls
            if control.kind is ControlKind.TRAFFIC_LIGHT
        ]
        self._half_lane_m = half
        self._trail: list[tuple[float, float]] = []
        box = run.vehicle.bounding_box
        self._size_m = box.extent.x, box.extent.y

    def pass_by(self, frame: Frame) -> None:
        """Remember where the vehicle was; once a tick."""
        at = frame.ego.x_m, frame.ego.y_m
        if not self._trail or math.dist(at, self._trail[-1]) >= TRAIL_M:
            self._trail.append(at)

    def draw(self, canvas: Canvas, left: float, ego: Ego, bodies: Iterable[Body], marks: Sequence[Evidence]) -> None:
        """Everything within sight; the vehicle stands in the middle of what is right of ``left``."""
        width, height = canvas.size
        view = View(ego.x_m, ego.y_m, ego.yaw_rad, height / ACROSS_M, ((left + width) / 2, EGO_AT * height))
        sight_m = math.hypot(width, height) / view.scale
        outlines = self._in_sight(canvas, view)
        with canvas.smoothly():
            canvas.fill(LAND)
            for outline in outlines:
                canvas.polygon(outline, ASPHALT)
            for outline in outlines:
                left_edge, right_edge = np.split(outline, 2)
                canvas.line(left_edge, EDGE)
                canvas.line(right_edge, EDGE)
            self._draw_route(canvas, view, sight_m)
            for body in bodies:
                _draw_body(canvas, view, body)
            _draw_body(canvas, view, Body(ego.x_m, ego.y_m, ego.yaw_rad, *self._size_m, walks=False), WHITE)
            for mark in marks:
                _draw_cross(canvas, view, mark.x_m, mark.y_m)

    def _in_sight(self, canvas: Canvas, view: View) -> list[NDArray[np.float64]]:
        """Return the outlines of those pieces of lanes that may be in the window, in its pixels."""
        middles, reaches = view.pixels(self._lanes.middles_m), self._lanes.reaches_m * view.scale
        off = np.abs(middles - np.array(canvas.size) / 2) - np.array(canvas.size) / 2
        chosen = [self._lanes.outlines_m[i] for i in np.flatnonzero(off.max(axis=1) < reaches)]
        if not chosen:
            return []
        ends = np.cumsum([len(outline) for outline in chosen])[:-1]
        return np.split(view.pixels(np.concatenate(chosen)), ends)

    def _draw_route(self, canvas: Canvas, view: View, sight_m: float) -> None:
        """The plan, the way driven, and what is to be heeded on the way."""
        away_m = np.hypot(self._route_m[:, 0] - view.x_m, self._route_m[:, 1] - view.y_m)
        for inside, group in groupby(range(len(away_m)), key=lambda i: bool(away_m[i] < sight_m)):
            if inside and len(indices := list(group)) > 1:
                stretch = slice(indices[0], indices[-1] + 1)
                canvas.polygon(view.pixels(_band(self._route_m[stretch], self._route_yaw_rad[stretch], ROUTE_M)), ROUTE)
        if len(self._trail) > 1:
            canvas.line(view.pixels(np.array(self._trail[-int(sight_m / TRAIL_M) :])), TRAIL, 2)
        shows = [(control, LIGHTS.get(str(actor.get_state()), GREY)) for control, actor in self._lights if actor]
        signs = [(control, SIGNS[control.kind]) for control in self._run.route.controls if control.kind in SIGNS]
        for control, colour in (*signs, *shows):
            if math.dist((control.x_m, control.y_m), (view.x_m, view.y_m)) < sight_m:
                across = np.array([-math.sin(control.yaw_rad), math.cos(control.yaw_rad)]) * self._half_lane_m
                at = np.array([control.x_m, control.y_m])
                canvas.line(view.pixels(np.vstack([at - across, at + across])), colour, 5)
        for stop in self._run.route.stops:
            ((x, y),) = view.pixels(np.array([[stop.x_m, stop.y_m]])).tolist()
            canvas.circle((x, y), 7, BLUE)
            canvas.text((x + 11, y - 6), stop.name)


def lanes_of(carla_map: carla.Map) -> Lanes:
    """Return all driving lanes of a map, junctions first, so that roads lie over them."""
    by_lane: dict[tuple[int, int, int], list[carla.Waypoint]] = {}
    for waypoint in carla_map.generate_waypoints(SPACING_M):
        by_lane.setdefault((waypoint.road_id, waypoint.section_id, waypoint.lane_id), []).append(waypoint)
    lanes = [sorted(lane, key=lambda waypoint: float(waypoint.s)) for lane in by_lane.values() if len(lane) > 1]
    lanes.sort(key=lambda lane: not lane[0].is_junction)
    outlines_m = tuple(outline for lane in lanes for outline in _outlines(lane))
    middles_m = np.array([outline.mean(axis=0) for outline in outlines_m]).reshape(-1, 2)
    reaches_m = np.array(
        [np.hypot(*(outline - middle).T).max() for outline, middle in zip(outlines_m, middles_m, strict=True)]
    )
    return Lanes(outlines_m, middles_m, reaches_m)


def _outlines(lane: Sequence[carla.Waypoint]) -> list[NDArray[np.float64]]:
    """One lane in pieces; its far end, which samples do not reach, is filled up by their direction."""
    pose = np.array(
        [
            (place.location.x, place.location.y, math.radians(place.rotation.yaw), waypoint.lane_width)
            for waypoint in lane
            for place in (waypoint.transform,)
        ]
    )
    ahead = 1.0 if lane[0].lane_id < 0 else -1.0
    end = pose[-1].copy()
    end[:2] += ahead * SPACING_M * np.array([math.cos(end[2]), math.sin(end[2])])
    pose = np.vstack([pose, end])
    pieces = [pose[first : first + PIECE + 1] for first in range(0, len(pose) - 1, PIECE)]
    return [_band(piece[:, :2], piece[:, 2], piece[:, 3]) for piece in map(_without_needless, pieces)]


def _without_needless(pose: NDArray[np.float64]) -> NDArray[np.float64]:
    """Where a lane goes straight on and keeps its width, its ends are enough. (K, 4) to (L, 4)."""
    kept = [0]
    for i in range(1, len(pose) - 1):
        turned_rad = abs(math.remainder(pose[i + 1, 2] - pose[kept[-1], 2], math.tau))
        if turned_rad > STRAIGHT_RAD or abs(pose[i + 1, 3] - pose[kept[-1], 3]) > SAME_WIDTH_M:
            kept.append(i)
    return pose[[*kept, len(pose) - 1]]


def _band(
    middle_m: NDArray[np.float64], yaw_rad: NDArray[np.float64], width_m: float | NDArray[np.float64]
) -> NDArray[np.float64]:
    """The outline of a band around a line of N points with headings: (2 N, 2), there on the left, back on the right."""
    across = np.column_stack([-np.sin(yaw_rad), np.cos(yaw_rad)]) * (np.asarray(width_m) / 2).reshape(-1, 1)
    return np.vstack([middle_m - across, (middle_m + across)[::-1]])


def _draw_body(canvas: Canvas, view: View, body: Body, colour: Colour | None = None) -> None:
    """A box with a nose, or a dot."""
    if body.walks:
        ((x, y),) = view.pixels(np.array([[body.x_m, body.y_m]])).tolist()
        canvas.circle((x, y), 4, YELLOW)
        return
    length, width = body.half_length_m, body.half_width_m
    outline = np.array(
        [[-length, -width], [0.6 * length, -width], [length, 0.0], [0.6 * length, width], [-length, width]]
    )
    cos, sin = math.cos(body.yaw_rad), math.sin(body.yaw_rad)
    turned = outline @ np.array([[cos, sin], [-sin, cos]]) + (body.x_m, body.y_m)
    canvas.polygon(view.pixels(turned), TRAIL if colour is None else colour)


def _draw_cross(canvas: Canvas, view: View, x_m: float, y_m: float) -> None:
    """Where something went wrong."""
    ((x, y),) = view.pixels(np.array([[x_m, y_m]])).tolist()
    for slope in (-1, 1):
        canvas.line(np.array([[x - 6, y - 6 * slope], [x + 6, y + 6 * slope]]), RED, 3)
