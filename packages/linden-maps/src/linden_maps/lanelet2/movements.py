"""Ways through junctions: where they turn, which of them meet, and which of two goes first."""

import math
from collections import defaultdict
from itertools import combinations
from typing import NamedTuple

import numpy as np

from linden.maps.opendrive.evaluate.pieces import F64
from linden.maps.opendrive.evaluate.tables import Tables
from linden.maps.opendrive.model import Junction
from linden_maps.lanelet2.stretches import ROAD, LaneletNetwork

STRAIGHT_RAD = math.radians(30.0)
"""A way that turns less than this goes straight on."""
_SPACING_M = 1.0
_MARGIN_M = 0.4
"""Ways meet where their lanes reach into each other by more than this."""
_LAYER_M = 3.0
_INSIDE_M = 1e-3
"""From a lane's ends, where the records of its neighbour may begin."""
_AHEAD_M = 3.0
_CROSSING_RAD = math.radians(45.0)
FREE, YIELD, STOP, LIGHT = "free", "yield", "stop", "light"
_RANK = {FREE: 2, LIGHT: 2, YIELD: 1, STOP: 0}


class Movement(NamedTuple):
    """A lanelet through a junction; ``line`` (N, 3) runs along its middle in its direction of travel."""

    stretch: int
    road_id: int
    line: F64
    width_m: float
    heading_rad: float  # at its start
    turn_rad: float  # to the left
    origins: frozenset[int]  # stretches it comes from
    right_hand: bool

    @property
    def direction(self) -> str:
        """Autoware's turn_direction; to turn back is to turn left."""
        if abs(self.turn_rad) <= STRAIGHT_RAD:
            return "straight"
        return "left" if self.turn_rad > 0.0 else "right"


def movements_of(tables: Tables, network: LaneletNetwork) -> dict[int, list[Movement]]:
    """Return the ways through each junction."""
    found = [n for n, stretch in enumerate(network.stretches) if stretch.junction_id >= 0 and stretch.subtype == ROAD]
    origins: dict[int, set[int]] = defaultdict(set)
    for number, after in enumerate(network.successors):
        for following in after:
            origins[following].add(number)
    junctions: dict[int, list[Movement]] = defaultdict(list)
    for number, (line, width_m, heading) in zip(found, _middles(tables, network, found), strict=True):
        stretch = network.stretches[number]
        road = tables.roads[stretch.road]
        junctions[stretch.junction_id].append(
            Movement(
                stretch=number,
                road_id=road.id,
                line=line,
                width_m=width_m,
                heading_rad=float(heading[0]),
                turn_rad=float(np.sum(np.mod(np.diff(heading) + np.pi, 2.0 * np.pi) - np.pi)),
                origins=frozenset(origins[number]),
                right_hand=road.is_right_hand,
            )
        )
    return dict(junctions)


def _middles(tables: Tables, network: LaneletNetwork, numbers: list[int]) -> list[tuple[F64, float, F64]]:
    """Return the middle line, mean width and headings of stretches in their direction of travel."""
    rows, places, counts = [], [], []
    for number in numbers:
        count = 0
        for piece in network.stretches[number].pieces:
            steps = max(2, math.ceil((piece.end_m - piece.start_m) / _SPACING_M) + 1)
            rows.append(np.full(steps, piece.row))
            places.append(np.linspace(piece.start_m + _INSIDE_M, piece.end_m - _INSIDE_M, steps))
            count += steps
        counts.append(count)
    if not numbers:
        return []
    centres = tables.lane_centres(np.concatenate(rows), np.concatenate(places))
    points = np.stack([centres.x_m, centres.y_m, centres.z_m], axis=1)
    cuts = np.cumsum(counts)[:-1]
    found = []
    columns = (np.split(values, cuts) for values in (points, centres.width_m, centres.heading_rad))
    for number, line, width, heading in zip(numbers, *columns, strict=True):
        if network.stretches[number].forward:
            found.append((line, float(width.mean()), heading))
        else:
            found.append((line[::-1], float(width.mean()), heading[::-1] + np.pi))
    return found


