"""A parked car pulls out: NHTSA's "parking, same direction"."""

from __future__ import annotations

from typing import TYPE_CHECKING, ClassVar

from basu.scenarios.actions import DriveAlong, InTurn
from basu.scenarios.criteria import Arrives, InTime, NoCollision
from basu.scenarios.library.road_users import BLUEPRINTS, EGO_HALF_LENGTH_M, HALF_LENGTH_M
from basu.scenarios.nhtsa import Group
from basu.scenarios.parameters import Choice, Number
from basu.scenarios.paths import Path
from basu.scenarios.scenario import Scenario
from basu.scenarios.stage import ActorSpec
from basu.scenarios.triggers import TimeToArrival

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from py_trees.behaviour import Behaviour

    from basu.scenarios.criteria import Criterion
    from basu.scenarios.parameters import Parameter

PARKED = "parked car"
AHEAD_M = 50.0  # of the trigger point, to its middle: a case is placed where the kerb is free there
KERB_M = 1.05  # from the lane's edge to the middle of a parking lane of 7 ft
CHANGE_M = 9.0  # along the street, to get out of the parking lane
DAWDLES_M = 15.0  # in the lane before it drives as others do
GETS_GOING_M = 12.0
STREET_MPS = 9.0  # 20 mph
LEAVES_M = 70.0


class ParkedCarPullsOut(Scenario):
    """A parked car pulls out from the kerb right in front of the ego.

    NHTSA pre-crash scenario 17, vehicles parking, same direction. Its driver has not looked back. It needs a moment to
    be in the lane and a few metres to get up to speed: a careful driver brakes moderately, a careless one drives into
    its side or its boot.
    """

    group = Group.LANE_CHANGE
    parameters: ClassVar[Sequence[Parameter]] = (
        Choice("kind", ("car", "van", "suv"), "the parked car"),
        Number("warning", 2.8, 2.0, 5.0, "s", "from when it sets off until the ego would be level with its tail"),
        Number("pace", 3.0, 1.5, 5.0, "m/s", "at which it pulls out and drives for the first metres"),
        Number("accelerate", 1.5, 0.8, 3.0, "m/s²", "with which it sets off"),
    )
    weather: ClassVar[Mapping[str, float]] = {"cloudiness": 15.0, "sun_altitude_angle": 30.0}
    timeout_s = 60.0
    needs_m = 100.0
    aliases: ClassVar[Sequence[str]] = ("ParkingCutIn",)

    @property
    def _right_m(self) -> float:
        return self.place.width_m(AHEAD_M) / 2.0 + KERB_M

    def actors(self) -> Sequence[ActorSpec]:
        """The car at the kerb."""
        return [ActorSpec(PARKED, BLUEPRINTS[self.choice("kind")], self.place.at(AHEAD_M, self._right_m))]

    def trigger(self) -> Behaviour:
        """The ego is about to be there."""
        ahead_m = AHEAD_M - HALF_LENGTH_M[self.choice("kind")] - EGO_HALF_LENGTH_M
        return TimeToArrival(self.place.trigger_s_m + ahead_m, self.number("warning"), "the parked car")

    def conflict(self) -> Behaviour:
        """It pulls out, dawdles, and drives on."""
        begin_m = self.place.trigger_s_m + AHEAD_M
        lane = Path.of_route(self.place.route, begin_m - 5.0, begin_m + LEAVES_M)
        path = lane.swerved(5.0, CHANGE_M, self._right_m, 0.0)
        pace_mps, slow_m = self.number("pace"), 5.0 + CHANGE_M + DAWDLES_M
        return InTurn(
            DriveAlong(
                PARKED,
                path,
                ((0.0, pace_mps), (slow_m, pace_mps), (slow_m + GETS_GOING_M, STREET_MPS)),
                accelerate_mps2=self.number("accelerate"),
                at_end="vanish",
            ),
            name="it pulls out",
        )

    def criteria(self) -> Sequence[Criterion]:
        """No contact, and the ego goes on."""
        return [NoCollision(), Arrives(), InTime()]
