"""A street of South Linden: houses, trees and lamps on the lots along it.

No survey of the single houses was found, so they are drawn, with the same seed every time, from what is known of the
neighbourhood: frame houses of one and a half to two storeys and bungalows, 6 to 8 m behind the pavement, 1.5 to 3 m
apart, about one lot in five vacant (Linden Community Plan 2018: 22 % of dwellings; median house 94 m²).
"""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from linden.maps.ground import Ground
from linden.maps.records import LOT_DEPTH_M, LOT_WIDTH_M, LOTS, Standing, StandingBox
from linden.protocol.values.enums import SemanticTag
from linden.scenery.scene.objects import ObjectKind, Scene, assembled, boxes_on, join, things_with
from linden.structured import StructuredArray

F64 = NDArray[np.float64]

SEED = 614  # any number does; the houses stand where they do because of it
VACANT = 0.2
BUNGALOWS = 0.35
_CLEAR_M = 1.0  # between a footprint and what is drawn on a lot
SETBACK_M = (6.0, 8.0)
HOUSE_WIDTH_M = (7.0, 8.8)
HOUSE_DEPTH_M = (8.0, 11.5)
HOUSE_HEIGHT_M = (5.8, 7.4)
BUNGALOW_HEIGHT_M = (4.0, 4.8)

WITH_TREE = 0.6
TREE_DEPTH_M = (2.0, 4.5)
TRUNK_HALF_M = (0.12, 0.25)
TRUNK_HEIGHT_M = 4.0

LOTS_A_LAMP = 4
"""A lamp every 44 m on either side, which is what American streets of this width have."""
LAMP_DEPTH_M = 0.5
LAMP_HALF_WIDTH_M = 0.08
LAMP_HEIGHT_M = 7.5
LAMP_ARM_HALF_M = (0.9, 0.12, 0.08)
"""The arm with its lantern, from the top of the pole towards the street."""

assert SETBACK_M[1] + HOUSE_DEPTH_M[1] <= LOT_DEPTH_M
assert HOUSE_WIDTH_M[1] < LOT_WIDTH_M


def furnish(lots: StructuredArray, ground: Ground) -> Scene:
    """Return what stands on the lots: houses, then trees, then lamps, each in the order of the lots."""
    draw = _draw(lots)
    return join([_houses(lots, ground, draw), _trees(lots, ground, draw), _lamps(lots, ground)])


def _draw(lots: StructuredArray) -> F64:
    """Return what is drawn for each lot (N, 9): no lot depends on what stands on another."""
    return np.random.default_rng(SEED).random((len(lots), 9))


def with_house(lots: StructuredArray) -> NDArray[np.intp]:
    """Return the lots that houses stand on, in the order of the houses."""
    return np.flatnonzero((_draw(lots)[:, 0] >= VACANT) & ~is_taken(lots))


def is_taken(lots: StructuredArray) -> NDArray[np.bool_]:
    """Return which lots (N,) something else stands on, as :func:`with_taken` marked them."""
    taken: NDArray[np.bool_] = lots["taken"] if "taken" in (lots.dtype.names or ()) else np.zeros(len(lots), bool)
    return taken


def with_taken(lots: StructuredArray, standing: Sequence[Standing]) -> StructuredArray:
    """Return lots, marked where a building of the map reaches into them.

    They stay in the table, so that what is drawn for the other lots does not change.
    """
    marked = np.zeros(len(lots), [*LOTS.descr, ("taken", "?")])
    for name in LOTS.names or ():
        marked[name] = lots[name]
    cosine, sine = np.cos(lots["yaw_rad"]), np.sin(lots["yaw_rad"])
    for inwards_m in np.linspace(0.0, LOT_DEPTH_M, 6):
        for aside_m in np.linspace(-0.5, 0.5, 4) * LOT_WIDTH_M:
            x = lots["front_m"][:, 0] + cosine * inwards_m - sine * aside_m
            y = lots["front_m"][:, 1] + sine * inwards_m + cosine * aside_m
            places = np.column_stack([x, y])
            for thing in standing:
                for box in thing.boxes if thing.kind == "building" else ():
                    marked["taken"] |= ~is_clear(places, box)
    return marked


