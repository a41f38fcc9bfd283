"""Buildings, street furniture and street-name signs of an OpenDRIVE map as upright boxes.

A footprint becomes upright boxes: it is cut into strips across its longest side, at each of its corners. For a
footprint of right angles, which most buildings have, the boxes are exact; an oblique wall becomes steps.
"""

import math
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from linden.maps.ground import Ground
from linden.maps.opendrive.evaluate.tables import tables_of
from linden.maps.opendrive.model import OpenDrive
from linden.maps.opendrive.outlines import outline_of
from linden.maps.opendrive.roadside import RoadObject
from linden.maps.records import (
    ADVANCE,
    BLADE_LETTER_M,
    NAMES_BETWEEN,
    STREET_NAME_SIGN,
    Standing,
    StandingBox,
)

F64 = NDArray[np.float64]

FURNITURE = frozenset({"bench", "bin", "mailbox"})
"""Names of objects of the type ``obstacle`` that are known."""

STREET_NAME = "streetName"
"""Code of an object's ``userData``: a blade of a street-name sign, its turn against the road in rad, and the name."""

BLADE_HALF_HEIGHT_M = 0.075
BLADE_HALF_THICKNESS_M = 0.006
MARGIN_M = 0.06
MOST_BLADES = 4
LONGEST_NAME = 30

MOST_STANDING = 20_000
MOST_STRIPS = 24
"""Of one footprint; a round one has as many corners as its author liked."""
_SAME_M = 0.05  # corners that are nearer to each other along the longest side share a cut
_HIGH_M = 1e6


def standing_on(opendrive: OpenDrive, ground: Ground) -> tuple[Standing, ...]:
    """Return the buildings and the furniture of a map in the order of its roads, at most ``MOST_STANDING``."""
    tables = tables_of(opendrive)
    found: list[Standing] = []
    for index, road in enumerate(tables.roads):
        for thing in road.objects:
            kind = _kind(thing)
            if kind is None or len(found) == MOST_STANDING:
                continue
            outline = outline_of(tables, index, thing)
            if len(outline) < 3 or not np.isfinite(outline).all():
                continue
            boxes = footprint_boxes(outline)
            if not boxes:
                continue
            middle = outline.mean(axis=0)
            heights, _ = ground.surfaces_under(np.array([[*middle, _HIGH_M]]))
            place = (float(middle[0]), float(middle[1]), float(heights[0]) + thing.z_offset_m)
            if kind == STREET_NAME_SIGN:
                s_m = min(max(thing.s_m, 0.0), float(tables.road_length_m[index]))
                heading = tables.curves.pose(np.array([index]), np.array([s_m])).heading_rad
                found.append(_name_sign(thing, boxes[0], place, float(heading[0])))
            else:
                found.append(_standing(kind, thing, boxes, place))
    return tuple(found)


def blades_of(thing: RoadObject) -> tuple[tuple[float, str], ...]:
    """Return the blades of a street-name sign: turn against the road in rad, and name; what is no such is left out."""
    found = []
    for code, value in thing.user_data:
        turn, _, name = value.partition(" ")
        try:
            turn_rad = float(turn)
        except ValueError:
            continue
        if code == STREET_NAME and math.isfinite(turn_rad) and name.strip():
            found.append((turn_rad, name.strip()[:LONGEST_NAME]))
    return tuple(found[:MOST_BLADES])


def blade_half_length_m(name: str) -> float:
    """Return half the length of a blade: as long as its name in capitals, which are as far apart as they are wide."""
    return 0.5 * BLADE_LETTER_M * ADVANCE * len(name) + MARGIN_M