def yields(
    junction: Junction | None,
    movements: list[Movement],
    controls: dict[int, str],
    phases: dict[int, frozenset[str]],
) -> dict[int, list[int]]:
    """Return for each way (stretch) the ways that yield to it.

    ``controls`` name the sign or light before each way, ``phases`` the controllers of its lights.
    """
    priorities = set(junction.priorities) if junction else set()
    roundabout = junction is not None and "roundabout" in dict(junction.user_data)
    found: dict[int, list[int]] = defaultdict(list)
    for one, other in combinations(movements, 2):
        gaps = None if one.origins & other.origins else _gaps(one, other)
        if gaps is None:
            continue
        phase, theirs = (phases.get(way.stretch, frozenset()) for way in (one, other))
        if phase and theirs and phase.isdisjoint(theirs):
            first = second = True  # a light holds the one while the other goes
        else:
            first, second = _goes_first(one, other, gaps, priorities, controls, roundabout=roundabout)
        if first:
            found[one.stretch].append(other.stretch)
        if second:
            found[other.stretch].append(one.stretch)
    return dict(found)


def _gaps(one: Movement, other: Movement) -> F64 | None:
    """Return how far the lanes' edges lie apart, each place with each; None where they do not meet."""
    away = one.line[:, None, :] - other.line[None, :, :]
    gap: F64 = np.hypot(away[..., 0], away[..., 1]) - 0.5 * (one.width_m + other.width_m) + _MARGIN_M
    gap[np.abs(away[..., 2]) > _LAYER_M] = np.inf
    return gap if gap.min() < 0.0 else None


def _goes_first(
    one: Movement,
    other: Movement,
    gaps: F64,
    priorities: set[tuple[int, int]],
    controls: dict[int, str],
    *,
    roundabout: bool,
) -> tuple[bool, bool]:
    """Return whether the one goes before the other, and the other before the one; lights may let both."""
    stated = ((one.road_id, other.road_id) in priorities, (other.road_id, one.road_id) in priorities)
    if any(stated):
        return stated
    if roundabout:
        return _circulates(gaps), _circulates(gaps.T)
    mine, theirs = (controls.get(way.stretch, FREE) for way in (one, other))
    if _RANK[mine] != _RANK[theirs]:
        return _RANK[mine] > _RANK[theirs], _RANK[mine] < _RANK[theirs]
    return _by_rule(one, other, both_lights=mine == theirs == LIGHT)


def _by_rule(one: Movement, other: Movement, *, both_lights: bool) -> tuple[bool, bool]:
    """Return which of two goes first where the same stands before both.

    Oncoming traffic goes before traffic that turns across it; else traffic from the right goes first (Ohio Revised Code
    4511.41 and 4511.42), from the left where traffic keeps left. Lights hold one of two that cross.
    """
    angle = math.remainder(one.heading_rad - other.heading_rad, math.tau)
    if abs(angle) > math.pi - _CROSSING_RAD:
        near, far = ("left", "right") if one.right_hand else ("right", "left")
        ranks = [{"straight": 1, far: 1, near: 0}[way.direction] for way in (one, other)]
        return ranks[0] > ranks[1], ranks[0] < ranks[1]
    if abs(angle) < _CROSSING_RAD:
        return False, False
    if both_lights:
        return True, True
    from_right = angle > 0.0 if one.right_hand else angle < 0.0
    return from_right, not from_right


def _circulates(gaps: F64) -> bool:
    """Return whether the first (rows) is on its way round already where the second (columns) enters its way."""
    entry = int(np.argmax((gaps < 0.0).any(axis=0)))
    at = int(np.argmax(gaps[:, entry] < 0.0))
    return at * _SPACING_M > entry * _SPACING_M + _AHEAD_M
