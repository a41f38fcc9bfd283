"""The wheels deviate a little from their commanded angle."""

from __future__ import annotations

from typing import TYPE_CHECKING

from basu.scenarios.actions import InTurn, PullSteering
from basu.scenarios.criteria import Arrives, Gentle, InTime, KeepsLane, NoCollision, Regains
from basu.scenarios.nhtsa import Group
from basu.scenarios.parameters import Choice, Number
from basu.scenarios.scenario import Scenario
from basu.scenarios.triggers import EgoPasses, Faster

if TYPE_CHECKING:
    from collections.abc import Sequence

    from py_trees.behaviour import Behaviour

    from basu.scenarios.criteria import Criterion

MOVING_MPS = 2.0
TOLERATED_M = 0.3  # beyond the lane's edge for the vehicle's middle: no driver needs more for so little


class SteeringDeviation(Scenario):
    """The steering strays a little for a moment, as on 20 February 2020, and nothing is ahead.

    On that day a shuttle in Linden stopped hard over such a deviation at 7.1 mph, and a passenger slid to the floor. A
    driver steers against it and goes on. An ego that stops hard for no reason fails, and so does one that drifts out of
    its lane. How large the deviation was is not known: see `docs/reference/passengers.md`.
    """

    group = Group.SHUTTLE
    parameters = (
        Number("ahead", 50.0, 20.0, 80.0, "m", "from the trigger point to where it begins"),
        Number("deviation", 0.03, 0.01, 0.1, "", "of full lock"),
        Number("lasts", 1.5, 0.5, 4.0, "s", "that it lasts"),
        Choice("side", ("right", "left"), "to which it pulls"),
    )
    needs_m = 110.0

    def trigger(self) -> Behaviour:
        """The ego drives along."""
        begins_m = self.place.trigger_s_m + self.number("ahead")
        return InTurn(EgoPasses(begins_m, "where its steering strays"), Faster(MOVING_MPS))

    def conflict(self) -> Behaviour:
        """It strays."""
        amount = self.number("deviation") * (1.0 if self.choice("side") == "right" else -1.0)
        return PullSteering(amount, self.number("lasts"))

    def criteria(self) -> Sequence[Criterion]:
        """No braking that throws passengers (1.5 m/s²), the lane is kept and found again, and the ego goes on."""
        return [Gentle(), KeepsLane(TOLERATED_M), Regains(), NoCollision(), Arrives(), InTime()]
