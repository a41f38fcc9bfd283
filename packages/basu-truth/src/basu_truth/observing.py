"""`Observer`: the objects that each sensor sees in a frame, with their boxes, shares and velocities."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING, Any, NamedTuple

import carla
import numpy as np

from basu.agents.sight.line_of_sight import ranges_m
from basu.routing.weather import changed
from basu_truth.alone import Single, groups
from basu_truth.clouds import numbers_of_points, points_of
from basu_truth.geometry import box_outline, corners_m, in_picture, matrix, pose_of
from basu_truth.masks import PARKED_FROM, count, rectangles
from basu_truth.rig import INSTANCES, LIDARS, SEMANTIC_LIDAR, transform_of
from basu_truth.truth import SeenObject
from basu_truth.views import Things, View

if TYPE_CHECKING:
    from collections.abc import Mapping

    from basu_truth.alone import AloneView, AloneWorld
    from basu_truth.geometry import F64
    from basu_truth.rig import Declared
    from basu_truth.scene import Kind, Scene, Shot
    from basu_truth.truth import Rectangle

WALKERS = ("pedestrian", "animal")
WITHOUT_LAMPS = ("pedestrian", "animal", "bicycle", "traffic_cone", "barrier")
MARGIN_PX, MARGIN_SHARE = 3.0, 0.1  # around the outline of a box, for what stands out of it
MARGIN_DEG = 1.0  # likewise around its angles, seen from a lidar

Outline = tuple[float, float, float, float]  # left, top, right, bottom


class _Body(NamedTuple):
    """An object that some sensor sees in this frame."""

    number: int
    kind: Kind
    box: F64  # (4, 4) from the box's frame to the world
    velocity_mps: tuple[float, float, float]


class Observer:
    """Finds the objects of one replay, frame by frame."""

    def __init__(self, scene: Scene, bare: AloneWorld) -> None:
        self._scene, self._bare = scene, bare
        self._things = Things(scene.things)

    def observed(self, shot: Shot) -> list[SeenObject]:
        """Return the objects that each sensor sees, sensor by sensor and in the order of their numbers.

        Raises:
            SimulatorError: the simulator with the bare map went away.
        """
        views = [self._view(each, shot.measured[each.sensor.id], shot) for each in self._scene.declared]
        seen = {
            (place, number): _seen(view, self._body(number, shot), shot)
            for place, view in enumerate(views)
            for number in np.unique(view.numbers).tolist()
            if number in shot.actors or number >= PARKED_FROM
        }
        bodies = {number: self._body(number, shot) for number in sorted({number for _, number in seen})}
        outlines = {number: [_outline(body, view) for view in views] for number, body in bodies.items()}
        counted: dict[tuple[int, int], SeenObject] = {}
        poses = {view.each.sensor.id: transform_of(pose_of(view.pose)) for view in views}
        boxes = [rectangles(view.numbers) if view.rows is None else {} for view in views]
        for group in groups(outlines):
            singles = [self._single(bodies[number], shot) for number in group]
            for alone in self._bare.look(poses, singles):
                for place, view in enumerate(views):
                    bare = self._bare_view(view, alone)
                    for number in alone.number_of:
                        if (place, number) in seen:
                            counted[place, number] = _counted(
                                seen[place, number], view, bare, alone.number_of[number], boxes[place]
                            )
        return [self._in_cloud(counted[key], views[key[0]], shot) for key in sorted(counted)]

    def _view(self, each: Declared, measured: Mapping[str, Any], shot: Shot) -> View:
        """Return what a sensor sees."""
        pose = shot.sensors[each.sensor.id]
        see = self._things.seen_by_camera if each.sensor.is_camera else self._things.seen_by_lidar
        return see(each, measured, pose)

    def _bare_view(self, view: View, alone: AloneView) -> View:
        """Return what the same sensor sees in the bare map."""
        measured = alone.measured[view.each.sensor.id]
        if view.rows is None:
            return self._things.seen_by_camera(view.each, {INSTANCES: measured}, view.pose)
        return self._things.seen_by_lidar(view.each, {SEMANTIC_LIDAR: measured}, view.pose)

    def _single(self, body: _Body, shot: Shot) -> Single:
        """Return an object as the bare map shows it."""
        placed = shot.actors.get(body.number)
        bones = self._scene.bones(body.number) if body.kind.category in WALKERS and placed is not None else None
        return Single(body.number, body.kind, placed, bones)

    def _body(self, number: int, shot: Shot) -> _Body:
        """Return an object by its number."""
        placed = shot.actors.get(number)
        if placed is not None:
            return _Body(number, placed.kind, placed.actor @ placed.kind.box, placed.velocity_mps)
        kind = self._things[number]
        return _Body(number, kind, kind.box, (0.0, 0.0, 0.0))

    def _in_cloud(self, seen: SeenObject, view: View, shot: Shot) -> SeenObject:
        """Return an object of a lidar with the number of its points in the cloud of the declared lidar."""
        if view.rows is None:
            return seen
        type_id = view.each.spec.type_id
        measured = shot.measured[view.each.sensor.id][type_id]
        points = points_of(measured, is_semantic=type_id == LIDARS[1])
        numbered = view.rows.copy()
        numbered["object_id"] = view.numbers
        inside = numbers_of_points(points, numbered) == seen.track
        return replace(seen, cloud_points=int(np.count_nonzero(inside)))


def _seen(view: View, body: _Body, shot: Shot) -> SeenObject:
    """Return an object with its place; its pixels or points are not counted yet."""
    in_sensor = np.linalg.inv(view.pose) @ body.box
    distance_m = float(np.linalg.norm(in_sensor[:3, 3]))
    return SeenObject(
        frame=shot.number,
        sensor=view.each.sensor.id,
        track=body.number,
        category=body.kind.category,
        model=body.kind.model,
        box=pose_of(body.box),
        box_in_sensor=pose_of(in_sensor),
        size_m=body.kind.size_m,
        velocity_mps=body.velocity_mps,
        distance_m=distance_m,
        visible=0,
        whole=None,
        in_range=distance_m <= _range_m(shot.weather, has_lamps=body.kind.category not in WITHOUT_LAMPS),
        is_parked=body.number >= PARKED_FROM,
    )


def _counted(seen: SeenObject, view: View, bare: View, bare_number: int, boxes: Mapping[int, Rectangle]) -> SeenObject:
    """Return an object with its pixels or points."""
    if view.rows is not None:
        visible = int(np.count_nonzero(view.numbers == seen.track))
        alone = int(np.count_nonzero(bare.numbers == bare_number))
        return replace(seen, visible=visible, whole=max(visible, alone) if view.each.is_whole_turn else None)
    found = count(view.numbers, seen.track, bare.numbers, bare_number, boxes)
    return replace(
        seen,
        visible=found.visible,
        whole=found.whole,
        hidden_by_actors=found.hidden_by_actors,
        hidden_by_scenery=found.hidden_by_scenery,
        rectangle=found.rectangle,
        whole_rectangle=found.whole_rectangle,
        truncation=_truncation(seen, view),
    )


def _truncation(seen: SeenObject, view: View) -> float:
    """Return the share of the outline of an object's box that is outside of the picture."""
    outline = box_outline(_corners(seen), view.each.sensor)
    inside = None if outline is None else in_picture(outline, view.each.sensor)
    if outline is None or inside is None:
        return 1.0
    return 1.0 - inside.width * inside.height / (outline.width * outline.height)


