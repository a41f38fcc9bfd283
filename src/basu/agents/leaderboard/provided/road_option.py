"""What a driver is to do at a point of its plan; names and values of CARLA's ``agents.navigation.local_planner``."""

from __future__ import annotations

import enum


class RoadOption(enum.IntEnum):
    """A command of high level, as CARLA's planner numbers them."""

    VOID = -1
    LEFT = 1
    RIGHT = 2
    STRAIGHT = 3
    LANEFOLLOW = 4
    CHANGELANELEFT = 5
    CHANGELANERIGHT = 6
