"""A driver behind the shuttle overtakes it as it leaves its stop."""

from __future__ import annotations

from functools import cached_property
from typing import TYPE_CHECKING

from basu.scenarios.actions import Brake, ChangeLane, DriveAlong, FollowerLimits, InTurn, Meanwhile, Wait
from basu.scenarios.criteria import Arrives, InTime, LeastDistance, NoCollision
from basu.scenarios.nhtsa import Group
from basu.scenarios.parameters import Number
from basu.scenarios.paths import Path, lanes_apart_m
from basu.scenarios.scenario import Scenario
from basu.scenarios.stage import ActorSpec
from basu.scenarios.triggers import Faster, PassesEgo

if TYPE_CHECKING:
    from collections.abc import Sequence

    from py_trees.behaviour import Behaviour

    from basu.scenarios.criteria import Criterion

CAR, HALF_LENGTH_M = "vehicle.lincoln.mkz_2020", 2.45
EGO_HALF_LENGTH_M = 2.0
OUT_M, IN_M = 10.0, 12.0  # on which it gets out of the lane, and back in
HURRY = FollowerLimits(accelerate_mps2=4.0, brake_mps2=4.0)
SLOW_S = 4.0  # that it crawls


class LeavingStop(Scenario):
    """An impatient driver behind the shuttle overtakes as it leaves its stop, cuts in, and brakes.

    The ego stands at a service stop, a car behind it. When it moves off, the car pulls out, comes back into the lane
    ``gap`` before the ego's bumper and slows down for what is ahead. The ego must let it in. The clear one of the
    shuttle's own. It is the leaderboard's ParkingExit where a stop lies in the lane, as all of Linden's do.
    """

    group = Group.SHUTTLE
    parameters = (
        Number("behind", 8.0, 6.0, 12.0, "m", "from the ego's bumper to the car's at the stop"),
        Number("speed", 10.0, 8.0, 11.0, "m/s", "at which it overtakes"),
        Number("gap", 3.0, 1.5, 8.0, "m", "before the ego's bumper at which it begins to cut in"),
        Number("slow", 2.5, 1.0, 5.0, "m/s", "to which it brakes in the lane"),
    )
    needs_m = 90.0

    @cached_property
    def _lane(self) -> Path:
        """The ego's lane, from behind the car on."""
        back_m = self._back_m + 2.0
        ahead_m = [-back_m + 2.0 * n for n in range(int((back_m + self.place.left_m + 60.0) / 2.0))]
        return Path.through([self.place.at(metres)[:3] for metres in ahead_m])

    @property
    def _back_m(self) -> float:
        return EGO_HALF_LENGTH_M + self.number("behind") + HALF_LENGTH_M

    def actors(self) -> Sequence[ActorSpec]:
        """The car behind the ego."""
        return [ActorSpec("car", CAR, self.place.at(-self._back_m))]

    def trigger(self) -> Behaviour:
        """The ego moves off."""
        return Faster(0.3)

    def conflict(self) -> Behaviour:
        """Out, past the ego, in, slow, and on."""
        lane, speed_mps, slow_mps = self._lane, self.number("speed"), self.number("slow")
        apart_m = lanes_apart_m(self.place, 10.0)
        return InTurn(
            ChangeLane("car", lane, -apart_m, over_m=OUT_M, speed_mps=speed_mps, limits=HURRY, name="car pulls out"),
            Meanwhile(
                PassesEgo("car", self.number("gap")),
                DriveAlong("car", lane.beside(-apart_m), speed_mps, accelerate_mps2=HURRY.accelerate_mps2),
                name="car overtakes",
            ),
            ChangeLane("car", lane, over_m=IN_M, speed_mps=speed_mps, limits=HURRY, name="car cuts in"),
            Brake("car", slow_mps, HURRY.brake_mps2, lane),
            Meanwhile(Wait(SLOW_S), DriveAlong("car", lane, slow_mps, at_end="go on"), name="car crawls"),
            DriveAlong("car", lane, speed_mps, at_end="vanish"),
        )

    def criteria(self) -> Sequence[Criterion]:
        """It is not touched or nearly so, and the ego goes on."""
        return [NoCollision(), LeastDistance(0.5, to="car", while_moving=True), Arrives(), InTime()]
