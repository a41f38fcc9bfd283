"""Layout of yards around houses: boxes of porches, hedges, fences and parked cars, and the driveways.

A lot's measures are those of :mod:`linden.maps.records`; which lot has what is drawn with a seed, like the houses.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from linden.maps.ground import Ground
from linden.maps.records import LOT_DEPTH_M, LOT_WIDTH_M
from linden.protocol.values.enums import SemanticTag
from linden.scenery.scene.neighbourhood import HOUSE_WIDTH_M, LOTS_A_LAMP, SEED, between, on_lots, tree_side, with_house
from linden.scenery.scene.objects import ObjectKind, Scene, assembled, boxes_on, join, things_with
from linden.structured import StructuredArray

F64 = NDArray[np.float64]
I64 = NDArray[np.int64]

PORCHES, HEDGES, SIDE_FENCES, BACK_FENCES, DRIVES, CARS = 0.55, 0.28, 0.3, 0.4, 0.55, 0.5
"""How many houses have one, and how many drives a car."""

PORCH_DEPTH_M = 1.7
PORCH_HEIGHT_M = 3.0
PORCH_WIDE = 0.92  # of the house's width
HEDGE_HALF_M = (0.3, 1.5, 0.5)
HEDGE_DEPTH_M, HEDGE_ASIDE_M = 0.85, -3.2
FENCE_HALF_M = 0.04
FENCE_HEIGHT_M = (1.1, 1.8)
FENCE_BACK_M = LOT_DEPTH_M - 0.1
FENCE_FRONT_M = 10.0
DRIVE_ASIDE_M, DRIVE_HALF_M = 3.55, 1.25
"""A drive is a bay in front of the house on one side of the lot, its middle so far from the lot's."""
CAR_FRONT_M = 0.6  # from the pavement
CAR_HALF_M = ((2.19, 0.91, 0.72), (2.30, 0.93, 0.85), (2.05, 0.88, 0.74))
"""Of the cars that stand on drives: a saloon, a sport utility vehicle, a hatchback."""


class Drive(NamedTuple):
    """Drives (N): the lot, on which hand of it (1 right, -1 left), how long."""

    lot: I64
    side: F64
    length_m: F64


def yards(lots: StructuredArray, houses: Scene, drive: Drive, ground: Ground) -> Scene:
    """Return what lies around the houses that stand on the lots and have these drives."""
    lot_of_house = with_house(lots)
    draw = _draw(lots)
    open_left = np.setdiff1d(lot_of_house, drive.lot[drive.side < 0.0])
    box = houses.boxes[np.searchsorted(houses.boxes["thing"], _house_rows(houses))]
    return join(
        [
            _porches(box, houses.things[_house_rows(houses)], draw[lot_of_house]),
            _hedges(lots[open_left], ground, draw[open_left]),
            _fences(lots[lot_of_house], ground, draw[lot_of_house]),
            _cars(lots, ground, drive, draw),
        ]
    )


def drives(lots: StructuredArray, houses: Scene) -> Drive:
    """Return the drives of the lots that have one."""
    lot, rows = with_house(lots), _house_rows(houses)
    with_porch = has_porch(lots)[lot]
    draw = np.random.default_rng([SEED, 2]).random((len(lots), 2))[lot]
    box = houses.boxes[np.searchsorted(houses.boxes["thing"], rows)]
    front = np.hypot(*(box["centre"][:, :2] - lots["front_m"][lot]).T) - box["half"][:, 0]
    side = np.where((draw[:, 1] < 0.5) | (lot % LOTS_A_LAMP == 0), -1.0, 1.0)
    side = np.where(tree_side(lots)[lot] == side, -side, side)
    chosen = (draw[:, 0] < DRIVES) & ((lot % LOTS_A_LAMP != 0) | (side < 0.0))
    length = front - np.where(with_porch, PORCH_DEPTH_M + 0.1, 0.1)
    return Drive(lot[chosen], side[chosen], length[chosen])


def has_porch(lots: StructuredArray) -> NDArray[np.bool_]:
    """Return for each lot whether the house on it, if there is one, has a porch."""
    with_porch: NDArray[np.bool_] = _draw(lots)[:, 0] < PORCHES
    return with_porch


def _draw(lots: StructuredArray) -> F64:
    return np.random.default_rng([SEED, 1]).random((len(lots), 12))


