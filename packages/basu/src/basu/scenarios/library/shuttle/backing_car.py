"""A car backs out of a driveway: NHTSA's "backing up into another vehicle", with the ego as the other vehicle."""

from __future__ import annotations

from typing import TYPE_CHECKING, ClassVar

from basu.scenarios.actions import BackUp, DriveAlong, Hold, InTurn
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

CAR = "backing car"
AHEAD_M = 50.0  # of the trigger point, to its middle: a case is placed where nothing stands beside the lane
CLEAR_M = 1.2  # from the lane's edge to its tail, before it sets off
HALF_WIDTH_M = 1.0


class BackingCar(Scenario):
    """A car backs out of a driveway on the right into the ego's lane, stops, and pulls in again.

    NHTSA pre-crash scenario 15, backing up into another vehicle, seen from the other vehicle: the shuttle itself never
    backs up. The driver of the car notices the ego late. A careful ego brakes and waits, a careless one drives into
    its tail.
    """

    group = Group.SHUTTLE
    parameters: ClassVar[Sequence[Parameter]] = (
        Choice("kind", ("car", "van", "suv"), "the backing vehicle"),
        Number("warning", 4.0, 3.0, 6.0, "s", "from when it sets off until the ego would be level with its flank"),
        Number("pace", 1.8, 1.0, 2.5, "m/s", "at which it backs up"),
        Number("into", 1.8, 1.2, 2.5, "m", "of the ego's lane that it takes"),
        Number("stands", 3.0, 1.0, 6.0, "s", "for which it stands in the lane"),
    )
    weather: ClassVar[Mapping[str, float]] = {"cloudiness": 15.0, "sun_altitude_angle": 30.0}
    timeout_s = 60.0
    needs_m = 95.0

    @property
    def _clear_m(self) -> float:
        """To the right of the ego's lane, of the car's middle in its driveway."""
        return self.place.width_m(AHEAD_M) / 2.0 + CLEAR_M + HALF_LENGTH_M[self.choice("kind")]

    def actors(self) -> Sequence[ActorSpec]:
        """The car in its driveway, with its tail to the street."""
        return [ActorSpec(CAR, BLUEPRINTS[self.choice("kind")], self.place.at(AHEAD_M, self._clear_m, 90.0))]

    def trigger(self) -> Behaviour:
        """The ego is about to be there."""
        begins_m = self.place.trigger_s_m + AHEAD_M - HALF_WIDTH_M - EGO_HALF_LENGTH_M
        return TimeToArrival(begins_m, self.number("warning"), "the driveway")

    def conflict(self) -> Behaviour:
        """It backs into the lane, stands, and pulls in again."""
        pace_mps, way_m = self.number("pace"), CLEAR_M + self.number("into")
        return InTurn(
            BackUp(CAR, way_m, pace_mps),
            Hold(CAR, self.number("stands")),
            DriveAlong(CAR, Path.straight(self.place.at(AHEAD_M, self._clear_m - way_m, 90.0), way_m), pace_mps),
            name="it backs out",
        )

    def criteria(self) -> Sequence[Criterion]:
        """No contact, and the ego goes on."""
        return [NoCollision(), Arrives(), InTime()]
