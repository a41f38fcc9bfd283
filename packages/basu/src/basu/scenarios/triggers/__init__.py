"""Triggers of scenarios: places, progress along the route, motion, time and contact."""

from basu.scenarios.triggers.along_route import (
    ActorTimeToArrival,
    EgoArrives,
    EgoBeyond,
    EgoEntersJunction,
    EgoLeavesJunction,
    EgoPasses,
    PassesEgo,
    TimeToArrival,
    TimeToRest,
)
from basu.scenarios.triggers.motion import ClosesIn, EgoTouches, Elapsed, Faster, Slower, StandsStill, Trigger
from basu.scenarios.triggers.places import (
    Circle,
    CrossesLine,
    EgoNear,
    EgoOver,
    InRegion,
    Near,
    NearPlace,
    Polygon,
    Stretch,
)

__all__ = [
    "ActorTimeToArrival",
    "Circle",
    "ClosesIn",
    "CrossesLine",
    "EgoArrives",
    "EgoBeyond",
    "EgoEntersJunction",
    "EgoLeavesJunction",
    "EgoNear",
    "EgoOver",
    "EgoPasses",
    "EgoTouches",
    "Elapsed",
    "Faster",
    "InRegion",
    "Near",
    "NearPlace",
    "PassesEgo",
    "Polygon",
    "Slower",
    "StandsStill",
    "Stretch",
    "TimeToArrival",
    "TimeToRest",
    "Trigger",
]