def is_clear(places_m: F64, box: StandingBox) -> NDArray[np.bool_]:
    """Return which places (N, 2) lie outside of a box in plan, and some way off."""
    offset = places_m - (box.x_m, box.y_m)
    cos, sin = np.cos(box.yaw_rad), np.sin(box.yaw_rad)
    along, across = offset @ (cos, sin), offset @ (-sin, cos)
    clear: NDArray[np.bool_] = (np.abs(along) > box.half_x_m + _CLEAR_M) | (np.abs(across) > box.half_y_m + _CLEAR_M)
    return clear


def tree_side(lots: StructuredArray) -> F64:
    """Return for each lot on which hand its tree stands (1 right, -1 left), 0 where it has none."""
    draw = _draw(lots)
    return np.where((draw[:, 6] < WITH_TREE) & ~is_taken(lots), np.sign(draw[:, 7] - 0.5), 0.0)


def _houses(lots: StructuredArray, ground: Ground, draw: F64) -> Scene:
    built = with_house(lots)
    lots, draw = lots[built], draw[built]
    width, depth = between(HOUSE_WIDTH_M, draw[:, 1]), between(HOUSE_DEPTH_M, draw[:, 2])
    height = np.where(
        draw[:, 3] < BUNGALOWS, between(BUNGALOW_HEIGHT_M, draw[:, 4]), between(HOUSE_HEIGHT_M, draw[:, 4])
    )
    inwards = between(SETBACK_M, draw[:, 5]) + 0.5 * depth
    things = things_with(ObjectKind.HOUSE, on_lots(lots, ground, inwards, np.zeros(len(lots))), lots["yaw_rad"])
    half = 0.5 * np.column_stack([depth, width, height])
    return assembled(things, boxes_on(things, half * (0.0, 0.0, 1.0), half, SemanticTag.BUILDINGS))


def _trees(lots: StructuredArray, ground: Ground, draw: F64) -> Scene:
    planted = (draw[:, 6] < WITH_TREE) & ~is_taken(lots)
    lots, draw = lots[planted], draw[planted]
    aside = (draw[:, 7] - 0.5) * (LOT_WIDTH_M - 3.0)
    things = things_with(
        ObjectKind.TREE, on_lots(lots, ground, between(TREE_DEPTH_M, draw[:, 8]), aside), lots["yaw_rad"]
    )
    half = np.full((len(lots), 3), 0.5 * TRUNK_HEIGHT_M)
    half[:, :2] = between(TRUNK_HALF_M, draw[:, 1])[:, None]
    return assembled(things, boxes_on(things, half * (0.0, 0.0, 1.0), half, SemanticTag.VEGETATION))


def _lamps(lots: StructuredArray, ground: Ground) -> Scene:
    lots = lots[::LOTS_A_LAMP]
    aside = np.full(len(lots), 0.5 * LOT_WIDTH_M - 0.5)
    base = on_lots(lots, ground, np.full(len(lots), LAMP_DEPTH_M), aside)
    things = things_with(ObjectKind.STREET_LAMP, base, lots["yaw_rad"])
    half = np.array([LAMP_HALF_WIDTH_M, LAMP_HALF_WIDTH_M, 0.5 * LAMP_HEIGHT_M])
    arm = np.array([-LAMP_ARM_HALF_M[0], 0.0, LAMP_HEIGHT_M])
    return assembled(
        things,
        boxes_on(things, np.array([0.0, 0.0, half[2]]), half, SemanticTag.POLES),
        boxes_on(things, arm, np.array(LAMP_ARM_HALF_M), SemanticTag.POLES),
    )


def on_lots(lots: StructuredArray, ground: Ground, inwards_m: F64, aside_m: F64) -> F64:
    """Return places (N, 3) on the ground, so far into the lots and to the right of their middle."""
    cosine, sine = np.cos(lots["yaw_rad"]), np.sin(lots["yaw_rad"])
    x = lots["front_m"][:, 0] + cosine * inwards_m - sine * aside_m
    y = lots["front_m"][:, 1] + sine * inwards_m + cosine * aside_m
    height, _ = ground.surfaces_under(np.column_stack([x, y, np.full(len(lots), np.inf)]))
    return np.column_stack([x, y, height])


def between(bounds: tuple[float, float], share: F64) -> F64:
    """Return numbers so far along between two bounds."""
    return bounds[0] + (bounds[1] - bounds[0]) * share
