"""Scenario II of the thesis, without an obstacle: follow a leading vehicle to the next junction."""

from __future__ import annotations

from typing import TYPE_CHECKING, ClassVar

from basu.scenarios.actions import DriveAlong, InTurn
from basu.scenarios.criteria import InTime, LeastDistance, NoCollision
from basu.scenarios.nhtsa import Group
from basu.scenarios.parameters import Choice, Number
from basu.scenarios.paths import Path, next_junction
from basu.scenarios.scenario import Scenario
from basu.scenarios.stage import ActorSpec
from basu.scenarios.triggers import EgoNear, StandsStill

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from py_trees.behaviour import Behaviour

    from basu.scenarios.criteria import Criterion
    from basu.scenarios.parameters import Parameter

LEADER = "leader"
MODELS: dict[str, str] = {
    "car": "vehicle.nissan.micra",
    "motorcycle": "vehicle.kawasaki.ninja",
    "bicycle": "vehicle.gazelle.omafiets",
}
NOTICED_M = 2.0  # the leader sets off once the ego is no farther behind than it was placed, and this
HALF_LENGTH_M = {"car": 1.85, "motorcycle": 1.1, "bicycle": 0.9}
LINE_M = 0.5  # the leader's front stops so far before the line; before the junction where none is
CLOSE_M = 12.0  # middle to middle; behind a car that leaves 7 m between the bumpers
DAYLIGHT: dict[str, float] = {"cloudiness": 10.0, "sun_altitude_angle": 60.0}


class FollowLeadingVehicle(Scenario):
    """A slower vehicle ahead drives to the next junction and stops there.

    The ego follows a car, motorcycle or bicycle that keeps a constant speed and stops before the junction; it is over
    when the ego stands close behind. NHTSA pre-crash scenario: lead vehicle moving at lower constant speed. An ego
    that does not watch the leader drives into it.
    """

    group = Group.REAR_END
    parameters: ClassVar[Sequence[Parameter]] = (
        Choice("leader", tuple(MODELS), "the leader"),
        Number("ahead", 14.0, 9.0, 40.0, "m", "from the trigger point to the leader's middle at first"),
        Number("speed", 4.5, 2.0, 6.0, "m/s", "of the leader"),
        Number("brake", 2.0, 1.0, 6.0, "m/s²", "of the leader before the junction"),
    )
    weather: ClassVar[Mapping[str, float]] = DAYLIGHT
    partner_choice = ("leader", MODELS)
    timeout_s = 60.0
    needs_m = 40.0
    needs_junction = True

    def actors(self) -> Sequence[ActorSpec]:
        """The leader, ahead in the lane."""
        return [ActorSpec(LEADER, MODELS[self.choice("leader")], self.place.at(self.number("ahead")))]

    @property
    def stop_m(self) -> float:
        """Where the leader's middle comes to stand, ahead of the trigger point."""
        entered_m = next_junction(self.place, self.number("ahead")).from_m
        line_m = self.place.stop_line_m(before_m=entered_m)
        return (entered_m if line_m is None else line_m) - LINE_M - HALF_LENGTH_M[self.choice("leader")]

    def way(self) -> Path:
        """The leader's, from where it stands to the junction."""
        begin_m = self.place.trigger_s_m
        return Path.of_route(self.place.route, begin_m + self.number("ahead"), begin_m + self.stop_m)

    def trigger(self) -> Behaviour:
        """The ego is behind it: at once in a case of its own, and where it comes by on a route."""
        return EgoNear(LEADER, self.number("ahead") + NOTICED_M)

    def conflict(self) -> Behaviour:
        """The leader drives to the junction."""
        return DriveAlong(LEADER, self.way(), self.number("speed"), brake_mps2=self.number("brake"))

    def resolution(self) -> Behaviour:
        """The ego comes to stand close behind."""
        return InTurn(EgoNear(LEADER, CLOSE_M), StandsStill(1.0), name="closes up and stands")

    def criteria(self) -> Sequence[Criterion]:
        """No contact, and the ego keeps up.

        Half a metre is what people leave between bumpers in a queue at the least; nearer than that is luck.
        """
        return [NoCollision(), LeastDistance(0.5, to=LEADER, while_moving=True), InTime()]
