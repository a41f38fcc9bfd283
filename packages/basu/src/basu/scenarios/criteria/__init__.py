"""By what a drive through a scenario is judged: functions of its record.

A scenario names them in ``criteria``::

    from basu.scenarios.criteria import Arrives, InTime, LeastDistance, NoCollision

    def criteria(self):
        return [NoCollision(), LeastDistance(0.5, to="child"), Arrives(), InTime()]

Each takes ``deciding=False`` to report without weighing. One of your own is a class with a ``name`` and a method
``judge`` (see `Criterion`). No collision, no near miss, least distance, time to collision and post-encroachment time
are judged of every case, whether its scenario names them or not.
"""

from basu.scenarios.criteria.comfort import Gentle
from basu.scenarios.criteria.contact import NoCollision
from basu.scenarios.criteria.criterion import Aspect, Criterion, Judgement, Played, StandingThing
from basu.scenarios.criteria.going import Arrives, InTime, Reaches, ReachesPoint
from basu.scenarios.criteria.lane import KeepsLane, Regains
from basu.scenarios.criteria.stopping import StoppedFor
from basu.scenarios.criteria.surrogate_measures import (
    KeepsHeadway,
    LeastDistance,
    LeastTtc,
    Pet,
    margins_of,
    reported_always,
)
from basu.scenarios.criteria.traffic_rules import HeedsRedLights, HeedsStopSigns, KeepsSpeed, MinimumSpeed
from basu.scenarios.criteria.yielding import YieldsToEmergencyVehicle

__all__ = [
    "Arrives",
    "Aspect",
    "Criterion",
    "Gentle",
    "HeedsRedLights",
    "HeedsStopSigns",
    "InTime",
    "Judgement",
    "KeepsHeadway",
    "KeepsLane",
    "KeepsSpeed",
    "LeastDistance",
    "LeastTtc",
    "MinimumSpeed",
    "NoCollision",
    "Pet",
    "Played",
    "Reaches",
    "ReachesPoint",
    "Regains",
    "StandingThing",
    "StoppedFor",
    "YieldsToEmergencyVehicle",
    "margins_of",
    "reported_always",
]
