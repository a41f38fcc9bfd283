"""Sides of two ways through a junction that are one boundary: where both run between the same ends, close together.

Autoware wants lanelets that touch to share their bound, those of opposite directions too (vm-01-03 and vm-01-04 of its
map requirements). In OpenDRIVE each way through a junction is a road of its own. Two ways side by side have almost the
same boundary. A left turn and the right turn back, for example, are drawn as different curves.
"""

from collections import defaultdict
from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from linden.maps.opendrive.evaluate.pieces import F64
from linden_maps.lanelet2.stretches import LaneletNetwork, Side
from linden_maps.polylines import resampled

NEAR_M = 0.5
"""Boundaries further apart than this are two; the shared one is their mean, so it lies within half of this of both."""
_PLACES = 129
_SAME_M = 1e-3


class Same(NamedTuple):
    """The side that another one became one with, and whether the two run in opposite directions."""

    number: int
    turned: bool


def one_line(
    network: LaneletNetwork, index: dict[Side, int], lines: list[F64], end_of: Callable[[int], int]
) -> dict[int, Same]:
    """Return which sides become one with an earlier one, by number, and move the lines of both to their mean.

    ``lines`` run in ascending s. ``end_of`` gives the joint of an end: 2 n for the start of the line n, 2 n + 1 for
    its end.
    """
    groups: dict[tuple[int, int], list[int]] = defaultdict(list)
    beside = _beside(network, index, end_of)
    for number in beside:
        first, last = sorted((end_of(2 * number), end_of(2 * number + 1)))
        if first != last:
            groups[first, last].append(number)
    same: dict[int, Same] = {}
    taken: set[int] = set()
    for members in groups.values():
        for at, number in enumerate(members):
            for other in members[at + 1 :]:
                if {number, other} & taken or beside[number] & beside[other]:
                    continue
                turned = end_of(2 * number) != end_of(2 * other)
                if _joined(lines, number, other, turned=turned):
                    same[other] = Same(number, turned)
                    taken |= {number, other}
    return same


def _beside(network: LaneletNetwork, index: dict[Side, int], end_of: Callable[[int], int]) -> dict[int, set[bool]]:
    """Return on which hands of each side of a way through a junction a lanelet lies: left (True) of it, or right.

    The side is seen from its lesser joint to its greater one, so that the hands of two sides can be compared.
    """
    hands: dict[int, set[bool]] = {}
    for stretch in network.stretches:
        for side in (stretch.left, stretch.right):
            number = index[side]
            if stretch.junction_id < 0 or side.family != "road":
                continue
            ascends = end_of(2 * number) < end_of(2 * number + 1)
            lies_left = side == stretch.right  # of its right side, seen along the traffic
            hands.setdefault(number, set()).add(lies_left == (ascends == stretch.forward))
    return hands


def _joined(lines: list[F64], number: int, other: int, *, turned: bool) -> bool:
    """Move two lines to their mean if they are near each other, and return whether they were."""
    first, second = (resampled(lines[each], _PLACES) for each in (number, other))
    second = second[::-1] if turned else second
    apart_m = np.linalg.norm(first - second, axis=1).max()
    if apart_m < _SAME_M or apart_m > NEAR_M:
        return bool(apart_m < _SAME_M)
    mean = (first + second) / 2.0
    mean[0], mean[-1] = lines[number][0], lines[number][-1]
    lines[number], lines[other] = mean, mean[::-1] if turned else mean
    return True
