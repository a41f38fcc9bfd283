"""The scene of maps other than Linden: the buildings and the furniture that the map has; else houses on its lots."""

import re
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from linden.maps.facts import MapFacts
from linden.maps.records import STREET_NAME_SIGN, Standing
from linden.protocol.values.enums import SemanticTag
from linden.scenery.scene.neighbourhood import furnish, is_clear
from linden.scenery.scene.objects import BOX, THING, ObjectKind, Scene

KIND_OF = {
    "building": ObjectKind.BUILDING,
    "bench": ObjectKind.BENCH,
    "bin": ObjectKind.BIN,
    "mailbox": ObjectKind.MAILBOX,
    STREET_NAME_SIGN: ObjectKind.STREET_NAME_SIGN,
}
_HOUSE_M = ((5.0, 16.0), (5.0, 16.0), (3.8, 9.5))  # least and most length, width and height


def plain(facts: MapFacts) -> Scene:
    """Return houses, trees and lamps on the lots of a map; no houses where the map has buildings of its own."""
    drawn = furnish(facts.lots, facts.ground)
    if not any(thing.kind == "building" for thing in facts.standing):
        return drawn
    return kept(drawn, (drawn.things["kind"] != ObjectKind.HOUSE) & beside_buildings(drawn, facts.standing))


def beside_buildings(scene: Scene, standing: Sequence[Standing]) -> NDArray[np.bool_]:
    """Return which things of a scene (N,) stand outside of a map's buildings."""
    free = np.ones(len(scene.things), bool)
    for thing in standing:
        for box in thing.boxes if thing.kind == "building" else ():
            free &= is_clear(scene.things["base"][:, :2], box)
    return free


def mapped(standing: Sequence[Standing], *, with_houses: bool = True) -> Scene:
    """Return the things that a map says stand beside its roads; small buildings are houses, where these are wanted."""
    things = np.zeros(len(standing), THING)
    boxes = np.zeros(sum(len(thing.boxes) for thing in standing), BOX)
    row = 0
    for number, thing in enumerate(standing):
        kind = _kind(thing) if with_houses else KIND_OF[thing.kind]
        things[number] = (kind, (thing.x_m, thing.y_m, thing.z_m), thing.yaw_rad)
        for nth, box in enumerate(thing.boxes):
            boxes[row] = (box[:3], box[3:6], box.yaw_rad, _tag(thing.kind, nth), number)
            row += 1
    labels = tuple((number, _label(thing.name)) for number, thing in enumerate(standing) if _label(thing.name))
    return Scene(things, boxes, labels)


def kept(scene: Scene, wanted: NDArray[np.bool_]) -> Scene:
    """Return a scene of those of the things that are wanted (N,); the scene has no labels."""
    boxes = scene.boxes[wanted[scene.boxes["thing"]]].copy()
    boxes["thing"] = (np.cumsum(wanted) - 1)[boxes["thing"]]
    return Scene(scene.things[wanted], boxes)


def _tag(kind: str, nth: int) -> SemanticTag:
    """Return the tag of the nth box of a thing; the first one of a sign is its post."""
    if kind == STREET_NAME_SIGN:
        return SemanticTag.TRAFFIC_SIGNS if nth else SemanticTag.POLES
    return SemanticTag.BUILDINGS if kind == "building" else SemanticTag.STATIC


def _kind(thing: Standing) -> ObjectKind:
    """Return what a thing is: a building of a house's size is a house, with a gable."""
    only = thing.boxes[0]
    small = all(low <= 2.0 * size_m <= high for size_m, (low, high) in zip(only[3:6], _HOUSE_M, strict=True))
    return ObjectKind.HOUSE if thing.kind == "building" and len(thing.boxes) == 1 and small else KIND_OF[thing.kind]


def _label(name: str) -> str:
    """Return a name as a part of an object's name: letters and digits of ASCII alone."""
    return re.sub(r"[^A-Za-z0-9]+", "", name)