def _corners(seen: SeenObject) -> F64:
    return corners_m(matrix(seen.box_in_sensor), seen.size_m)


def _outline(body: _Body, view: View) -> Outline | None:
    """Return the outline of an object with a margin: in pixels, or in degrees around a lidar; None out of view."""
    corners = corners_m(np.linalg.inv(view.pose) @ body.box, body.kind.size_m)
    if view.rows is not None:
        return _angles_deg(corners)
    outline = box_outline(corners, view.each.sensor)
    if outline is None or in_picture(outline, view.each.sensor) is None:
        return None
    margin = MARGIN_PX + MARGIN_SHARE * max(outline.width, outline.height)
    left, top = outline.left - margin, outline.top - margin
    return left, top, left + outline.width + 2.0 * margin, top + outline.height + 2.0 * margin


def _angles_deg(corners: F64) -> Outline:
    """Return the least and largest azimuth and elevation of a box (8, 3) around a lidar, with a margin."""
    azimuth = np.degrees(np.arctan2(corners[:, 1], corners[:, 0]))
    level = np.hypot(corners[:, 0], corners[:, 1])
    elevation = np.degrees(np.arctan2(corners[:, 2], level))
    low, high = float(elevation.min()) - MARGIN_DEG, float(elevation.max()) + MARGIN_DEG
    if np.ptp(azimuth) > 180.0:
        return -180.0, low, 180.0, high
    return float(azimuth.min()) - MARGIN_DEG, low, float(azimuth.max()) + MARGIN_DEG, high


def _range_m(weather: Mapping[str, float], *, has_lamps: bool) -> float:
    """Return how far light and air let a driver see a body."""
    if not weather:
        return math.inf
    without, with_lamps = ranges_m(changed(carla.WeatherParameters(), weather))
    return with_lamps if has_lamps else without
