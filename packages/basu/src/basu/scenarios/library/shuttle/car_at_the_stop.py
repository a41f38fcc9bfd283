"""A car stands where the shuttle is to stop."""

from __future__ import annotations

from typing import TYPE_CHECKING

from basu.scenarios.actions import DriveAlong, Either, InTurn, Wait
from basu.scenarios.criteria import Arrives, InTime, NoCollision, StoppedFor
from basu.scenarios.nhtsa import Group
from basu.scenarios.parameters import Number
from basu.scenarios.paths import Path
from basu.scenarios.scenario import Scenario
from basu.scenarios.stage import ActorSpec
from basu.scenarios.triggers import EgoNear, StandsStill

if TYPE_CHECKING:
    from collections.abc import Sequence

    from py_trees.behaviour import Behaviour

    from basu.scenarios.criteria import Criterion

CAR = "vehicle.nissan.micra"
EGO_FRONT_M = 2.0
NEAR_M = 25.0
WITHIN_M = 12.0  # before the stop's place: behind the car that stands there passengers can still get on and off
STANDS_S = 3.0  # the least that counts as having stopped for passengers
LEAVES_MPS = 7.0


class CarAtTheStop(Scenario):
    """A car stands at the service stop, in the lane, and its driver comes back after a while.

    The ego must stop behind or beside it for its passengers, touch nothing, and not stay for ever: when the car leaves,
    it serves the stop and goes on. The case gives the stop; on a route it is the next one behind the trigger point.
    """

    group = Group.SHUTTLE
    parameters = (
        Number("ahead", 45.0, 25.0, 90.0, "m", "from the trigger point to the car, where no stop lies on the way"),
        Number("right", 0.3, -0.3, 1.5, "m", "of the lane's middle, where the car stands"),
        Number("waits", 5.0, 0.0, 15.0, "s", "that it stands on when the ego stands"),
    )
    needs_m = 90.0
    timeout_s = 90.0

    @property
    def _stop_m(self) -> float:
        """The stop, ahead of the trigger point."""
        trigger_m = self.place.trigger_s_m
        ahead_m = [stop.s_m - trigger_m for stop in self.place.route.stops if stop.s_m > trigger_m + 5.0]
        return min(ahead_m, default=self.number("ahead"))

    def actors(self) -> Sequence[ActorSpec]:
        """The car at the stop."""
        return [ActorSpec("car", CAR, self.place.at(self._stop_m, self.number("right")))]

    def trigger(self) -> Behaviour:
        """The ego comes near."""
        return EgoNear("car", NEAR_M)

    def conflict(self) -> Behaviour:
        """It stands, until the ego has stood behind it, or for ten seconds; then it leaves."""
        way = Path.of_route(self.place.route, self.place.trigger_s_m + self._stop_m)
        return InTurn(
            Either(StandsStill(2.0), Wait(10.0)),
            Wait(self.number("waits")),
            DriveAlong("car", way, LEAVES_MPS, at_end="vanish"),
        )

    def criteria(self) -> Sequence[Criterion]:
        """Nothing is touched, passengers could get on and off, and the ego goes on."""
        stop_s_m = self.place.trigger_s_m + self._stop_m + EGO_FRONT_M
        stopped = StoppedFor("the service stop", s_m=stop_s_m, within_m=WITHIN_M, stand_s=STANDS_S)
        return [NoCollision(), stopped, Arrives(), InTime()]
