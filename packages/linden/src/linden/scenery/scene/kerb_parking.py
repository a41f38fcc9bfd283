"""Cars parked along the streets, in parking lanes: clear of drives, stops, signs, crossings and spawn points.

There is no count of the cars at Linden's kerbs; the share of lots with one before them is an estimate.
"""

import numpy as np
from numpy.typing import NDArray

from linden.maps.facts import MapFacts
from linden.plane_bins import nearby
from linden.protocol.values.enums import LaneType, SemanticTag
from linden.scenery.scene.linden_survey import surveyed
from linden.scenery.scene.neighbourhood import SEED, between, on_lots
from linden.scenery.scene.objects import ObjectKind, Scene, assembled, boxes_on, things_with
from linden.scenery.scene.yard_layout import CAR_HALF_M, Drive
from linden.structured import StructuredArray

F64 = NDArray[np.float64]
Flags = NDArray[np.bool_]

SHARE = 0.5
TO_LANE_M = 3.93
"""From a lot's front back to the middle of the cars: pavement, verge and kerb, then half the width of the lane."""
FREE_AHEAD_M = 6.1
"""Of parking lane before and behind a car: 20 feet from a crosswalk, as Columbus City Code 2151.01 asks for."""
FROM_SIGNAL_M = 12.0  # 30 feet from a stop sign or light, and half a car
FROM_STOP_M = 27.0  # room for the shuttle to pull in and out, and for the crosswalk behind it
FROM_SPAWN_M = 7.8  # half a car and half the longest bus, which is wider than its lane
WRONG_WAY = 0.04
_ASIDE_M = (1.2, 2.4)
_OFF_LINE_M, _OFF_LINE_RAD = 0.05, 0.012  # drivers do not park like machines
_HIGH_M = 1e9


def kerbside_cars(lots: StructuredArray, drive: Drive, facts: MapFacts) -> Scene:
    """Return cars before the lots that lie along parking lanes."""
    draw = np.random.default_rng([SEED, 5]).random((len(lots), 8))
    side = np.where(draw[:, 1] < 0.5, -1.0, 1.0)
    side[drive.lot] = -drive.side
    half = np.array(CAR_HALF_M)[(draw[:, 2] * len(CAR_HALF_M)).astype(int)]
    out = np.full(len(lots), -TO_LANE_M) + between((-_OFF_LINE_M, _OFF_LINE_M), draw[:, 3])
    base = on_lots(lots, facts.ground, out, side * between(_ASIDE_M, draw[:, 4]))
    yaw = lots["yaw_rad"] - np.where(draw[:, 5] < WRONG_WAY, -0.5, 0.5) * np.pi
    yaw += between((-_OFF_LINE_RAD, _OFF_LINE_RAD), draw[:, 6])
    rows = np.flatnonzero(draw[:, 0] < SHARE)
    rows = rows[_in_lane(base[rows], lots["yaw_rad"][rows], half[rows], facts)]
    rows = rows[_clear(base[rows], facts)]
    things = things_with(ObjectKind.PARKED_CAR, base[rows], yaw[rows])
    return assembled(things, boxes_on(things, half[rows] * (0.0, 0.0, 1.0), half[rows], SemanticTag.CAR))


def _in_lane(base: F64, into_rad: F64, half_m: F64, facts: MapFacts) -> Flags:
    """Return which cars stand in a parking lane with all corners, that goes on before and behind them."""
    along = np.column_stack([-np.sin(into_rad), np.cos(into_rad)])
    across = np.column_stack([np.cos(into_rad), np.sin(into_rad)])
    inside = np.ones(len(base), bool)
    parking = facts.lanes["type_bits"] == LaneType.PARKING
    for ahead in (-1.0, -0.5, 0.0, 0.5, 1.0):
        for aside in (-1.0, 1.0):
            reach = ahead * (half_m[:, 0] + FREE_AHEAD_M)
            points = base[:, :2] + reach[:, None] * along + (aside * (half_m[:, 1] + 0.02))[:, None] * across
            triangle = facts.ground.surfaces_under(np.column_stack([points, np.full(len(base), _HIGH_M)]))[1]
            inside &= (triangle >= 0) & parking[facts.lane_of_triangle[triangle]]
    return inside


def _clear(base: F64, facts: MapFacts) -> Flags:
    """Return which places (N, 3) are far enough from signs and lights, from the shuttle's stops, from spawn points."""
    signals = np.array([signal.transform.location[:2] for signal in facts.signals]).reshape(-1, 2)
    spawns = np.array([point.location[:2] for point in facts.spawn_points]).reshape(-1, 2)
    stops = surveyed(facts.geo_origin_deg).stops_m
    clear = np.ones(len(base), bool)
    for others, reach_m in ((signals, FROM_SIGNAL_M), (stops, FROM_STOP_M), (spawns, FROM_SPAWN_M)):
        clear &= ~nearby(base[:, :2], others, reach_m)
    return clear
