"""Utility poles and bus shelters of Linden, and ``clear_of``, which drops lots that the railroad crosses."""

import math
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from linden.maps.ground import Ground
from linden.maps.records import LOT_WIDTH_M
from linden.protocol.values.enums import SemanticTag
from linden.scenery.scene.neighbourhood import LOTS_A_LAMP, on_lots
from linden.scenery.scene.objects import ObjectKind, Scene, assembled, boxes_on, things_with
from linden.structured import StructuredArray

F64 = NDArray[np.float64]

POLE_HALF_M = 0.14
POLE_HEIGHT_M = 9.5
_POLE_DEPTH_M = 0.9
_POLE_ASIDE_M = 0.35 - 0.5 * LOT_WIDTH_M

SHELTER_HALF_M = (0.75, 2.0, 1.25)
PANEL_HALF_M = 0.03
_SEARCH_M = 18.0
_CLEAR_M = 4.5  # between the middle of a shelter and that of anything else
_BEHIND_M = 0.3  # the pavement
_SAME_SIDE = 0.25  # cosine of the widest angle to the named point of the compass

RAILROAD_CLEAR_M = 10.0
_HIGH_M = 1e9


def poles(lots: StructuredArray, ground: Ground) -> Scene:
    """Return utility poles on one side of each street, every fourth lot, clear of the lamps."""
    first = np.concatenate([[True], lots["road_id"][1:] != lots["road_id"][:-1]])[: len(lots)]
    leading = lots["yaw_rad"][np.maximum.accumulate(np.where(first, np.arange(len(lots)), 0))] if len(lots) else 0.0
    same_side = np.cos(lots["yaw_rad"] - leading) > 0.0
    some = lots[(np.arange(len(lots)) % LOTS_A_LAMP == LOTS_A_LAMP // 2) & same_side]
    base = on_lots(some, ground, np.full(len(some), _POLE_DEPTH_M), np.full(len(some), _POLE_ASIDE_M))
    clear = ~_on_road(base[:, :2], ground)
    things = things_with(ObjectKind.UTILITY_POLE, base[clear], some["yaw_rad"][clear])
    half = np.array([POLE_HALF_M, POLE_HALF_M, 0.5 * POLE_HEIGHT_M])
    return assembled(things, boxes_on(things, half * (0.0, 0.0, 1.0), half, SemanticTag.POLES))


def shelters(stops_m: F64, kerbs: F64, others: Scene, ground: Ground) -> Scene:
    """Return shelters behind the pavement beside each stop (N, 2), their backs to the land; x looks away from the road.

    ``kerbs`` (N, 2) point roughly to the side of the street they are on. Where all is taken there is none.
    """
    found = [_beside(stop, kerb, others, ground) for stop, kerb in zip(stops_m, kerbs, strict=True)]
    places = [place for place in found if place is not None]
    base = np.array([place[0] for place in places]).reshape(-1, 3)
    things = things_with(ObjectKind.SHELTER, base, np.array([place[1] for place in places]))
    x, y, z = SHELTER_HALF_M
    back = boxes_on(things, np.array([x - PANEL_HALF_M, 0.0, z]), np.array([PANEL_HALF_M, y, z]), SemanticTag.STATIC)
    ends = [
        boxes_on(things, np.array([0.0, s * (y - PANEL_HALF_M), z]), np.array([x, PANEL_HALF_M, z]), SemanticTag.STATIC)
        for s in (-1.0, 1.0)
    ]
    roof = boxes_on(things, np.array([-0.15, 0.0, 2.0 * z]), np.array([x + 0.2, y + 0.1, 0.06]), SemanticTag.STATIC)
    return assembled(things, back, *ends, roof)


def _beside(stop: F64, kerb: F64, others: Scene, ground: Ground) -> tuple[F64, float] | None:
    """Return place and direction of the shelter of one stop."""
    angles = np.arange(72) * (math.tau / 72)
    ways = np.stack([np.cos(angles), np.sin(angles)], axis=1)
    ways = ways[ways @ kerb > _SAME_SIDE]
    for away in np.arange(0.5, _SEARCH_M, 0.25).tolist():
        free = ~_on_road(stop + away * ways, ground)
        if free.any():
            break
    else:
        return None
    out = ways[free].mean(axis=0)
    out /= max(float(np.hypot(*out)), 1e-9)
    along = np.array([-out[1], out[0]])
    x, y, _ = SHELTER_HALF_M
    corners = np.array([(a, b) for a in (-x, 0.0, x) for b in (-y, 0.0, y)])
    taken = others.boxes["centre"][:, :2]
    taken = taken[np.abs(taken - stop).max(axis=1) < 2.0 * _SEARCH_M + _CLEAR_M]
    for shift in (0.0, 3.0, -3.0, 6.0, -6.0, 9.0, -9.0, 12.0, -12.0):
        for deeper in (0.0, 0.5, 1.0, 1.5, 2.0, 3.0):
            middle = stop + (away + x + _BEHIND_M + deeper) * out + shift * along
            points = middle + corners @ np.stack([out, along])
            if _on_road(points, ground).any() or (np.hypot(*(taken - middle).T) < _CLEAR_M).any():
                continue
            height, _ = ground.surfaces_under([[*middle, _HIGH_M]])
            return np.array([*middle, height[0]]), math.atan2(out[1], out[0])
    return None


def _on_road(points: F64, ground: Ground) -> NDArray[np.bool_]:
    on: NDArray[np.bool_] = ground.surfaces_under(np.column_stack([points, np.full(len(points), _HIGH_M)]))[1] >= 0
    return on


def clear_of(lots: StructuredArray, line_m: F64) -> StructuredArray:
    """Return the lots that a railroad along ``line_m`` (N, 2) does not cross."""
    if len(line_m) < 2:
        return lots
    middle = lots["front_m"] + 10.0 * np.column_stack([np.cos(lots["yaw_rad"]), np.sin(lots["yaw_rad"])])
    nearest = np.full(len(lots), np.inf)
    for begin, end in pairwise(line_m):
        ahead = end - begin
        share = np.clip(((middle - begin) @ ahead) / max(float(ahead @ ahead), 1e-9), 0.0, 1.0)
        nearest = np.minimum(nearest, np.hypot(*(middle - begin - share[:, None] * ahead).T))
    return lots[nearest > RAILROAD_CLEAR_M + LOT_WIDTH_M]