def footprint_boxes(outline: F64) -> list[tuple[float, float, float, float, float]]:
    """Return upright boxes over a ring of corners (N, 2): x, y of the middle, half length, half width, yaw in rad."""
    sides = np.roll(outline, -1, axis=0) - outline
    longest = sides[int(np.argmax(np.hypot(*sides.T)))]
    yaw_rad = math.atan2(longest[1], longest[0])
    cos, sin = math.cos(yaw_rad), math.sin(yaw_rad)
    turned = outline @ np.array([[cos, -sin], [sin, cos]])
    found = []
    cuts = _cuts(np.sort(turned[:, 0]))
    for low, high in pairwise(cuts):
        for below, above in _spans(turned, 0.5 * (low + high)):
            u, v = 0.5 * (low + high), 0.5 * (below + above)
            half_u, half_v = 0.5 * (high - low), 0.5 * (above - below)
            if half_v > 0.5 * _SAME_M:
                found.append((u * cos - v * sin, u * sin + v * cos, half_u, half_v, yaw_rad))
    return found


def _cuts(places: F64) -> list[float]:
    """Return where strips begin and end: at the corners, but in equal parts where these are too many."""
    cuts = [float(places[0])]
    for place in places[1:].tolist():
        if place - cuts[-1] > _SAME_M:
            cuts.append(place)
    if len(cuts) > MOST_STRIPS + 1:
        return [float(place) for place in np.linspace(cuts[0], cuts[-1], MOST_STRIPS + 1)]
    return cuts


def _spans(ring: F64, at: float) -> list[tuple[float, float]]:
    """Return where a line across a ring at one place lies inside of it (even-odd rule)."""
    after = np.roll(ring, -1, axis=0)
    crossing = (ring[:, 0] > at) != (after[:, 0] > at)
    first, second = ring[crossing], after[crossing]
    share = (at - first[:, 0]) / (second[:, 0] - first[:, 0])
    places = np.sort(first[:, 1] + share * (second[:, 1] - first[:, 1])).tolist()
    return list(zip(places[::2], places[1::2], strict=True))


def _kind(thing: RoadObject) -> str | None:
    """Return what an object is, None where it is nothing that stands, or has no height."""
    height_m = _height_m(thing)
    if not 0.0 < height_m < 1000.0:
        return None
    if thing.type.lower() == "building":
        return "building"
    if thing.type.lower() == "pole" and blades_of(thing):
        return STREET_NAME_SIGN
    return thing.name if thing.type.lower() == "obstacle" and thing.name in FURNITURE else None


def _height_m(thing: RoadObject) -> float:
    return max((thing.height_m, *(corner.height_m for corner in thing.outline)))


def _standing(
    kind: str,
    thing: RoadObject,
    boxes: list[tuple[float, float, float, float, float]],
    base_m: tuple[float, float, float],
) -> Standing:
    half_z = 0.5 * _height_m(thing)
    name = thing.name if kind == "building" else ""
    return Standing(
        kind,
        name,
        *base_m,
        boxes[0][4],
        tuple(StandingBox(x, y, base_m[2] + half_z, u, v, half_z, yaw) for x, y, u, v, yaw in boxes),
    )


def _name_sign(
    thing: RoadObject,
    post: tuple[float, float, float, float, float],
    place_m: tuple[float, float, float],
    heading_rad: float,
) -> Standing:
    """Return a street-name sign: its post, and its blades on top of each other, the first one at the post's top."""
    x_m, y_m, base_m = place_m
    blades = blades_of(thing)
    half_z = 0.5 * _height_m(thing)
    boxes = [StandingBox(post[0], post[1], base_m + half_z, post[2], post[3], half_z, post[4])]
    for nth, (turn_rad, name) in enumerate(blades):
        middle_m = base_m + _height_m(thing) - (2 * nth + 1) * BLADE_HALF_HEIGHT_M
        yaw_rad = -math.remainder(heading_rad + turn_rad, math.tau)  # CARLA's frame is left-handed
        half = blade_half_length_m(name), BLADE_HALF_THICKNESS_M, BLADE_HALF_HEIGHT_M
        boxes.append(StandingBox(x_m, y_m, middle_m, *half, yaw_rad))
    names = NAMES_BETWEEN.join(name for _, name in blades)
    return Standing(STREET_NAME_SIGN, names, x_m, y_m, base_m, post[4], tuple(boxes))
