"""The door of a parked car opens into the ego's lane."""

from __future__ import annotations

from typing import TYPE_CHECKING

from basu.scenarios.criteria import Arrives, InTime, KeepsLane, NoCollision
from basu.scenarios.library.on_foot import ego_is_due
from basu.scenarios.library.pedalcyclist.car_door import HINGE_M, car_with_door, opens_and_shuts
from basu.scenarios.nhtsa import Group
from basu.scenarios.parameters import Number
from basu.scenarios.paths import parked_m
from basu.scenarios.scenario import Scenario

if TYPE_CHECKING:
    from collections.abc import Sequence

    from py_trees.behaviour import Behaviour

    from basu.scenarios.criteria import Criterion
    from basu.scenarios.stage import ActorSpec, Pose


class Dooring(Scenario):
    """Somebody in a parked car throws the door open before the ego, into its lane.

    The ego must leave room or stop until the door is shut again. It is the crash that takes cyclists, seen from one who
    comes along on four wheels: NHTSA's typology counts it with vehicles that leave a parked position (2007, scenario
    17) and, where a cyclist is hit, with pedalcyclists. The door is a sheet of its size, as in ``car_door``.
    """

    group = Group.PEDALCYCLIST
    parameters = (
        Number("ahead", 60.0, 40.0, 90.0, "m", "from the trigger point to the door's hinge"),
        Number("notice", 2.2, 1.4, 4.0, "s", "that the ego needs to the door when it opens"),
        Number("stays", 5.0, 3.0, 12.0, "s", "that it stays open"),
        Number("kerb", 0.0, -0.2, 0.3, "m", "that the car stands farther out into the street than the lane's middle"),
    )
    needs_m = 100.0
    aliases = ("VehicleOpensDoorTwoWays",)

    @property
    def _car(self) -> Pose:
        at_m = self.number("ahead") - HINGE_M
        return self.place.at(at_m, parked_m(self.place, at_m) - self.number("kerb"))

    def actors(self) -> Sequence[ActorSpec]:
        """The parked car and its door."""
        return car_with_door(self._car)

    def trigger(self) -> Behaviour:
        """The ego is near."""
        return ego_is_due(self.place, self.number("ahead") - 1.0, self.number("notice"), "the door")

    def conflict(self) -> Behaviour:
        """It opens, and shuts."""
        return opens_and_shuts(self._car, self.number("stays"))

    def criteria(self) -> Sequence[Criterion]:
        """Nothing is touched, the ego stays on the street, and goes on."""
        return [NoCollision(), KeepsLane(passing=True), Arrives(), InTime()]
