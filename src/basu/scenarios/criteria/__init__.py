"""By what a drive through a scenario is judged: functions of its record.

A scenario names them in ``criteria``::

    from basu.scenarios.criteria import Arrives, InTime, LeastDistance, NoCollision

    def criteria(self):
        return [NoCollision(), LeastDistance(0.5, to="child"), Arrives(), InTime()]

Each takes ``deciding=False`` to tell without weighing. One of your own is a class with a ``name`` and a method
``judge`` (see `Criterion`).
"""

from basu.scenarios.criteria.contact import NoCollision
from basu.scenarios.criteria.criterion import Criterion, Judgement, Played, Thing
from basu.scenarios.criteria.going import Arrives, InTime, Reaches, ReachesPoint
from basu.scenarios.criteria.lane import KeepsLane
from basu.scenarios.criteria.margins.least_distance import LeastDistance

__all__ = [
    "Arrives",
    "Criterion",
    "InTime",
    "Judgement",
    "KeepsLane",
    "LeastDistance",
    "NoCollision",
    "Played",
    "Reaches",
    "ReachesPoint",
    "Thing",
]
