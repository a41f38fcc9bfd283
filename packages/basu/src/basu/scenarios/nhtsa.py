"""NHTSA's pre-crash typology: nine groups with their yearly burden, and the 37 scenarios with their frequencies.

Table 1.1 of the thesis has yearly averages of FARS and GES 2011-2015 out of DOT HS 812 745 (Swanson and others, August
2019). Costs are in millions of dollars. A group's burden is the four columns by which groups weigh. They are fatal and
all crashes in which a light vehicle makes the critical action, their cost, and equivalent lives.

Frequencies: DOT HS 810 767 (Najm, Smith and Yanagisawa, Pre-Crash Scenario Typology for Crash Avoidance Research, April
2007), table 13: police-reported crashes of 2004 with a light vehicle, GES, in thousands. The figures are taken from a
public transcription of that table; its percentages are parts of 5,942,000 crashes, to which the counts add up with
"other". The scenarios stand in the nine groups of DOT HS 812 745; those outside the nine groups have none.
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
    SHUTTLE = "shuttle"  # what a shuttle meets besides; outside the nine groups, weighs nothing in their shares


class Burden(NamedTuple):
    """What the crashes of a group take in a year."""

    fatal_crashes: int
    crashes: int
    cost_musd: int
    equivalent_lives: int


class YearlyStatistics(NamedTuple):
    """The nine columns of table 1.1, as yearly averages of crashes in which a light vehicle takes part."""

    involved_fatal_crashes: int  # with a light vehicle in the critical event
    involved_crashes: int
    fatal_crashes: int  # from here on a light vehicle makes the critical action
    crashes: int
    fatal_per_1e9_miles: float  # crashes for 10^9 miles of light vehicles
    per_1e9_miles: int
    cost_musd: int
    equivalent_lives: int
    fatal_per_thousand: float  # fatal crashes for a thousand crashes

    @property
    def burden(self) -> Burden:
        """Return the four columns by which groups weigh."""
        return Burden(self.fatal_crashes, self.crashes, self.cost_musd, self.equivalent_lives)


TABLE_1_1: dict[Group, YearlyStatistics] = {
    Group.CONTROL_LOSS: YearlyStatistics(4_529, 473_392, 4_456, 470_733, 1.6, 174, 77_507, 8_474, 9.5),
    Group.ROAD_DEPARTURE: YearlyStatistics(6_536, 562_564, 6_500, 547_098, 2.4, 202, 97_737, 10_686, 11.9),
    Group.ANIMAL: YearlyStatistics(103, 298_106, 102, 297_968, 0.0, 110, 6_231, 681, 0.3),
    Group.PEDESTRIAN: YearlyStatistics(3_732, 70_525, 3_731, 70_461, 1.4, 26, 47_342, 5_176, 53.0),
    Group.PEDALCYCLIST: YearlyStatistics(518, 47_927, 518, 47_927, 0.2, 18, 12_146, 1_328, 10.8),
    Group.LANE_CHANGE: YearlyStatistics(875, 697_888, 752, 644_099, 0.3, 238, 32_935, 3_601, 1.2),
    Group.OPPOSITE_DIRECTION: YearlyStatistics(3_288, 100_993, 3_258, 100_786, 1.2, 37, 48_255, 5_276, 32.3),
    Group.REAR_END: YearlyStatistics(1_623, 1_756_327, 1_245, 1_709_717, 0.5, 632, 106_515, 11_646, 0.7),
    Group.CROSSING_PATHS: YearlyStatistics(4_086, 1_152_112, 3_972, 1_131_273, 1.5, 418, 135_406, 14_805, 3.5),
}
# As the table prints its sums; they differ from the sums of the rows by rounding.
PRINTED_SUMS = YearlyStatistics(25_289, 5_159_833, 24_534, 5_020_062, 9.1, 1_855, 564_073, 61_674, 4.9)
BURDENS = {group: row.burden for group, row in TABLE_1_1.items()}


class PreCrash(NamedTuple):
    """One of the 37 pre-crash scenarios."""

    number: int  # in the order of DOT HS 810 767
    name: str
    group: Group | None
    thousands: int  # of crashes in a year


_ROWS: dict[Group | None, tuple[tuple[int, str, int], ...]] = {
    Group.CONTROL_LOSS: (
        (2, "control loss with prior vehicle action", 103),
        (3, "control loss without prior vehicle action", 529),
    ),
    Group.ROAD_DEPARTURE: (
        (6, "road edge departure with prior vehicle maneuver", 68),
        (7, "road edge departure without prior vehicle maneuver", 334),
        (8, "road edge departure while backing up", 66),
    ),
    Group.ANIMAL: (
        (9, "animal crash with prior vehicle maneuver", 23),
        (10, "animal crash without prior vehicle maneuver", 305),
    ),
    Group.PEDESTRIAN: (
        (11, "pedestrian crash with prior vehicle maneuver", 17),
        (12, "pedestrian crash without prior vehicle maneuver", 39),
    ),
    Group.PEDALCYCLIST: (
        (13, "pedalcyclist crash with prior vehicle maneuver", 18),
        (14, "pedalcyclist crash without prior vehicle maneuver", 24),
    ),
    Group.LANE_CHANGE: (
        (16, "vehicle turning, same direction", 222),
        (17, "vehicle parking, same direction", 48),
        (18, "vehicle changing lanes, same direction", 338),
        (19, "vehicle drifting, same direction", 98),
    ),
    Group.OPPOSITE_DIRECTION: (
        (20, "vehicle making a maneuver, opposite direction", 15),
        (21, "vehicle not making a maneuver, opposite direction", 124),
    ),
    Group.REAR_END: (
        (22, "following vehicle making a maneuver", 85),
        (23, "lead vehicle accelerating", 19),
        (24, "lead vehicle moving at lower constant speed", 210),
        (25, "lead vehicle decelerating", 428),
        (26, "lead vehicle stopped", 975),
    ),
    Group.CROSSING_PATHS: (
        (4, "running red light", 254),
        (5, "running stop sign", 48),
        (27, "left turn across path from opposite directions at signalized junctions", 220),
        (28, "vehicle turning right at signalized junctions", 35),
        (29, "left turn across path from opposite directions at non-signalized junctions", 190),
        (30, "straight crossing paths at non-signalized junctions", 264),
        (31, "vehicle turning at non-signalized junctions", 435),
    ),
    None: (
        (1, "vehicle failure", 42),
        (15, "backing up into another vehicle", 131),
        (32, "evasive action with prior vehicle maneuver", 13),
        (33, "evasive action without prior vehicle maneuver", 56),
        (34, "non-collision incident", 46),
        (35, "object crash with prior vehicle maneuver", 30),
        (36, "object crash without prior vehicle maneuver", 55),
    ),
}
PRE_CRASH = {
    number: PreCrash(number, name, group, count) for group, rows in _ROWS.items() for number, name, count in rows
}
OTHER_THOUSANDS = 35  # scenario 37, 0.6 % of the crashes

# The scenarios of NHTSA that each of BASU's stands for, by its class. A user's class names its own in `pre_crash`.
STANDS_FOR: dict[str, tuple[int, ...]] = {
    "ControlLoss": (3,),
    "SlipperyStop": (2,),
    "BendDeparture": (7,),
    "CrossWind": (6, 7),
    "DeerAtDusk": (10,),
    "DogOnTheRoad": (9, 10),
    "OccludedChild": (12,),
    "PedestrianCrossing": (12,),
    "PedestrianTurn": (11,),
    "PedestrianTurnsBack": (12,),
    "CyclistAhead": (14,),
    "CyclistAtRightTurn": (13,),
    "CyclistCrossing": (14,),
    "CyclistSwerves": (14,),
    "Dooring": (14,),
    "DynamicObject": (14,),
    "CutInAtTtc": (18,),
    "CutInBeforeStop": (18,),
    "DriftingNeighbour": (19,),
    "ParkedCarPullsOut": (17,),
    "RightHook": (16,),
    "NarrowedStreet": (20,),
    "OncomingOvertaker": (20,),
    "StrayingOncoming": (21,),
    "FollowLeadingVehicle": (24, 26),
    "FollowLeadingVehicleWithObstacle": (25,),
    "LeadVehicleBrakes": (22, 25),
    "LeadVehicleSwerves": (26,),
    "StaticObject": (26,),
    "StopAndGo": (23, 25),
    "CarAcrossJunction": (30,),
    "EgoTurnsLeft": (27, 29),
    "LeftTurnAcrossPath": (27, 29),
    "RedLightRunner": (4,),
    "RightTurnIntoPath": (28, 31),
    "Roundabout": (31,),
    "StopSignRunner": (5,),
    "StraightCrossingPaths": (30,),
    "TurnIntoTraffic": (31,),
    "UnsignalizedIntersection": (30,),
}


def stands_for(scenario: str, group: Group, declared: tuple[int, ...] = ()) -> tuple[PreCrash, ...]:
    """The pre-crash scenarios of ``group`` that a scenario stands for; none where none is known."""
    numbers = declared or STANDS_FOR.get(scenario, ())
    return tuple(PRE_CRASH[number] for number in numbers if PRE_CRASH[number].group is group)
