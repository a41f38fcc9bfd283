"""Scenario II of the thesis, with an obstacle: an actor crosses before the vehicle ahead."""

from __future__ import annotations

from typing import TYPE_CHECKING, ClassVar

from basu.scenarios.actions import Brake, DriveAlong, InTurn, Together, WalkAlong
from basu.scenarios.library.rear_end.follow_leading_vehicle import LEADER, FollowLeadingVehicle
from basu.scenarios.library.road_users import animal
from basu.scenarios.parameters import Choice, Number
from basu.scenarios.paths import Path
from basu.scenarios.stage import ActorSpec

if TYPE_CHECKING:
    from collections.abc import Sequence

    from py_trees.behaviour import Behaviour

    from basu.scenarios.parameters import Parameter

CROSSER = "crosser"
PEOPLE = {
    "child": "walker.pedestrian.0009",
    "adult": "walker.pedestrian.0001",
}
KERB_M = 4.5  # from the middle of the lane to where it waits, on the pavement or between parked cars
ACROSS_M = 9.0  # that it walks, to beyond the other lane
LEAST_M = 2.0  # that the leader drives before it brakes
LOOK_M = 7.0  # from the leader's middle to the crossing actor, when it brakes


class FollowLeadingVehicleWithObstacle(FollowLeadingVehicle):
    """The vehicle ahead brakes hard for a crossing actor, then drives on to the next junction.

    As FollowLeadingVehicle, and a child, an adult or a dog crosses before the leader, which stands until the way is
    free. NHTSA pre-crash scenario: lead vehicle decelerating. Fair: the leader brakes no harder than a careful
    follower at two seconds' distance can answer with 3 m/s².
    """

    parameters: ClassVar[Sequence[Parameter]] = (
        *(p for p in FollowLeadingVehicle.parameters if p.name != "brake"),
        Choice("crosser", ("dog", *PEOPLE), "the actor that crosses before the leader"),
        Number("after", 25.0, 10.0, 60.0, "m", "that the leader drives until it brakes"),
        Number("brake", 5.0, 2.0, 8.0, "m/s²", "of the leader for the crossing actor"),
        Number("pace", 1.4, 0.8, 3.0, "m/s", "of the crossing actor"),
    )

    def actors(self) -> Sequence[ActorSpec]:
        """The leader, and on the right the crossing actor."""
        stands = self.place.at(self.cross_m, KERB_M, -90.0)
        kind = self.choice("crosser")
        crosser = ActorSpec(CROSSER, PEOPLE[kind], stands) if kind in PEOPLE else animal(CROSSER, kind, stands)
        return [*super().actors(), crosser]

    @property
    def brakes_m(self) -> float:
        """Where the leader's middle is when it brakes, ahead of the trigger point: never too near to the junction."""
        latest_m = self.stop_m - self.braking_m - LOOK_M
        return max(self.number("ahead") + LEAST_M, min(self.number("ahead") + self.number("after"), latest_m))

    @property
    def braking_m(self) -> float:
        """What the leader needs to stand."""
        return self.number("speed") ** 2 / (2.0 * self.number("brake"))

    @property
    def cross_m(self) -> float:
        """Where the other crosses: beyond where the leader stops."""
        return self.brakes_m + self.braking_m + LOOK_M

    def conflict(self) -> Behaviour:
        """Drive, brake for the crossing actor, wait until it has crossed, drive on."""
        way = self.way()
        start = self.place.at(self.cross_m, KERB_M, -90.0)
        return InTurn(
            DriveAlong(LEADER, way, self.number("speed"), to_m=self.brakes_m - self.number("ahead"), at_end="go on"),
            Together(
                Brake(LEADER, at_mps2=self.number("brake"), path=way),
                WalkAlong(CROSSER, Path.straight(start, ACROSS_M), self.number("pace")),
                name="the leader lets an actor cross",
            ),
            DriveAlong(LEADER, way, self.number("speed"), brake_mps2=2.0),
        )