def _house_rows(houses: Scene) -> I64:
    return np.flatnonzero(houses.things["kind"] == ObjectKind.HOUSE).astype(np.int64)


def _porches(box: StructuredArray, things: StructuredArray, draw: F64) -> Scene:
    chosen = draw[:, 0] < PORCHES  # as has_porch
    box, things = box[chosen], things[chosen]
    x = -box["half"][:, 0] - 0.5 * PORCH_DEPTH_M - 0.02
    forward = np.column_stack([np.cos(box["yaw_rad"]), np.sin(box["yaw_rad"]), np.zeros(len(box))])
    made = things_with(ObjectKind.PORCH, things["base"] + forward * x[:, None], box["yaw_rad"])
    half = np.column_stack(
        [
            np.full(len(box), 0.5 * PORCH_DEPTH_M),
            PORCH_WIDE * box["half"][:, 1],
            np.minimum(0.5 * PORCH_HEIGHT_M, 0.6 * box["half"][:, 2]),
        ]
    )
    return assembled(made, boxes_on(made, half * (0.0, 0.0, 1.0), half, SemanticTag.BUILDINGS))


def _hedges(lots: StructuredArray, ground: Ground, draw: F64) -> Scene:
    chosen = draw[:, 1] < HEDGES
    lots = lots[chosen]
    base = on_lots(lots, ground, np.full(len(lots), HEDGE_DEPTH_M), np.full(len(lots), HEDGE_ASIDE_M))
    things = things_with(ObjectKind.HEDGE, base, lots["yaw_rad"])
    half = np.array(HEDGE_HALF_M)
    return assembled(things, boxes_on(things, half * (0.0, 0.0, 1.0), half, SemanticTag.VEGETATION))


def _fences(lots: StructuredArray, ground: Ground, draw: F64) -> Scene:
    """Return fences along the backs and along the left sides of lots."""
    scenes = []
    middle = 0.5 * (FENCE_FRONT_M + FENCE_BACK_M)
    runs = (
        (draw[:, 2] < BACK_FENCES, FENCE_BACK_M, 0.0, (FENCE_HALF_M, 0.5 * LOT_WIDTH_M - 0.1)),
        (draw[:, 3] < SIDE_FENCES, middle, 0.1 - 0.5 * LOT_WIDTH_M, (FENCE_BACK_M - middle - 0.1, FENCE_HALF_M)),
    )
    for chosen, depth, aside, (half_x, half_y) in runs:
        some = lots[chosen]
        base = on_lots(some, ground, np.full(len(some), depth), np.full(len(some), aside))
        things = things_with(ObjectKind.FENCE, base, some["yaw_rad"])
        tall = np.where(draw[chosen, 4] < 0.4, *FENCE_HEIGHT_M)
        half = np.column_stack([np.full(len(some), half_x), np.full(len(some), half_y), 0.5 * tall])
        scenes.append(assembled(things, boxes_on(things, half * (0.0, 0.0, 1.0), half, SemanticTag.FENCES)))
    return join(scenes)


def _cars(lots: StructuredArray, ground: Ground, drive: Drive, draw: F64) -> Scene:
    """Return cars that stand on drives, nose to the house."""
    half = np.array(CAR_HALF_M)[(draw[drive.lot, 6] * len(CAR_HALF_M)).astype(int)]
    fits = (draw[drive.lot, 5] < CARS) & (2.0 * half[:, 0] + CAR_FRONT_M + 0.3 < drive.length_m)
    lot, side, half = drive.lot[fits], drive.side[fits], half[fits]
    inwards = CAR_FRONT_M + half[:, 0] + between((0.0, 0.3), draw[lot, 7])
    base = on_lots(lots[lot], ground, inwards, side * DRIVE_ASIDE_M)
    turned = np.where(draw[lot, 8] < 0.7, 0.0, np.pi)  # some are backed in
    things = things_with(ObjectKind.PARKED_CAR, base, lots["yaw_rad"][lot] + turned)
    return assembled(things, boxes_on(things, half * (0.0, 0.0, 1.0), half, SemanticTag.CAR))


assert DRIVE_ASIDE_M + DRIVE_HALF_M <= 0.5 * LOT_WIDTH_M - 0.6, "a drive leaves room for the lamp beside it"
assert HOUSE_WIDTH_M[1] + 0.4 < LOT_WIDTH_M, "a fence fits between two houses"
