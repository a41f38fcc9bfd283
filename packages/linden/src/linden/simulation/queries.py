"""Queries: boxes of map objects, actors and traffic lights; `cast_ray` and `project_point` on all surfaces."""

import math
from typing import NamedTuple

import numpy as np

from linden.blueprints.library import BlueprintKind
from linden.errors import Refusal
from linden.geometry import rotation_matrix
from linden.physics.contact.statics import Statics
from linden.plane_bins import Bins
from linden.protocol.values.enums import SemanticTag
from linden.protocol.values.episode import EnvironmentObject, LabelledPoint
from linden.protocol.values.space import BoundingBox, Transform, Vector3D
from linden.scenery.ray_query import MovingBoxes, StandingBoxes, Surface, crossings
from linden.simulation.actor_table import NO_BODY, ActorRecord
from linden.simulation.episode import Episode

SAME_SURFACE_M = 0.05
"""Lanes lie over one another in junctions, and share their edges: road met again this soon is the same road."""

_OF_SIGNALS = (BlueprintKind.TRAFFIC_LIGHT, BlueprintKind.TRAFFIC_SIGN)


class _Moving(NamedTuple):
    boxes: MovingBoxes
    tags: list[int]


def environment_objects(episode: Episode, tag: int) -> list[EnvironmentObject]:
    """Return the loaded objects of a tag, or all of them; disabled ones too, for their ids enable them again."""
    surroundings = episode.surroundings
    objects = surroundings.scene.objects
    return [objects[row] for row in np.flatnonzero(surroundings.loaded) if tag in (objects[row].type, SemanticTag.ANY)]


def object_names(episode: Episode) -> list[str]:
    """Return the names of all loaded things."""
    scene = episode.surroundings.scene
    things = np.unique(scene.boxes["thing"][episode.surroundings.loaded])
    return [scene.thing_names[thing] for thing in things]


def level_boxes(episode: Episode, tag: int) -> list[BoundingBox]:
    """Return the boxes, in the world, of everything of a tag that is there now: scenery, then actors with a body.

    Boxes of actors carry their ids, those of a traffic light's and a sign's parts too (BoundingBoxCalculator.cpp).
    """
    scene, present = episode.surroundings.scene, episode.surroundings.present
    signal_ids = [record.id for record in episode.actors if record.kind in _OF_SIGNALS]
    things = scene.boxes["thing"]
    found = [
        scene.world_boxes[row]._replace(actor_id=signal_ids[things[row]] if things[row] < len(signal_ids) else 0)
        for row in np.flatnonzero(present)
        if tag in (scene.boxes["tag"][row], SemanticTag.ANY)
    ]
    return found + [box for found_tag, box in body_boxes(episode) if tag in (found_tag, SemanticTag.ANY)]


def body_boxes(episode: Episode) -> list[tuple[int, BoundingBox]]:
    """Return tag and box, in the world, of every actor with a body; boxes carry the actors' ids."""
    found = []
    for record in episode.actors:
        if record.slot != NO_BODY:
            centre, pose = _centre(episode, record)
            found.append((_tag(record), BoundingBox(centre, record.box.extent, pose.rotation, record.id)))
    return found


def light_boxes(episode: Episode, actor_id: int) -> list[BoundingBox]:
    """Return the boxes, in the world, of a traffic light's heads; their lenses count as one, as in CARLA.

    Raises:
        ActorRefusal: no such actor, or no traffic light.
    """
    scene, light = episode.surroundings.scene, episode.light(actor_id)
    return [
        scene.world_boxes[row]._replace(actor_id=actor_id)
        for row in scene.boxes_of(light)
        if scene.boxes["tag"][row] == SemanticTag.TRAFFIC_LIGHT
    ]


def cast_ray(episode: Episode, start: Vector3D, end: Vector3D) -> list[LabelledPoint]:
    """Return every surface between two points in the order of the ray, with its tag."""
    statics, moving = episode.statics, _moving(episode)
    origin, target = np.array(start, np.float64), np.array(end, np.float64)
    length_m = math.dist(start, end)
    found: list[LabelledPoint] = []
    last_road_m = dict.fromkeys(SemanticTag, -math.inf)
    for at, surface, number in crossings(episode.map.ground, _standing(statics), moving.boxes, origin, target).tolist():
        tag = _tag_of(episode, moving, Surface(int(surface)), int(number))
        if surface == Surface.ROAD:
            if at * length_m - last_road_m[tag] < SAME_SURFACE_M:
                continue
            last_road_m[tag] = at * length_m
        point = origin + at * (target - origin)
        found.append(LabelledPoint(Vector3D(*map(float, point)), int(tag)))
    return found


def project_point(episode: Episode, start: Vector3D, direction: Vector3D, reach_m: float) -> LabelledPoint | None:
    """Return the first surface in a direction within a distance, None where there is none.

    Raises:
        Refusal: the direction is none.
    """
    length = math.hypot(*direction)
    if length == 0.0:
        raise Refusal("project_point needs a direction; (0, 0, 0) points nowhere, (0, 0, -1) points down")
    end = Vector3D(*(a + b / length * reach_m for a, b in zip(start, direction, strict=True)))
    return next(iter(cast_ray(episode, start, end)), None)


def _standing(statics: Statics) -> StandingBoxes:
    bins = Bins(statics.bin_start, statics.bin_items, statics.bin_frame)
    return StandingBoxes(statics.centre, statics.half, statics.yaw_rad, bins)


def _moving(episode: Episode) -> _Moving:
    """Return the boxes of all actors that can be hit."""
    records = [record for record in episode.actors if record.slot != NO_BODY and episode.bodies.collides[record.slot]]
    places = [_centre(episode, record) for record in records]
    boxes = MovingBoxes(
        np.array([centre for centre, _ in places], np.float64).reshape(-1, 3),
        np.array([record.box.extent for record in records], np.float64).reshape(-1, 3),
        np.array([rotation_matrix(pose.rotation) for _, pose in places], np.float64).reshape(-1, 3, 3),
    )
    return _Moving(boxes, [_tag(record) for record in records])


def _centre(episode: Episode, record: ActorRecord) -> tuple[Vector3D, Transform]:
    """Return the middle of an actor's box in the world, and the actor's pose."""
    pose = episode.transform(record.id)
    centre = np.asarray(pose.location) + rotation_matrix(pose.rotation) @ np.asarray(record.box.location)
    return Vector3D(*map(float, centre)), pose


def _tag(record: ActorRecord) -> int:
    return record.semantic_tags[0] if record.semantic_tags else SemanticTag.NONE


def _tag_of(episode: Episode, moving: _Moving, surface: Surface, number: int) -> SemanticTag:
    if surface is Surface.TERRAIN:
        return SemanticTag.TERRAIN
    if surface is Surface.ROAD:
        world_map = episode.map
        return SemanticTag(int(world_map.lanes["tag"][world_map.lane_of_triangle[number]]))
    return SemanticTag(moving.tags[number] if surface is Surface.MOVING else int(episode.statics.tag[number]))
