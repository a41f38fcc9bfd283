"""The nine groups of NHTSA's pre-crash typology and what they cost: table 1.1 of the thesis.

Source: yearly averages of FARS and GES 2011-2015, crashes in which a light vehicle makes the critical action, as table
1.1 of the thesis prints them out of NHTSA's report of August 2019 [5]. Costs are in millions of dollars.
"""

from __future__ import annotations

import enum
from typing import NamedTuple


class Group(enum.Enum):
    """What kind of crash a scenario leads to; the last is the project's own."""

    CONTROL_LOSS = "control loss"
    ROAD_DEPARTURE = "road departure"
    ANIMAL = "animal"
    PEDESTRIAN = "pedestrian"
    PEDALCYCLIST = "pedalcyclist"
    LANE_CHANGE = "lane change"
    OPPOSITE_DIRECTION = "opposite direction"
    REAR_END = "rear-end"
    CROSSING_PATHS = "crossing paths"
    SHUTTLE = "shuttle"  # what a shuttle meets besides; not in NHTSA's typology, weighs nothing in its shares


class Toll(NamedTuple):
    """What the crashes of a group take in a year."""

    fatal_crashes: int
    crashes: int
    cost_musd: int
    equivalent_lives: int


TOLLS: dict[Group, Toll] = {
    Group.CONTROL_LOSS: Toll(4_456, 470_733, 77_507, 8_474),
    Group.ROAD_DEPARTURE: Toll(6_500, 547_098, 97_737, 10_686),
    Group.ANIMAL: Toll(102, 297_968, 6_231, 681),
    Group.PEDESTRIAN: Toll(3_731, 70_461, 47_342, 5_176),
    Group.PEDALCYCLIST: Toll(518, 47_927, 12_146, 1_328),
    Group.LANE_CHANGE: Toll(752, 644_099, 32_935, 3_601),
    Group.OPPOSITE_DIRECTION: Toll(3_258, 100_786, 48_255, 5_276),
    Group.REAR_END: Toll(1_245, 1_709_717, 106_515, 11_646),
    Group.CROSSING_PATHS: Toll(3_972, 1_131_273, 135_406, 14_805),
}
PRINTED_TOTAL = Toll(24_534, 5_020_062, 564_073, 61_674)  # as the table has it; sums differ by rounding
