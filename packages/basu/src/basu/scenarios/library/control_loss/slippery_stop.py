"""Control loss with prior vehicle action: the ego brakes for a stop sign on a slippery road."""

from __future__ import annotations

from typing import TYPE_CHECKING, ClassVar

from basu.errors import ScenarioError
from basu.routing import ControlKind
from basu.scenarios.actions import InTurn, JitterControls, Meanwhile, SetFriction, Together
from basu.scenarios.criteria import Arrives, HeedsStopSigns, InTime, KeepsLane, NoCollision
from basu.scenarios.nhtsa import Group
from basu.scenarios.parameters import Choice, Number
from basu.scenarios.scenario import Scenario
from basu.scenarios.triggers import EgoPasses

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from py_trees.behaviour import Behaviour

    from basu.scenarios.criteria import Criterion
    from basu.scenarios.parameters import Parameter

PATCH_M = 3.0  # radius of a slippery place; they lie so far apart, too, so that they overlap
LONGEST_S = 40.0  # the steering is off for no longer than this, however slowly the ego comes to the line
ICY: dict[str, float] = {
    "cloudiness": 80.0,
    "precipitation": 20.0,
    "precipitation_deposits": 60.0,
    "wetness": 90.0,
    "sun_altitude_angle": 8.0,
}


class SlipperyStop(Scenario):
    """The road before a stop sign is slippery, and the steering is pulled aside while the ego brakes.

    From some metres before the line on the tyres have little friction, the steering is off to one side and jitters.
    The ego has to stand before the line, in its lane. NHTSA pre-crash scenario: control loss with prior vehicle
    action. Fair: a stop at 1 m/s² is possible on the least friction there is to choose, and the patch is longer than
    that takes from 15 mph.
    """

    group = Group.CONTROL_LOSS
    parameters: ClassVar[Sequence[Parameter]] = (
        Number("friction", 0.25, 0.15, 1.0, "", "of the tyres on the patch; a dry road has 1.1 for the shuttle"),
        Number("slippery", 27.0, 12.0, 40.0, "m", "of road before the line that are slippery"),
        Choice("side", ("right", "left"), "to which the steering is pulled"),
        Number("pull", 0.12, 0.0, 0.4, "", "share of the full steering by which it is off in the mean"),
        Number("jitter", 0.05, 0.0, 0.2, "", "standard deviation of the steering's noise, share of the full steering"),
    )
    weather: ClassVar[Mapping[str, float]] = ICY
    timeout_s = 50.0
    needs_m = 40.0

    @property
    def line_m(self) -> float:
        """The stop line, along the ego's route.

        Raises:
            ScenarioError: no stop sign is on the route behind the trigger point.
        """
        for control in self.place.route.controls:
            if control.kind is ControlKind.STOP_SIGN and control.s_m > self.place.trigger_s_m:
                return control.s_m
        raise ScenarioError("the ego's route passes no stop sign behind the trigger point; SlipperyStop needs one")

    @property
    def slippery_from_m(self) -> float:
        """Where the patch begins, along the ego's route."""
        return self.line_m - self.number("slippery")

    def setup(self) -> Behaviour:
        """The patch, as overlapping places along the lane."""
        begin_m, end_m = self.slippery_from_m, self.line_m
        count = 1 + round((end_m - begin_m) / PATCH_M)
        ahead_m = [begin_m + PATCH_M * (number + 0.5) - self.place.trigger_s_m for number in range(count)]
        friction = self.number("friction")
        return Together(*(SetFriction(self.place.at(m), PATCH_M, friction) for m in ahead_m), name="slippery road")

    def trigger(self) -> Behaviour:
        """The ego comes onto the slippery road."""
        return EgoPasses(self.slippery_from_m, "the beginning of the slippery road")

    def conflict(self) -> Behaviour:
        """Its steering is off until it is over the line."""
        sign = 1.0 if self.choice("side") == "right" else -1.0
        return InTurn(
            Meanwhile(
                EgoPasses(self.line_m, "the stop line"),
                JitterControls(LONGEST_S, steer=self.number("jitter"), throttle=0.0, pull=sign * self.number("pull")),
                name="braking with the steering off",
            )
        )

    def criteria(self) -> Sequence[Criterion]:
        """Stand before the line as the sign asks, with the middle in the lane throughout."""
        return [HeedsStopSigns(), KeepsLane(0.0), NoCollision(), Arrives(), InTime()]
