"""The scene of maps other than Linden: the buildings and the furniture that the map has; else houses on its lots."""

import re
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from linden.maps.facts import MapFacts
from linden.maps.records import Standing, StandingBox
from linden.protocol.values.enums import SemanticTag
from linden.scenery.scene.neighbourhood import furnish
from linden.scenery.scene.objects import BOX, THING, Kind, Scene

KIND_OF = {"building": Kind.BUILDING, "bench": Kind.BENCH, "bin": Kind.BIN, "mailbox": Kind.MAILBOX}
_TAG_OF = {"building": SemanticTag.BUILDINGS}
_HOUSE_M = ((5.0, 16.0), (5.0, 16.0), (3.8, 9.5))  # least and most length, width and height
_CLEAR_M = 1.0  # between a footprint and what is drawn on a lot


def plain(facts: MapFacts) -> Scene:
    """Return houses, trees and lamps on the lots of a map; no houses where the map has buildings of its own."""
    drawn = furnish(facts.lots, facts.ground)
    footprints = [box for thing in facts.standing if thing.kind == "building" for box in thing.boxes]
    if not footprints:
        return drawn
    free = drawn.things["kind"] != Kind.HOUSE
    for box in footprints:
        free &= _is_clear(drawn.things["base"], box)
    return kept(drawn, free)


def mapped(standing: Sequence[Standing]) -> Scene:
    """Return the things that a map says stand beside its roads."""
    things = np.zeros(len(standing), THING)
    boxes = np.zeros(sum(len(thing.boxes) for thing in standing), BOX)
    row = 0
    for number, thing in enumerate(standing):
        things[number] = (_kind(thing), (thing.x_m, thing.y_m, thing.z_m), thing.yaw_rad)
        for box in thing.boxes:
            tag = _TAG_OF.get(thing.kind, SemanticTag.STATIC)
            boxes[row] = (box[:3], box[3:6], box.yaw_rad, tag, number)
            row += 1
    labels = tuple((number, _label(thing.name)) for number, thing in enumerate(standing) if _label(thing.name))
    return Scene(things, boxes, labels)


def kept(scene: Scene, wanted: NDArray[np.bool_]) -> Scene:
    """Return a scene of those of the things that are wanted (N,); the scene has no labels."""
    boxes = scene.boxes[wanted[scene.boxes["thing"]]].copy()
    boxes["thing"] = (np.cumsum(wanted) - 1)[boxes["thing"]]
    return Scene(scene.things[wanted], boxes)


def _kind(thing: Standing) -> Kind:
    """Return what a thing is: a building of a house's size is a house, with a gable."""
    only = thing.boxes[0]
    small = all(low <= 2.0 * size_m <= high for size_m, (low, high) in zip(only[3:6], _HOUSE_M, strict=True))
    return Kind.HOUSE if thing.kind == "building" and len(thing.boxes) == 1 and small else KIND_OF[thing.kind]


def _label(name: str) -> str:
    """Return a name as a part of an object's name: letters and digits of ASCII alone."""
    return re.sub(r"[^A-Za-z0-9]+", "", name)


def _is_clear(places_m: NDArray[np.float64], box: StandingBox) -> NDArray[np.bool_]:
    """Return which places (N, 3) lie outside of a box in plan, and some way off."""
    offset = places_m[:, :2] - (box.x_m, box.y_m)
    cos, sin = np.cos(box.yaw_rad), np.sin(box.yaw_rad)
    along, across = offset @ (cos, sin), offset @ (-sin, cos)
    clear: NDArray[np.bool_] = (np.abs(along) > box.half_x_m + _CLEAR_M) | (np.abs(across) > box.half_y_m + _CLEAR_M)
    return clear
