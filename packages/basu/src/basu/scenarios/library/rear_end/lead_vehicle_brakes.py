"""Rear-end: the vehicle ahead brakes hard without a cause that could be seen."""

from __future__ import annotations

from typing import TYPE_CHECKING, ClassVar

from basu.scenarios.actions import Brake, DriveAlong, Hold, InTurn, Meanwhile
from basu.scenarios.criteria import Arrives, InTime, LeastDistance, NoCollision
from basu.scenarios.library.rear_end.follow_leading_vehicle import DAYLIGHT, LEADER, MODELS, NOTICED_M
from basu.scenarios.nhtsa import Group
from basu.scenarios.parameters import Choice, Number
from basu.scenarios.paths import Path
from basu.scenarios.scenario import Scenario
from basu.scenarios.stage import ActorSpec
from basu.scenarios.triggers import EgoArrives, EgoNear

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from py_trees.behaviour import Behaviour

    from basu.scenarios.criteria import Criterion
    from basu.scenarios.parameters import Parameter

BEYOND_M = 60.0  # that the leader drives on behind the end of the ego's route


class LeadVehicleBrakes(Scenario):
    """The vehicle ahead brakes hard to a stand, waits and drives on.

    NHTSA pre-crash scenario: lead vehicle decelerating. Fair: at the distance that two seconds make, an ego
    that brakes at 4 m/s² one second after the leader comes to stand behind it.
    """

    group = Group.REAR_END
    aliases: ClassVar[Sequence[str]] = ("HardBreakRoute",)
    parameters: ClassVar[Sequence[Parameter]] = (
        Choice("leader", tuple(MODELS), "the leader"),
        Number("ahead", 13.0, 9.0, 30.0, "m", "from the trigger point to the leader's middle at first"),
        Number("speed", 5.5, 3.0, 6.5, "m/s", "of the leader"),
        Number("after", 40.0, 15.0, 80.0, "m", "that the leader drives until it brakes"),
        Number("brake", 6.0, 2.0, 9.0, "m/s²", "of the leader"),
        Number("stands", 2.0, 0.0, 6.0, "s", "that the leader stands"),
    )
    weather: ClassVar[Mapping[str, float]] = DAYLIGHT
    partner_choice = ("leader", MODELS)
    timeout_s = 45.0
    needs_m = 80.0

    def actors(self) -> Sequence[ActorSpec]:
        """The leader, ahead in the lane."""
        return [ActorSpec(LEADER, MODELS[self.choice("leader")], self.place.at(self.number("ahead")))]

    def way(self) -> Path:
        """The leader's: the ego's route, and straight on behind its end."""
        begin_m = self.place.trigger_s_m + self.number("ahead")
        end = self.place.at(self.place.left_m)
        return Path.of_route(self.place.route, begin_m).then(Path.straight(end, BEYOND_M))

    def trigger(self) -> Behaviour:
        """The ego is behind it: at once in a case of its own, and where it comes by on a route."""
        return EgoNear(LEADER, self.number("ahead") + NOTICED_M)

    def conflict(self) -> Behaviour:
        """Drive, brake and stand."""
        way, speed_mps = self.way(), self.number("speed")
        return InTurn(
            DriveAlong(LEADER, way, speed_mps, to_m=self.number("after"), at_end="go on"),
            Brake(LEADER, at_mps2=self.number("brake"), path=way),
            Hold(LEADER, self.number("stands")),
            name="brakes hard",
        )

    def resolution(self) -> Behaviour:
        """The leader pulls away, to be out of the ego's way, and the ego arrives."""
        away = DriveAlong(LEADER, self.way(), self.number("speed"), at_end="vanish")
        return Meanwhile(EgoArrives(), away)

    def criteria(self) -> Sequence[Criterion]:
        """No contact; half a metre is the least that people leave between bumpers in a queue."""
        return [NoCollision(), LeastDistance(0.5, to=LEADER, while_moving=True), Arrives(), InTime()]
