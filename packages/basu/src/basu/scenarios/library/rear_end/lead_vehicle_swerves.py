"""Rear-end: the vehicle ahead swerves round a car that stands in the lane and was hidden by it."""

from __future__ import annotations

from typing import TYPE_CHECKING, ClassVar

from basu.scenarios.actions import ChangeLane, DriveAlong, Either, InTurn
from basu.scenarios.criteria import InTime, LeastDistance, NoCollision
from basu.scenarios.library.rear_end.follow_leading_vehicle import DAYLIGHT, LEADER, NOTICED_M
from basu.scenarios.nhtsa import Group
from basu.scenarios.parameters import Number
from basu.scenarios.paths import Path, lanes_apart_m
from basu.scenarios.scenario import Scenario
from basu.scenarios.stage import ActorSpec
from basu.scenarios.triggers import EgoBeyond, EgoNear, StandsStill

if TYPE_CHECKING:
    from collections.abc import Collection, Mapping, Sequence

    from py_trees.behaviour import Behaviour

    from basu.scenarios.criteria import Criterion
    from basu.scenarios.parameters import Parameter

STANDING = "standing"
VAN = "vehicle.volkswagen.t2"  # too high to see over it
CAR = "vehicle.nissan.micra"
CLOSE_M = 30.0  # middle to middle, in which the ego stands; a driver that wants to swing out stays back
LENGTHS_M = 4.1  # of half a van and half a car: from middle to middle where they would touch
LEAST_M = 2.0  # that it drives before it swerves, were it placed ever so near
AWAY_M = 25.0  # that the leader drives on beside or behind the standing car


class LeadVehicleSwerves(Scenario):
    """The van ahead swerves at the last moment round a car that stands in the lane.

    A driver that looks no farther than the van sees the standing car when the van has left the lane, some metres before
    it. NHTSA pre-crash scenario: lead vehicle stopped, with vision obscured. Fair: from the distance of two seconds
    behind the van, a stop at 3 m/s² ends before the car.
    """

    group = Group.REAR_END
    parameters: ClassVar[Sequence[Parameter]] = (
        Number("ahead", 16.0, 9.0, 30.0, "m", "from the trigger point to the van's middle at first"),
        Number("speed", 7.0, 4.0, 9.0, "m/s", "of the van"),
        Number("stands_at", 65.0, 50.0, 85.0, "m", "from the trigger point to the standing car's middle"),
        Number("late", 12.0, 9.0, 25.0, "m", "between van and car, bumper to bumper, when the van begins to swerve"),
    )
    weather: ClassVar[Mapping[str, float]] = DAYLIGHT
    timeout_s = 45.0
    needs_m = 90.0

    def actors(self) -> Sequence[ActorSpec]:
        """The van, and the car that stands."""
        ahead = self.place.at(self.number("ahead"))
        return [ActorSpec(LEADER, VAN, ahead), ActorSpec(STANDING, CAR, self.place.at(self.number("stands_at")))]

    def trigger(self) -> Behaviour:
        """The ego is behind it: at once in a case of its own, and where it comes by on a route."""
        return EgoNear(LEADER, self.number("ahead") + NOTICED_M)

    def conflict(self) -> Behaviour:
        """Drive up to the car, swerve into the other lane, and on beside it."""
        place, speed_mps = self.place, self.number("speed")
        way = Path.of_route(place.route, place.trigger_s_m + self.number("ahead"))
        free_m = self.number("stands_at") - self.number("ahead") - LENGTHS_M  # between their bumpers at first
        late_m = min(self.number("late"), free_m - LEAST_M)
        to_m = free_m - late_m
        left_m = -lanes_apart_m(place, self.number("stands_at"))
        return InTurn(
            DriveAlong(LEADER, way, speed_mps, to_m=to_m, at_end="go on"),
            ChangeLane(LEADER, way, left_m, over_m=late_m, name=f"{LEADER} swerves"),
            DriveAlong(LEADER, way.beside(left_m), speed_mps, to_m=free_m + AWAY_M, at_end="vanish"),
            name="drives up to the standing car and swerves",
        )

    def resolution(self) -> Behaviour:
        """The ego stands behind the car, or has gone round it."""
        stands = InTurn(EgoNear(STANDING, CLOSE_M), StandsStill(1.0), name="stands behind it")
        return Either(stands, EgoBeyond(STANDING, 1.0), name="stands behind it or is past it")

    def partners(self) -> Collection[str]:
        """Both: the ego has to see the standing car, and to keep off the van."""
        return (LEADER, STANDING)

    def criteria(self) -> Sequence[Criterion]:
        """It stops behind the car or goes round it; nearer than 0.4 m, while it moves, would be luck."""
        return [NoCollision(), LeastDistance(0.4, to=STANDING, while_moving=True), InTime()]
